// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command/run_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <list>
#include <optional>
#include <system_error>

#include "command/new_file.h"
#include "command/output.h"
#include "command/terminal.h"
#include "command/text.h"

namespace limber::program {

namespace fs = std::filesystem;

/// One output of the run.
struct Output {
  std::string option, path;  ///< as the user has typed them
  fs::path target;           ///< behind all links
  std::FILE* stream = nullptr;
  std::optional<NewFile> file;   ///< where the stream goes, unless that is a pipe, a device or a descriptor
  std::uint64_t byte_count = 0;  ///< of what has been handed over

  ~Output() {
    if (!file && stream != nullptr) std::fclose(stream);
  }
};

namespace {

std::map<fs::path, std::string>& run_inputs() {
  static std::map<fs::path, std::string> files;
  return files;
}

/// What has not been put in place when the program ends is removed.
std::list<Output>& run_outputs() {
  static std::list<Output> outputs;
  return outputs;
}

/// The number of a descriptor of this program, if that is what an absolute path without links names.
std::optional<int> descriptor_named(const fs::path& path) {
  std::error_code failed;
  const fs::path folder = path.parent_path();
  const std::string name = path.filename().string();
  if (folder != "/dev/fd" && folder != fs::canonical("/proc/self/fd", failed)) return std::nullopt;
  int descriptor = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), descriptor);
  return error == std::errc() ? std::optional(descriptor) : std::nullopt;
}

/// What writing to `path` changes: an absolute path without links, or that of a descriptor. Empty where links have no
/// end.
fs::path target_of(fs::path path) {
  constexpr int most_links = 40;  // as Linux has it
  std::error_code failed;
  for (int i = 0; i < most_links; ++i) {
    path = fs::absolute(path, failed);
    path = fs::weakly_canonical(path.parent_path(), failed) / path.filename();
    if (descriptor_named(path) || !fs::is_symlink(path, failed)) return path;
    path = path.parent_path() / fs::read_symlink(path, failed);
  }
  return {};
}

/// Whether writing to one target changes the other. Devices may be named as often as one likes.
bool overwrites(const fs::path& path, const fs::path& other) {
  std::error_code failed;
  const bool is_there = fs::exists(path, failed);
  if (is_there != fs::exists(other, failed)) return false;
  return is_there ? fs::is_regular_file(path, failed) && fs::equivalent(path, other, failed) : path == other;
}

/// Refuses an output that is an input or another output.
void check(const Output& output) {
  const auto refuse_if = [&output](const fs::path& other, const char* what) {
    if (!overwrites(output.target, other)) return;
    throw BadInput(fmt::format("{}: {} is {}", output.option, output.path, what));
  };
  for (const auto& input : run_inputs()) refuse_if(input.first, "one of the inputs");
  for (const char* const stream : {"/dev/stdout", "/dev/stderr"}) refuse_if(stream, "where another output goes");
  for (const Output& other : run_outputs()) {
    if (&other != &output) refuse_if(other.target, "where another output goes");
  }
}

/// Null with errno where that fails.
std::FILE* stream_to(int descriptor) { return descriptor == -1 ? nullptr : fdopen(descriptor, "wb"); }

void open_output(Output& output) {
  const auto refuse = [&output](const std::string& reason) {
    throw BadInput(fmt::format("{}: cannot write {}: {}", output.option, output.path, reason));
  };
  const std::string target = output.target.string();
  std::error_code failed;
  const fs::file_status status = fs::status(output.path, failed);
  if (status.type() == fs::file_type::none) refuse(failed.message());
  const bool is_there = fs::exists(status);
  if (const std::optional<int> descriptor = descriptor_named(output.target)) {
    output.stream = stream_to(dup(*descriptor));  // which goes on where the descriptor is, and empties no file
  } else if (is_there && !fs::is_regular_file(status)) {
    output.stream = stream_to(open(target.c_str(), O_WRONLY));
  } else if (is_there ? access(target.c_str(), W_OK) == 0 : output.target.has_filename()) {
    try {
      output.stream = output.file.emplace(output.target).stream();
    } catch (const std::system_error& error) {
      refuse(std::string(is_there ? "no file can be made beside it, to take its place: " : "") +
             error.code().message());
    }
  }
  if (output.stream == nullptr) refuse(std::strerror(is_there ? errno : ENOENT));
}

}  // namespace

void add_input(const fs::path& path) { run_inputs().emplace(target_of(path), path.string()); }

const std::map<fs::path, std::string>& inputs() { return run_inputs(); }

OutputFile::OutputFile(const std::string& option, const std::string& path) {
  if (path == "-") return;
  output_ = &run_outputs().emplace_back();
  output_->option = option;
  output_->path = path;
  output_->target = target_of(path);
  check(*output_);
  open_output(*output_);
}

bool OutputFile::is_terminal() const { return program::is_terminal(output_ == nullptr ? stdout : output_->stream); }

void OutputFile::write(std::string_view text) {
  if (output_ == nullptr) return program::write(text), flush();
  const bool is_written = std::fwrite(text.data(), 1, text.size(), output_->stream) == text.size();
  if (!is_written || std::fflush(output_->stream) != 0) fail_to_write(output_->path, errno);
  output_->byte_count += text.size();
}

void OutputFile::write_rows(std::string_view rows) {
  write(rows);
  if (output_ != nullptr && output_->file) output_->file->keep(output_->byte_count);
}

void place_outputs() {
  for (Output& output : run_outputs()) {
    if (!output.file) continue;
    check(output);
    try {
      output.file->store();
    } catch (const std::system_error& error) {
      fail_to_write(output.path, error.code().value());
    }
  }
  for (Output& output : run_outputs()) {
    try {
      if (output.file) output.file->place();
    } catch (const std::system_error& error) {
      throw OutputFailed(fmt::format("{}: cannot replace {}: {}; the answer is in {}", output.option, output.path,
                                     error.code().message(), output.file->path()));
    }
  }
}

std::string short_name(const std::string& path) {
  return descriptor_named(target_of(path)) == STDOUT_FILENO ? "-" : path;
}

}  // namespace limber::program
