// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "errors.h"

namespace limber::python {
namespace {

template <typename T>
T read(const unsigned char* place) {
  T value;
  std::memcpy(&value, place, sizeof value);
  return value;
}

/// The element type that a format of the struct module stands for.
Scalar scalar_of(const char* format, std::size_t item_bytes) {
  if (format == nullptr) return Scalar::other;
  if (*format == '@' || *format == '=' || *format == '<') ++format;  // the machine's own byte order
  if (format[0] == '\0' || format[1] != '\0') return Scalar::other;
  switch (format[0]) {
    case 'f':
      return Scalar::float32;
    case 'd':
      return Scalar::float64;
    case 'i':
    case 'l':
    case 'q':
      return item_bytes == 4 ? Scalar::int32 : Scalar::int64;
    case 'I':
    case 'L':
    case 'Q':
      return item_bytes == 4 ? Scalar::uint32 : Scalar::uint64;
    default:
      return Scalar::other;
  }
}

/// Whether reading the memory of an array would read what its mask hides.
bool has_masked_elements(nb::handle object) {
  const bool is_plain = std::strcmp(Py_TYPE(object.ptr())->tp_name, "numpy.ndarray") == 0;
  return !is_plain && nb::cast<bool>(nb::module_::import_("numpy.ma").attr("is_masked")(object));
}

}  // namespace

Array::Array(nb::handle object, const char* name, const char* expected, Lists lists)
    : owner_(nb::borrow(object)), name_(name), expected_(expected) {
  if (PyObject_CheckBuffer(object.ptr()) == 0) {
    try {
      const nb::object array = nb::module_::import_("numpy").attr("asarray")(object);
      if (nb::cast<int>(array.attr("ndim")) == 0) refuse(found());
      const nb::object kind = array.attr("dtype").attr("kind");
      const bool is_integers = kind.equal(nb::str("i")) || kind.equal(nb::str("u"));
      owner_ = lists == Lists::floats && is_integers ? array.attr("astype")("float64") : array;
    } catch (nb::python_error& error) {
      if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError)) throw;
      refuse(found());
    }
  } else if (has_masked_elements(object)) {
    refuse("masked elements");
  }
  if (PyObject_GetBuffer(owner_.ptr(), &buffer_, PyBUF_STRIDES | PyBUF_FORMAT) != 0) {
    PyErr_Clear();
    refuse(found());
  }
  strides_ = buffer_.strides;
  if (strides_ == nullptr) {
    packed_strides_.resize(dimensions());
    PyBuffer_FillContiguousStrides(buffer_.ndim, buffer_.shape, packed_strides_.data(),
                                   static_cast<int>(buffer_.itemsize), 'C');
    strides_ = packed_strides_.data();
  }
  scalar_ = scalar_of(buffer_.format, item_bytes());
}

Array::~Array() { PyBuffer_Release(&buffer_); }

bool Array::is_packed() const {
  const bool is_aligned = reinterpret_cast<std::uintptr_t>(data()) % item_bytes() == 0;
  return is_aligned && PyBuffer_IsContiguous(&buffer_, 'C') != 0;
}

bool Array::has_shape(std::initializer_list<std::ptrdiff_t> shape) const {
  if (dimensions() != shape.size()) return false;
  return std::equal(shape.begin(), shape.end(), buffer_.shape,
                    [](std::ptrdiff_t wanted, Py_ssize_t found) { return wanted < 0 || wanted == found; });
}

double Array::real(const unsigned char* place) const {
  double number = 0;
  read_reals(place, 0, {&number, 1});
  return number;
}

void Array::read_reals(const unsigned char* place, std::ptrdiff_t stride, std::span<double> numbers) const {
  const auto read_as = [&]<typename T>(T) {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      numbers[i] = static_cast<double>(read<T>(place + static_cast<std::ptrdiff_t>(i) * stride));
    }
  };
  switch (scalar_) {
    case Scalar::float32:
      return read_as(float{});
    case Scalar::int32:
      return read_as(std::int32_t{});
    case Scalar::int64:
      return read_as(std::int64_t{});
    case Scalar::uint32:
      return read_as(std::uint32_t{});
    case Scalar::uint64:
      return read_as(std::uint64_t{});
    default:
      return read_as(double{});
  }
}

std::uint32_t Array::id(const unsigned char* place, std::size_t row) const {
  const auto refuse_id = [&](const std::string& value) {
    raise({ErrorCode::index_out_of_range,
           std::string(name_) + "[" + std::to_string(row) + "]: " + value + " is not an index", row});
  };
  if (scalar_ == Scalar::uint32) return read<std::uint32_t>(place);
  if (scalar_ == Scalar::uint64) {
    const auto value = read<std::uint64_t>(place);
    if (value >= no_id) refuse_id(std::to_string(value));
    return static_cast<std::uint32_t>(value);
  }
  const std::int64_t value = scalar_ == Scalar::int32 ? read<std::int32_t>(place) : read<std::int64_t>(place);
  if (value < 0 || value >= std::int64_t{no_id}) refuse_id(std::to_string(value));
  return static_cast<std::uint32_t>(value);
}

void Array::refuse(const std::string& found) const {
  throw nb::value_error((std::string(name_) + ": expected " + expected_ + "; got " + found).c_str());
}

void Array::refuse() const { refuse(found()); }

std::string Array::found() const {
  if (nb::hasattr(owner_, "dtype") && nb::hasattr(owner_, "shape")) {
    return nb::cast<std::string>(nb::str("shape {} and dtype {}").format(owner_.attr("shape"), owner_.attr("dtype")));
  }
  if (buffer_.obj == nullptr) return nb::cast<std::string>(owner_.type().attr("__name__"));
  nb::list shape;
  for (std::size_t axis = 0; axis < dimensions(); ++axis) shape.append(size(axis));
  return nb::cast<std::string>(nb::str("shape {} and dtype {}")
                                   .format(nb::tuple(shape), buffer_.format == nullptr ? "unknown" : buffer_.format));
}

namespace {

constexpr const char* rows_of_3_floats = "shape (n, 3) and dtype float32 or float64";

/// Calls read(i, place of the first element) for each row of an array with two axes.
template <typename Read>
void for_rows(const Array& array, const Read& read_row) {
  const unsigned char* row = array.data();
  for (std::size_t i = 0; i < array.size(0); ++i, row += array.stride(0)) read_row(i, row);
}

}  // namespace

Positions::Positions(nb::handle object, const char* name) : array_(object, name, rows_of_3_floats, Lists::floats) {
  if (!array_.has_floats({-1, 3}) && !array_.is_empty_list()) array_.refuse();
  const bool has_rows = array_.size(0) != 0;
  const bool is_readable =
      has_rows && array_.stride(1) == static_cast<std::ptrdiff_t>(array_.item_bytes()) && array_.stride(0) >= 0;
  if (is_readable) return;
  copied_.emplace(3 * array_.size(0));
  if (!has_rows) return;
  for_rows(array_, [&](std::size_t i, const unsigned char* row) {
    array_.read_reals(row, array_.stride(1), std::span(*copied_).subspan(3 * i, 3));
  });
}

PositionsView Positions::view() const {
  if (copied_) return PositionsView::packed(*copied_);
  const auto stride_bytes = static_cast<std::size_t>(array_.stride(0));
  if (array_.scalar() == Scalar::float32) {
    return PositionsView::strided(reinterpret_cast<const float*>(array_.data()), array_.size(0), stride_bytes);
  }
  return PositionsView::strided(reinterpret_cast<const double*>(array_.data()), array_.size(0), stride_bytes);
}

Ids::Ids(nb::handle object, const char* name)
    : array_(object, name, "shape (n,) and dtype int32, int64, uint32 or uint64", Lists::integers) {
  if (!array_.is_empty_list() && !(array_.is_integer() && array_.has_shape({-1}))) array_.refuse();
  if (array_.scalar() == Scalar::uint32 && array_.is_packed()) return;
  copied_.emplace(array_.size(0));
  for (std::size_t i = 0; i < copied_->size(); ++i) {
    (*copied_)[i] = array_.id(array_.data() + static_cast<std::ptrdiff_t>(i) * array_.stride(0), i);
  }
}

std::span<const std::uint32_t> Ids::view() const {
  if (copied_) return *copied_;
  return {reinterpret_cast<const std::uint32_t*>(array_.data()), array_.size(0)};
}

namespace {

/// Rows of `width` ids.
template <std::size_t width>
std::vector<std::array<std::uint32_t, width>> id_rows(const Array& array) {
  const bool has_rows = !array.is_empty_list() && !array.has_shape({0, static_cast<std::ptrdiff_t>(width)});
  if (!has_rows) return {};
  if (!array.is_integer() || !array.has_shape({-1, static_cast<std::ptrdiff_t>(width)})) array.refuse();
  std::vector<std::array<std::uint32_t, width>> rows(array.size(0));
  if (array.scalar() == Scalar::uint32 && array.is_packed()) {
    std::memcpy(rows.data(), array.data(), rows.size() * sizeof rows[0]);
    return rows;
  }
  for_rows(array, [&](std::size_t i, const unsigned char* row) {
    for (std::size_t k = 0; k < width; ++k) {
      rows[i][k] = array.id(row + static_cast<std::ptrdiff_t>(k) * array.stride(1), i);
    }
  });
  return rows;
}

}  // namespace

std::vector<Corners> faces_from(nb::handle object, const char* name) {
  return id_rows<3>(Array(object, name, "shape (n, 3) and dtype int32, int64, uint32 or uint64", Lists::integers));
}

std::vector<std::array<std::uint32_t, 2>> id_pairs_from(nb::handle object, const char* name) {
  return id_rows<2>(Array(object, name, "shape (n, 2) and dtype int32, int64, uint32 or uint64", Lists::integers));
}

std::vector<Vec3> points_from(nb::handle object, const char* name) {
  const Positions positions(object, name);
  std::vector<Vec3> points(positions.view().size());
  positions.view().copy_to(points);
  return points;
}

Vec3 point_from(nb::handle object, const char* name) {
  const Array array(object, name, "shape (3,) and dtype float32 or float64", Lists::floats);
  if (!array.has_floats({3})) array.refuse();
  const auto coordinate = [&](std::ptrdiff_t axis) { return array.real(array.data() + axis * array.stride(0)); };
  return {coordinate(0), coordinate(1), coordinate(2)};
}

}  // namespace limber::python
