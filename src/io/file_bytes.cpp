// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#if defined(_WIN32)
#include <fstream>
#else
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

#include <algorithm>
#include <cerrno>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "base/check.h"
#include "io/soup.h"

namespace limber::io {
namespace {

namespace fs = std::filesystem;

BadResult unreadable(std::string reason) { return BadResult({ErrorCode::unreadable_file, std::move(reason), {}}); }

BadResult unreadable(const std::error_code& error) {
  if (error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory) {
    return unreadable("no such file");
  }
  if (error == std::errc::permission_denied) return unreadable("cannot be opened, its permissions may forbid it");
  return unreadable(error.message());
}

/// The path that a name in UTF-8 means. No file has another name: Windows refuses it.
std::optional<fs::path> path_of(const std::string& name) {
  try {
    return fs::path(std::u8string(name.begin(), name.end()));
  } catch (const std::system_error&) {
    return std::nullopt;
  }
}

#if defined(_WIN32)
void read_all(const fs::path& path, std::string& bytes) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw unreadable("cannot be opened, its permissions may forbid it");
  if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
    throw unreadable("cannot be read to its end");
}
#else
BadResult last_error() { return unreadable(std::error_code(errno, std::generic_category())); }

class Descriptor {
 public:
  explicit Descriptor(const fs::path& path)
      : number(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {}  // a pipe does not wait
  ~Descriptor() {
    if (number >= 0) close(number);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  const int number;
};

void read_all(const fs::path& path, std::string& bytes) {
  const Descriptor file(path);
  struct stat opened {};  // the path may name something else by now
  if (file.number < 0 || fstat(file.number, &opened) != 0) throw last_error();
  if (!S_ISREG(opened.st_mode)) throw unreadable("is not a regular file");
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count = read(file.number, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw last_error();
    if (count == 0) throw unreadable("cannot be read to its end");
    done += static_cast<std::size_t>(count);
  }
}
#endif

}  // namespace

std::string read_regular_file(const fs::path& path, std::uint64_t max_bytes) {
  // Opening a device may already do something, so the kind is asked first, and again of what was opened in the end.
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (status.type() == fs::file_type::not_found) throw unreadable("no such file");
  if (status.type() == fs::file_type::none) throw unreadable(failed);
  if (fs::is_directory(status)) throw unreadable("is a folder");
  if (!fs::is_regular_file(status)) throw unreadable("is not a regular file");
  const std::uint64_t size = fs::file_size(path, failed);
  if (failed) throw unreadable(failed);
  if (size > max_bytes) {
    throw BadResult({ErrorCode::too_large,
                     "has " + std::to_string(size) + " bytes, more than the limit of " + std::to_string(max_bytes),
                     {}});
  }
  std::string bytes(static_cast<std::size_t>(size), '\0');
  read_all(path, bytes);
  return bytes;
}

BufferSource buffers_beside(const fs::path& mesh_file) {
  return [folder = mesh_file.parent_path()](const std::string& name, std::uint64_t max_bytes) {
    const std::optional<fs::path> path = path_of(name);
    if (!path) throw unreadable("no such file");
    LIMBER_ASSERT(path->is_relative());
    std::error_code failed;
    const fs::path real_folder = fs::canonical(folder.empty() ? fs::path(".") : folder, failed);
    if (failed) throw unreadable(failed.message());
    const fs::path real_file = fs::canonical(real_folder / *path, failed);
    if (failed) throw unreadable(failed);
    const auto [folder_end, file_part] =
        std::mismatch(real_folder.begin(), real_folder.end(), real_file.begin(), real_file.end());
    if (folder_end != real_folder.end() || file_part == real_file.end()) {
      throw unreadable("lies outside the folder of the glTF file");
    }
    return read_regular_file(real_file, max_bytes);
  };
}

}  // namespace limber::io
