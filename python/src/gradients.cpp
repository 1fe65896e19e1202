// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>

#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "arrays.h"
#include "bindings.h"
#include "docstrings.h"
#include "interrupts.h"
#include "limber/limber.h"
#include "records.h"

namespace limber::python {
namespace {

using ContactRecord = Named<"numpy.void">;
using PoseGradients = Named<"PoseGradient">;

ContactRecord contact_between(BodyObject& a, BodyObject& b, const Witness& witness, const PoseLike& pose_a,
                              const PoseLike& pose_b) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  Contact contact;
  static_cast<TriangleContact&>(contact) = without_gil([&] { return contact_of(pair.a(), pair.b(), witness); });
  contact.triangle_a = witness.triangle_a;
  contact.triangle_b = witness.triangle_b;
  return nb::object(array_of(std::span<const Contact>(&contact, 1), dtypes().contact)[0]);
}

/// Vectors, so many for each of the contacts, as an array with the axes of the contacts first.
FloatArray by_contact(const std::vector<Vec3>& vectors, const GivenContacts& given, nb::handle last_axes) {
  return nb::object(array_of(std::span<const Vec3>(vectors)).attr("reshape")(given.array.attr("shape") + last_axes));
}

template <typename Gradient>
PoseGradients pose_gradients(nb::handle contacts, nb::handle center, const Gradient& gradient) {
  const GivenContacts given = contacts_from(contacts);
  const Vec3 about = point_from(center, "center");
  const auto [forces, moments] = aside(given.contacts.size(), [=] {
    std::pair<std::vector<Vec3>, std::vector<Vec3>> both;
    for (const Contact& contact : given.contacts) {
      const PoseGradient by_pose = gradient(contact, about);
      both.first.push_back(by_pose.force), both.second.push_back(by_pose.moment);
    }
    return both;
  });
  const nb::tuple axes = nb::make_tuple(3);
  return result("PoseGradient", "force"_a = by_contact(forces, given, axes),
                "moment"_a = by_contact(moments, given, axes));
}

template <typename Gradient>
FloatArray vertex_gradients(nb::handle contacts, const Gradient& gradient) {
  const GivenContacts given = contacts_from(contacts);
  const std::vector<Vec3> by_corners = aside(given.contacts.size(), [=] {
    std::vector<Vec3> all;
    for (const Contact& contact : given.contacts) {
      for (const Vec3& by_corner : gradient(contact)) all.push_back(by_corner);
    }
    return all;
  });
  return by_contact(by_corners, given, nb::make_tuple(3, 3));
}

std::string pose_documentation(const char* model) {
  return std::string("The derivatives of distances by the motion of ") + model + R"(, which turns about `center`.

Center   is nearly always the origin of the model's frame, the translation of its pose, or its center of mass.
Shape    contacts are those of contacts(), an array of limber3d.contact_dtype with any axes, or one of its records.
Returns  `force`, the derivatives by a translation, of length 1; and `moment`, those by a rotation about the center in
         radians about each axis. Both have the axes of the contacts and three coordinates, of the world.

)" + docs::header_gradients;
}

std::string vertex_documentation(const char* model) {
  return std::string("The derivatives of distances by the corners of the triangles of ") + model +
         R"(. Those by all other vertices are 0.

Shape    contacts are those of contacts(), an array of limber3d.contact_dtype with any axes, or one of its records.
Returns  An array with the axes of the contacts, three corners, and three coordinates, of the world.

)" + docs::header_gradients;
}

}  // namespace

void bind_gradients(nb::module_& m) {
  m.def("contact_of", &contact_between, "a"_a, "b"_a, "witness"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        (std::string(docs::contact_of) + "\n\nReturns  A record of limber3d.contact_dtype, as those of contacts().")
            .c_str());
  const auto pose_gradient = [&](const char* name, auto gradient, const char* model) {
    m.def(
        name,
        [gradient](const ContactsLike& contacts, const ArrayLike& center) {
          return pose_gradients(contacts, center, gradient);
        },
        "contacts"_a, "center"_a, pose_documentation(model).c_str());
  };
  pose_gradient("pose_gradient_a", pose_gradient_a, "a");
  pose_gradient("pose_gradient_b", pose_gradient_b, "b");
  const auto vertex_gradient = [&](const char* name, auto gradient, const char* model) {
    m.def(
        name, [gradient](const ContactsLike& contacts) { return vertex_gradients(contacts, gradient); }, "contacts"_a,
        vertex_documentation(model).c_str());
  };
  vertex_gradient("vertex_gradients_a", vertex_gradients_a, "a");
  vertex_gradient("vertex_gradients_b", vertex_gradients_b, "b");
}

}  // namespace limber::python
