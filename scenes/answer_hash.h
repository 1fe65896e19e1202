// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

/// One number for the answers to very many queries: whether two builds, processors, instruction sets, numbers of
/// threads or revisions answer alike.
namespace limber::scenes {

/// The answers to all queries of one kind.
struct AnswerHash {
  std::string kind;
  std::uint64_t queries = 0;
  std::uint64_t hash = 0;  ///< of every bit of the answers, in their order; statistics and times do not count
};

/// Asks queries of every kind that the library has, about scenes where bodies are apart, cross, touch, deform and lie
/// in common planes: some 4 000 for each unit of `scale`, which takes a second.
std::vector<AnswerHash> answer_hashes(std::uint32_t scale);

/// One hash of them all.
std::uint64_t total(const std::vector<AnswerHash>& hashes);

}  // namespace limber::scenes
