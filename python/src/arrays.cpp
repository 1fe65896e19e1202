// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <utility>

#include "bindings.h"

namespace limber::python {
namespace {

nb::handle numpy_array;  // the class, which lives as long as the process

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
  return !object.type().is(numpy_array) && nb::cast<bool>(nb::module_::import_("numpy.ma").attr("is_masked")(object));
}

}  // namespace

void bind_arrays() { numpy_array = nb::object(nb::module_::import_("numpy").attr("ndarray")).release(); }

Array::Array(nb::handle object, const char* name, const char* expected, Lists lists)
    : owner_(nb::borrow(object)), name_(name), expected_(expected) {
  if (PyObject_CheckBuffer(object.ptr()) == 0) {
    try {
      const nb::object array = nb::module_::import_("numpy").attr("asarray")(object);
      if (nb::cast<int>(array.attr("ndim")) == 0) refuse(found());
      owner_ = array;
    } catch (nb::python_error& error) {
      if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError)) throw;
      refuse(found());
    }
  } else if (has_masked_elements(object)) {
    refuse("masked elements");
  }
  get_buffer();
  const bool is_wanted = lists == Lists::floats ? is_float() : scalar_ != Scalar::other;
  if (!is_wanted && buffer_.itemsize <= 8) convert(lists);
}

void Array::get_buffer() {
  if (PyObject_GetBuffer(owner_.ptr(), &buffer_, PyBUF_STRIDES | PyBUF_FORMAT) != 0) {
    PyErr_Clear();
    refuse(found());
  }
  scalar_ = scalar_of(buffer_.format, static_cast<std::size_t>(buffer_.itemsize));
}

void Array::convert(Lists lists) {
  const nb::object array = nb::module_::import_("numpy").attr("asarray")(owner_);
  const std::string kind = nb::cast<std::string>(array.attr("dtype").attr("kind"));
  if (kind != "i" && kind != "u" && kind != "f") return;
  const bool is_float = lists == Lists::floats || kind == "f";
  given_ = std::exchange(owner_, array.attr("astype")(is_float ? "float64" : kind == "u" ? "uint64" : "int64"));
  PyBuffer_Release(&buffer_);
  get_buffer();
}

Array::~Array() { PyBuffer_Release(&buffer_); }

std::optional<std::size_t> Array::row_bytes() const {
  if (is_packed()) return static_cast<std::size_t>(buffer_.itemsize * buffer_.shape[1]);
  if (buffer_.strides[1] != buffer_.itemsize || buffer_.strides[0] < 0) return std::nullopt;
  return static_cast<std::size_t>(buffer_.strides[0]);
}

bool Array::has_shape(std::initializer_list<std::ptrdiff_t> shape) const {
  if (dimensions() != shape.size()) return false;
  return std::equal(shape.begin(), shape.end(), buffer_.shape,
                    [](std::ptrdiff_t wanted, Py_ssize_t found) { return wanted < 0 || wanted == found; });
}

template <typename Use>
void Array::for_elements(const Use& use) const {
  const auto count = static_cast<std::size_t>(buffer_.len / buffer_.itemsize);
  const unsigned char* const packed = is_packed() ? data() : nullptr;
  Py_buffer view = buffer_;                     // CPython 3.10 takes no const one
  std::vector<Py_ssize_t> place(dimensions());  // of the next element, unless they are packed
  const auto next = [&] {
    const void* const element = PyBuffer_GetPointer(&view, place.data());
    for (std::size_t axis = place.size(); axis-- > 0 && ++place[axis] == view.shape[axis];) place[axis] = 0;
    return element;
  };
  const auto use_as = [&]<typename T>(T value) {
    in_pieces(count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const void* const element = packed != nullptr ? packed + i * sizeof value : next();
        std::memcpy(&value, element, sizeof value);  // which need not be aligned
        use(value, i);
      }
    });
  };
  switch (scalar_) {
    case Scalar::float32:
      return use_as(float{});
    case Scalar::int32:
      return use_as(std::int32_t{});
    case Scalar::int64:
      return use_as(std::int64_t{});
    case Scalar::uint32:
      return use_as(std::uint32_t{});
    case Scalar::uint64:
      return use_as(std::uint64_t{});
    default:
      return use_as(double{});
  }
}

std::vector<double> Array::numbers() const {
  std::vector<double> numbers;
  numbers.reserve(static_cast<std::size_t>(buffer_.len / buffer_.itemsize));
  for_elements([&](auto value, std::size_t) { numbers.push_back(static_cast<double>(value)); });
  return numbers;
}

std::vector<std::uint32_t> Array::ids() const {
  std::vector<std::uint32_t> ids;
  ids.reserve(static_cast<std::size_t>(buffer_.len / buffer_.itemsize));
  for_elements([&]<typename T>(T value, std::size_t i) {
    if constexpr (std::is_integral_v<T> && !std::is_same_v<T, std::uint32_t>) {
      if (std::cmp_less(value, 0) || std::cmp_greater_equal(value, no_id)) {
        const std::size_t row = i / (dimensions() == 1 ? 1 : size(1));
        raise({ErrorCode::index_out_of_range,
               std::string(name_) + "[" + std::to_string(row) + "]: " + std::to_string(value) + " is not an index",
               row});
      }
    }
    ids.push_back(static_cast<std::uint32_t>(value));
  });
  return ids;
}

void Array::refuse(const std::string& found) const {
  throw nb::value_error((std::string(name_) + ": expected " + expected_ + "; got " + found).c_str());
}

void Array::refuse() const { refuse(found()); }

std::string Array::found() const {
  const nb::object& given = given_.is_valid() ? given_ : owner_;
  if (nb::hasattr(given, "dtype") && nb::hasattr(given, "shape")) {
    return nb::cast<std::string>(nb::str("shape {} and dtype {}").format(given.attr("shape"), given.attr("dtype")));
  }
  if (buffer_.obj == nullptr) return nb::cast<std::string>(owner_.type().attr("__name__"));
  nb::list shape;
  for (std::size_t axis = 0; axis < dimensions(); ++axis) shape.append(size(axis));
  return nb::cast<std::string>(nb::str("shape {} and dtype {}")
                                   .format(nb::tuple(shape), buffer_.format == nullptr ? "unknown" : buffer_.format));
}

std::vector<std::uint32_t> ids_from(nb::handle object, const char* name) {
  const Array array(object, name, "shape (n,) of integers", Lists::integers);
  if (array.is_empty_list()) return {};
  if (!array.is_integer() || !array.has_shape({-1})) array.refuse();
  return array.ids();
}

namespace {

/// Rows of ids, as many as a row holds.
template <typename Row>
std::vector<Row> id_rows(const Array& array) {
  constexpr std::size_t width = sizeof(Row) / sizeof(std::uint32_t);
  const bool has_rows = !array.is_empty_list() && !array.has_shape({0, static_cast<std::ptrdiff_t>(width)});
  if (!has_rows) return {};
  if (!array.is_integer() || !array.has_shape({-1, static_cast<std::ptrdiff_t>(width)})) array.refuse();
  const std::vector<std::uint32_t> ids = array.ids();
  std::vector<Row> rows;
  rows.reserve(array.size(0));
  in_pieces(array.size(0), [&](std::size_t begin, std::size_t end) {
    rows.resize(end);
    std::memcpy(static_cast<void*>(rows.data() + begin), ids.data() + begin * width, (end - begin) * sizeof(Row));
  });
  return rows;
}

}  // namespace

std::vector<Corners> faces_from(nb::handle object, const char* name) {
  return id_rows<Corners>(Array(object, name, "shape (n, 3) of integers", Lists::integers));
}

std::vector<ObjectPair> id_pairs_from(nb::handle object, const char* name) {
  return id_rows<ObjectPair>(Array(object, name, "shape (n, 2) of integers", Lists::integers));
}

std::vector<Vec3> points_from(nb::handle object, const char* name) {
  const Array array(object, name, "shape (n, 3) of floats or integers", Lists::floats);
  if (!array.has_floats({-1, 3}) && !array.is_empty_list()) array.refuse();
  std::vector<Vec3> points;
  if (array.size(0) == 0) return points;
  const std::optional<std::size_t> row_bytes = array.row_bytes();
  const std::vector<double> numbers = row_bytes ? std::vector<double>{} : array.numbers();
  const void* const first = row_bytes ? static_cast<const void*>(array.data()) : numbers.data();
  const bool is_float32 = row_bytes && array.scalar() == Scalar::float32;
  points.reserve(array.size(0));
  in_pieces(array.size(0), [&](std::size_t begin, std::size_t end) {
    const std::size_t step = row_bytes.value_or(sizeof(Vec3));
    const unsigned char* const there = static_cast<const unsigned char*>(first) + begin * step;
    const auto view = [&](const auto* at) { return PositionsView::strided(at, end - begin, step); };
    points.resize(end);
    (is_float32 ? view(reinterpret_cast<const float*>(there)) : view(reinterpret_cast<const double*>(there)))
        .copy_to(std::span(points).subspan(begin));
  });
  return points;
}

Vec3 point_from(nb::handle object, const char* name) {
  const Array array(object, name, "shape (3,) of floats or integers", Lists::floats);
  if (!array.has_floats({3})) array.refuse();
  const std::vector<double> p = array.numbers();
  return {p[0], p[1], p[2]};
}

Mat3 matrix_from(const Array& array) {
  const std::size_t n = array.size(1);
  const std::vector<double> m = array.numbers();
  return {{m[0], m[1], m[2]}, {m[n], m[n + 1], m[n + 2]}, {m[2 * n], m[2 * n + 1], m[2 * n + 2]}};
}

namespace {

constexpr const char* pose_form =
    "None, a 4 x 4 matrix, (rotation, translation) with a 3 x 3 matrix, or (quaternion, translation) with w, x, y, z, "
    "of floats or integers";
constexpr const char* poses_form =
    "None, one pose, n 4 x 4 matrices, (n rotations, n translations) or (n quaternions, n translations), "
    "of floats or integers";

constexpr const char* configurations_form =
    "for n configurations of k ids: (n, k, 4, 4), or a tuple of (n, k, 3, 3) or (n, k, 4) and (n, k, 3), of floats "
    "or integers";

/// The pose that numbers stand for: a matrix of 16; or a rotation of 9 or a quaternion, and a translation. `index` is
/// that in a list, where there is one; messages have it by rows of so many columns, if it is a list of rows.
Transform rigid_or_raise(std::span<const double> turn, std::span<const double> shift, const char* name,
                         std::optional<std::size_t> index, std::optional<std::size_t> columns = std::nullopt) {
  const auto converted = [&]() -> Result<Transform> {
    const auto& q = turn;
    const auto& t = shift;
    if (turn.size() == 16) return transform_from_matrix(turn.first<16>(), MatrixOrder::row_major);
    if (turn.size() == 4) return transform_from_quaternion({t[0], t[1], t[2]}, q[0], q[1], q[2], q[3]);
    const std::array<double, 16> matrix{turn[0], turn[1], turn[2], t[0], turn[3], turn[4], turn[5], t[1],
                                        turn[6], turn[7], turn[8], t[2], 0,       0,       0,       1};
    return transform_from_matrix(matrix, MatrixOrder::row_major);
  };
  const Result<Transform> result = converted();
  if (result) return *result;
  std::string text = name;
  if (index && columns) {
    text.append("[" + std::to_string(*index / *columns) + ", " + std::to_string(*index % *columns) + "]");
  } else if (index) {
    text.append("[").append(std::to_string(*index)).append("]");
  }
  raise({result.error().code, text.append(": ").append(result.error().text), index});
}

/// A pose or poses in the forms of this file: what is like SciPy's RigidTransform is a matrix, its Rotation a rotation
/// about the origin.
nb::object plain_pose(nb::handle given) {
  if (!nb::hasattr(given, "as_matrix")) return nb::borrow(given);
  nb::object matrix = given.attr("as_matrix")();
  const nb::object shape = matrix.attr("shape");
  if (!shape[nb::int_(-1)].equal(nb::int_(3))) return matrix;
  const nb::object of_shifts = shape[nb::slice(nb::int_(0), nb::int_(-1), nb::int_(1))];
  return nb::make_tuple(matrix, nb::module_::import_("numpy").attr("zeros")(of_shifts));
}

/// The two parts of a pose or of poses, or nothing if the object is not a tuple of two.
std::optional<std::array<nb::object, 2>> parts_of(const nb::object& object) {
  if (!PyTuple_CheckExact(object.ptr()) || PyTuple_Size(object.ptr()) != 2) return std::nullopt;
  nb::object turn = object[0], shift = object[1];
  if (nb::hasattr(turn, "as_matrix")) turn = turn.attr("as_matrix")();
  return std::array{turn, shift};
}

/// Poses of as many numbers: matrices without shifts, or turns with them.
std::vector<Transform> all_rigid(std::size_t count, const std::vector<double>& turns, const std::vector<double>& shifts,
                                 const char* name, std::optional<std::size_t> columns = std::nullopt) {
  std::vector<Transform> poses;
  poses.reserve(count);
  in_pieces(count, [&](std::size_t begin, std::size_t end) {
    const std::size_t turn_size = turns.size() / count, shift_size = shifts.size() / count;
    for (std::size_t i = begin; i < end; ++i) {
      poses.push_back(rigid_or_raise(std::span(turns).subspan(i * turn_size, turn_size),
                                     std::span(shifts).subspan(i * shift_size, shift_size), name, i, columns));
    }
  });
  return poses;
}

}  // namespace

Transform pose_from(nb::handle given, const char* name) {
  if (given.is_none()) return {};
  const nb::object object = plain_pose(given);
  if (const auto parts = parts_of(object)) {
    const Array turn((*parts)[0], name, pose_form, Lists::floats), shift((*parts)[1], name, pose_form, Lists::floats);
    if (!turn.has_numbers({3, 3}) && !turn.has_numbers({4})) turn.refuse();
    if (!shift.has_numbers({3})) shift.refuse();
    return rigid_or_raise(turn.numbers(), shift.numbers(), name, std::nullopt);
  }
  const Array matrix(object, name, pose_form, Lists::floats);
  if (!matrix.has_numbers({4, 4})) matrix.refuse();
  return rigid_or_raise(matrix.numbers(), {}, name, std::nullopt);
}

PoseList::PoseList(nb::handle given, const char* name) {
  const nb::object object = plain_pose(given);
  if (const auto parts = parts_of(object)) {
    const Array turns((*parts)[0], name, poses_form, Lists::floats);
    const Array shifts((*parts)[1], name, poses_form, Lists::floats);
    is_one_for_all_ = shifts.dimensions() == 1;
    if (!is_one_for_all_) {
      if (!turns.has_numbers({-1, 3, 3}) && !turns.has_numbers({-1, 4})) turns.refuse();
      if (!shifts.has_numbers({static_cast<std::ptrdiff_t>(turns.size(0)), 3})) shifts.refuse();
      poses_ = all_rigid(turns.size(0), turns.numbers(), shifts.numbers(), name);
    }
  } else if (!object.is_none()) {
    const Array matrices(object, name, poses_form, Lists::floats);
    is_one_for_all_ = matrices.dimensions() == 2;
    if (!is_one_for_all_) {
      if (!matrices.has_numbers({-1, 4, 4})) matrices.refuse();
      poses_ = all_rigid(matrices.size(0), matrices.numbers(), {}, name);
    }
  }
  if (is_one_for_all_) poses_.push_back(pose_from(object, name));
}

std::vector<Transform> configurations_from(nb::handle given, std::size_t objects, const char* name) {
  const nb::object object = plain_pose(given);
  const auto k = static_cast<std::ptrdiff_t>(objects);
  if (const auto parts = parts_of(object)) {
    const Array turns((*parts)[0], name, configurations_form, Lists::floats);
    const Array shifts((*parts)[1], name, configurations_form, Lists::floats);
    if (!turns.has_numbers({-1, k, 3, 3}) && !turns.has_numbers({-1, k, 4})) turns.refuse();
    if (!shifts.has_numbers({static_cast<std::ptrdiff_t>(turns.size(0)), k, 3})) shifts.refuse();
    return all_rigid(turns.size(0) * objects, turns.numbers(), shifts.numbers(), name, objects);
  }
  const Array matrices(object, name, configurations_form, Lists::floats);
  if (!matrices.has_numbers({-1, k, 4, 4})) matrices.refuse();
  return all_rigid(matrices.size(0) * objects, matrices.numbers(), {}, name, objects);
}

}  // namespace limber::python
