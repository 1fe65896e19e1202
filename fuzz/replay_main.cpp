// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs a fuzz target on files, on every file of folders, and on so many random inputs, without libFuzzer:
// fuzz_<target> [--random N] PATH...
// Exit code 0 when all properties hold, 2 when there is no input or one cannot be read.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/property.h"

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> inputs_below(int count, char** arguments) {
  std::vector<fs::path> inputs;
  for (int i = 1; i < count; ++i) {
    const fs::path path = arguments[i];
    if (!fs::is_directory(path)) {
      inputs.push_back(path);
      continue;
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
      if (entry.is_regular_file()) inputs.push_back(entry.path());
    }
  }
  std::sort(inputs.begin(), inputs.end());
  return inputs;
}

/// The same inputs on each machine, some of them too short for all that they stand for.
void run_random(int count) {
  constexpr std::size_t longest = 500;
  for (int seed = 0; seed < count; ++seed) {
    std::mt19937 random(static_cast<std::uint32_t>(seed));
    std::vector<std::uint8_t> bytes(random() % longest);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    std::printf("random input %d (%zu bytes)\n", seed, bytes.size());
    std::fflush(stdout);  // names the input that ends the process
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
}

}  // namespace

int main(int count, char** arguments) {
  if (count > 2 && arguments[1] == std::string_view("--random")) {
    run_random(std::atoi(arguments[2]));
    if (count == 3) return 0;
    count -= 2, arguments += 2;
  }
  const std::vector<fs::path> inputs = inputs_below(count, arguments);
  for (const fs::path& path : inputs) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    std::printf("%s (%zu bytes)\n", path.c_str(), bytes.size());
    if (!file) {
      std::printf("cannot be read\n");
      return 2;
    }
    std::fflush(stdout);  // names the input that ends the process
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  }
  std::printf("%zu inputs\n", inputs.size());
  return inputs.empty() ? 2 : 0;
}
