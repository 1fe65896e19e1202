// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command/new_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <random>
#include <system_error>
#include <utility>

#include "command/output.h"
#include "command/terminal.h"

#if defined(_WIN32)
#include <io.h>
#endif

namespace limber::program {
namespace {

namespace fs = std::filesystem;

constinit NewFile* first_new_file = nullptr;

[[noreturn]] void throw_errno() { throw std::system_error(errno, std::generic_category()); }

std::string path_beside(const fs::path& target) {
  constexpr std::size_t most_bytes = 230;  // most file systems have room for 255
  const std::string name = target.filename().string();
  const std::uint32_t number = std::random_device()();
  return (target.parent_path() / fmt::format("{}.partial-{:08x}", name.size() > most_bytes ? "limber" : name, number))
      .string();
}

#if defined(_WIN32)

struct SignalsHeld {
  SignalsHeld() {}
};

int made_beside(const fs::path& /*target*/, const std::string& path) {
  return open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_BINARY, S_IREAD | S_IWRITE);
}

bool is_brought_to_disk(int descriptor) { return _commit(descriptor) == 0; }

#else

constexpr std::array ending_signals = {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU};
pthread_t writing_thread;

sigset_t set_of_ending_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : ending_signals) sigaddset(&set, signal);
  return set;
}

/// While it lives, no signal ends the run.
class SignalsHeld {
 public:
  SignalsHeld() {
    const sigset_t held = set_of_ending_signals();
    pthread_sigmask(SIG_BLOCK, &held, &before_);
  }
  ~SignalsHeld() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

 private:
  sigset_t before_{};
};

int made_beside(const fs::path& target, const std::string& path) {
  constexpr mode_t anybody = 0666, nobody_else = 0600, permissions = 0777;
  struct stat old {};
  const bool is_there = stat(target.c_str(), &old) == 0;
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, is_there ? nobody_else : anybody);
  if (descriptor == -1 || !is_there) return descriptor;
  // Few may give files away, but many may to groups of theirs.
  constexpr auto same_owner = static_cast<uid_t>(-1);
  [[maybe_unused]] const bool is_permitted =
      fchown(descriptor, old.st_uid, old.st_gid) == 0 || fchown(descriptor, same_owner, old.st_gid) == 0;
  fchmod(descriptor, old.st_mode & permissions);
  return descriptor;
}

/// Where there is no disk behind a file, EINVAL says so.
bool is_brought_to_disk(int descriptor) { return fsync(descriptor) == 0 || errno == EINVAL; }

#endif

}  // namespace

NewFile::NewFile(const fs::path& target) : target_(target), next_(first_new_file) {
  watch_signals();
  const SignalsHeld held;
  for (int attempts = 100; descriptor_ == -1; --attempts) {
    path_ = path_beside(target);
    descriptor_ = made_beside(target, path_);
    if (descriptor_ == -1 && (errno != EEXIST || attempts == 0)) throw_errno();
  }
  stream_ = fdopen(descriptor_, "wb");
  if (stream_ == nullptr) throw_errno();
  text_if_kept_ = on_one_line(fmt::format("limber: rows until now are in {}; {} is as before", path_, target.string()));
  text_if_kept_ = (is_terminal(stderr) ? "\n" : "") + text_if_kept_ + '\n';  // a bar may stand there
  first_new_file = this;
}

NewFile::~NewFile() {
  const SignalsHeld held;
  if (!is_listed_) return;
  leave_list();
  std::fclose(stream_);
  std::remove(path_.c_str());
}

void NewFile::leave_list() {
  NewFile** file = &first_new_file;
  while (*file != this) file = &(*file)->next_;
  *file = next_;
  is_listed_ = false;
}

void NewFile::store() {
  if (std::fflush(stream_) != 0 || !is_brought_to_disk(descriptor_)) throw_errno();
}

void NewFile::place() {
  const SignalsHeld held;
  leave_list();
  if (std::fclose(stream_) != 0) throw_errno();
  fs::rename(path_, target_);
}

#if defined(_WIN32)

void NewFile::watch_signals() {}

#else

void NewFile::watch_signals() {
  writing_thread = pthread_self();
  struct sigaction action = {}, before = {};
  action.sa_handler = end_by_signal;
  action.sa_mask = set_of_ending_signals();
  action.sa_flags = SA_RESTART;
  for (const int signal : ending_signals) {
    // What is ignored, as SIGHUP under nohup, stays so.
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_DFL) sigaction(signal, &action, nullptr);
  }
}

void NewFile::end_by_signal(int signal) {
  const int reason = errno;
  if (pthread_equal(pthread_self(), writing_thread) == 0) {  // which may be writing just now
    pthread_kill(writing_thread, signal);
    errno = reason;
    return;
  }
  for (const NewFile* file = first_new_file; file != nullptr; file = file->next_) {
    const auto kept_bytes = static_cast<off_t>(file->kept_bytes_.load());
    if (kept_bytes == 0 || ftruncate(file->descriptor_, kept_bytes) != 0) {
      unlink(file->path_.c_str());
      continue;
    }
    const std::string& text = file->text_if_kept_;
    [[maybe_unused]] const ssize_t is_read = ::write(STDERR_FILENO, text.data(), text.size());
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);  // comes once this function has returned
}

#endif

}  // namespace limber::program
