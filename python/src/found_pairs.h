// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "limber/contacts.h"
#include "query_arguments.h"
#include "records.h"

/// From the pairs that a query visits to an array of them.
namespace limber::python {

/// The pairs that search(visitor, options) visits, at most max_count of them. Ctrl-C ends the search.
template <typename Pair, typename Search>
std::vector<Pair> collected(nb::handle filter, std::optional<std::size_t> max_count, const Search& search) {
  std::vector<Pair> found;
  if (max_count == 0) return found;
  const TriangleFilter which(filter);
  without_gil_unless(which.needs_gil(), [&] {
    search(
        [&](const Pair& pair) {
          found.push_back(pair);
          constexpr std::size_t pairs_between_looks = 1 << 16;  // some ten milliseconds
          if (found.size() % pairs_between_looks == 0) look_for_signals();
          return found.size() != max_count;
        },
        PairOptions{which.get()});
  });
  return found;
}

template <typename Search>
nb::object found_pairs(nb::handle filter, std::optional<std::size_t> max_count, const Search& search) {
  const std::vector<TrianglePair> found = collected<TrianglePair>(filter, max_count, search);
  return array_of(std::span<const TrianglePair>(found), nb::str("uint32"), {found.size(), 2});
}

template <typename Search>
nb::object found_contacts(nb::handle filter, std::optional<std::size_t> max_count, const Search& search) {
  const std::vector<Contact> found = collected<Contact>(filter, max_count, search);
  return array_of(std::span<const Contact>(found), dtypes().contact);
}

/// The contacts that search(room, options) writes, for room of that many.
template <typename Search>
nb::object found_closest(nb::handle filter, std::size_t room, const Search& search) {
  const TriangleFilter which(filter);
  std::vector<Contact> found(room);
  const PairCount count =
      without_gil_unless(which.needs_gil(), [&] { return search(found, PairOptions{which.get()}); });
  return array_of(std::span<const Contact>(found).first(count.count), dtypes().contact);
}

}  // namespace limber::python
