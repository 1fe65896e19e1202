// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace limber::base {

/// A visitor that writes what it is called with to a span, as far as there is room.
template <typename T>
class SpanFiller {
 public:
  explicit SpanFiller(std::span<T> room) : room_(room) {}
  bool operator()(const T& found) {
    if (next_ < room_.size()) room_[next_++] = found;
    return true;
  }

 private:
  std::span<T> room_;
  std::size_t next_ = 0;
};

/// A visitor that keeps what it is called with.
template <typename T>
class ListFiller {
 public:
  const std::vector<T>& list() const { return list_; }
  bool operator()(const T& found) { return list_.push_back(found), true; }

 private:
  std::vector<T> list_;
};

}  // namespace limber::base
