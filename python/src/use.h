// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <stdexcept>

/// Who uses an object of Python right now: any number of readers, or one that changes it.
namespace limber::python {

/// Somebody else uses the object in a way that excludes the call. Python sees limber3d.BusyError.
class Busy : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Counts the users of an object. Nobody waits: a call that may not go on throws Busy.
class Users {
 public:
  void begin_reading(const char* refusal) {
    int users = count_.load(std::memory_order_relaxed);
    do {
      if (users < 0) throw Busy(refusal);
    } while (!count_.compare_exchange_weak(users, users + 1, std::memory_order_acquire, std::memory_order_relaxed));
  }
  void end_reading() { count_.fetch_sub(1, std::memory_order_release); }

  void begin_changing(const char* refusal) {
    int nobody = 0;
    if (!count_.compare_exchange_strong(nobody, -1, std::memory_order_acquire, std::memory_order_relaxed)) {
      throw Busy(refusal);
    }
  }
  void end_changing() { count_.store(0, std::memory_order_release); }

 private:
  std::atomic<int> count_ = 0;  // of readers; -1 while the object is changed
};

/// An object that is read for as long as this lives.
class Reading {
 public:
  Reading(Users& users, const char* refusal) : users_(&users) { users.begin_reading(refusal); }
  Reading(Reading&& other) noexcept : users_(other.users_) { other.users_ = nullptr; }
  Reading& operator=(Reading&&) = delete;
  ~Reading() {
    if (users_ != nullptr) users_->end_reading();
  }

 private:
  Users* users_;
};

/// An object that is changed for as long as this lives.
class Changing {
 public:
  Changing(Users& users, const char* refusal) : users_(users) { users.begin_changing(refusal); }
  Changing(const Changing&) = delete;
  Changing& operator=(const Changing&) = delete;
  ~Changing() { users_.end_changing(); }

 private:
  Users& users_;
};

}  // namespace limber::python
