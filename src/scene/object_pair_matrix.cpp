// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <new>
#include <string>

#include "base/check.h"
#include "limber/scene.h"

namespace limber {
namespace {

constexpr std::size_t bits_of_word = 64;

/// How many pairs there are of so many ids.
std::size_t pairs_of(std::size_t size) { return size < 2 ? 0 : size * (size - 1) / 2; }

/// The place of a pair among {1, 0}, {2, 0}, {2, 1}, ... Pre: a < b.
std::size_t place_of(ObjectId a, ObjectId b) { return std::size_t{b} * (std::size_t{b} - 1) / 2 + a; }

/// There is no memory for a matrix of so many ids.
class TooManyIds : public std::bad_alloc {
 public:
  TooManyIds(std::size_t size, std::size_t words)
      : text_("limber::ObjectPairMatrix: size: there is no memory for the " + std::to_string(words * 8) +
              " bytes of a matrix of " + std::to_string(size) +
              " ids; let a function be the filter of so many objects") {}
  const char* what() const noexcept override { return text_.c_str(); }

 private:
  std::string text_;
};

}  // namespace

ObjectPairMatrix::ObjectPairMatrix(std::size_t size, bool counts) : size_(0) { resize(size, counts); }

void ObjectPairMatrix::resize(std::size_t size, bool counts) {
  LIMBER_REQUIRE(size <= no_id, "limber::ObjectPairMatrix: size: there are no more ids than 2^32 - 1");
  const std::size_t before = bits_.empty() ? 0 : pairs_of(size_);  // none if it was moved from
  const std::uint64_t all = counts ? ~std::uint64_t{0} : 0;
  const std::size_t words = (pairs_of(size) + bits_of_word - 1) / bits_of_word;
  try {
    if (words > bits_.max_size()) throw std::bad_alloc();
    bits_.resize(words, all);
  } catch (const std::bad_alloc&) {
    throw TooManyIds(size, words);
  }
  // The word in which old pairs end and new ones begin.
  if (before < pairs_of(size) && before % bits_of_word != 0) {
    const std::uint64_t old = (std::uint64_t{1} << (before % bits_of_word)) - 1;
    std::uint64_t& word = bits_[before / bits_of_word];
    word = (word & old) | (all & ~old);
  }
  size_ = size;
}

void ObjectPairMatrix::require_ids(std::span<const ObjectId> ids, const char* function) const {
  const std::size_t size = bits_.empty() ? std::min<std::size_t>(size_, 1) : size_;  // none if it was moved from
  LIMBER_REQUIRE(std::all_of(ids.begin(), ids.end(), [&](ObjectId id) { return id < size; }),
                 (std::string("limber::ObjectPairMatrix") + function + ": an id is not below size()").c_str());
}

void ObjectPairMatrix::write(ObjectId a, ObjectId b, bool counts) {
  const std::size_t place = place_of(std::min(a, b), std::max(a, b));
  const std::uint64_t bit = std::uint64_t{1} << (place % bits_of_word);
  LIMBER_ASSERT(a != b && place / bits_of_word < bits_.size());
  if (counts) {
    bits_[place / bits_of_word] |= bit;
  } else {
    bits_[place / bits_of_word] &= ~bit;
  }
}

void ObjectPairMatrix::set(ObjectId a, ObjectId b, bool counts) {
  require_ids({{a, b}}, "::set");
  LIMBER_REQUIRE(a != b, "limber::ObjectPairMatrix::set: the two ids are the same");
  write(a, b, counts);
}

void ObjectPairMatrix::set_among(std::span<const ObjectId> ids, bool counts) {
  require_ids(ids, "::set_among");
  for (const ObjectId a : ids) {
    for (const ObjectId b : ids) {
      if (a < b) write(a, b, counts);
    }
  }
}

void ObjectPairMatrix::set_between(std::span<const ObjectId> ids_a, std::span<const ObjectId> ids_b, bool counts) {
  require_ids(ids_a, "::set_between");
  require_ids(ids_b, "::set_between");
  for (const ObjectId a : ids_a) {
    for (const ObjectId b : ids_b) {
      if (a != b) write(a, b, counts);
    }
  }
}

bool ObjectPairMatrix::operator()(ObjectId a, ObjectId b) const {
  if (a == b || std::max(a, b) >= size_ || bits_.empty()) {
    require_ids({{a, b}}, "");
    return false;
  }
  const std::size_t place = place_of(std::min(a, b), std::max(a, b));
  return (bits_[place / bits_of_word] >> (place % bits_of_word) & 1) != 0;
}

}  // namespace limber
