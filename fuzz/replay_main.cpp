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

void run(const std::string& name, const std::string& bytes) {
  std::printf("%s (%zu bytes)\n", name.c_str(), bytes.size());
  std::fflush(stdout);  // names the input that ends the process
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

/// The same inputs on each machine, some of them too short for all that they stand for.
void run_random(unsigned count) {
  constexpr std::size_t longest = 500;
  for (unsigned seed = 0; seed < count; ++seed) {
    std::mt19937 random(seed);
    std::string bytes(random() % longest, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    run("random input " + std::to_string(seed), bytes);
  }
}

}  // namespace

int main(int count, char** arguments) {
  std::vector<fs::path> inputs;
  int random_count = 0;
  for (int i = 1; i < count; ++i) {
    if (arguments[i] == std::string_view("--random") && i + 1 < count) {
      random_count = std::atoi(arguments[++i]);
    } else if (fs::is_directory(arguments[i])) {
      inputs.insert(inputs.end(), fs::directory_iterator(arguments[i]), {});
    } else {
      inputs.emplace_back(arguments[i]);
    }
  }
  std::sort(inputs.begin(), inputs.end());
  run_random(static_cast<unsigned>(random_count));
  for (const fs::path& path : inputs) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    if (!file) {
      std::printf("%s cannot be read\n", path.c_str());
      return 2;
    }
    run(path.string(), bytes);
  }
  return inputs.empty() && random_count == 0 ? 2 : 0;
}
