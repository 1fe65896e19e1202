// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "limber/classic.h"
#include "limber/io.h"
#include "limber/model.h"
#include "limber/reference.h"
#include "stopwatch.h"

namespace CLI {
class App;
}

namespace limber::program {

enum class Engine { fast, classic, reference };

/// The arguments that the verbs about two rigid models share.
struct PairArguments {
  std::string a, b;
  Transform pose_a, pose_b;  // world_from_model
  Engine engine = Engine::fast;
  bool json = false;
};
void add_pair_arguments(CLI::App& command, PairArguments& arguments);

template <typename Answer>
struct TimedAnswer {
  Answer answer;
  double build_us = 0;    // of the trees of both models
  double elapsed_us = 0;  // of the query alone
};

/// Builds models of one engine and puts a query to it.
template <typename Model, typename Placed, typename Query>
auto ask_models(const PairArguments& arguments, const MeshFile& a, const MeshFile& b, Query query) {
  const Stopwatch building;
  const Model model_a(a.mesh);
  const Model model_b(b.mesh);
  const double build_us = building.microseconds();
  const Stopwatch asking;
  auto answer = query(Placed{model_a, arguments.pose_a}, Placed{model_b, arguments.pose_b});
  return TimedAnswer<decltype(answer)>{std::move(answer), build_us, asking.microseconds()};
}

/// Puts a query to the engine that the arguments name; `query` takes two placed models or meshes of any engine.
template <typename Query>
auto ask(const PairArguments& arguments, const MeshFile& a, const MeshFile& b, Query query) {
  if (arguments.engine == Engine::fast) return ask_models<Model, Placed>(arguments, a, b, query);
  if (arguments.engine == Engine::classic) return ask_models<classic::Model, classic::Placed>(arguments, a, b, query);
  const Stopwatch asking;
  auto answer = query(reference::Placed{a.mesh, arguments.pose_a}, reference::Placed{b.mesh, arguments.pose_b});
  return TimedAnswer<decltype(answer)>{std::move(answer), 0, asking.microseconds()};
}

}  // namespace limber::program
