// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// How a node or a leaf of one tree looks from the other; part of kernels-inl.h, and included once per instruction set
// like it. Plain loops over four numbers, which compilers turn into one instruction each.
//
// Float64 finds where a centre lies relative to the local origin it is compared at; from there on float32 resolves
// everything that matters, however far the models are from the world's origin. All errors on the way are added to the
// bounds of the node that is seen.

// Everything float32 does with numbers of a magnitude changes a length by less than this part of it: some 20 roundings
// of 2^-24 each, in every direction.
inline constexpr float doubt = 0x1p-19F;

/// A seen node in frame, unit and origin of the lanes it is compared with, enlarged by rounding errors.
struct Facing {
  alignas(16) float center[4];
  alignas(16) float half[4];  // along the axes of the lanes' frame
  alignas(16) float normal[4];
  float radius, low, high, rim_low, rim_high;
};

/// A direction in which lanes may be told apart from a seen node. A lane whose reach along it is at most `gap`,
/// measured from the lanes' origin, cannot improve the answer.
struct Toward {
  const float* normal;
  float gap;
  float cut;  // how far apart lanes and node must be for that, in units
};

/// Two leaves, expressed in the frame of a, origin at the centre of a, scaled so that all numbers are about 1 or less.
struct LeafPair {
  float step_a, step_b;  // length of one quantum
  float offset[4];       // from the centre of a to that of b
  float error;           // exceeds what rounding and quantisation can change any gap by
  float cut;             // pairs of triangles at least this far apart cannot improve the answer
  float gap;             // reach of a triangle of a towards b, minus that of one of b, that cannot improve the answer
  double scale;          // from lengths
};

/// A seen node's centre in the frame of the one who sees it, relative to `origin`, in lengths; the fourth is 0.
LIMBER_KERNEL void place(const Block& block, std::uint32_t lane, const View& view, const Vec3& origin,
                         double* between) {
  const double x = block.origin.x + view.other_unit * static_cast<double>(block.bounds.center_x[lane]);
  const double y = block.origin.y + view.other_unit * static_cast<double>(block.bounds.center_y[lane]);
  const double z = block.origin.z + view.other_unit * static_cast<double>(block.bounds.center_z[lane]);
  const double from[4] = {origin.x, origin.y, origin.z, 0};
  for (int j = 0; j < 4; ++j) {
    between[j] = view.from_other[0][j] * x + view.from_other[1][j] * y + view.from_other[2][j] * z +
                 view.from_other[3][j] - from[j];
  }
}

/// The matrix with these columns times (x, y, z).
LIMBER_KERNEL void turn(const float (&columns)[3][4], float x, float y, float z, float* out) {
  for (int j = 0; j < 4; ++j) out[j] = columns[0][j] * x + columns[1][j] * y + columns[2][j] * z;
}

LIMBER_KERNEL double dot3(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Radius of the circle in which a plane cuts a ball, that far from its centre; 0 where it does not.
LIMBER_KERNEL float rim(float radius, float height) {
  return std::sqrt(std::max(0.0F, radius * radius - height * height));
}

LIMBER_KERNEL Facing face(const Block& lanes, const Seen& seen, const View& view, const double* between) {
  const NodeBounds& n = seen.block->bounds;
  const std::uint32_t k = seen.lane;
  alignas(32) double center[4];
  for (int j = 0; j < 4; ++j) center[j] = between[j] * view.per_unit;
  const float radius = n.radius[k] * view.ratio;
  // Also where radius or error are infinite, or the product of 0 and infinity.
  const double size = static_cast<double>(radius) + static_cast<double>(view.error_units);
  if (!(std::abs(center[0]) + std::abs(center[1]) + std::abs(center[2]) + size < furthest)) {
    constexpr auto everywhere = static_cast<float>(4 * furthest);
    return {
        {0, 0, 0, 0}, {everywhere, everywhere, everywhere, 0}, {1, 0, 0, 0}, everywhere, -everywhere, everywhere, 0, 0};
  }
  Facing f;
  for (int j = 0; j < 4; ++j) f.center[j] = static_cast<float>(center[j]);
  turn(view.rotation, n.normal_x[k], n.normal_y[k], n.normal_z[k], f.normal);
  turn(view.rotation_abs, n.half_x[k], n.half_y[k], n.half_z[k], f.half);
  const float magnitude = std::abs(f.center[0]) + std::abs(f.center[1]) + std::abs(f.center[2]);
  const float error = (magnitude + lanes.reach + radius) * doubt + view.error_units;
  for (float& half : f.half) half = std::min(half * view.ratio, radius) + error;
  f.radius = radius + error;
  f.low = n.low[k] * view.ratio - error;
  f.high = n.high[k] * view.ratio + error;
  f.rim_low = rim(f.radius, f.low), f.rim_high = rim(f.radius, f.high);
  return f;
}

/// How far a seen node reaches from its centre towards the one who sees it, at least, in its own units.
LIMBER_KERNEL float reach_back(const Seen& seen, const float* out) {
  const NodeBounds& n = seen.block->bounds;
  const std::uint32_t k = seen.lane;
  const float radius = n.radius[k];
  if (seen.corners != nullptr) {
    const float step = radius * (1 / quantum);
    return leaf_support(*seen.corners, out) * step + 0.91F * step + radius * doubt;
  }
  const float x = n.normal_x[k], y = n.normal_y[k], z = n.normal_z[k];
  const float cosine = out[0] * x + out[1] * y + out[2] * z, cosine_abs = std::abs(cosine);
  const float height = cosine > 0 ? n.high[k] : -n.low[k];
  const float u = y * out[2] - z * out[1], v = z * out[0] - x * out[2], w = x * out[1] - y * out[0];
  const float sine = std::sqrt(u * u + v * v + w * w);
  const float ball = radius * cosine_abs > height ? height * cosine_abs + rim(radius, height) * sine : radius;
  const float box = std::abs(out[0]) * n.half_x[k] + std::abs(out[1]) * n.half_y[k] + std::abs(out[2]) * n.half_z[k];
  return std::min(ball, box) + radius * doubt;
}

/// What view.toward says about lanes and a seen node. Pre: there is one.
LIMBER_KERNEL Toward look(const Block& lanes, const Seen& seen, const View& view, const double* between) {
  const double reach = static_cast<double>(reach_back(seen, view.other_normal)) * view.other_unit;
  const double gap = dot3(view.toward, between) - reach - view.cut - view.error;
  return {view.normal, core::float_down(std::clamp(gap * view.per_unit, -furthest, furthest)) - lanes.reach * doubt,
          core::float_up(std::min(view.cut * view.per_unit, furthest))};
}

/// The power of two that brings a size to 1 or more, but below 2. Pre: 2^-1000 < size < 2^1000.
LIMBER_KERNEL double scale_to_one(double size) {
  return std::bit_cast<double>((std::uint64_t{2046} - (std::bit_cast<std::uint64_t>(size) >> 52)) << 52);
}

LIMBER_KERNEL LeafPair place_leaves(const Seen& a, const Seen& b, const View& view) {
  const NodeBounds &na = a.block->bounds, &nb = b.block->bounds;
  const Vec3 center_a =
      a.block->origin + view.unit * Vec3{na.center_x[a.lane], na.center_y[a.lane], na.center_z[a.lane]};
  alignas(32) double offset[4];
  place(*b.block, b.lane, view, center_a, offset);
  const double radius_a = view.unit * static_cast<double>(na.radius[a.lane]);
  const double radius_b = view.other_unit * static_cast<double>(nb.radius[b.lane]);
  const double size =
      std::abs(offset[0]) + std::abs(offset[1]) + std::abs(offset[2]) + radius_a + radius_b + view.error;
  LeafPair p;
  const double scale = scale_to_one(std::clamp(size, 0x1p-900, 0x1p900));
  p.scale = scale;
  const double step_a = radius_a * scale / static_cast<double>(quantum);
  const double step_b = radius_b * scale / static_cast<double>(quantum);
  p.step_a = static_cast<float>(step_a), p.step_b = static_cast<float>(step_b);
  for (int j = 0; j < 4; ++j) p.offset[j] = static_cast<float>(offset[j] * scale);
  const double steps = 0.91 * (step_a + step_b);  // sqrt(3) * 0.52 of a step, each
  p.error = core::float_up(steps + view.error * scale) + 0x1p-17F;
  p.cut = core::float_up(std::min(view.cut * scale, furthest));
  p.gap = 0;
  if (view.has_toward) {
    const double rounding = (radius_a + radius_b) * static_cast<double>(doubt);
    const double gap = (dot3(view.toward, offset) - view.cut - view.error - rounding) * scale - steps;
    p.gap = core::float_down(std::clamp(gap, -furthest, furthest));
  }
  return p;
}
