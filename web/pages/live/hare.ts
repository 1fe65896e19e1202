// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** A hare, modelled as ellipsoids and rods that are blended, and meshed by surface nets. */

type Vec3 = readonly [number, number, number];

export interface TriangleMesh {
  vertices: Float64Array;
  faces: Uint32Array;
}

interface Ellipsoid {
  center: Vec3;
  radii: Vec3;
}

/** With round ends of different radii. */
interface Rod {
  a: Vec3;
  b: Vec3;
  radiusA: number;
  radiusB: number;
}

/** Each part, and how far its joint with the parts before it is rounded. Left and right are alike. */
const parts: readonly { ellipsoid?: Ellipsoid; rod?: Rod; joint: number }[] = [
  { ellipsoid: { center: [0, 0.34, -0.08], radii: [0.235, 0.27, 0.36] }, joint: 0.1 },
  { ellipsoid: { center: [0, 0.44, 0.2], radii: [0.17, 0.22, 0.18] }, joint: 0.12 },
  { ellipsoid: { center: [0, 0.74, 0.27], radii: [0.145, 0.15, 0.19] }, joint: 0.1 },
  { ellipsoid: { center: [0.03, 0.69, 0.42], radii: [0.075, 0.065, 0.07] }, joint: 0.06 }, // cheeks
  { rod: { a: [0.055, 0.84, 0.2], b: [0.12, 1.27, 0.04], radiusA: 0.042, radiusB: 0.048 }, joint: 0.05 }, // ears
  { rod: { a: [0.075, 1, 0.145], b: [0.105, 1.16, 0.085], radiusA: 0.062, radiusB: 0.062 }, joint: 0.04 },
  { ellipsoid: { center: [0, 0.3, -0.47], radii: [0.085, 0.085, 0.08] }, joint: 0.03 }, // tail
  { ellipsoid: { center: [0.2, 0.22, -0.12], radii: [0.11, 0.2, 0.22] }, joint: 0.06 }, // legs
  { rod: { a: [0.22, 0.055, -0.22], b: [0.22, 0.05, 0.14], radiusA: 0.06, radiusB: 0.052 }, joint: 0.05 },
  { rod: { a: [0.1, 0.36, 0.29], b: [0.11, 0.05, 0.36], radiusA: 0.065, radiusB: 0.05 }, joint: 0.05 },
];

// The loops below run half a million times while the page waits: they allocate nothing.

/** Negative inside; elsewhere about the distance. */
function ofEllipsoid({ center, radii }: Ellipsoid, x: number, y: number, z: number): number {
  const u = (x - center[0]) / radii[0];
  const v = (y - center[1]) / radii[1];
  const w = (z - center[2]) / radii[2];
  const scaled = Math.sqrt(u * u + v * v + w * w);
  const steepness = Math.sqrt((u / radii[0]) ** 2 + (v / radii[1]) ** 2 + (w / radii[2]) ** 2);
  return steepness > 0 ? (scaled * (scaled - 1)) / steepness : -radii[0];
}

function ofRod({ a, b, radiusA, radiusB }: Rod, x: number, y: number, z: number): number {
  const ux = b[0] - a[0];
  const uy = b[1] - a[1];
  const uz = b[2] - a[2];
  const vx = x - a[0];
  const vy = y - a[1];
  const vz = z - a[2];
  const along = (ux * vx + uy * vy + uz * vz) / (ux * ux + uy * uy + uz * uz);
  const t = along < 0 ? 0 : along > 1 ? 1 : along;
  return Math.sqrt((vx - t * ux) ** 2 + (vy - t * uy) ** 2 + (vz - t * uz) ** 2) - (radiusA + t * (radiusB - radiusA));
}

function hare(x: number, y: number, z: number): number {
  let d = 1e9;
  for (let i = 0; i < parts.length; ++i) {
    const { ellipsoid, rod, joint } = parts[i];
    const other = ellipsoid !== undefined ? ofEllipsoid(ellipsoid, Math.abs(x), y, z) : ofRod(rod!, Math.abs(x), y, z);
    const near = Math.max(joint - Math.abs(d - other), 0);
    d = Math.min(d, other) - (near * near) / (4 * joint);
  }
  return d;
}

const spacing = 0.0185;
const low: Vec3 = [-0.42, -0.04, -0.6];
const [nx, ny, nz] = [49, 77, 65]; // grid points
const steps: Vec3 = [1, nx, nx * ny]; // from a grid point to the next along x, y, z
const corners = Array.from({ length: 8 }, (_, corner) =>
  steps.reduce((sum, step, axis) => sum + ((corner >> axis) & 1) * step, 0),
);

export function hareMesh(): TriangleMesh {
  const values = gridValues();
  const vertexOf = new Int32Array(values.length).fill(-1); // of the cell whose lowest corner is that grid point
  const vertices: number[] = [];
  for (let k = 0; k < nz - 1; ++k) {
    for (let j = 0; j < ny - 1; ++j) {
      for (let h = 0; h < nx - 1; ++h) {
        const cell = h + j * nx + k * nx * ny;
        let insideCount = 0;
        for (const corner of corners) insideCount += values[cell + corner] < 0 ? 1 : 0;
        if (insideCount === 0 || insideCount === 8) continue;
        vertexOf[cell] = vertices.length / 3;
        vertices.push(
          ...onSurface([h, j, k].map((i, axis) => low[axis] + (i + 0.5) * spacing) as [number, number, number]),
        );
      }
    }
  }
  return { vertices: Float64Array.from(vertices), faces: Uint32Array.from(facesAround(values, vertexOf)) };
}

/** The field at the points of the grid. */
function gridValues(): Float32Array {
  const values = new Float32Array(nx * ny * nz);
  for (let i = 0; i < values.length; ++i) {
    const [h, j, k] = [i % nx, Math.floor(i / nx) % ny, Math.floor(i / (nx * ny))];
    values[i] = hare(low[0] + h * spacing, low[1] + j * spacing, low[2] + k * spacing);
  }
  return values;
}

/** Goes down the slope to the surface. */
function onSurface(p: [number, number, number]): Vec3 {
  const by = 1e-4;
  for (let round = 0; round < 3; ++round) {
    const [x, y, z] = p;
    const d = hare(x, y, z);
    const slope = [hare(x + by, y, z) - d, hare(x, y + by, z) - d, hare(x, y, z + by) - d];
    const steepness = (slope[0] ** 2 + slope[1] ** 2 + slope[2] ** 2) / by;
    for (let axis = 0; axis < 3; ++axis) p[axis] -= (d * slope[axis]) / Math.max(steepness, 0.1 * by);
  }
  return p;
}

/** Two triangles for each edge of the grid that the surface crosses, between the vertices of the four cells around. */
function facesAround(values: Float32Array, vertexOf: Int32Array): number[] {
  const faces: number[] = [];
  for (let i = 0; i < values.length; ++i) {
    for (let axis = 0; axis < 3; ++axis) {
      const end = i + steps[axis];
      if (end >= values.length || values[i] < 0 === values[end] < 0) continue;
      const [u, v] = [steps[(axis + 1) % 3], steps[(axis + 2) % 3]];
      const [a, b, c, d] = [i, i - u, i - u - v, i - v].map((cell) => vertexOf[cell]);
      if (values[i] < 0) faces.push(a, b, c, a, c, d);
      else faces.push(a, c, b, a, d, c);
    }
  }
  return faces;
}
