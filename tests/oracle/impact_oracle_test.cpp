// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// First contacts of moving elements against the roots of polynomials that CGAL isolates, exact: the algebraic kernel
// finds every time at which the answer could begin, and each is tested in order.
#include <CGAL/Algebraic_kernel_d_1.h>
#include <CGAL/Gmpz.h>
#include <CGAL/Polynomial.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "limber/motion.h"
#include "support/random_motion.h"

namespace limber::testing {
namespace {

using Kernel = CGAL::Algebraic_kernel_d_1<CGAL::Gmpz>;
using Polynomial = Kernel::Polynomial_1;
using Root = Kernel::Algebraic_real_1;
using Vector = std::array<Polynomial, 3>;

Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Polynomial dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// A number as a multiple of 2^exponent.
CGAL::Gmpz whole(double x, int exponent) {
  int own = 0;
  const double mantissa = std::frexp(x, &own);
  CGAL::Gmpz result(std::ldexp(mantissa, 53));
  if (mantissa == 0) return result;
  const int shift = own - 53 - exponent;
  if (shift >= 0) return result << shift;
  return result >> -shift;  // exact: x is such a multiple
}

class Oracle {
 public:
  Oracle(const MovingCorners& m, bool is_face) : is_face_(is_face) {
    int lowest = 2000;
    for (const auto& corners : {std::to_array(m.start), std::to_array(m.end)}) {
      for (const Vec3& p : corners) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          int exponent = 0;
          if (std::frexp(p[axis], &exponent) != 0) lowest = std::min(lowest, std::max(exponent - 53, -1074));
        }
      }
    }
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const CGAL::Gmpz start = whole(m.start[i][axis], lowest), end = whole(m.end[i][axis], lowest);
        corner_[i][axis] = Polynomial(start, end - start);
      }
    }
  }

  /// The first time at which the elements touch.
  std::optional<Root> first_contact() const {
    const auto& [a, b, c, d] = corner_;
    const Polynomial volume = dot(b - a, cross(c - a, d - a));
    std::vector<Root> times;
    if (sign(volume, Root(0)) == 0) times.emplace_back(0);
    if (!CGAL::is_zero(volume)) {
      add_roots(volume, times);
    } else {
      for (const auto& [p, q, r] : {std::tie(a, b, c), std::tie(a, b, d), std::tie(a, c, d), std::tie(b, c, d)}) {
        for (const Polynomial& area : cross(q - p, r - p)) add_roots(area, times);
      }
      // Not c and d, which are corners of one element.
      for (const auto& [p, q] : {std::tie(a, b), std::tie(a, c), std::tie(a, d), std::tie(b, c), std::tie(b, d)}) {
        for (const Polynomial& difference : q - p) add_roots(difference, times);
      }
    }
    std::sort(times.begin(), times.end());
    for (const Root& t : times) {
      if (touch_at(t)) return t;
    }
    return {};
  }

 private:
  void add_roots(const Polynomial& p, std::vector<Root>& times) const {
    if (CGAL::is_zero(p) || p.degree() == 0) return;
    std::vector<std::pair<Root, unsigned>> roots;
    kernel_.solve_1_object()(p, std::back_inserter(roots));
    for (const auto& [root, multiplicity] : roots) {
      if (root >= Root(0) && root <= Root(1)) times.push_back(root);
    }
  }

  int sign(const Polynomial& p, const Root& t) const {
    if (CGAL::is_zero(p)) return 0;
    try {
      return static_cast<int>(kernel_.sign_at_1_object()(p, t));
    } catch (const CGAL::Precondition_exception&) {
      // As the kernel narrows a root, it may find that the root is a rational number; then it throws.
      if (t.low() != t.high()) throw;
      return static_cast<int>(p.sign_at(t.low()));
    }
  }

  bool is_on_segment(const Vector& p, const Vector& q, const Vector& r, const Root& t) const {
    for (const Polynomial& area : cross(q - p, r - p)) {
      if (sign(area, t) != 0) return false;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (sign(q[axis] - p[axis], t) * sign(r[axis] - p[axis], t) > 0) return false;
    }
    return true;
  }

  /// Of four corners that are in one plane at t.
  bool touch_at(const Root& t) const {
    const auto& [a, b, c, d] = corner_;
    if (is_face_) {
      // The vertex is on an edge, or on the same side of all three.
      if (is_on_segment(a, b, c, t) || is_on_segment(a, c, d, t) || is_on_segment(a, d, b, t)) return true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int bc = sign(cross(b - a, c - a)[axis], t), cd = sign(cross(c - a, d - a)[axis], t);
        if (bc != 0 && bc == cd && bc == sign(cross(d - a, b - a)[axis], t)) return true;
      }
      return false;
    }
    // An end is on the other edge, or each edge separates the ends of the other.
    if (is_on_segment(a, c, d, t) || is_on_segment(b, c, d, t)) return true;
    if (is_on_segment(c, a, b, t) || is_on_segment(d, a, b, t)) return true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto side = [&](const Vector& p, const Vector& q, const Vector& r) {
        return sign(cross(q - p, r - p)[axis], t);
      };
      if (side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0) return true;
    }
    return false;
  }

  bool is_face_;
  std::array<Vector, 4> corner_;
  Kernel kernel_;
};

bool is_at_least(const Root& t, double time) { return t >= Root(CGAL::Gmpq(time)); }

class ImpactOracle : public ::testing::TestWithParam<MotionKind> {};

TEST_P(ImpactOracle, NeverDisagrees) {
  constexpr auto kinds = static_cast<std::uint64_t>(MotionKind::count);
  const std::uint64_t pairs = count_from("LIMBER_IMPACT_PAIRS", 20'000) / kinds + 1;
  Rng rng(3000 + static_cast<std::uint64_t>(GetParam()));
  std::uint64_t touching = 0, at_start = 0;
  double widest = 0;
  for (std::uint64_t i = 0; i < pairs; ++i) {
    const bool is_face = rng.below(2) == 0;
    const MovingCorners m = random_motion(rng, GetParam(), is_face);
    const std::optional<Root> truth = Oracle(m, is_face).first_contact();
    const ElementImpact found = impact_of(m, is_face);
    ASSERT_EQ(found.status != ImpactStatus::clear, truth.has_value()) << "pair " << i << (is_face ? " face" : " edges");
    if (!truth) continue;
    ++touching;
    ASSERT_EQ(found.status == ImpactStatus::initial_contact, *truth == Root(0)) << "pair " << i;
    at_start += found.status == ImpactStatus::initial_contact ? 1 : 0;
    ASSERT_TRUE(is_at_least(*truth, found.lower)) << "pair " << i << " " << found.lower;
    ASSERT_TRUE(*truth <= Root(CGAL::Gmpq(found.upper))) << "pair " << i << " " << found.upper;
    widest = std::max(widest, found.upper - found.lower);
    ASSERT_LE(found.upper - found.lower, 0x1p-53);
  }
  std::cout << pairs << " pairs, " << touching << " touch, " << at_start << " at the start, widest interval " << widest
            << "\n";
}

INSTANTIATE_TEST_SUITE_P(Kinds, ImpactOracle, ::testing::ValuesIn(every_kind<MotionKind>()),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace limber::testing
