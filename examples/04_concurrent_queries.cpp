// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Many threads ask about the same models: queries are const and share nothing.
#include <cstdio>
#include <thread>
#include <vector>

#include "limber/limber.h"
#include "shapes.h"

int main() {
  const limber::Model square(shapes::sheet(64, 8)), ball(shapes::ball(32));
  const auto distance_at = [&](std::size_t place) {
    const double height = 0.1 * static_cast<double>(place);
    return limber::distance({square}, {ball, {{}, {0, 0, 1 + height}}}).upper;
  };

  constexpr std::size_t places = 64, thread_count = 8;
  std::vector<double> found(places);
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < thread_count; ++t) {
      threads.emplace_back([&, t] {
        for (std::size_t place = t; place < places; place += thread_count) found[place] = distance_at(place);
      });
    }
  }
  std::size_t equal = 0;
  for (std::size_t place = 0; place < places; ++place) equal += found[place] == distance_at(place) ? 1 : 0;
  std::printf("%zu of %zu answers are the same to the last bit on one thread\n", equal, places);
  return equal == places ? 0 : 1;
}
