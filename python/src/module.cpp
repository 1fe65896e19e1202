// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>

#include "bindings.h"
#include "records.h"

NB_MODULE(_core, module) {
  using namespace limber::python;
  module.doc() = "The compiled part of limber3d.";
  module.attr("version") = LIMBER_VERSION;
  bind_errors(module);
  bind_records(module);
  bind_results(module);
  bind_model(module);
  bind_queries(module);
  bind_elements(module);
  bind_contacts(module);
  bind_self_queries(module);
  bind_points(module);
  bind_scene(module);
  bind_batch(module);
  bind_mesh_files(module);
}
