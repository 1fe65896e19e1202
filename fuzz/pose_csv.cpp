// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Bytes as one pose and as a list of poses: the result is rigid transforms or an error of one line, whatever the text.
#include "formats/csv.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "command/run_files.h"
#include "command/text.h"
#include "fuzz/property.h"

void limber::program::add_input(const std::filesystem::path& /*path*/) {}  // no output has to be kept from a file

namespace limber::fuzz {
namespace {

/// A file of this process; removed at exit.
struct ScratchFile {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("limber-fuzz-" + std::to_string(::getpid()) + ".csv");
  ~ScratchFile() { std::filesystem::remove(path); }
} const scratch;

void check_one_pose(std::string_view text) {
  const Result<Transform> pose = program::parsed_pose(text);
  if (pose) return require(is_rigid(*pose), "a pose that was read is rigid");
  require(is_one_line(pose.error().text), "an error of a pose is one line", pose.error().text);
}

/// Whether every row is a pose by itself, so that the list must be accepted.
bool is_plain_list(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    if (!program::parsed_pose(text.substr(0, end))) return false;
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  }
  return true;
}

void check_list(std::string_view text) {
  const std::string path = scratch.path.string();
  std::ofstream(scratch.path, std::ios::binary) << text;
  const auto line_count = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
  try {
    const std::vector<Transform> poses = program::read_poses(path);
    require(!poses.empty() && poses.size() <= line_count, "a list has one pose at least and one a line at most");
    for (const Transform& pose : poses) require(is_rigid(pose), "a pose of a list is rigid");
  } catch (const program::BadInput& refused) {
    const std::string why = refused.what();
    require(is_one_line(why), "an error of a list is one line", why);
    require(why.starts_with(path + ": "), "an error of a list starts with the file's name", why);
    require(text.empty() || !is_plain_list(text), "a list of poses is accepted", why);
  }
}

}  // namespace
}  // namespace limber::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  limber::fuzz::check_one_pose(text);
  limber::fuzz::check_list(text);
  return 0;
}
