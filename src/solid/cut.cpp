// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// cut.h says what t and x, their wedges, the lines there and det(p, q) are.
//
// 1. The constructor finds the ends of the segment that t and x share, exactly.
// 2. add() takes the triangles that cross it, and sorts them by where they do.
// 3. look() and look_everywhere() follow the lines in the wedges, from where a ray tells the winding numbers.
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

// What rounding changes a place on a segment by. With u = 2^-53, a quotient is off by 2 u, its error, which is below 1,
// by 6 u, and the difference of two places by 1 u. This is 32 u.
constexpr double rounding_of_place = 0x1p-48;

/// The points in which the border of t crosses a plane; of an edge that lies in the plane, its ends.
std::vector<ExactPoint> edge_crossings(const Triangle& t, const Triangle& plane, int unit) {
  const PlaneSides sides(plane.v0, plane.v1, plane.v2);
  const std::array<int, 3> side{sides.of(t.v0), sides.of(t.v1), sides.of(t.v2)};
  std::vector<ExactPoint> points;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = next_corner[i];
    if (side[i] == 0) points.emplace_back(t[i], unit);
    if (side[i] * side[k] < 0) points.push_back(*crossing(ExactPoint(t[i], unit), ExactPoint(t[k], unit), plane));
  }
  return points;
}

/// A point, how far it is over a plane, and the side on which it is.
struct Height {
  Vec3 point;
  Estimate estimate;
  int side;
};

std::array<Height, 3> heights_of(const Triangle& y, const Triangle& plane) {
  const PlaneSides sides(plane.v0, plane.v1, plane.v2);
  const auto height = [&](const Vec3& p) { return Height{p, height_over(plane, p), sides.of(p)}; };
  return {height(y.v0), height(y.v1), height(y.v2)};
}

/// The sign of left - right, given the signs of both: by their estimates, or that of exact() where these leave it open.
template <typename Exact>
int sign_of_difference(int sign_of_left, const Estimate& left, int sign_of_right, const Estimate& right,
                       const Exact& exact) {
  if (sign_of_left != sign_of_right) return sign_of_left > sign_of_right ? 1 : -1;
  if (sign_of_left == 0) return 0;
  // Twice both errors: what rounding the difference and this sum changes is far less than that.
  const int sign = Estimate{left.value - right.value, 2 * (left.error + right.error)}.certain_sign();
  return sign != 0 ? sign : exact();
}

/// Which of two points is higher over a plane: 1 for p, -1 for q, 0 if they are equally high.
int compare_heights(const Height& p, const Height& q, const Triangle& plane) {
  return sign_of_difference(p.side, p.estimate, q.side, q.estimate, [&] {
    const int unit = CommonUnit().include(p.point).include(q.point).include(plane).exponent();
    return (ExactPoint(p.point, unit).height(plane, unit) - ExactPoint(q.point, unit).height(plane, unit)).sign();
  });
}

/// The sign of det(p, q) of cut.h: the side on which the line where the planes of t and x meet passes the edge p q.
int side_of_pass(const Height& p_over_t, const Height& p_over_x, const Height& q_over_t, const Height& q_over_x,
                 const Triangle& t, const Triangle& x) {
  const Estimate left = p_over_t.estimate * q_over_x.estimate, right = q_over_t.estimate * p_over_x.estimate;
  return sign_of_difference(p_over_t.side * q_over_x.side, left, q_over_t.side * p_over_x.side, right, [&] {
    const Vec3 &p = p_over_t.point, &q = q_over_t.point;
    const int unit = CommonUnit().include(p).include(q).include(t).include(x).exponent();
    const ExactPoint from(p, unit), to(q, unit);
    return (from.height(t, unit) * to.height(x, unit) - to.height(t, unit) * from.height(x, unit)).sign();
  });
}

}  // namespace

int orientation_of_copy(const Triangle& y, const Triangle& t) {
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
  while (axis_ < 2 && along_[axis_].is_zero()) ++axis_;
  LIMBER_ASSERT(!along_[axis_].is_zero());
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
    const int like_t = orientation_of_copy(y, t_), like_x = orientation_of_copy(y, x_);
    behind_t_[pair::index(s)] += like_t;
    behind_x_[pair::index(s)] += like_x;
    is_shared_ = is_shared_ || (like_t == 0 && like_x == 0);
  }
  if (side * last_side >= 0) return;
  Crosser crosser;
  crosser.triangle = y, crosser.surface = s;
  crosser.step = side;  // where the segment begins in front of y, the number grows by 1, as it is larger behind
  const std::array<Height, 3> over_t = heights_of(y, t_), over_x = heights_of(y, x_);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = next_corner[i];
    // Of the line, and of moving it by e off x and e^2 off t, as cut.h derives, with p = corner i and q = corner k.
    crosser.of_line[i] = side_of_pass(over_t[i], over_x[i], over_t[k], over_x[k], t_, x_);
    if (crosser.of_line[i] != 0) continue;
    crosser.of_move_off_x[i] = compare_heights(over_t[k], over_t[i], t_);
    crosser.of_move_off_t[i] = compare_heights(over_x[i], over_x[k], x_);
  }
  // A height that is off by d moves the place by d / size at most. `error` is that of both, and size - error at most
  // the true size.
  const Estimate first = ends_[0].height_estimate(y), last = ends_[1].height_estimate(y);
  const double size = std::abs(first.value) + std::abs(last.value), error = first.error + last.error;
  crosser.place = {0.5, 0.5};  // anywhere on the segment: exact points decide
  if (size > 2 * error && std::isfinite(size)) {
    crosser.place = {std::abs(first.value) / size, error / (size - error) + rounding_of_place};
  }
  const auto added = crossers_.insert(std::move(crosser));  // after those that are crossed in the same point
  added->is_with_previous = added != crossers_.begin() && compare(*std::prev(added), *added) == 0;
}

WindingNumbers Cut::begin(Cells& cells, int side_of_t, int side_of_x) const {
  const PlaneSides sides(x_.v0, x_.v1, x_.v2);
  std::size_t corner = 0;
  while (corner < 2 && sides.of(t_[corner]) != side_of_x) ++corner;
  LIMBER_ASSERT(sides.of(t_[corner]) == side_of_x);
  return cells.winding_numbers(CutProbe(ends_[0], along_, t_[corner], *direction_off(t_, side_of_t)));
}

void Cut::look_everywhere(Cells& cells) const {
  LIMBER_ASSERT(!is_shared());
  const WindingNumbers before_both = begin(cells, 1, 1);
  for (const int side_of_t : {1, -1}) {
    for (const int side_of_x : {1, -1}) {
      WindingNumbers numbers = before_both;
      for (const std::size_t s : {0, 1}) {
        numbers[s] += (side_of_t < 0 ? behind_t_[s] : 0) + (side_of_x < 0 ? behind_x_[s] : 0);
      }
      follow(cells, numbers, side_of_t, side_of_x);
    }
  }
}

}  // namespace limber::solid
