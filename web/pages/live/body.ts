// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The body over the sheet: the hare, or a mesh from a file. */

import { readMeshBytes } from '../../limber3d/index.js';
import { length } from '../shared/vectors.ts';
import type { Vec3 } from '../shared/vectors.ts';
import { usualUp } from '../shared/viewer.ts';
import { hareMesh } from './hare.ts';
import type { TriangleMesh } from './hare.ts';
import type { BodyPose } from './pose.ts';

export interface Body {
  name: string;
  mesh: TriangleMesh;
  /** What the file's lengths were multiplied by. */
  scale: number;
  /** How it stands at first. */
  start: BodyPose;
}

const size = 1.05; // the diagonal of the body's box
const height = 0.24; // of its lowest point above the sheet
const upright: BodyPose['quaternion'] = [0, Math.sin(-0.35), 0, Math.cos(-0.35)];
const zUp: BodyPose['quaternion'] = [-Math.SQRT1_2, 0, 0, Math.SQRT1_2]; // turns z up
const mostBytes = 400e6;

export const hareBody = (): Body => placed('Hare', hareMesh(), upright);

/** Reads OBJ, PLY, STL, OFF or glTF. Throws an error with one line that says what is wrong. */
export async function bodyOf(file: File): Promise<Body> {
  if (file.size > mostBytes) throw new Error(`${file.name}: is larger than ${mostBytes / 1e6} MB`);
  const { vertices, faces } = readMeshBytes(await file.arrayBuffer(), file.name);
  return placed(file.name, { vertices, faces }, usualUp([file.name]) === 'y' ? [0, 0, 0, 1] : zUp);
}

/** Of the usual size, its middle at the origin of its frame. */
function placed(name: string, mesh: TriangleMesh, quaternion: BodyPose['quaternion']): Body {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const vertex of mesh.faces) {
    for (let axis = 0; axis < 3; ++axis) {
      low[axis] = Math.min(low[axis], mesh.vertices[3 * vertex + axis]);
      high[axis] = Math.max(high[axis], mesh.vertices[3 * vertex + axis]);
    }
  }
  const extent = low.map((l, axis) => high[axis] - l) as unknown as Vec3;
  const scale = size / length(extent);
  if (!(scale > 0 && scale < Infinity)) throw new Error(`${name}: has no size that can be shown`);
  const vertices = mesh.vertices.map((c, i) => (c - (low[i % 3] + high[i % 3]) / 2) * scale);
  const below = (scale * (quaternion === zUp ? extent[2] : extent[1])) / 2;
  return {
    name,
    mesh: { vertices, faces: mesh.faces },
    scale,
    start: { translation: [0, height + below, 0], quaternion },
  };
}
