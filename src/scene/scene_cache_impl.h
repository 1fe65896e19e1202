// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "limber/scene.h"

namespace limber {

/// Query caches of the pairs asked about last.
struct SceneCache::Impl {
  explicit Impl(std::size_t max_pairs) : max_entries_(max_pairs) {}

  /// The caches for queries of some pairs, nullptr where a pair gets none: all are taken by others of these pairs, or
  /// the pair has been there before. Valid until the next call.
  std::span<QueryCache* const> caches_of(std::span<const ObjectPair> pairs);

  ObjectPair closest;  // of the last scene that was asked for its closest objects

 private:
  struct Entry {
    std::uint64_t key = 0;
    std::uint64_t last_call = 0;  // in which it was taken
    QueryCache cache;
  };
  void find_unused();

  std::size_t max_entries_;
  std::uint64_t call_ = 0;
  std::vector<Entry> entries_;
  std::unordered_map<std::uint64_t, std::size_t> entry_of_key_;
  std::vector<std::size_t> taken_, unused_;
  std::vector<QueryCache*> caches_;
};

}  // namespace limber
