// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>

#include <array>
#include <exception>
#include <stdexcept>
#include <string>
#include <string_view>

#include "bindings.h"
#include "docstrings.h"
#include "interrupts.h"
#include "records.h"

namespace limber::python {

void raise(const Error& error) {
  // Names of files need not be UTF-8.
  const nb::object text =
      nb::steal(PyUnicode_DecodeUTF8(error.text.data(), static_cast<Py_ssize_t>(error.text.size()), "surrogateescape"));
  const nb::object exception = nb::module_::import_("limber3d.errors").attr("error_of")(text, error.code, error.where);
  PyErr_SetObject(exception.type().ptr(), exception.ptr());
  throw nb::python_error();
}

namespace {

/// The text of a refused call, with Python's names of functions.
std::string in_python(std::string text) {
  struct Word {
    std::string_view cpp, python;
  };
  constexpr std::array<Word, 3> words = {{{"limber::", "limber3d."}, {"::", "."}, {"visit_", ""}}};
  for (const auto& [cpp, python] : words) {
    for (auto at = text.find(cpp); at != std::string::npos; at = text.find(cpp, at + python.size())) {
      text.replace(at, cpp.size(), python);
    }
  }
  return text;
}

void translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const std::invalid_argument& refusal) {
    PyErr_SetString(PyExc_ValueError, in_python(refusal.what()).c_str());
  } catch (const nb::cast_error&) {
    // nanobind has checked the class of every argument.
    PyErr_SetString(PyExc_TypeError, "an argument is not initialized: its class has to call super().__init__()");
  }
}

void bind_errors(nb::module_& module) {
  nb::enum_<ErrorCode>(module, "ErrorCode", docs::ErrorCode)
      .value("empty_mesh", ErrorCode::empty_mesh, docs::ErrorCode_empty_mesh)
      .value("non_finite", ErrorCode::non_finite, docs::ErrorCode_non_finite)
      .value("too_large", ErrorCode::too_large, docs::ErrorCode_too_large)
      .value("index_out_of_range", ErrorCode::index_out_of_range, docs::ErrorCode_index_out_of_range)
      .value("size_mismatch", ErrorCode::size_mismatch, docs::ErrorCode_size_mismatch)
      .value("not_rigid", ErrorCode::not_rigid, docs::ErrorCode_not_rigid)
      .value("unreadable_file", ErrorCode::unreadable_file, docs::ErrorCode_unreadable_file)
      .value("malformed_file", ErrorCode::malformed_file, docs::ErrorCode_malformed_file)
      .value("unsupported_format", ErrorCode::unsupported_format, docs::ErrorCode_unsupported_format)
      .value("changed_connectivity", ErrorCode::changed_connectivity, docs::ErrorCode_changed_connectivity)
      .value("broken_invariant", ErrorCode::broken_invariant, docs::ErrorCode_broken_invariant)
      .value("not_closed", ErrorCode::not_closed, docs::ErrorCode_not_closed)
      .value("not_convex", ErrorCode::not_convex, docs::ErrorCode_not_convex);
  nb::register_exception_translator(translate);
  const nb::exception<Busy> busy(module, "BusyError", PyExc_RuntimeError);
  busy.attr("__doc__") =
      "A model, scene or cache is in use by another thread in a way that excludes the call.\n\n"
      "A model may be read by any number of threads at a time, and changed by one that nobody else disturbs.";
}

}  // namespace
}  // namespace limber::python

namespace python = limber::python;

NB_MODULE(_core, module) {
  // What daemon threads use when Python ends is never freed, and no fault.
  nanobind::set_leak_warnings(false);
  module.doc() = "The compiled part of limber3d.";
  module.attr("version") = LIMBER_VERSION;
  nanobind::module_::import_("atexit").attr("register")(nanobind::cpp_function(&python::wait_for_abandoned));
  python::bind_errors(module);
  python::bind_arrays();
  python::bind_records(module);
  python::bind_results(module);
  python::bind_model(module);
  python::bind_bodies(module);
  python::bind_queries(module);
  python::bind_elements(module);
  python::bind_motion(module);
  python::bind_contacts(module);
  python::bind_gradients(module);
  python::bind_points(module);
  python::bind_solids(module);
  python::bind_scene(module);
  python::bind_scene_batch(module);
  python::bind_batch(module);
}
