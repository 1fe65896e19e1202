// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/file_bytes.h"

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

namespace limber::io {
namespace {

namespace fs = std::filesystem;

Error unreadable(std::string reason) { return {ErrorCode::unreadable_file, std::move(reason), {}}; }

Error unreadable(const std::error_code& error) {
  if (error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory) {
    return unreadable("no such file");
  }
  if (error == std::errc::permission_denied) return unreadable("cannot be opened, its permissions may forbid it");
  return unreadable(error.message());
}

Error too_large(std::uint64_t size, std::uint64_t max_bytes) {
  return {ErrorCode::too_large,
          "has " + std::to_string(size) + " bytes, more than the limit of " + std::to_string(max_bytes),
          {}};
}

#if !defined(_WIN32)

Error unreadable(int error_number) { return unreadable(std::error_code(error_number, std::generic_category())); }

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

Result<void> check_kind(const struct stat& status) {
  if (S_ISDIR(status.st_mode)) return unreadable("is a folder");
  if (!S_ISREG(status.st_mode)) return unreadable("is not a regular file");
  return {};
}

#endif

}  // namespace

#if defined(_WIN32)

Result<std::string> read_regular_file(const fs::path& path, std::uint64_t max_bytes) {
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (status.type() == fs::file_type::not_found) return unreadable("no such file");
  if (status.type() == fs::file_type::none) return unreadable(failed);
  if (fs::is_directory(status)) return unreadable("is a folder");
  if (!fs::is_regular_file(status)) return unreadable("is not a regular file");
  const std::uint64_t size = fs::file_size(path, failed);
  if (failed) return unreadable(failed);
  if (size > max_bytes) return too_large(size, max_bytes);

  std::ifstream file(path, std::ios::binary);
  if (!file) return unreadable("cannot be opened, its permissions may forbid it");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (!file.read(bytes.data(), static_cast<std::streamsize>(size))) return unreadable("cannot be read to its end");
  return bytes;
}

#else

Result<std::string> read_regular_file(const fs::path& path, std::uint64_t max_bytes) {
  // Opening a device may already do something, so the kind is asked first, and again of what was opened in the end.
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return unreadable(errno);
  if (Result<void> checked = check_kind(status); !checked) return checked.error();
  const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (file.number() < 0 || fstat(file.number(), &status) != 0) return unreadable(errno);
  if (Result<void> checked = check_kind(status); !checked) return checked.error();
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (size > max_bytes) return too_large(size, max_bytes);

  std::string bytes(static_cast<std::size_t>(size), '\0');
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count = read(file.number(), bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return unreadable(errno);
    if (count == 0) return unreadable("cannot be read to its end");
    done += static_cast<std::size_t>(count);
  }
  return bytes;
}

#endif

namespace {

/// The path that a name in UTF-8 means. No file has another name: Windows refuses it.
std::optional<fs::path> path_of(const std::string& name) {
  try {
    return fs::path(std::u8string(name.begin(), name.end()));
  } catch (const std::system_error&) {
    return std::nullopt;
  }
}

}  // namespace

BufferSource buffers_beside(const fs::path& mesh_file) {
  return [folder = mesh_file.parent_path()](const std::string& name, std::uint64_t max_bytes) -> Result<std::string> {
    const std::optional<fs::path> path = path_of(name);
    if (!path) return unreadable("no such file");
    LIMBER_ASSERT(path->is_relative());
    std::error_code failed;
    const fs::path real_folder = fs::canonical(folder.empty() ? fs::path(".") : folder, failed);
    if (failed) return unreadable(failed.message());
    const fs::path real_file = fs::canonical(real_folder / *path, failed);
    if (failed) return unreadable(failed);
    const auto [folder_end, file_part] =
        std::mismatch(real_folder.begin(), real_folder.end(), real_file.begin(), real_file.end());
    if (folder_end != real_folder.end() || file_part == real_file.end()) {
      return unreadable("lies outside the folder of the glTF file");
    }
    return read_regular_file(real_file, max_bytes);
  };
}

}  // namespace limber::io
