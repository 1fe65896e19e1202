// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace limber {

/// Gives the library access to private members of public classes.
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

  template <typename Body>
  static bool is_in_one_piece(const Body& body) {
    return body.is_in_one_piece_;
  }

  /// What is known of a body that is convex; nullptr if nothing is.
  template <typename Body>
  static auto convex_parts(const Body& body) {
    return body.convex_;
  }

  template <typename Convex>
  static auto parts_of(const Convex& convex) {
    return convex.parts_.get();
  }

  /// The surface of a solid, which its model may lose; 0 for other bodies, and for shapes, which do not change.
  template <typename Body>
  static std::uint32_t surface_id(const Body& body) {
    return body.surface_id_;
  }

  /// The model of a placed closed surface.
  ///
  /// Throws   std::invalid_argument if the model has been reset() since its surface was created.
  template <typename Surface>
  static auto placed(const Surface& placed) {
    return placed.surface.placed(placed.pose);
  }

  /// Bit mask of the elements that a triangle represents: bit k is the vertex of corner k, bit 3 + k is the edge from
  /// corner k to the next corner.
  ///
  /// Pre      The triangle exists.
  template <typename Edges>
  static std::uint8_t represented_by(const Edges& edges, std::uint32_t triangle) {
    return edges.represented_[triangle];
  }
};

}  // namespace limber
