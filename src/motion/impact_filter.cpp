// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Pieces of the time are decided one after the other, in order. A piece that cannot be decided is clipped to where the
// elements may be in one plane, and halved if that leaves much of it.
//
// All numbers are relative to one corner and scaled by one power of two, so the answer does not depend on the unit.
// Polynomials are in Bernstein form, whose coefficients bound them. The vectors u, v and w of MovingElements at a time
// are off by 8 eps of their largest coordinate, where eps = 2^-53; volumes and areas of them by what the constants say
// (docs/algorithms/impact.md).
#include "motion/element_impact.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/check.h"
#include "base/error_bounds.h"

namespace limber::motion {
namespace {

using Kind = MovingElements::Kind;

/// Whether one element is on one side of the other along an axis, all the time. Comparisons do not round.
bool are_apart_along_an_axis(const MovingElements& e) {
  const bool is_face = e.kind == Kind::vertex_face;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    bool is_below = true, is_above = true;
    for (const auto& p : e.corners) {
      const double a = p[0][axis], b = p[1][axis], c = p[2][axis], d = p[3][axis];
      const double low_a = is_face ? a : std::min(a, b), high_a = is_face ? a : std::max(a, b);
      const double low_c = std::min(c, d), high_c = std::max(c, d);
      const double low_b = is_face ? std::min(b, low_c) : low_c, high_b = is_face ? std::max(b, high_c) : high_c;
      is_below = is_below && high_a < low_b, is_above = is_above && low_a > high_b;
    }
    if (is_below || is_above) return true;
  }
  return false;
}

/// A quadratic in Bernstein form over a piece of time.
struct BernsteinQuadratic {
  double c[3];

  bool is_above(double x) const { return c[0] > x && c[1] > x && c[2] > x; }
  bool is_below(double x) const { return c[0] < x && c[1] < x && c[2] < x; }
};

BernsteinQuadratic operator-(const BernsteinQuadratic& a, const BernsteinQuadratic& b) {
  return {{a.c[0] - b.c[0], a.c[1] - b.c[1], a.c[2] - b.c[2]}};
}
BernsteinQuadratic operator*(double s, const BernsteinQuadratic& a) { return {{s * a.c[0], s * a.c[1], s * a.c[2]}}; }

double cross_along(const Vec3& a, const Vec3& b, std::size_t axis) {
  const std::size_t i = axis == 2 ? 0 : axis + 1, k = axis == 0 ? 2 : axis - 1;
  return a[i] * b[k] - a[k] * b[i];
}
/// Coordinate `axis` of the cross product of two vectors.
BernsteinQuadratic cross_along(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1, std::size_t axis) {
  return {{cross_along(a0, b0, axis), 0.5 * (cross_along(a0, b1, axis) + cross_along(a1, b0, axis)),
           cross_along(a1, b1, axis)}};
}

/// Where a cubic in Bernstein form over a piece of time, from 0 to 1, is first certain no more to be above a level: the
/// lower side of the hull of its coefficients comes down to it. Pre: c[0] is above the level, and not all are.
double first_fall(const double (&c)[4], double level) {
  double first = 1;
  for (int i = 0; i < 3; ++i) {
    const double above = c[i] - level;
    if (above <= 0) continue;
    for (int k = i + 1; k < 4; ++k) {
      const double below = level - c[k];
      if (below >= 0) first = std::min(first, (i + (k - i) * (above / (above + below))) / 3);
    }
  }
  return first;
}

class Filter {
 public:
  Filter(const MovingElements& e, const ElementImpactOptions& options) : kind_(e.kind), options_(options) {
    start_ = vectors_of(kind_, e.corners[0]);
    const Vectors end = vectors_of(kind_, e.corners[1]);
    const double most = std::max(largest(start_), largest(end));
    if (most == 0) return;  // all corners are in one place
    // In two steps, because one factor may be out of range.
    const int exponent = std::ilogb(most), half = exponent / 2;
    const double scale = std::ldexp(1.0, -half), rest = std::ldexp(1.0, half - exponent);
    start_ = rest * (scale * start_);
    const Vectors scaled_end = rest * (scale * end);
    motion_ = scaled_end - start_;
    const double u = std::max(max_abs(start_.u), max_abs(scaled_end.u));
    const double v = std::max(max_abs(start_.v), max_abs(scaled_end.v));
    const double w = std::max(max_abs(start_.w), max_abs(scaled_end.w));
    // Errors are then above 2^-645, far above what underflow in products loses.
    is_in_range_ = std::min({u, v, w}) > 0x1p-200;
    volume_error_ = base::moving_volume_error * u * v * w;
    area_error_ = base::moving_area_error * (u * v + v * w + w * u);
  }

  FilterResult run() const {
    FilterResult result;
    if (!is_in_range_) return result;
    LIMBER_ASSERT(options_.max_time >= 0);
    Piece open[most_open];  // that are left, the next one on top
    std::size_t size = 0, undecided = 0;
    open[size++] = {0, options_.max_time};
    while (size > 0) {
      Piece piece = open[--size];
      const Vectors begin = at(piece.begin), end = at(piece.end);
      const BernsteinVolume volume(begin, end);
      switch (decide(begin, end, volume)) {
        case Decision::no_contact:
          break;
        case Decision::contact:
          narrow(piece, volume);
          return {FilterResult::Verdict::contact, piece.begin, piece.end};
        case Decision::unknown: {
          const Piece clipped = clip(piece, volume);
          const double middle = 0.5 * (clipped.begin + clipped.end);
          LIMBER_ASSERT(piece.begin <= clipped.begin && clipped.end <= piece.end);
          const bool is_short = clipped.end - clipped.begin < 0.7 * (piece.end - piece.begin);
          // Pieces of elements in one plane have volumes of no sign, however short they are.
          const std::size_t most = volume.largest_size() > volume_error_ ? most_undecided : 1;
          if (size + 2 > most_open || ++undecided > most) return result;
          if (is_short) {
            open[size++] = clipped;
          } else {
            open[size++] = {middle, clipped.end};
            open[size++] = {clipped.begin, middle};
          }
          break;
        }
      }
    }
    result.verdict = FilterResult::Verdict::clear;
    return result;
  }

 private:
  static constexpr std::size_t most_open = 13, most_undecided = 24;
  enum class Decision { no_contact, contact, unknown };

  struct Piece {
    double begin, end;
  };

  static double largest(const Vectors& x) { return std::max({max_abs(x.u), max_abs(x.v), max_abs(x.w)}); }

  Vectors at(double t) const { return start_ + t * motion_; }

  static double volume_at(const Vectors& x) { return dot(x.u, cross(x.v, x.w)); }

  /// The part of a piece outside of which the elements are certainly in no one plane. An end that is not that of the
  /// piece has a volume of certain sign.
  Piece clip(const Piece& piece, const BernsteinVolume& volume) const {
    const double level = 8 * volume_error_, length = piece.end - piece.begin;
    const double(&c)[4] = volume.c;
    const auto fall = [&](double c0, double c1, double c2, double c3) {
      if (!(std::abs(c0) > level)) return 0.0;
      const double side = c0 < 0 ? -1 : 1;
      return first_fall({side * c0, side * c1, side * c2, side * c3}, level);
    };
    return {piece.begin + fall(c[0], c[1], c[2], c[3]) * length, piece.end - fall(c[3], c[2], c[1], c[0]) * length};
  }

  Decision decide(const Vectors& a, const Vectors& b, const BernsteinVolume& volume) const {
    const double(&c)[4] = volume.c;
    const double e = volume_error_;
    if (volume.least_size() > e) return Decision::no_contact;

    const Vec3 middle = cross(a.u + b.u, a.v + b.v);
    const Vec3 size = abs(middle);
    const std::size_t axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : size.y > size.z ? 1 : 2;
    const double side = middle[axis] < 0 ? -1 : 1;
    const BernsteinQuadratic normal = side * cross_along(a.u, b.u, a.v, b.v, axis);
    if (!normal.is_above(area_error_)) return Decision::unknown;
    // Where the elements are in one plane, w = s u + r v with s = s_numerator / normal and r = r_numerator / normal.
    const BernsteinQuadratic s_numerator = side * cross_along(a.w, b.w, a.v, b.v, axis);
    const BernsteinQuadratic r_numerator = side * cross_along(a.u, b.u, a.w, b.w, axis);
    const bool is_face = kind_ == Kind::vertex_face;
    const BernsteinQuadratic limits[4] = {s_numerator, r_numerator,
                                          is_face ? normal - s_numerator - r_numerator : normal - s_numerator,
                                          normal - r_numerator};
    bool is_inside = true;
    for (std::size_t i = 0; i < (is_face ? 3U : 4U); ++i) {
      if (limits[i].is_below(-area_error_)) return Decision::no_contact;
      is_inside = is_inside && limits[i].is_above(area_error_);
    }
    if (!is_inside || !(std::min(c[0], c[3]) < -e && std::max(c[0], c[3]) > e)) return Decision::unknown;
    // Differences of coefficients, each off by the error.
    const double rise[3] = {c[1] - c[0], c[2] - c[1], c[3] - c[2]};
    const bool is_monotone =
        c[0] < 0 ? std::min({rise[0], rise[1], rise[2]}) > 2 * e : std::max({rise[0], rise[1], rise[2]}) < -2 * e;
    return is_monotone ? Decision::contact : Decision::unknown;
  }

  /// Narrows a piece with one contact as far as float64 can tell the signs of volumes at its ends.
  void narrow(Piece& piece, const BernsteinVolume& volume) const {
    double begin = piece.begin, end = piece.end;
    double at_begin = volume.c[0], at_end = volume.c[3];
    const double side = at_end > 0 ? 1 : -1;
    // Puts an end of the interval at t, if the sign there is certain.
    const auto narrow_to = [&](double t) {
      const double there = volume_at(at(t));
      if (!(begin < t && t < end) || std::abs(there) <= volume_error_) return;
      (side * there > 0 ? end : begin) = t, (side * there > 0 ? at_end : at_begin) = there;
    };
    // The factors below matter for speed only.
    const double wanted = std::max(options_.time_error, time_resolution);
    for (double before = 2; end - begin > wanted && end - begin < 0.9 * before;) {
      before = end - begin;
      const double slope = (at_end - at_begin) / before, guess = begin - at_begin / slope;
      const double away = 2 * volume_error_ / std::abs(slope) + 0.02 * std::min(guess - begin, end - guess);
      narrow_to(guess - away);
      narrow_to(guess + away);
      if (end - begin > 0.5 * before) narrow_to(0.5 * (begin + end));
    }
    piece.begin = begin, piece.end = end;
  }

  Kind kind_;
  ElementImpactOptions options_;
  bool is_in_range_ = false;
  Vectors start_, motion_;
  double volume_error_ = 0, area_error_ = 0;
};

}  // namespace

FilterResult filter_impact(const MovingElements& elements, const ElementImpactOptions& options) {
  if (are_apart_along_an_axis(elements)) return {FilterResult::Verdict::clear, 0, 0};
  return Filter(elements, options).run();
}

}  // namespace limber::motion
