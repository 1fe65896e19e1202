// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include "limber/distance.h"
#include "scene/scene_impl.h"

namespace limber {
namespace {

constexpr std::size_t no_entry = static_cast<std::size_t>(-1);

std::uint64_t key_of(const ObjectPair& pair) { return std::uint64_t{pair.a} << 32 | pair.b; }

}  // namespace

SceneCache::SceneCache(std::size_t max_pairs) : max_pairs_(max_pairs) {}
SceneCache::SceneCache(SceneCache&&) noexcept = default;
SceneCache& SceneCache::operator=(SceneCache&&) noexcept = default;
SceneCache::~SceneCache() = default;

void SceneCache::clear() { impl_.reset(); }

SceneCache::Impl& SceneCache::impl() {
  if (impl_ == nullptr) impl_ = std::make_unique<Impl>(max_pairs_);
  return *impl_;
}

std::span<QueryCache* const> SceneCache::Impl::caches_of(std::span<const ObjectPair> pairs) {
  ++call_;
  taken_.assign(pairs.size(), no_entry), caches_.assign(pairs.size(), nullptr);
  // First those that have one, so that no other pair takes it.
  std::size_t without = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto found = entry_of_key_.find(key_of(pairs[i]));
    if (found == entry_of_key_.end()) {
      ++without;
    } else if (std::exchange(entries_[found->second].last_call, call_) != call_) {
      taken_[i] = found->second;
    }
  }
  unused_.clear();
  if (entries_.size() + without > max_entries_) find_unused();
  for (std::size_t i = 0; i < pairs.size() && without > 0; ++i) {
    const std::uint64_t key = key_of(pairs[i]);
    if (taken_[i] != no_entry || entry_of_key_.contains(key)) continue;
    if (entries_.size() < max_entries_) {
      entries_.emplace_back();
      taken_[i] = entries_.size() - 1;
    } else if (!unused_.empty()) {
      taken_[i] = unused_.back();
      unused_.pop_back();
      entry_of_key_.erase(entries_[taken_[i]].key);
    } else {
      break;
    }
    entry_of_key_.emplace(key, taken_[i]);
    entries_[taken_[i]].key = key, entries_[taken_[i]].last_call = call_;
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (taken_[i] != no_entry) caches_[i] = &entries_[taken_[i]].cache;
  }
  return caches_;
}

/// Lists the entries that no pair of this call has, the one to be given away first at the end.
void SceneCache::Impl::find_unused() {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i].last_call < call_) unused_.push_back(i);
  }
  std::sort(unused_.begin(), unused_.end(), [&](std::size_t i, std::size_t j) {
    return std::pair(entries_[j].last_call, j) < std::pair(entries_[i].last_call, i);
  });
}

}  // namespace limber
