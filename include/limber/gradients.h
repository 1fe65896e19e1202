// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "limber/base.h"
#include "limber/distance.h"
#include "limber/geometry.h"
#include "limber/math.h"
#include "limber/model.h"

/// How a distance changes with poses and with vertices: what a solver or an optimizer needs beside the distance.
///
///   const DistanceResult near = distance(a, b);
///   const TriangleContact contact = contact_of(a, b, *near.witness);
///   const PoseGradient by_b = pose_gradient_b(contact, b.pose.translation);
///
/// The contacts of contacts.h need no contact_of(): they are TriangleContacts.
///
/// Where the triangles are apart and no other points of the models are as close, the distance has a derivative, and
/// these functions give it. Where several pairs of points are equally close, as between parallel faces, the distance
/// has a kink. What is given then is the derivative for the one pair that the contact names: to first order, a motion
/// may bring the models closer than that says, but not farther apart. Where triangles cross, or bodies with a radius
/// overlap, the distance and its derivative are 0; what is given is the direction in which the contact's normal parts
/// them. A witness of what is inside of a solid gives a contact of two triangles that are apart.
///
/// Frame    World, as the contact is. In the frame of a model, apply the inverse of its rotation.
/// Cost     O(1). Allocates nothing.
/// Threads  Reentrant.
/// Source   docs/guide/contacts.md, "Gradients".
namespace limber {

/// The derivative of a distance by a rigid motion of one model: the power of a unit force along the contact's normal.
struct [[nodiscard]] PoseGradient {
  Vec3 force;   ///< by a translation; of length 1
  Vec3 moment;  ///< by a rotation about the center that was given, in radians about each axis
};

/// The derivative by the motion of a, or of b, which turns about `center`: nearly always the origin of its frame,
/// pose.translation, or its center of mass.
inline PoseGradient pose_gradient_a(const TriangleContact& contact, const Vec3& center) {
  return {-contact.normal, -cross(contact.point_a - center, contact.normal)};
}
inline PoseGradient pose_gradient_b(const TriangleContact& contact, const Vec3& center) {
  return {contact.normal, cross(contact.point_b - center, contact.normal)};
}

/// The derivatives by the corners of the triangle of a, or of b. Those by all other vertices are 0.
[[nodiscard]] inline std::array<Vec3, 3> vertex_gradients_a(const TriangleContact& contact) {
  const Vec3 &n = contact.normal, &w = contact.weights_a;
  return {-w.x * n, -w.y * n, -w.z * n};
}
[[nodiscard]] inline std::array<Vec3, 3> vertex_gradients_b(const TriangleContact& contact) {
  const Vec3 &n = contact.normal, &w = contact.weights_b;
  return {w.x * n, w.y * n, w.z * n};
}

/// The contact() of geometry.h of the two triangles that a witness names, as placed, less the radii of shapes as
/// contacts.h says. For one model with itself, both are Placed{model}.
///
/// Throws   std::invalid_argument unless both models are committed, both poses are rigid, and the models have these
///          triangles.
LIMBER_API TriangleContact contact_of(const Placed& a, const Placed& b, const Witness& witness);

}  // namespace limber
