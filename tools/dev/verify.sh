#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: verify           the oracles at length: 20 million pairs of triangles, 40 000 scenes of all scales and 1 000
#:                  deformation sequences against exact arithmetic; a million queries that are interrupted and go on;
#:                  200 000 queries in scenes of motion planners; 5 million moving pairs and 20 000 moving scenes;
#:                  60 000 pairs of closed surfaces against cells and axes, 380 against CGAL, 100 000 penetrations
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

need_for_tests
configure release -DLIMBER_BUILD_TESTS=ON
build release --target limber_oracle_tests limber_property_tests
export LIMBER_ORACLE_PAIRS=20000000 LIMBER_EXACT_PAIRS=1000000 LIMBER_EXACT_SCENES=40000 LIMBER_EXACT_SEQUENCES=1000
export LIMBER_INTERRUPTED_QUERIES=1000000 LIMBER_NEIGHBOR_PAIRS=300000 LIMBER_PLANNING_QUERIES=200000
export LIMBER_IMPACT_PAIRS=5000000 LIMBER_IMPACT_SCENES=10000
export LIMBER_SOLID_PAIRS=20000 LIMBER_ORACLE_SOLIDS=380 LIMBER_PENETRATION_PAIRS=100000 LIMBER_NORMAL_PAIRS=200000
oracles='^oracle\..*(Cgal|Exact|Impact|Solid)'
properties='^property\.(Impact|Interrupted|EveryKind/NeighborsOfKind|Scenes/PlanningQueries|Solid|Penetration|ContactNormals)'
(cd -- "$root" && ctest --test-dir build/release --output-on-failure --parallel "$jobs" --verbose \
  -R "$oracles|$properties" "$@") </dev/null
