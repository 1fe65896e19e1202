// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernels' arithmetic, included once per instruction set, inside that set's namespace, after `Packet` and `Mask`
// have been defined there. No include guard for that reason.

// Largest error of a squared quantity formed from at most ten float32 operations, as a fraction of it.
inline constexpr float squares_up = 1 + 0x1p-20F, squares_down = 1 - 0x1p-20F;

template <typename P>
struct Triple {
  P x, y, z;
};
using Packet3 = Triple<Packet>;

template <typename P>
LIMBER_KERNEL Triple<P> operator-(const Triple<P>& a, const Triple<P>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
LIMBER_KERNEL Packet3 broadcast(const float* v) { return {Packet::set(v[0]), Packet::set(v[1]), Packet::set(v[2])}; }
template <typename P>
LIMBER_KERNEL P dot(const Triple<P>& a, const Triple<P>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename P>
LIMBER_KERNEL Triple<P> cross(const Triple<P>& a, const Triple<P>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

LIMBER_KERNEL Packet zero() { return Packet::set(0); }

/// The furthest of each triangle's corners in direction n, in steps.
LIMBER_KERNEL Packet furthest_corners(const LeafTriangles& leaf, std::uint32_t i, const Packet3& n) {
  Packet furthest[3];
  for (int k = 0; k < 3; ++k) {
    furthest[k] =
        dot(n, Packet3{Packet::from_int16(leaf.corner[3 * k] + i), Packet::from_int16(leaf.corner[3 * k + 1] + i),
                       Packet::from_int16(leaf.corner[3 * k + 2] + i)});
  }
  return max(max(furthest[0], furthest[1]), furthest[2]);
}
LIMBER_KERNEL float leaf_support(const LeafTriangles& leaf, const float* normal) {
  const Packet3 n = broadcast(normal);
  Packet furthest = furthest_corners(leaf, 0, n);
  for (std::uint32_t i = Packet::lanes; i < width; i += Packet::lanes) {
    furthest = max(furthest, furthest_corners(leaf, i, n));
  }
  return largest(furthest);
}

#include "simd/placing-inl.h"

/// Half of a ball cut by its slab, on one side of the centre: its height, and the radius of the circle at that height.
struct Cap {
  Packet height, rim;
};

LIMBER_KERNEL Cap cap(Packet radius, Packet height) {
  return {height, sqrt(max(radius * radius - height * height, zero()))};
}
LIMBER_KERNEL Cap select(Mask which, const Cap& a, const Cap& b) {
  return {select(which, a.height, b.height), select(which, a.rim, b.rim)};
}

/// How far a ball with that cap reaches in a direction at an angle to the slab's normal: the ball itself where its
/// furthest point is left, the rim otherwise.
LIMBER_KERNEL Packet reach(Packet radius, const Cap& c, Packet cosine, Packet sine) {
  return select(radius * cosine <= c.height, radius, c.height * cosine + c.rim * sine);
}

/// Squared length of a segment with these components, negative ones counting as none.
LIMBER_KERNEL Packet gap_sq(Packet along, Packet across) {
  const Packet u = max(along, zero()), v = max(across, zero());
  return u * u + v * v;
}

/// Lanes `i` and following of a block of nodes, and the facing node, as seen by the stages of bound_lanes().
struct Pairing {
  Packet3 center, half, normal;
  Packet3 d;  // from the lanes' centres to the facing node's
  Packet radius, distance, d_sq;
  Packet reaches, between;  // sum of the radii, and gap of the balls
  Cap upper, lower;
};

LIMBER_KERNEL Pairing pair_up(const NodeBounds& lanes, std::uint32_t i, const Facing& facing) {
  Pairing p;
  p.center = {Packet::load(lanes.center_x + i), Packet::load(lanes.center_y + i), Packet::load(lanes.center_z + i)};
  p.half = {Packet::load(lanes.half_x + i), Packet::load(lanes.half_y + i), Packet::load(lanes.half_z + i)};
  p.normal = {Packet::load(lanes.normal_x + i), Packet::load(lanes.normal_y + i), Packet::load(lanes.normal_z + i)};
  p.radius = Packet::load(lanes.radius + i);
  p.upper = cap(p.radius, Packet::load(lanes.high + i));
  p.lower = cap(p.radius, zero() - Packet::load(lanes.low + i));
  p.d = broadcast(facing.center) - p.center;
  p.d_sq = dot(p.d, p.d);
  p.distance = sqrt(p.d_sq);
  p.reaches = p.radius + Packet::set(facing.radius);
  p.between = p.distance - p.reaches;
  return p;
}

/// The lanes that are not far enough away along the direction `toward`. Leaves in `bound_sq` what it says of all.
LIMBER_KERNEL Mask near_along(const Pairing& p, const Toward& toward, Packet& bound_sq) {
  const Packet3 n = broadcast(toward.normal);
  const Packet cosine = dot(p.normal, n);
  const Packet3 crossed = cross(p.normal, n);
  const Packet ball_reach =
      reach(p.radius, select(cosine > zero(), p.upper, p.lower), abs(cosine), sqrt(dot(crossed, crossed)));
  const Packet box_reach = abs(n.x) * p.half.x + abs(n.y) * p.half.y + abs(n.z) * p.half.z;
  // The gap along n falls short of the cut by `lack`; what the balls are apart across n may make up for it:
  // (cut - lack)^2 + across^2 >= cut^2.
  const Packet lack = dot(n, p.center) + min(ball_reach, box_reach) - Packet::set(toward.gap);
  const Packet3 crossed_d = cross(p.d, n);
  const Packet across = max(sqrt(dot(crossed_d, crossed_d)) * Packet::set(squares_down) - p.reaches, zero());
  const Packet cut = Packet::set(toward.cut), missing = min(lack, cut);
  const Packet needed = missing * (cut + (cut - missing));
  bound_sq = gap_sq(cut * Packet::set(squares_down) - lack, across);
  return (lack > zero()) & (needed >= across * across * Packet::set(squares_down));
}

/// Squared gap of the balls or of the boxes along the lanes' axes.
LIMBER_KERNEL Packet ball_and_box_sq(const Pairing& p, const Packet3& half_f) {
  const Packet x = max(abs(p.d.x) - p.half.x - half_f.x, zero());
  const Packet y = max(abs(p.d.y) - p.half.y - half_f.y, zero());
  const Packet z = max(abs(p.d.z) - p.half.z - half_f.z, zero());
  return max(gap_sq(p.between, zero()), x * x + y * y + z * z);
}

/// Squared gap along the normal of either slab or along the line of centres.
LIMBER_KERNEL Packet slab_sq(const Pairing& p, const Facing& facing) {
  const Packet radius_f = Packet::set(facing.radius);
  const Packet3 normal_f = broadcast(facing.normal);
  const Cap upper_f{Packet::set(facing.high), Packet::set(facing.rim_high)};
  const Cap lower_f{Packet::set(-facing.low), Packet::set(facing.rim_low)};
  // Along either normal, together with the gap of the balls across it.
  const Packet cosine = dot(p.normal, normal_f);
  const Packet3 crossed = cross(p.normal, normal_f);
  const Packet cosine_abs = abs(cosine), sine = sqrt(dot(crossed, crossed));
  const Packet height_f = dot(p.d, normal_f), height = dot(p.d, p.normal);
  const Packet height_f_abs = abs(height_f), height_abs = abs(height);
  const Cap near_f = select(height_f > zero(), lower_f, upper_f), near = select(height > zero(), p.upper, p.lower);
  // Of what the products of dot() can be off by, the square roots keep no more than 2^-20 of d_sq.
  const Packet rounding = p.d_sq * Packet::set(0x1p-20F);
  const Packet aside_f = sqrt(max(p.d_sq - height_f * height_f - rounding, zero()));
  const Packet aside = sqrt(max(p.d_sq - height * height - rounding, zero()));
  const Packet tilted = reach(p.radius, select(height_f * cosine > zero(), p.upper, p.lower), cosine_abs, sine);
  const Packet tilted_f = reach(radius_f, select(height * cosine > zero(), lower_f, upper_f), cosine_abs, sine);
  const Packet best = max(gap_sq(height_f_abs - tilted - near_f.height, aside_f - p.reaches),
                          gap_sq(height_abs - near.height - tilted_f, aside - p.reaches));
  // Along the line of centres; products with `distance` instead of quotients. sqrt(2 * 2^-20) < 0.0015 makes good what
  // `rounding` took from the sines.
  const Packet more = p.distance * Packet::set(0.0015F);
  const Packet box = abs(p.d.x) * p.half.x + abs(p.d.y) * p.half.y + abs(p.d.z) * p.half.z;
  const Packet line = min(box, select(p.radius * height_abs <= near.height * p.distance, p.radius * p.distance,
                                      near.height * height_abs + near.rim * (aside + more)));
  const Packet line_f = select(radius_f * height_f_abs <= near_f.height * p.distance, radius_f * p.distance,
                               near_f.height * height_f_abs + near_f.rim * (aside_f + more));
  const Packet gap = max(p.d_sq - line - line_f, zero()) / max(p.distance, Packet::set(0x1p-50F));
  return max(best, gap * gap);
}

LIMBER_KERNEL KeptLanes bound_packet(const NodeBounds& lanes, std::uint32_t i, const Facing& facing,
                                     const Toward* toward, float limit_sq, float* order, float* bound_sq) {
  const Pairing p = pair_up(lanes, i, facing);
  const Packet limit = Packet::set(limit_sq), down = Packet::set(squares_down);
  const Packet best = max(ball_and_box_sq(p, broadcast(facing.half)), slab_sq(p, facing)) * down;
  const Packet overlap = p.between / max(p.reaches, Packet::set(0x1p-100F));
  select(best > zero(), best, min(overlap, zero())).store(order + i);
  unsigned kept = bits(best < limit);
  Packet along_sq = zero();
  if (toward != nullptr) kept &= bits(near_along(p, *toward, along_sq));
  if (bound_sq != nullptr) max(best, along_sq * down).store(bound_sq + i);
  return {kept, kept & bits(best <= zero())};
}

LIMBER_KERNEL KeptLanes bound_lanes(const Block& lanes, const Seen& seen, const View& view, float limit_sq,
                                    float* order, float* bound_sq) {
  alignas(32) double between[4];
  place(*seen.block, seen.lane, view, lanes.origin, between);
  const Facing facing = face(lanes, seen, view, between);
  Toward toward;
  const bool has_toward = view.has_toward && view.cut * view.per_unit < furthest / 2;
  if (has_toward) toward = look(lanes, seen, view, between);
  KeptLanes kept{0, 0};
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const KeptLanes these =
        bound_packet(lanes.bounds, i, facing, has_toward ? &toward : nullptr, limit_sq, order, bound_sq);
    kept.all |= these.all << i, kept.meeting |= these.meeting << i;
  }
  const unsigned used = (1U << lanes.count) - 1;
  return {kept.all & used, kept.meeting & used};
}

/// Corners as numbers, for one leaf: [3 * corner + axis][lane].
struct alignas(64) Corners {
  float v[9][width];

  LIMBER_KERNEL Packet3 at(int corner, std::uint32_t lane) const {
    return {Packet::load(v[3 * corner] + lane), Packet::load(v[3 * corner + 1] + lane),
            Packet::load(v[3 * corner + 2] + lane)};
  }
  LIMBER_KERNEL Packet3 spread(int corner, std::uint32_t lane) const {
    return {Packet::set(v[3 * corner][lane]), Packet::set(v[3 * corner + 1][lane]),
            Packet::set(v[3 * corner + 2][lane])};
  }
};

/// Three numbers, one for each corner.
struct Extent {
  Packet low, high;
};
LIMBER_KERNEL Extent extent(Packet x, Packet y, Packet z) { return {min(min(x, y), z), max(max(x, y), z)}; }

/// Squared gap of two triangles along a direction of squared length `w_sq`, times `w_sq`.
LIMBER_KERNEL Packet gap_along_sq(const Extent& a, const Extent& b) {
  const Packet gap = max(max(b.low - a.high, a.low - b.high), zero());
  return gap * gap;
}

/// Whether triangles that far apart cannot matter. Directions too short for float32 tell nothing.
LIMBER_KERNEL Mask apart(Packet gap, Packet w_sq, Packet limit_sq) {
  return (gap >= limit_sq * w_sq) & (w_sq >= Packet::set(1e-20F));
}

/// Tells the lanes of b apart from one triangle of a; `rows` has that triangle in every lane. Leaves in `bound_sq` the
/// best bound it met.
LIMBER_KERNEL unsigned compare_row(const Packet3 (&rows)[3], const Packet3 (&b)[3], Packet limit_sq, unsigned wanted,
                                   Packet& bound_sq) {
  // Along the line of the middles: right where the triangles are small against their distance.
  const Packet3 w{b[0].x + b[1].x + b[2].x - (rows[0].x + rows[1].x + rows[2].x),
                  b[0].y + b[1].y + b[2].y - (rows[0].y + rows[1].y + rows[2].y),
                  b[0].z + b[1].z + b[2].z - (rows[0].z + rows[1].z + rows[2].z)};
  const Packet w_sq = dot(w, w);
  const Packet gap_w = gap_along_sq(extent(dot(w, rows[0]), dot(w, rows[1]), dot(w, rows[2])),
                                    extent(dot(w, b[0]), dot(w, b[1]), dot(w, b[2])));
  unsigned kept = wanted & ~bits(apart(gap_w, w_sq, limit_sq));
  if (kept == 0) return 0;
  // Along the normal of either triangle, from a corner of a so that the numbers are small.
  const Packet3 r0[3] = {b[0] - rows[0], b[1] - rows[0], b[2] - rows[0]};
  const Packet3 e1 = rows[1] - rows[0], e2 = rows[2] - rows[0];
  const Packet3 n = cross(e1, e2);
  const Packet n_sq = dot(n, n);
  const Packet gap_n =
      gap_along_sq(extent(zero(), dot(n, e1), dot(n, e2)), extent(dot(n, r0[0]), dot(n, r0[1]), dot(n, r0[2])));
  const Packet3 m = cross(b[1] - b[0], b[2] - b[0]);
  const Packet m_sq = dot(m, m);
  const Packet gap_m =
      gap_along_sq(extent(zero(), dot(m, e1), dot(m, e2)), extent(dot(m, r0[0]), dot(m, r0[1]), dot(m, r0[2])));
  kept &= ~(bits(apart(gap_n, n_sq, limit_sq)) | bits(apart(gap_m, m_sq, limit_sq)));
  const Packet least = Packet::set(1e-20F);
  bound_sq = max(max(gap_w / max(w_sq, least), gap_n / max(n_sq, least)), gap_m / max(m_sq, least));
  return kept;
}

/// Which lanes of b, in bits, matter to which of a, in bytes, by how far they reach towards each other.
LIMBER_KERNEL std::uint64_t near_along(const LeafTriangles& a, const LeafTriangles& b, const LeafPair& pair,
                                       const View& view) {
  alignas(64) float high[width];
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    (furthest_corners(a, i, broadcast(view.normal)) * Packet::set(pair.step_a)).store(high + i);
  }
  std::uint64_t wanted = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet reach = furthest_corners(b, i, broadcast(view.other_normal)) * Packet::set(pair.step_b);
    for (std::uint32_t row = 0; row < width; ++row) {
      wanted |= std::uint64_t{bits(Packet::set(high[row]) + reach > Packet::set(pair.gap))} << (8 * row + i);
    }
  }
  return wanted;
}

/// Boxes of the triangles of a leaf.
struct alignas(64) Boxes {
  float low[3][width], high[3][width];
};

LIMBER_KERNEL void find_boxes(const Corners& c, Boxes& boxes) {
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet3 p = c.at(0, i), q = c.at(1, i), r = c.at(2, i);
    const Extent x = extent(p.x, q.x, r.x), y = extent(p.y, q.y, r.y), z = extent(p.z, q.z, r.z);
    x.low.store(boxes.low[0] + i), x.high.store(boxes.high[0] + i);
    y.low.store(boxes.low[1] + i), y.high.store(boxes.high[1] + i);
    z.low.store(boxes.low[2] + i), z.high.store(boxes.high[2] + i);
  }
}

/// The same by their boxes.
LIMBER_KERNEL std::uint64_t near_by_box(const Corners& a, const Corners& b, Packet limit_sq) {
  Boxes boxes_a, boxes_b;
  find_boxes(a, boxes_a);
  find_boxes(b, boxes_b);
  std::uint64_t wanted = 0;
  for (std::uint32_t row = 0; row < width; ++row) {
    for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
      Packet sum = zero();
      for (int axis = 0; axis < 3; ++axis) {
        const Packet above = Packet::load(boxes_b.low[axis] + i) - Packet::set(boxes_a.high[axis][row]);
        const Packet below = Packet::set(boxes_a.low[axis][row]) - Packet::load(boxes_b.high[axis] + i);
        const Packet gap = max(max(above, below), zero());
        sum = sum + gap * gap;
      }
      wanted |= std::uint64_t{bits(sum < limit_sq)} << (8 * row + i);
    }
  }
  return wanted;
}

/// Rows for columns in a matrix of 8 by 8 bits.
LIMBER_KERNEL std::uint64_t transposed(std::uint64_t m) {
  std::uint64_t t = (m ^ (m >> 7)) & 0x00aa00aa00aa00aaU;
  m ^= t ^ (t << 7);
  t = (m ^ (m >> 14)) & 0x0000cccc0000ccccU;
  m ^= t ^ (t << 14);
  t = (m ^ (m >> 28)) & 0x00000000f0f0f0f0U;
  return m ^ t ^ (t << 28);
}
LIMBER_KERNEL int rows_in_use(std::uint64_t m) {
  m |= m >> 4;
  m |= m >> 2;
  m |= m >> 1;
  return std::popcount(m & 0x0101010101010101U);
}

/// The corners of a leaf about its centre, or where the other one sees them.
LIMBER_KERNEL void unpack(const LeafTriangles& leaf, float step, Corners& c) {
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    for (int k = 0; k < 9; ++k) (Packet::from_int16(leaf.corner[k] + i) * Packet::set(step)).store(c.v[k] + i);
  }
}
LIMBER_KERNEL void unpack(const LeafTriangles& leaf, float step, const View& view, const float* offset, Corners& c) {
  const Packet3 x = broadcast(view.rotation[0]), y = broadcast(view.rotation[1]), z = broadcast(view.rotation[2]);
  const Packet3 shift = broadcast(offset);
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    for (int k = 0; k < 9; k += 3) {
      const Packet px = Packet::from_int16(leaf.corner[k] + i) * Packet::set(step);
      const Packet py = Packet::from_int16(leaf.corner[k + 1] + i) * Packet::set(step);
      const Packet pz = Packet::from_int16(leaf.corner[k + 2] + i) * Packet::set(step);
      (x.x * px + y.x * py + z.x * pz + shift.x).store(c.v[k] + i);
      (x.y * px + y.y * py + z.y * pz + shift.y).store(c.v[k + 1] + i);
      (x.z * px + y.z * py + z.z * pz + shift.z).store(c.v[k + 2] + i);
    }
  }
}

LIMBER_KERNEL void leaf_candidates(const Seen& a, const Seen& b, const View& view, Candidates& candidates) {
  const LeafPair pair = place_leaves(a, b, view);
  candidates.count = 0, candidates.error = pair.error, candidates.scale = pair.scale;
  std::uint64_t wanted = view.has_toward ? near_along(*a.corners, *b.corners, pair, view) : ~std::uint64_t{0};
  if (wanted == 0) return;
  Corners ca, cb;
  unpack(*a.corners, pair.step_a, ca);
  unpack(*b.corners, pair.step_b, view, pair.offset, cb);

  const float reach = pair.cut + pair.error;
  const Packet limit_sq = Packet::set(reach * reach * squares_up);
  // Boxes say something only where triangles that matter are closer than they are large.
  if (reach < (pair.step_a + pair.step_b) * quantum) wanted &= near_by_box(ca, cb, limit_sq);

  // One triangle of `rows` at a time is compared with all of `lanes`: the fewer rows the better.
  const std::uint64_t turned = transposed(wanted);
  const bool turn = rows_in_use(turned) < rows_in_use(wanted);
  if (turn) wanted = turned;
  const Corners &rows = turn ? cb : ca, &lanes = turn ? ca : cb;
  while (wanted != 0) {
    const auto row = static_cast<std::uint32_t>(std::countr_zero(wanted)) / 8;
    const auto these = static_cast<unsigned>(wanted >> (8 * row) & 0xff);
    wanted &= ~(std::uint64_t{0xff} << (8 * row));
    const Packet3 corners[3] = {rows.spread(0, row), rows.spread(1, row), rows.spread(2, row)};
    alignas(64) float bounds[width];
    unsigned kept = 0;
    for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
      const Packet3 others[3] = {lanes.at(0, i), lanes.at(1, i), lanes.at(2, i)};
      Packet bound_sq = zero();
      kept |= compare_row(corners, others, limit_sq, these >> i & ((1U << Packet::lanes) - 1), bound_sq) << i;
      bound_sq.store(bounds + i);
    }
    for (; kept != 0; kept &= kept - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(kept));
      const auto lane_a = static_cast<std::uint8_t>(turn ? lane : row);
      const auto lane_b = static_cast<std::uint8_t>(turn ? row : lane);
      candidates.pairs[candidates.count++] = {bounds[lane], lane_a, lane_b};
    }
  }
}

#include "simd/fitting-inl.h"
#include "simd/motion-inl.h"
