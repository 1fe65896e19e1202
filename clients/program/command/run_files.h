// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

/// The files that a run reads and writes.
namespace limber::program {

/// To be called for every file that the run reads, once its name is known.
///
/// Errors   BadInput where standard output or standard error goes to this file; nobody reads it in the latter case.
void add_input(const std::filesystem::path& path);

/// The file that an option names, or standard output where it names "-".
///
/// Promise  A regular file stays as it is until place_outputs(). What is written goes to a new file beside it, with
///          ".partial-" and eight digits after its name. A run that fails removes that one; a signal that ends the run
///          does, too, but leaves whole rows and tells where. SIGKILL, and Windows, leave it as it is. Pipes, devices
///          and descriptors, such as /dev/stdout, are written at once.
/// Threads  One thread makes and uses all of them.
class OutputFile {
 public:
  /// Errors   BadInput naming the option and the file: where it is an input or another output, under whatever name, or
  ///          cannot be written.
  OutputFile(const std::string& option, const std::string& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Writes and hands over. Errors: OutputFailed.
  void write(std::string_view text);

  /// As write(), and a signal leaves everything until the end of these rows.
  void write_rows(std::string_view rows);

 private:
  struct Output* output_ = nullptr;  // one of the run's; null: standard output
};

/// Puts all files in place that outputs have written, with owner and mode of those that were there, whose links stay.
///
/// Errors   OutputFailed; BadInput where a file has become an input after it was opened.
void place_outputs();

}  // namespace limber::program
