// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <memory>
#include <mutex>
#include <utility>

#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/elements.h"
#include "limber/model.h"
#include "use.h"

/// Models and caches as Python holds them.
namespace limber::python {

namespace nb = nanobind;

/// A model, who uses it, and its edges once they have been asked for.
struct ModelObject {
  explicit ModelObject(Model built) : model(std::move(built)) {}

  Model model;
  Users users;
  std::mutex edges_mutex;
  std::shared_ptr<const MeshEdges> edges;  // until reset()
};

inline Reading reading(ModelObject& object) {
  return {object.users, "the model is being changed by another thread, or by a call that has not returned"};
}

inline Changing changing(ModelObject& object) {
  return {object.users, "the model is in use by another thread, or by a query that has not returned"};
}

/// The edges of a model, which are built when they are first asked for. Pre: the model is being read.
std::shared_ptr<const MeshEdges> edges_of(ModelObject& object);

/// A cache, and who uses it.
struct CacheObject {
  QueryCache cache;
  Users users;
};

}  // namespace limber::python
