// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "errors.h"

#include "bindings.h"
#include "use.h"

namespace limber::python {

namespace nb = nanobind;

void raise(const Error& error) {
  if (error.code == ErrorCode::index_out_of_range) throw nb::index_error(error.text.c_str());
  if (error.code == ErrorCode::unreadable_file) {
    PyErr_SetString(PyExc_OSError, error.text.c_str());
    throw nb::python_error();
  }
  throw nb::value_error(error.text.c_str());
}

void bind_errors(nb::module_& module) {
  const nb::exception<Busy> busy(module, "BusyError", PyExc_RuntimeError);
  busy.attr("__doc__") =
      "A model, scene or cache is in use by another thread in a way that excludes the call.\n\n"
      "A model may be read by any number of threads at a time, and changed by one that nobody else disturbs.";
}

}  // namespace limber::python
