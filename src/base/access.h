// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace limber {

/// What public classes keep for the library's own use.
struct Access {
  /// Makes an object by a constructor that is not public.
  template <typename Class, typename... Arguments>
  static Class make(const Arguments&... arguments) {
    return Class(arguments...);
  }

  template <typename Class>
  static auto& impl(Class& object) {
    return object.impl();
  }

  /// What a triangle owns of MeshEdges, a bit mask: bit k is the vertex of corner k, bit 3 + k the edge from there to
  /// the next one.
  ///
  /// Pre      The triangle exists.
  template <typename Edges>
  static std::uint8_t represented_by(const Edges& edges, std::uint32_t triangle) {
    return edges.represented_[triangle];
  }
};

}  // namespace limber
