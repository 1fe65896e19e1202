// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "poses.h"

#include <array>
#include <cstring>
#include <optional>
#include <span>
#include <string>

#include "arrays.h"
#include "errors.h"

namespace limber::python {
namespace {

constexpr const char* pose_form =
    "None, a 4 x 4 matrix, (rotation, translation) with a 3 x 3 matrix, or (quaternion, translation) with w, x, y, z, "
    "of float32, float64, or integers of 32 or 64 bits";
constexpr const char* poses_form =
    "None, one pose, n 4 x 4 matrices, (n rotations, n translations) or (n quaternions, n translations), "
    "of float32, float64, or integers of 32 or 64 bits";

/// The index of a pose in a list, where there is one.
using Index = std::optional<std::size_t>;

Transform rigid_or_raise(Result<Transform> result, const char* name, Index index) {
  if (result) return *result;
  std::string text = name;
  if (index) text.append("[").append(std::to_string(*index)).append("]");
  raise({result.error().code, text.append(": ").append(result.error().text), index});
}

/// `count` numbers of the two axes that follow `first_axis`, row by row.
template <std::size_t count>
std::array<double, count> matrix_at(const Array& array, const unsigned char* first, std::size_t first_axis) {
  constexpr std::size_t side = count == 16 ? 4 : 3;
  std::array<double, count> numbers;
  for (std::size_t row = 0; row < side; ++row) {
    array.read_reals(first + static_cast<std::ptrdiff_t>(row) * array.stride(first_axis), array.stride(first_axis + 1),
                     std::span(numbers).subspan(side * row, side));
  }
  return numbers;
}

Transform from_matrix(const Array& array, const unsigned char* first, std::size_t axis, const char* name, Index index) {
  return rigid_or_raise(transform_from_matrix(matrix_at<16>(array, first, axis), MatrixOrder::row_major), name, index);
}

Vec3 vector_at(const Array& array, const unsigned char* first, std::size_t axis) {
  std::array<double, 3> numbers;
  array.read_reals(first, array.stride(axis), numbers);
  return {numbers[0], numbers[1], numbers[2]};
}

Transform from_parts(const Array& turn, const unsigned char* turn_at, const Array& shift, const unsigned char* shift_at,
                     std::size_t axis, const char* name, Index index) {
  const Vec3 translation = vector_at(shift, shift_at, axis);
  if (turn.size(axis) == 3) {
    const std::array<double, 9> m = matrix_at<9>(turn, turn_at, axis);
    const Vec3& t = translation;
    const std::array<double, 16> matrix{m[0], m[1], m[2], t.x, m[3], m[4], m[5], t.y,
                                        m[6], m[7], m[8], t.z, 0,    0,    0,    1};
    return rigid_or_raise(transform_from_matrix(matrix, MatrixOrder::row_major), name, index);
  }
  std::array<double, 4> q;
  turn.read_reals(turn_at, turn.stride(axis), q);
  return rigid_or_raise(transform_from_quaternion(translation, q[0], q[1], q[2], q[3]), name, index);
}

/// The two parts of a pose or of poses, or nothing if the object is not a tuple of two.
std::optional<std::array<nb::handle, 2>> parts_of(nb::handle object) {
  if (!PyTuple_CheckExact(object.ptr()) || PyTuple_GET_SIZE(object.ptr()) != 2) return std::nullopt;
  return std::array<nb::handle, 2>{PyTuple_GET_ITEM(object.ptr(), 0), PyTuple_GET_ITEM(object.ptr(), 1)};
}

}  // namespace

Transform pose_from(nb::handle object, const char* name) {
  if (object.is_none()) return {};
  if (const auto parts = parts_of(object)) {
    const Array turn((*parts)[0], name, pose_form, Lists::floats), shift((*parts)[1], name, pose_form, Lists::floats);
    if (!turn.has_numbers({3, 3}) && !turn.has_numbers({4})) turn.refuse();
    if (!shift.has_numbers({3})) shift.refuse();
    return from_parts(turn, turn.data(), shift, shift.data(), 0, name, std::nullopt);
  }
  const Array matrix(object, name, pose_form, Lists::floats);
  if (!matrix.has_numbers({4, 4})) matrix.refuse();
  return from_matrix(matrix, matrix.data(), 0, name, std::nullopt);
}

PoseList::PoseList(nb::handle object, const char* name) {
  if (object.is_none()) {
    poses_.emplace_back();
    return;
  }
  if (const auto parts = parts_of(object)) {
    const Array turn((*parts)[0], name, poses_form, Lists::floats), shift((*parts)[1], name, poses_form, Lists::floats);
    if (shift.dimensions() == 1) {
      poses_.push_back(pose_from(object, name));
      return;
    }
    if (!turn.has_numbers({-1, 3, 3}) && !turn.has_numbers({-1, 4})) turn.refuse();
    if (!shift.has_numbers({static_cast<std::ptrdiff_t>(turn.size(0)), 3})) shift.refuse();
    is_one_for_all_ = false;
    poses_.reserve(turn.size(0));
    for (std::size_t i = 0; i < turn.size(0); ++i) {
      const auto step = static_cast<std::ptrdiff_t>(i);
      poses_.push_back(from_parts(turn, turn.data() + step * turn.stride(0), shift,
                                  shift.data() + step * shift.stride(0), 1, name, i));
    }
    return;
  }
  const Array matrices(object, name, poses_form, Lists::floats);
  if (matrices.dimensions() == 2) {
    poses_.push_back(pose_from(object, name));
    return;
  }
  if (!matrices.has_numbers({-1, 4, 4})) matrices.refuse();
  is_one_for_all_ = false;
  poses_.reserve(matrices.size(0));
  for (std::size_t i = 0; i < matrices.size(0); ++i) {
    poses_.push_back(
        from_matrix(matrices, matrices.data() + static_cast<std::ptrdiff_t>(i) * matrices.stride(0), 1, name, i));
  }
}

}  // namespace limber::python
