// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

/// The parts of the module, one for each theme.
namespace limber::python {

using nanobind::literals::operator""_a;

/// How Python's garbage collector sees objects that keep others alive: through visit_references() of class T. A cycle
/// through such an object passes through the dictionary of an object too, where the collector breaks it.
template <typename T>
int traverse(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  if (!nanobind::inst_ready(self)) return 0;
  return nanobind::inst_ptr<T>(self)->visit_references(visit, arg);
}
template <typename T>
inline PyType_Slot collectable[] = {{Py_tp_traverse, reinterpret_cast<void*>(&traverse<T>)}, {0, nullptr}};

void bind_errors(nanobind::module_& module);
void bind_results(nanobind::module_& module);
void bind_model(nanobind::module_& module);
void bind_queries(nanobind::module_& module);
void bind_contacts(nanobind::module_& module);
void bind_self_queries(nanobind::module_& module);
void bind_elements(nanobind::module_& module);
void bind_points(nanobind::module_& module);
void bind_scene(nanobind::module_& module);
void bind_batch(nanobind::module_& module);
void bind_mesh_files(nanobind::module_& module);

}  // namespace limber::python
