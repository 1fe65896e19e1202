// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

/// The parts of the module, one for each theme.
namespace limber::python {

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
