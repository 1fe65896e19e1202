// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  Symbolic perturbation [EdelsbrunnerMuecke1990], as in probe.h, of a line instead of a point.
// Differs   The line is where two planes meet. The side on which it passes an edge is the sign of a determinant of four
//           heights: of both ends of the edge, over both planes.
#include "solid/cut.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/check.h"
#include "geometry/plane_sides.h"
#include "geometry/primitives.h"

namespace limber::solid {
namespace {

using geometry::next_corner;
using geometry::PlaneSides;

/// The points in which the border of t crosses a plane; of an edge that lies in the plane, its ends.
std::vector<ExactPoint> edge_crossings(const Triangle& t, const Triangle& plane, int unit) {
  const PlaneSides sides(plane.v0, plane.v1, plane.v2);
  std::vector<ExactPoint> points;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = next_corner[i];
    const int side = sides.of(t[i]);
    if (side == 0) points.emplace_back(t[i], unit);
    if (side * sides.of(t[k]) < 0) points.push_back(*crossing(ExactPoint(t[i], unit), ExactPoint(t[k], unit), plane));
  }
  return points;
}

/// How far a corner is over a plane, and the side on which it is.
struct Height {
  Estimate estimate;
  int side;
};

std::array<Height, 3> heights_of(const Triangle& y, const Triangle& plane) {
  const PlaneSides sides(plane.v0, plane.v1, plane.v2);
  const auto height = [&](const Vec3& p) { return Height{height_over(plane, p), sides.of(p)}; };
  return {height(y.v0), height(y.v1), height(y.v2)};
}

/// The sign of a difference x - y, given the signs of both: of the estimate, or of exact() where that leaves it open.
template <typename Exact>
int sign_of_difference(int sign_of_x, int sign_of_y, const Estimate& difference, const Exact& exact) {
  if (sign_of_x != sign_of_y) return sign_of_x > sign_of_y ? 1 : -1;
  if (sign_of_x == 0) return 0;
  const int sign = difference.certain_sign();
  return sign != 0 ? sign : exact();
}

/// Which of two points is higher over a plane: 1 for the first.
int compare_heights(const Vec3& p, const Height& of_p, const Vec3& q, const Height& of_q, const Triangle& plane) {
  const Estimate x = of_p.estimate, y = of_q.estimate;
  const Estimate difference{x.value - y.value, 2 * (x.error + y.error)};
  return sign_of_difference(of_p.side, of_q.side, difference, [&] {
    const int unit = CommonUnit().include(p).include(q).include(plane).exponent();
    return (ExactPoint(p, unit).height(plane, unit) - ExactPoint(q, unit).height(plane, unit)).sign();
  });
}

/// On which side of the line from p to q the line passes in which the planes of t and x meet.
int side_of_pass(const Vec3& p, const Height& p_over_t, const Height& p_over_x, const Vec3& q, const Height& q_over_t,
                 const Height& q_over_x, const Triangle& t, const Triangle& x) {
  const Estimate left = p_over_t.estimate * q_over_x.estimate, right = q_over_t.estimate * p_over_x.estimate;
  const Estimate difference{left.value - right.value, 2 * (left.error + right.error)};
  return sign_of_difference(p_over_t.side * q_over_x.side, q_over_t.side * p_over_x.side, difference, [&] {
    const int unit = CommonUnit().include(p).include(q).include(t).include(x).exponent();
    const ExactPoint from(p, unit), to(q, unit);
    return (from.height(t, unit) * to.height(x, unit) - to.height(t, unit) * from.height(x, unit)).sign();
  });
}

}  // namespace

int is_copy(const Triangle& y, const Triangle& t) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = next_corner[i], k = next_corner[j];
    if (y.v0 == t[i] && y.v1 == t[j] && y.v2 == t[k]) return 1;
    if (y.v0 == t[i] && y.v1 == t[k] && y.v2 == t[j]) return -1;
  }
  return 0;
}

Cut::Cut(const Triangle& t, pair::Side of_t, const Triangle& x, pair::Side of_x) : t_(t), x_(x) {
  behind_t_[pair::index(of_t)] = behind_x_[pair::index(of_x)] = 1;
  const int unit = CommonUnit().include(t).include(x).exponent();
  std::vector<ExactPoint> on_t = edge_crossings(t, x, unit), on_x = edge_crossings(x, t, unit);
  LIMBER_ASSERT(on_t.size() == 2 && on_x.size() == 2);
  along_ = direction(on_t[0], on_t[1]);
  while (along_[axis_].is_zero()) ++axis_;
  if (along_[axis_].sign() < 0) {
    std::swap(on_t[0], on_t[1]);
    for (Integer& d : along_) d = -d;
  }
  if (on_x[0].compare(on_x[1], axis_) > 0) std::swap(on_x[0], on_x[1]);
  const ExactPoint& first = on_t[0].compare(on_x[0], axis_) > 0 ? on_t[0] : on_x[0];
  const ExactPoint& last = on_t[1].compare(on_x[1], axis_) < 0 ? on_t[1] : on_x[1];
  LIMBER_ASSERT(first.compare(last, axis_) < 0);
  ends_ = {first, last};
}

void Cut::add(const Triangle& y, pair::Side s) {
  const int side = ends_[0].side_of_plane(y), last_side = ends_[1].side_of_plane(y);
  if (side == 0 && last_side == 0) {
    const int to_t = is_copy(y, t_), to_x = is_copy(y, x_);
    behind_t_[pair::index(s)] += to_t, behind_x_[pair::index(s)] += to_x;
    is_shared_ = is_shared_ || (to_t == 0 && to_x == 0);
  }
  if (side * last_side >= 0) return;
  Crosser crosser;
  crosser.triangle = y, crosser.surface = s, crosser.step = side;
  const std::array<Height, 3> over_t = heights_of(y, t_), over_x = heights_of(y, x_);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = next_corner[i];
    crosser.passes[0][i] = side_of_pass(y[i], over_t[i], over_x[i], y[k], over_t[k], over_x[k], t_, x_);
    if (crosser.passes[0][i] != 0) continue;
    crosser.passes[1][i] = compare_heights(y[k], over_t[k], y[i], over_t[i], t_);
    crosser.passes[2][i] = compare_heights(y[i], over_x[i], y[k], over_x[k], x_);
  }
  const Estimate first = ends_[0].height_estimate(y), last = ends_[1].height_estimate(y);
  const double size = std::abs(first.value) + std::abs(last.value), error = first.error + last.error;
  crosser.place = {std::abs(first.value) / size, error / (size - error) + 0x1p-48};
  if (!(size > 2 * error && std::isfinite(size))) crosser.place = {0, 2};  // anywhere on the segment
  const auto added = crossers_.insert(std::move(crosser));
  added->is_with_last = added != crossers_.begin() && compare(*std::prev(added), *added) == 0;
}

bool Cut::Crosser::is_pierced(int side_of_t, int side_of_x) const {
  int common = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const int off_x = side_of_x * passes[1][i], off_t = side_of_t * passes[2][i];
    const int side = passes[0][i] != 0 ? passes[0][i] : off_x != 0 ? off_x : off_t;
    LIMBER_ASSERT(side != 0);
    if (side == -common) return false;
    common = side;
  }
  return true;
}

const ExactPoint& Cut::point_of(const Crosser& x) const {
  if (!x.point) x.point = crossing(ends_[0], ends_[1], x.triangle);
  return *x.point;
}

int Cut::compare(const Crosser& x, const Crosser& y) const {
  const double ahead = y.place.value - x.place.value, error = x.place.error + y.place.error;
  if (std::abs(ahead) > error) return ahead > 0 ? -1 : 1;
  return is_copy(x.triangle, y.triangle) != 0 ? 0 : point_of(x).compare(point_of(y), axis_);
}

WindingNumbers Cut::begin(Cells& cells, int side_of_t, int side_of_x) const {
  const PlaneSides sides(x_.v0, x_.v1, x_.v2);
  std::size_t corner = 0;
  while (sides.of(t_[corner]) != side_of_x) ++corner;
  return cells.winding_numbers(CutProbe(ends_[0], along_, t_[corner], *direction_off(t_, side_of_t)));
}

void Cut::follow(Cells& cells, WindingNumbers numbers, int side_of_t, int side_of_x) const {
  std::size_t i = 0;
  for (const Crosser& c : crossers_) {
    if (cells.meter.is_spent_at(++i)) return;
    if (!c.is_with_last) cells.note_found(numbers);
    if (c.is_pierced(side_of_t, side_of_x)) numbers[pair::index(c.surface)] += c.step;
  }
  if (!cells.is_stopped()) cells.note_found(numbers);
}

void Cut::look(Cells& cells, int side_of_t) {
  for (const int side_of_x : {1, -1}) follow(cells, begin(cells, side_of_t, side_of_x), side_of_t, side_of_x);
}

void Cut::look_everywhere(Cells& cells) {
  LIMBER_ASSERT(!is_shared());
  const WindingNumbers in_front = begin(cells, 1, 1);
  for (const int side_of_t : {1, -1}) {
    for (const int side_of_x : {1, -1}) {
      WindingNumbers numbers = in_front;
      for (const std::size_t s : {0, 1}) {
        numbers[s] += (side_of_t < 0 ? behind_t_[s] : 0) + (side_of_x < 0 ? behind_x_[s] : 0);
      }
      follow(cells, numbers, side_of_t, side_of_x);
    }
  }
}

}  // namespace limber::solid
