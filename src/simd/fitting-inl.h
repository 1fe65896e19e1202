// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Bounds of leaves from the corners of their triangles; part of kernels-inl.h, and included once per instruction set
// like it. The lanes are the leaves of a block, so nothing has to be summed up across lanes.
//
// Corners are float32 relative to one of their own leaf, so however small a leaf is, its numbers are as exact as it
// needs; every bound is enlarged by the rounding on the way.

/// Rounding of a corner, and of what a few operations make of it, as a part of the leaf's extent.
inline constexpr float corner_doubt = 0x1p-21F;
/// And in units: what is smaller than this has no square in float32.
inline constexpr float least_doubt = 0x1p-60F;

/// Corner k of triangle j of a leaf.
LIMBER_KERNEL std::uint32_t corner_of(std::uint32_t k, std::uint32_t j) { return width * k + j; }

/// The corners of the leaves of a block, by axis, corner and leaf, in units.
struct alignas(64) BlockCorners {
  float v[3][3 * width * width];

  template <typename P = Packet>
  LIMBER_KERNEL Triple<P> at(std::uint32_t corner, std::uint32_t lane) const {
    const std::uint32_t i = width * corner + lane;
    return {P::load(v[0] + i), P::load(v[1] + i), P::load(v[2] + i)};
  }
};

LIMBER_KERNEL Triple<WidePacket> twice(const Packet3& p) { return {twice(p.x), twice(p.y), twice(p.z)}; }

/// The leaves of a block: lanes beyond them repeat the last.
struct LeavesOfBlock {
  BlockCorners corners;                 // relative to origin[leaf]
  alignas(64) double origin[3][width];  // a corner of each leaf, model frame
};

LIMBER_KERNEL void store3(const Packet3& p, float (&v)[3][width], std::uint32_t i) {
  p.x.store(v[0] + i), p.y.store(v[1] + i), p.z.store(v[2] + i);
}

LIMBER_KERNEL void gather(const Vec3* positions, std::span<const Leaf> leaves, std::uint32_t count, double per_unit,
                          LeavesOfBlock& gathered) {
  const auto position = [&](VertexId id) { return &positions[id].x; };
  // As load_points() wants them: by corner and triangles, then leaf, then triangle; four numbers each.
  constexpr std::uint32_t at_once = corners_at_once;
  alignas(64) float placed[4 * 3 * width * width];
  for (std::uint32_t k = 0; k < width; ++k) {
    const Leaf& leaf = leaves[std::min(k, count - 1)];
    const double* const origin = position(leaf.vertices[0][0]);
    for (int axis = 0; axis < 3; ++axis) gathered.origin[axis][k] = origin[axis];
    const std::uint32_t soon = count + k;
    for (std::uint32_t j = 0; soon < leaves.size() && j < width; j += 2) {
      __builtin_prefetch(position(leaves[soon].vertices[j][2]));
    }
    const double* origins[at_once];
    for (const double*& from : origins) from = origin;
    const Placing placing(origins, per_unit);
    for (std::uint32_t j = 0; j < width; j += at_once) {
      for (std::uint32_t c = 0; c < 3; ++c) {
        const double* points[at_once];
        for (std::uint32_t i = 0; i < at_once; ++i) points[i] = position(leaf.vertices[j + i][c]);
        placing.place(points, placed + 4 * (width * corner_of(c, j) + at_once * k));
      }
    }
  }
  for (std::uint32_t i = 0; i < 3 * width * width; i += WidePacket::lanes) {
    Triple<WidePacket> p;
    load_points(placed + 4 * i, p.x, p.y, p.z);
    p.x.store(gathered.corners.v[0] + i), p.y.store(gathered.corners.v[1] + i), p.z.store(gathered.corners.v[2] + i);
  }
}

template <typename P>
LIMBER_KERNEL Triple<P> min3(const Triple<P>& a, const Triple<P>& b) {
  return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
template <typename P>
LIMBER_KERNEL Triple<P> max3(const Triple<P>& a, const Triple<P>& b) {
  return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
template <typename P>
LIMBER_KERNEL Triple<P> operator+(const Triple<P>& a, const Triple<P>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename P>
LIMBER_KERNEL Triple<P> operator*(const Triple<P>& a, P s) {
  return {a.x * s, a.y * s, a.z * s};
}
/// A vector or its opposite, whichever is on the side of another.
template <typename P>
LIMBER_KERNEL Triple<P> turned(const Triple<P>& v, const Triple<P>& side) {
  const P cosine = dot(v, side);
  return {flipped_as(v.x, cosine), flipped_as(v.y, cosine), flipped_as(v.z, cosine)};
}
LIMBER_KERNEL Packet3 select(Mask which, const Packet3& a, const Packet3& b) {
  return {select(which, a.x, b.x), select(which, a.y, b.y), select(which, a.z, b.z)};
}
LIMBER_KERNEL Packet largest_abs(const Packet3& a) { return max(max(abs(a.x), abs(a.y)), abs(a.z)); }
LIMBER_KERNEL Packet3 load3(const float (&v)[3][width], std::uint32_t i) {
  return {Packet::load(v[0] + i), Packet::load(v[1] + i), Packet::load(v[2] + i)};
}

/// Boxes, and mean normals with each triangle's vector turned to one side of the others'.
struct BoxesAndAreas {
  alignas(64) float low[3][width], high[3][width], area[3][width];
};

LIMBER_KERNEL void find_boxes_and_areas(const BlockCorners& corners, BoxesAndAreas& found) {
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    Triple<WidePacket> lows = corners.at<WidePacket>(0, i), highs = lows;
    for (std::uint32_t c = corners_at_once; c < 3 * width; c += corners_at_once) {
      const Triple<WidePacket> p = corners.at<WidePacket>(c, i);
      lows = min3(lows, p), highs = max3(highs, p);
    }
    const Packet3 low{smaller_half(lows.x), smaller_half(lows.y), smaller_half(lows.z)};
    const Packet3 high{larger_half(highs.x), larger_half(highs.y), larger_half(highs.z)};
    // Relative to the leaf's extent, so that products of tiny edges do not vanish.
    const Packet extent = max(largest_abs(low), largest_abs(high));
    const Packet scale = Packet::set(1) / max(extent, Packet::set(0x1p-100F));
    // Two sums, of every other triangle each.
    const WidePacket none = twice(zero()), scales = twice(scale);
    Triple<WidePacket> sums[2 / corners_at_once];
    for (Triple<WidePacket>& sum : sums) sum = {none, none, none};
    for (std::uint32_t j = 0; j < width; j += corners_at_once) {
      Triple<WidePacket>& sum = sums[j % 2 / corners_at_once];
      const Triple<WidePacket> p = corners.at<WidePacket>(corner_of(0, j), i);
      sum = sum + turned(cross((corners.at<WidePacket>(corner_of(1, j), i) - p) * scales,
                               (corners.at<WidePacket>(corner_of(2, j), i) - p) * scales),
                         sum);
    }
    const Packet3 even{first_of(sums[0].x), first_of(sums[0].y), first_of(sums[0].z)};
    const Triple<WidePacket>& last = sums[2 / corners_at_once - 1];
    const Packet3 odd{last_of(last.x), last_of(last.y), last_of(last.z)};
    const Packet3 sum = even + turned(odd, even);
    store3(low, found.low, i), store3(high, found.high, i);
    store3(sum * (extent * extent), found.area, i);
  }
}

/// A unit vector along `area`, or the direction in which the box is thinnest where there is none.
LIMBER_KERNEL Packet3 slab_normal(const Packet3& area, const Packet3& half) {
  const Packet zeros = zero(), ones = Packet::set(1);
  const Packet size = largest_abs(area);
  const Packet3 scaled = area * (ones / max(size, Packet::set(0x1p-126F)));
  const Packet3 normal = scaled * (ones / max(sqrt(dot(scaled, scaled)), Packet::set(0.5F)));
  const Mask x_is_thinner = half.x <= half.y;
  const Mask z_is_thinnest = half.z < min(half.x, half.y);
  Packet3 thinnest{select(x_is_thinner, ones, zeros), select(x_is_thinner, zeros, ones), zeros};
  thinnest = select(z_is_thinnest, Packet3{zeros, zeros, ones}, thinnest);
  return select(size > Packet::set(0x1p-120F), normal, thinnest);
}

/// How far the corners are from a centre, and how high over it along a direction.
struct Spread {
  Packet radius, low, high;
};

/// Collects that, corner by corner.
struct Spreading {
  Triple<WidePacket> shift, normal;  // `shift` takes corners to where they are measured from
  WidePacket furthest_sq = twice(zero());
  WidePacket low = twice(Packet::set(0x1p100F)), high = twice(Packet::set(-0x1p100F));

  LIMBER_KERNEL void put(const Triple<WidePacket>& corner) {
    const Triple<WidePacket> d = corner - shift;
    const WidePacket height = dot(normal, d);
    furthest_sq = max(furthest_sq, dot(d, d));
    low = min(low, height), high = max(high, height);
  }
  /// `off` covers what corners and shift are off by.
  LIMBER_KERNEL Spread spread(Packet off) const {
    const Packet radius = sqrt(larger_half(furthest_sq)) * Packet::set(squares_up) + (off + off);
    const Packet tilt = (off + off) + radius * Packet::set(corner_doubt);
    return {radius, smaller_half(low) - tilt, larger_half(high) + tilt};
  }
};

/// Stores the corners as fractions of their leaf's ball.
LIMBER_KERNEL void quantise(const BlockCorners& corners, const NodeBounds& bounds, const float (&shift)[3][width],
                            std::uint32_t count, Leaf* leaves) {
  LeafTriangles beyond;  // where the lanes that are not used go
  LeafTriangles* to[width];
  for (std::uint32_t k = 0; k < width; ++k) to[k] = k < count ? &leaves[k].corners : &beyond;
  WidePacket scale[width / Packet::lanes];
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    scale[i / Packet::lanes] = twice(Packet::set(quantum) / Packet::load(bounds.radius + i));
  }
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      // Row by row, a triangle of all leaves each; a packet is a part of a row, or two rows.
      Square square;
      for (std::uint32_t i = 0; i < width * width; i += WidePacket::lanes) {
        const WidePacket center = twice(Packet::load(shift[axis] + i % width));
        const WidePacket p = WidePacket::load(corners.v[axis] + width * corner_of(k, 0) + i);
        square.put(i, (p - center) * scale[i % width / Packet::lanes]);
      }
      std::int16_t* columns[width];
      for (std::uint32_t leaf = 0; leaf < width; ++leaf) columns[leaf] = to[leaf]->corner[3 * k + axis];
      square.store_columns(columns);
    }
  }
}

/// The sum of vectors, each turned to one side of those before it.
LIMBER_KERNEL void sum_turned(const float (&v)[3][width], float (&sum)[3]) {
  sum[0] = sum[1] = sum[2] = 0;
  for (std::uint32_t k = 0; k < width; ++k) {
    const float side = sum[0] * v[0][k] + sum[1] * v[1][k] + sum[2] * v[2][k];
    for (int axis = 0; axis < 3; ++axis) sum[axis] += side < 0 ? -v[axis][k] : v[axis][k];
  }
}

/// A bound but for how far it reaches.
struct Frame {
  float center[3], half[3];
  Packet3 normal;
  float off;  // covers what corners are off by
};

/// That of all leaves together, which lie where `in_block` says, relative to the origin of the block.
LIMBER_KERNEL Frame frame_of_all(const BoxesAndAreas& found, const float (&in_block)[3][width]) {
  Frame frame;
  float low[3], high[3], area[3], extent = 0;
  for (int axis = 0; axis < 3; ++axis) {
    Packet least = Packet::set(0x1p100F), most = Packet::set(-0x1p100F);
    for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
      const Packet place = Packet::load(in_block[axis] + i);
      least = min(least, Packet::load(found.low[axis] + i) + place);
      most = max(most, Packet::load(found.high[axis] + i) + place);
    }
    low[axis] = -largest(zero() - least), high[axis] = largest(most);
    extent = std::max({extent, std::abs(low[axis]), std::abs(high[axis])});
  }
  frame.off = extent * corner_doubt + least_doubt;
  sum_turned(found.area, area);
  for (int axis = 0; axis < 3; ++axis) {
    const float center = 0.5F * low[axis] + 0.5F * high[axis];
    frame.center[axis] = center;
    frame.half[axis] = std::max(high[axis] - center, center - low[axis]) + frame.off;
  }
  frame.normal = slab_normal(broadcast(area), broadcast(frame.half));
  return frame;
}

LIMBER_KERNEL WholeBound bound_of(const Frame& frame, const Spread& all) {
  WholeBound whole;
  alignas(64) float n[3][width];
  store3(frame.normal, n, 0);
  for (int axis = 0; axis < 3; ++axis) {
    whole.center[axis] = frame.center[axis], whole.half[axis] = frame.half[axis], whole.normal[axis] = n[axis][0];
  }
  whole.radius = largest(all.radius), whole.high = largest(all.high), whole.low = -largest(zero() - all.low);
  return whole;
}

/// core::to_24_bits().
LIMBER_KERNEL Doubles to_24_bits(Doubles x) {
  const Doubles high = x * Doubles::set(0x1p29 + 1);
  return or_zero(high - (high - x), x, 0x1p-100);
}

LIMBER_KERNEL WholeBound fit_leaves(const Vec3* positions, double unit, Block& block, std::span<Leaf> leaves) {
  const double per_unit = 1 / unit;
  LeavesOfBlock gathered;
  gather(positions, leaves, block.count, per_unit, gathered);
  BoxesAndAreas found;
  find_boxes_and_areas(gathered.corners, found);

  // Where leaves are in the block; and centres, which are stored relative to the block, relative to the leaf.
  block.origin = {gathered.origin[0][0], gathered.origin[1][0], gathered.origin[2][0]};
  alignas(64) float in_block[3][width], shift[3][width], stored[3][width];
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const Doubles from = Doubles::set(gathered.origin[axis][0]);
    for (std::uint32_t k = 0; k < width; k += Doubles::lanes) {
      const Doubles offset = (Doubles::load(gathered.origin[axis] + k) - from) * Doubles::set(per_unit);
      const Doubles middle =
          Doubles::set(0.5) * (Doubles::from_floats(found.low[axis] + k) + Doubles::from_floats(found.high[axis] + k));
      const Doubles center = to_24_bits(offset + middle);
      offset.store_rounded(in_block[axis] + k);
      center.store_rounded(stored[axis] + k);
      (center - offset).store_rounded(shift[axis] + k);
    }
  }
  const Frame frame = frame_of_all(found, in_block);
  Spread all{zero(), Packet::set(0x1p100F), Packet::set(-0x1p100F)};
  NodeBounds& n = block.bounds;
  Packet reach = zero();
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet3 low = load3(found.low, i), high = load3(found.high, i), center = load3(shift, i);
    const Packet extent = max(max(largest_abs(low), largest_abs(high)), largest_abs(center));
    const Packet3 place = load3(stored, i);
    const Packet off =
        extent * Packet::set(corner_doubt) + largest_abs(place) * Packet::set(0x1p-50F) + Packet::set(least_doubt);
    const Packet3 half = max3(high - center, center - low) + Packet3{off, off, off};
    const Packet3 normal = slab_normal(load3(found.area, i), half);
    Spreading spreading{twice(center), twice(normal)};
    Spreading spreading_all{twice(broadcast(frame.center) - load3(in_block, i)), twice(frame.normal)};
    for (std::uint32_t c = 0; c < 3 * width; c += corners_at_once) {
      const Triple<WidePacket> corner = gathered.corners.at<WidePacket>(c, i);
      spreading.put(corner), spreading_all.put(corner);
    }
    const Spread spread = spreading.spread(off), some = spreading_all.spread(Packet::set(frame.off));
    all = {max(all.radius, some.radius), min(all.low, some.low), max(all.high, some.high)};
    place.x.store(n.center_x + i), place.y.store(n.center_y + i), place.z.store(n.center_z + i);
    half.x.store(n.half_x + i), half.y.store(n.half_y + i), half.z.store(n.half_z + i);
    normal.x.store(n.normal_x + i), normal.y.store(n.normal_y + i), normal.z.store(n.normal_z + i);
    spread.radius.store(n.radius + i), spread.low.store(n.low + i), spread.high.store(n.high + i);
    reach = max(reach, sqrt(dot(place, place)) * Packet::set(squares_up) + spread.radius);
  }
  block.reach = (largest(reach) + least_doubt) * squares_up;
  quantise(gathered.corners, n, shift, block.count, leaves.data());
  return bound_of(frame, all);
}

/// The least and the largest of all lanes, once all of them have been put in.
struct Range {
  Packet least, most;

  LIMBER_KERNEL void put(Packet low, Packet high) { least = min(least, low), most = max(most, high); }
  LIMBER_KERNEL float low() const { return -largest(zero() - least); }
  LIMBER_KERNEL float high() const { return largest(most); }
};

LIMBER_KERNEL Range no_range() { return {Packet::set(0x1p100F), Packet::set(-0x1p100F)}; }

/// How far lanes whose centres are at `d` reach from there: as balls, or by their slabs and the balls across them.
LIMBER_KERNEL Packet furthest_of(const Pairing& p, const Packet3& d, Packet low, Packet high) {
  const Packet distance_sq = dot(d, d), height = dot(p.normal, d);
  const Packet along = max(abs(height + low), abs(height + high));
  const Packet rounding = distance_sq * Packet::set(0x1p-20F);
  const Packet across = sqrt(max(distance_sq - height * height, zero()) + rounding) + p.radius;
  return min(sqrt(distance_sq) + p.radius, sqrt(along * along + across * across)) * Packet::set(squares_up);
}

/// The bound around the lanes of a block, all of which are in use.
LIMBER_KERNEL WholeBound enclose_all(const NodeBounds& n) {
  WholeBound whole;
  Range box[3] = {no_range(), no_range(), no_range()};
  alignas(64) float area[3][width];
  Packet largest_radius = zero();
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    largest_radius = max(largest_radius, Packet::load(n.radius + i));
  }
  // Relative to the largest, so that squares do not vanish.
  const Packet per_radius = Packet::set(1 / std::max(largest(largest_radius), 0x1p-100F));
  const float* const centers[3] = {n.center_x, n.center_y, n.center_z};
  const float* const halves[3] = {n.half_x, n.half_y, n.half_z};
  const float* const normals[3] = {n.normal_x, n.normal_y, n.normal_z};
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet radius = Packet::load(n.radius + i) * per_radius, weight = radius * radius;
    for (int axis = 0; axis < 3; ++axis) {
      const Packet center = Packet::load(centers[axis] + i), half = Packet::load(halves[axis] + i);
      box[axis].put(center - half, center + half);
      (Packet::load(normals[axis] + i) * weight).store(area[axis] + i);
    }
  }
  float extent = 0;
  for (const Range& side : box) extent = std::max({extent, std::abs(side.low()), std::abs(side.high())});
  const float off = extent * corner_doubt + least_doubt;
  for (int axis = 0; axis < 3; ++axis) {
    const float low = box[axis].low(), high = box[axis].high();
    whole.center[axis] = 0.5F * low + 0.5F * high;
    whole.half[axis] = std::max(high - whole.center[axis], whole.center[axis] - low) + off;
  }
  float sum[3];
  sum_turned(area, sum);
  const Packet3 normal = slab_normal(broadcast(sum), broadcast(whole.half));
  Range slab = no_range(), ball = no_range();
  const Packet offs = Packet::set(4 * off), up = Packet::set(squares_up);
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Facing at{{whole.center[0], whole.center[1], whole.center[2]}, {}, {}, 0, 0, 0, 0, 0};
    const Pairing p = pair_up(n, i, at);
    const Packet3 d{zero() - p.d.x, zero() - p.d.y, zero() - p.d.z};
    const Packet cosine = dot(p.normal, normal), height = dot(normal, d);
    const Packet3 crossed = cross(p.normal, normal);
    const Packet sine = sqrt(dot(crossed, crossed)), cosine_abs = abs(cosine);
    const Packet box_reach = abs(normal.x) * p.half.x + abs(normal.y) * p.half.y + abs(normal.z) * p.half.z;
    const Mask same_side = cosine > zero();
    const Packet above = reach(p.radius, select(same_side, p.upper, p.lower), cosine_abs, sine);
    const Packet below = reach(p.radius, select(same_side, p.lower, p.upper), cosine_abs, sine);
    slab.put(height - min(below, box_reach) * up - offs, height + min(above, box_reach) * up + offs);
    const Packet far = furthest_of(p, d, Packet::load(n.low + i), Packet::load(n.high + i)) + offs;
    ball.put(far, far);
  }
  alignas(64) float stored[3][width];
  store3(normal, stored, 0);
  for (int axis = 0; axis < 3; ++axis) whole.normal[axis] = stored[axis][0];
  whole.low = slab.low(), whole.high = slab.high();
  const float* const half = whole.half;
  const float diagonal = std::sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]) * squares_up;
  whole.radius = std::min(ball.high(), diagonal);
  return whole;
}

LIMBER_KERNEL WholeBound enclose(const Block& block) {
  if (block.count == width) return enclose_all(block.bounds);
  float rows[sizeof(NodeBounds) / sizeof(float) / width][width];
  std::memcpy(rows, &block.bounds, sizeof(rows));
  for (float(&row)[width] : rows) {
    for (std::uint32_t k = block.count; k < width; ++k) row[k] = row[block.count - 1];  // the last lane again
  }
  NodeBounds repeated;
  std::memcpy(&repeated, rows, sizeof(rows));
  return enclose_all(repeated);
}
