// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/distance.h"
#include "pair/query_cache_impl.h"

namespace limber {

QueryCache::QueryCache() = default;
QueryCache::QueryCache(QueryCache&&) noexcept = default;
QueryCache& QueryCache::operator=(QueryCache&&) noexcept = default;
QueryCache::~QueryCache() = default;

void QueryCache::clear() { impl_.reset(); }

QueryCache::Impl& QueryCache::impl() {
  if (impl_ == nullptr) impl_ = std::make_unique<Impl>();
  return *impl_;
}

}  // namespace limber
