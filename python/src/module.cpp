// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>

#include "bindings.h"
#include "gil.h"
#include "records.h"

namespace python = limber::python;

NB_MODULE(_core, module) {
  // What daemon threads use when Python ends is never freed, and no fault.
  nanobind::set_leak_warnings(false);
  const nanobind::object main_thread = nanobind::module_::import_("threading").attr("main_thread")();
  python::main_thread = nanobind::cast<unsigned long>(main_thread.attr("ident"));
  module.doc() = "The compiled part of limber3d.";
  module.attr("version") = LIMBER_VERSION;
  python::bind_errors(module);
  python::bind_records(module);
  python::bind_results(module);
  python::bind_model(module);
  python::bind_queries(module);
  python::bind_elements(module);
  python::bind_contacts(module);
  python::bind_self_queries(module);
  python::bind_points(module);
  python::bind_scene(module);
  python::bind_batch(module);
  python::bind_mesh_files(module);
}
