// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command/run_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <optional>
#include <random>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "command/output.h"
#include "command/text.h"

#if defined(_WIN32)
#include <io.h>
#else
#include <pthread.h>
#endif

namespace limber::program {

namespace fs = std::filesystem;

struct Output {
  std::string option, path;  ///< as the user has typed them; no path: not in use
  fs::path target;           ///< an absolute path without links
  std::FILE* stream = nullptr;
  std::uint64_t byte_count = 0;        ///< handed over to the stream's end
  std::string new_path, text_if_kept;  ///< of the file that is to take the target's place, if there is one
  // What a signal needs to know. It may come at any time.
  std::atomic<bool> is_new = false;  ///< whether the new file is the run's to remove
  std::atomic<std::uint64_t> row_bytes = 0;

  ~Output() {
    if (stream != nullptr) std::fclose(stream);
    if (is_new) std::remove(new_path.c_str());
    is_new = false;
  }
};

namespace {

std::set<fs::path> run_inputs;      // absolute and without links
std::array<Output, 4> run_outputs;  // no run has more; what is new when the program ends is removed

#if defined(_WIN32)

int made_file(const std::string& path, const std::string& /*target*/) {
  return open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_BINARY, S_IREAD | S_IWRITE);
}

bool reaches_disk(int descriptor) { return _commit(descriptor) == 0; }

void watch_signals() {}

#else

constexpr std::array ending_signals = {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU};
pthread_t writing_thread;

/// Makes a file with owner and mode of another, if that is there. Returns its descriptor, or -1 with errno.
int made_file(const std::string& path, const std::string& target) {
  constexpr mode_t anybody = 0666, nobody_else = 0600, permissions = 0777;
  struct stat old = {};
  const bool is_there = stat(target.c_str(), &old) == 0;
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, is_there ? nobody_else : anybody);
  if (descriptor == -1 || !is_there) return descriptor;
  [[maybe_unused]] const bool is_permitted = fchown(descriptor, old.st_uid, old.st_gid) == 0;
  fchmod(descriptor, old.st_mode & permissions);
  return descriptor;
}

/// EINVAL: there is no disk.
bool reaches_disk(int descriptor) { return fsync(descriptor) == 0 || errno == EINVAL; }

void end_by_signal(int signal) {
  const int reason = errno;
  if (pthread_equal(pthread_self(), writing_thread) == 0) {  // which may be writing just now
    pthread_kill(writing_thread, signal);
    errno = reason;
    return;
  }
  for (const Output& output : run_outputs) {
    if (!output.is_new) continue;
    const auto row_bytes = static_cast<off_t>(output.row_bytes.load());
    const std::string& text = output.text_if_kept;
    const bool is_kept = row_bytes > 0 && truncate(output.new_path.c_str(), row_bytes) == 0 &&
                         ::write(STDERR_FILENO, text.data(), text.size()) != 0;
    if (!is_kept) unlink(output.new_path.c_str());
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);  // comes once this function has returned
}

void watch_signals() {
  writing_thread = pthread_self();
  struct sigaction action = {}, before = {};
  action.sa_handler = end_by_signal;
  action.sa_flags = SA_RESTART;
  for (const int signal : ending_signals) sigaddset(&action.sa_mask, signal);
  for (const int signal : ending_signals) {
    // What is ignored, as SIGHUP under nohup, stays so.
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_DFL) sigaction(signal, &action, nullptr);
  }
}

#endif

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

/// Refuses an output that is an input or another output. A descriptor may be that of a standard stream.
void check(const Output& output) {
  const auto refuse_if = [&output](const fs::path& other, const char* what) {
    if (!overwrites(output.target, other)) return;
    throw BadInput(fmt::format("{}: {} is {}", output.option, output.path, what));
  };
  for (const fs::path& input : run_inputs) refuse_if(input, "one of the inputs");
  for (const char* const stream : {"/dev/stdout", "/dev/stderr"}) {
    if (!descriptor_named(output.target)) refuse_if(stream, "where another output goes");
  }
  for (const Output& other : run_outputs) {
    if (&other != &output && !other.path.empty()) refuse_if(other.target, "where another output goes");
  }
}

/// The descriptor of a new file beside the target, or -1 with errno.
int made_beside(Output& output) {
  constexpr std::size_t most_bytes = 230;  // most file systems have room for 255
  const std::string name = output.target.filename().string();
  const std::uint32_t number = std::random_device()();
  output.new_path = (output.target.parent_path() /
                     fmt::format("{}.partial-{:08x}", name.size() > most_bytes ? "limber" : name, number))
                        .string();
  output.text_if_kept = fmt::format("limber: rows until now are in {}; {} is as before\n", on_one_line(output.new_path),
                                    on_one_line(output.path));
  watch_signals();
  output.is_new = true;
  const int descriptor = made_file(output.new_path, output.target.string());
  if (descriptor == -1) output.is_new = false;
  return descriptor;
}

void open_output(Output& output) {
  const std::string target = output.target.string();
  const std::optional<int> named = descriptor_named(output.target);
  const char* hint = "";
  int descriptor = -1;
  std::error_code failed;
  const fs::file_status status = fs::status(output.path, failed);
  const bool is_there = fs::exists(status);
  errno = failed ? failed.value() : ENOENT;
  if (named) {
    descriptor = dup(*named);  // which goes on where that one is, and empties no file
  } else if (is_there && !fs::is_regular_file(status)) {
    descriptor = open(target.c_str(), O_WRONLY);
  } else if (is_there ? access(target.c_str(), W_OK) == 0 : errno == ENOENT && output.target.has_filename()) {
    descriptor = made_beside(output);
    if (is_there) hint = "no file can be made beside it, to take its place: ";
  }
  if (descriptor != -1) output.stream = fdopen(descriptor, "wb");
  if (output.stream != nullptr) return;
  throw BadInput(fmt::format("{}: cannot write {}: {}{}", output.option, output.path, hint, std::strerror(errno)));
}

}  // namespace

void add_input(const fs::path& path) {
  const fs::path input = target_of(path);
  // Not even the error may be added to an input.
  const bool is_mute = overwrites(input, "/dev/stderr") && std::freopen("/dev/null", "w", stderr) != nullptr;
  if (is_mute || overwrites(input, "/dev/stdout")) {
    throw BadInput(fmt::format("{} is one of the inputs, and what the run writes would be added to it", path.string()));
  }
  run_inputs.insert(input);
}

OutputFile::OutputFile(const std::string& option, const std::string& path) {
  if (path == "-") return;
  output_ = run_outputs.data();
  while (!output_->path.empty()) ++output_;
  output_->option = option;
  output_->path = path;
  output_->target = target_of(path);
  check(*output_);
  open_output(*output_);
}

void OutputFile::write(std::string_view text) {
  if (output_ == nullptr) return program::write(text), flush();
  const bool is_written = std::fwrite(text.data(), 1, text.size(), output_->stream) == text.size();
  if (!is_written || std::fflush(output_->stream) != 0) fail_to_write(output_->path, errno);
  output_->byte_count += text.size();
}

void OutputFile::write_rows(std::string_view rows) {
  write(rows);
  if (output_ != nullptr) output_->row_bytes = output_->byte_count;
}

void place_outputs() {
  for (const Output& output : run_outputs) {
    if (!output.is_new) continue;
    check(output);
    if (!reaches_disk(fileno(output.stream))) fail_to_write(output.path, errno);
  }
  for (Output& output : run_outputs) {
    if (!output.is_new) continue;
    std::error_code failed;
    std::fclose(std::exchange(output.stream, nullptr));
    fs::rename(output.new_path, output.target, failed);
    output.is_new = false;
    if (!failed) continue;
    throw OutputFailed(fmt::format("{}: cannot replace {}: {}; the answer is in {}", output.option, output.path,
                                   failed.message(), output.new_path));
  }
}

}  // namespace limber::program
