// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "limber/mesh.h"

/// Arrays that come from Python, read where they are.
namespace limber::python {

namespace nb = nanobind;

/// Element types that arguments may have.
enum class Scalar { float32, float64, int32, int64, uint32, uint64, other };

/// The memory of an array: NumPy's, or anything with the buffer protocol. What has neither, such as a list, becomes
/// a NumPy array first.
///
/// Threads  The destructor needs the GIL; reading does not.
class Array {
 public:
  /// `expected` says what the argument has to be, for messages: "shape (n, 3) and dtype float32 or float64".
  /// `list_dtype` is what lists become; nullptr lets NumPy decide.
  ///
  /// Throws   nb::python_error or nb::value_error if there is no such array.
  Array(nb::handle object, const char* name, const char* expected, const char* list_dtype);
  Array(const Array&) = delete;
  Array& operator=(const Array&) = delete;
  ~Array();

  Scalar scalar() const { return scalar_; }
  bool is_float() const { return scalar_ == Scalar::float32 || scalar_ == Scalar::float64; }
  bool is_integer() const { return scalar_ != Scalar::other && !is_float(); }
  std::size_t dimensions() const { return static_cast<std::size_t>(buffer_.ndim); }
  std::size_t size(std::size_t axis) const { return static_cast<std::size_t>(buffer_.shape[axis]); }
  std::ptrdiff_t stride(std::size_t axis) const { return buffer_.strides[axis]; }
  std::size_t item_bytes() const { return static_cast<std::size_t>(buffer_.itemsize); }
  /// Whether the elements lie one after the other, the last axis fastest.
  bool is_packed() const;
  const unsigned char* data() const { return static_cast<const unsigned char*>(buffer_.buf); }

  /// Whether this is an array of floats of that shape; -1 stands for any size.
  bool has_floats(std::initializer_list<std::ptrdiff_t> shape) const { return is_float() && has_shape(shape); }
  bool has_shape(std::initializer_list<std::ptrdiff_t> shape) const;

  /// The number at a place. Pre: the array holds floats, or integers.
  double real(const unsigned char* place) const;
  /// Pre: the array holds integers. Throws nb::index_error for a number that is no id.
  std::uint32_t id(const unsigned char* place) const;

  /// Throws nb::value_error naming argument, shape, element type and what was expected.
  [[noreturn]] void refuse() const;

 private:
  [[noreturn]] void refuse(const std::string& found) const;

  Py_buffer buffer_{};
  nb::object owner_;
  const char* name_;
  const char* expected_;
  Scalar scalar_ = Scalar::other;
};

/// Positions of vertices, read where they are unless the three coordinates of a vertex are not side by side.
class Positions {
 public:
  Positions(nb::handle object, const char* name);
  PositionsView view() const;

 private:
  Array array_;
  std::vector<double> copied_;
};

/// Ids of vertices, read where they are if they are packed uint32.
class Ids {
 public:
  Ids(nb::handle object, const char* name);
  std::span<const std::uint32_t> view() const;

 private:
  Array array_;
  std::vector<std::uint32_t> copied_;
};

/// Triples of vertex ids.
std::vector<Corners> faces_from(nb::handle object, const char* name);
/// Points as rows.
std::vector<Vec3> points_from(nb::handle object, const char* name);
/// One point.
Vec3 point_from(nb::handle object, const char* name);
/// Pairs of ids.
std::vector<std::array<std::uint32_t, 2>> id_pairs_from(nb::handle object, const char* name);

}  // namespace limber::python
