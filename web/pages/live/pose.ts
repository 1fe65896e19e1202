// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Where the body stands, in float64. */

import { cross, dot } from '../shared/vectors.ts';
import type { Vec3 } from '../shared/vectors.ts';

/** As limber3d takes it: x, y, z, w of a quaternion of length 1. */
export interface BodyPose {
  translation: Vec3;
  quaternion: readonly [number, number, number, number];
}

/** Turned by an angle about an axis of the world, of length 1, through the body's origin. */
export function turned({ translation, quaternion: q }: BodyPose, axis: Vec3, angle: number): BodyPose {
  const s = Math.sin(angle / 2);
  const p = [axis[0] * s, axis[1] * s, axis[2] * s, Math.cos(angle / 2)];
  const product: [number, number, number, number] = [
    p[3] * q[0] + p[0] * q[3] + p[1] * q[2] - p[2] * q[1],
    p[3] * q[1] + p[1] * q[3] + p[2] * q[0] - p[0] * q[2],
    p[3] * q[2] + p[2] * q[3] + p[0] * q[1] - p[1] * q[0],
    p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2],
  ];
  const size = Math.hypot(...product);
  return { translation, quaternion: product.map((c) => c / size) as typeof product };
}

/** The columns of the rotation. */
export function columnsOf({ quaternion: [x, y, z, w] }: BodyPose): readonly [Vec3, Vec3, Vec3] {
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
    [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
    [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
  ];
}

/** A point of the world in the body's frame. */
export function inBody(pose: BodyPose, p: Vec3): Vec3 {
  const off: Vec3 = [p[0] - pose.translation[0], p[1] - pose.translation[1], p[2] - pose.translation[2]];
  return directionInBody(pose, off);
}

export function directionInBody(pose: BodyPose, v: Vec3): Vec3 {
  return columnsOf(pose).map((column) => dot(column, v)) as unknown as Vec3;
}

/** How far along a ray its first triangle is, and which that is; nothing if it misses. */
export function firstHit(
  vertices: ArrayLike<number>,
  faces: ArrayLike<number>,
  from: Vec3,
  along: Vec3,
): { far: number; triangle: number } | undefined {
  let best: { far: number; triangle: number } | undefined;
  const point = (i: number): Vec3 => [vertices[3 * i], vertices[3 * i + 1], vertices[3 * i + 2]];
  for (let t = 0; 3 * t < faces.length; ++t) {
    const a = point(faces[3 * t]);
    const b = point(faces[3 * t + 1]);
    const c = point(faces[3 * t + 2]);
    const u: Vec3 = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
    const v: Vec3 = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
    const p = cross(along, v);
    const det = dot(u, p);
    if (det === 0) continue;
    const w: Vec3 = [from[0] - a[0], from[1] - a[1], from[2] - a[2]];
    const s = dot(w, p) / det;
    if (!(s >= 0 && s <= 1)) continue;
    const q = cross(w, u);
    const r = dot(along, q) / det;
    if (!(r >= 0 && s + r <= 1)) continue;
    const far = dot(v, q) / det;
    if (best === undefined || far < best.far) best = { far, triangle: t };
  }
  return best;
}
