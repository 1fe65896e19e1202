// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "limber/math.h"
#include "limber/mesh.h"
#include "limber/scene.h"

/// Arrays and poses that come from Python.
namespace limber::python {

namespace nb = nanobind;

/// Element types that arguments may have.
enum class Scalar { float32, float64, int32, int64, uint32, uint64, other };

/// What a list of integers stands for: coordinates, or ids.
enum class Lists { floats, integers };

/// The memory of an array: NumPy's, or anything with the buffer protocol. What has neither, such as a list, becomes
/// a NumPy array first. Arrays with masked elements are refused: whoever reads memory does not see the mask.
///
/// Threads  Functions need the GIL; reading the memory does not.
class Array {
 public:
  /// `expected` says what the argument has to be, for messages: "shape (n, 3) and dtype float32 or float64".
  /// `lists` says what a list of integers becomes.
  ///
  /// Throws   nb::python_error or nb::value_error if there is no such array.
  Array(nb::handle object, const char* name, const char* expected, Lists lists);
  Array(const Array&) = delete;
  Array& operator=(const Array&) = delete;
  ~Array();

  Scalar scalar() const { return scalar_; }
  bool is_float() const { return scalar_ == Scalar::float32 || scalar_ == Scalar::float64; }
  bool is_integer() const { return scalar_ != Scalar::other && !is_float(); }
  std::size_t dimensions() const { return static_cast<std::size_t>(buffer_.ndim); }
  std::size_t size(std::size_t axis) const { return static_cast<std::size_t>(buffer_.shape[axis]); }
  const unsigned char* data() const { return static_cast<const unsigned char*>(buffer_.buf); }
  /// Whether the elements lie one after the other, the last axis fastest.
  bool is_packed() const { return PyBuffer_IsContiguous(&buffer_, 'C') != 0; }
  /// From one row of an array with two axes to the next, if the elements of a row lie side by side, and rows do not run
  /// backwards.
  std::optional<std::size_t> row_bytes() const;

  /// Whether this is an array of floats of that shape; -1 stands for any size.
  bool has_floats(std::initializer_list<std::ptrdiff_t> shape) const { return is_float() && has_shape(shape); }
  /// Whether this is an array of floats or integers of that shape.
  bool has_numbers(std::initializer_list<std::ptrdiff_t> shape) const {
    return scalar_ != Scalar::other && has_shape(shape);
  }
  bool has_shape(std::initializer_list<std::ptrdiff_t> shape) const;
  /// Whether this may be a list of no rows: NumPy makes it one axis of floats.
  bool is_empty_list() const { return dimensions() == 1 && size(0) == 0; }

  /// All elements, row by row. Pre: the array holds floats, or integers.
  std::vector<double> numbers() const;
  /// All elements, row by row, as ids. Pre: the array holds integers.
  ///
  /// Throws   IndexError, naming the row, for a number that is no id.
  std::vector<std::uint32_t> ids() const;

  /// Throws nb::value_error naming argument, shape, element type and what was expected.
  [[noreturn]] void refuse() const;

 private:
  [[noreturn]] void refuse(const std::string& found) const;
  void get_buffer();
  /// Takes a copy of elements that are not read as they are: small or swapped ones, integers where floats are wanted.
  void convert(Lists lists);
  /// What the argument is: shape and element type, or its class where it has neither.
  std::string found() const;
  /// Calls use(value, i) for each element, row by row.
  template <typename Use>
  void for_elements(const Use& use) const;

  Py_buffer buffer_{};
  nb::object owner_, given_;  // the second before convert(), if that was called
  const char* name_;
  const char* expected_;
  Scalar scalar_ = Scalar::other;
};

/// Ids.
std::vector<std::uint32_t> ids_from(nb::handle object, const char* name);
/// Triples of vertex ids.
std::vector<Corners> faces_from(nb::handle object, const char* name);
/// Pairs of ids.
std::vector<ObjectPair> id_pairs_from(nb::handle object, const char* name);
/// Points as rows.
std::vector<Vec3> points_from(nb::handle object, const char* name);
/// One point.
Vec3 point_from(nb::handle object, const char* name);
/// The upper left of a matrix. Pre: it has at least three rows and columns of numbers.
Mat3 matrix_from(const Array& array);

/// One pose: None; a 4 x 4 matrix; (rotation, translation) with a 3 x 3 matrix; (quaternion, translation) with
/// w, x, y, z.
///
/// Throws   nb::value_error if it has none of these forms, or for what the functions of limber/math.h refuse.
Transform pose_from(nb::handle given, const char* name);

/// Many poses: the same forms with another axis before the others, or one pose for all.
class PoseList {
 public:
  /// Throws   As pose_from(), naming the index.
  PoseList(nb::handle given, const char* name);

  bool is_one_for_all() const { return is_one_for_all_; }
  /// Pre: not is_one_for_all().
  std::size_t size() const { return poses_.size(); }
  const Transform& operator[](std::size_t i) const { return poses_[is_one_for_all_ ? 0 : i]; }
  const std::vector<Transform>& poses() const { return poses_; }

 private:
  std::vector<Transform> poses_;
  bool is_one_for_all_ = true;
};

/// Poses of many configurations, of as many objects each, one configuration after the other: the forms of PoseList with
/// an axis of configurations, then one of objects, before the others.
///
/// Throws   As pose_from(), naming configuration and object.
std::vector<Transform> configurations_from(nb::handle given, std::size_t objects, const char* name);

}  // namespace limber::python
