// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

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

}  // namespace limber::base
