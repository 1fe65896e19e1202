// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

/// The files of a run: those that it reads, and those that it writes.
///
/// Promise  No output replaces a file that the run reads, whatever names both have, and no two outputs are one file.
///          Regular files are replaced whole, once the run has succeeded, or not at all; links to them stay. Pipes,
///          devices and descriptors are written at once.
namespace limber::program {

/// To be called for every file that the run reads, in any case before place_outputs().
void add_input(const std::filesystem::path& path);

/// The files that were added, each once: by its absolute path, the name that came first.
const std::map<std::filesystem::path, std::string>& inputs();

/// The file that an option names, or standard output where it names "-".
class OutputFile {
 public:
  /// Errors   BadInput naming the option and the file: where it is an input or another output, or cannot be written.
  OutputFile(const std::string& option, const std::string& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  bool is_terminal() const;

  /// Writes and hands over. Errors: OutputFailed.
  void write(std::string_view text);

  /// Writes whole rows and hands them over. They stay beside the file when a signal ends the run, with what was written
  /// before. Errors: OutputFailed.
  void write_rows(std::string_view rows);

 private:
  struct Output* output_ = nullptr;  // that of the run; null: standard output
};

/// Puts all files in place that outputs have written. Those of a run that does not come here are removed.
///
/// Errors   OutputFailed; BadInput as OutputFile, where a file was read later.
void place_outputs();

/// "-" for a path that names standard output, such as /dev/stdout; else the path.
std::string short_name(const std::string& path);

}  // namespace limber::program
