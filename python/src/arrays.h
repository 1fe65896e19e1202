// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "limber/mesh.h"

/// Arrays that come from Python, read where they are.
namespace limber::python {

namespace nb = nanobind;

/// Element types that arguments may have.
enum class Scalar { float32, float64, int32, int64, uint32, uint64, other };

/// What a list of integers stands for: coordinates, or ids.
enum class Lists { floats, integers };

/// The memory of an array: NumPy's, or anything with the buffer protocol. What has neither, such as a list, becomes
/// a NumPy array first. Arrays with masked elements are refused: whoever reads memory does not see the mask.
///
/// Threads  The destructor needs the GIL; reading does not.
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
  std::ptrdiff_t stride(std::size_t axis) const { return strides_[axis]; }
  std::size_t item_bytes() const { return static_cast<std::size_t>(buffer_.itemsize); }
  /// Whether the elements lie one after the other, the last axis fastest, at multiples of their size.
  bool is_packed() const;
  const unsigned char* data() const { return static_cast<const unsigned char*>(buffer_.buf); }

  /// Whether this is an array of floats of that shape; -1 stands for any size.
  bool has_floats(std::initializer_list<std::ptrdiff_t> shape) const { return is_float() && has_shape(shape); }
  /// Whether this is an array of floats or integers of that shape.
  bool has_numbers(std::initializer_list<std::ptrdiff_t> shape) const {
    return scalar_ != Scalar::other && has_shape(shape);
  }
  bool has_shape(std::initializer_list<std::ptrdiff_t> shape) const;
  /// Whether this may be a list of no rows: NumPy makes it one axis of floats.
  bool is_empty_list() const { return dimensions() == 1 && size(0) == 0; }

  /// The number at a place. Pre: the array holds floats, or integers.
  double real(const unsigned char* place) const;
  /// The numbers at a place and every `stride` bytes on, as many as `numbers` has. Pre: as real().
  void read_reals(const unsigned char* place, std::ptrdiff_t stride, std::span<double> numbers) const;
  /// The id at a place in that row. Pre: the array holds integers.
  ///
  /// Throws   IndexError for a number that is no id.
  std::uint32_t id(const unsigned char* place, std::size_t row) const;

  /// Throws nb::value_error naming argument, shape, element type and what was expected.
  [[noreturn]] void refuse() const;

 private:
  [[noreturn]] void refuse(const std::string& found) const;
  /// What the argument is: shape and element type, or its class where it has neither.
  std::string found() const;

  Py_buffer buffer_{};
  const Py_ssize_t* strides_ = nullptr;
  std::vector<Py_ssize_t> packed_strides_;  // of objects that leave them out, as ctypes does
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
  std::optional<std::vector<double>> copied_;
};

/// Ids of vertices, read where they are if they are packed uint32.
class Ids {
 public:
  Ids(nb::handle object, const char* name);
  std::span<const std::uint32_t> view() const;

 private:
  Array array_;
  std::optional<std::vector<std::uint32_t>> copied_;
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
