// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// How far points have gone; part of kernels-inl.h, and included once per instruction set like it.

LIMBER_KERNEL Motion measure_motion(const Vec3* from, const Vec3* to, std::size_t count, double most) {
  const Doubles limit = Doubles::set(most);
  Doubles furthest_sq = Doubles::set(0);
  DoublesMask is_bounded = limit <= limit;
  std::size_t i = 0;
  for (; i + Doubles::lanes <= count; i += Doubles::lanes) {
    Triple<Doubles> p, q;
    load_points(&to[i].x, p.x, p.y, p.z);
    load_points(&from[i].x, q.x, q.y, q.z);
    is_bounded = is_bounded & (abs(p.x) <= limit) & (abs(p.y) <= limit) & (abs(p.z) <= limit);
    const Triple<Doubles> d = p - q;
    furthest_sq = max(furthest_sq, dot(d, d));
  }
  if (!all_of(is_bounded)) return {0, false};
  double longest_sq = largest(furthest_sq);
  for (; i < count; ++i) {
    if (!(max_abs(to[i]) <= most) || !is_finite(to[i])) return {0, false};
    const Vec3 d = to[i] - from[i];
    longest_sq = std::max(longest_sq, d.x * d.x + d.y * d.y + d.z * d.z);
  }
  return {longest_sq, true};
}
