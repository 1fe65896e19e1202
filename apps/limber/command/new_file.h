// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

namespace limber::program {

/// A file that is written beside another and takes its place when it is whole. Until then it has the name of the other
/// with ".partial-" and eight digits after it.
///
/// Promise  The other file stays as it is until place(), however the run ends. A signal that ends the run removes the
///          new file; after keep() it leaves what was asked for, and tells so on standard error. SIGKILL, and Windows,
///          leave the new file as it is.
/// Threads  One thread makes all of them, and calls everything.
class NewFile {
 public:
  /// Makes the file, with owner and mode of `target` where there is one.
  ///
  /// Errors   std::system_error.
  explicit NewFile(const std::filesystem::path& target);
  /// Removes the file unless place() was called.
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  std::FILE* stream() const { return stream_; }
  const std::string& path() const { return path_; }

  /// A signal that ends the run is to leave the first bytes. Pre: the stream has handed them over.
  void keep(std::uint64_t byte_count) { kept_bytes_ = byte_count; }

  /// Brings everything to the disk. Errors: std::system_error.
  void store();

  /// Replaces the target and closes the stream.
  ///
  /// Errors   std::system_error; the new file then stays under its own path.
  void place();

 private:
  static void watch_signals();
  static void end_by_signal(int signal);
  void leave_list();

  std::filesystem::path target_;
  std::string path_, text_if_kept_;
  int descriptor_ = -1;
  std::FILE* stream_ = nullptr;
  std::atomic<std::uint64_t> kept_bytes_ = 0;
  bool is_listed_ = true;
  NewFile* next_;  // in the list of those that a signal is to look after
};

}  // namespace limber::program
