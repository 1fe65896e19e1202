// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The body over the sheet: the hare, or a mesh from a file. */

import { Box3, Quaternion, Vector3 } from 'three';
import { readMeshBytes } from '../../limber3d/index.js';
import { upY, upZ, usualUp } from '../shared/viewer.ts';
import { hareMesh } from './hare.ts';
import type { TriangleMesh } from './hare.ts';

/** As limber3d takes it; the quaternion has length 1. */
export interface BodyPose {
  translation: Vector3;
  quaternion: Quaternion;
}

export interface Body {
  name: string;
  mesh: TriangleMesh;
  /** How it stands at first. */
  start: BodyPose;
}

const size = 1.05; // the diagonal of the body's box
const height = 0.24; // of its lowest point above the sheet
const mostBytes = 400e6;

export const hareBody = (): Body => placed('Hare', hareMesh(), new Quaternion().setFromAxisAngle(upY, -0.7));

/** Reads OBJ, PLY, STL, OFF or glTF. Throws an error with one line that says what is wrong. */
export async function bodyOf(file: File): Promise<Body> {
  if (file.size > mostBytes) throw new Error(`${file.name}: is larger than ${mostBytes / 1e6} MB`);
  const { vertices, faces } = readMeshBytes(await file.arrayBuffer(), file.name);
  const upright = new Quaternion().setFromUnitVectors(usualUp([file.name]), upY);
  return placed(file.name, { vertices, faces }, upright);
}

/** Of the usual size, its middle at the origin of its frame. */
function placed(name: string, mesh: TriangleMesh, quaternion: Quaternion): Body {
  const box = new Box3();
  const p = new Vector3();
  for (const vertex of mesh.faces) box.expandByPoint(p.fromArray(mesh.vertices, 3 * vertex));
  const [center, extent] = [box.getCenter(new Vector3()).toArray(), box.getSize(new Vector3())];
  const scale = size / Math.hypot(...extent);
  if (!(scale > 0 && scale < Infinity)) throw new Error(`${name}: has no size that can be shown`);
  const vertices = mesh.vertices.map((c, i) => (c - center[i % 3]) * scale);
  const isZUp = upZ.clone().applyQuaternion(quaternion).y > 0.9;
  const below = (scale * (isZUp ? extent.z : extent.y)) / 2;
  return {
    name,
    mesh: { vertices, faces: mesh.faces },
    start: { translation: new Vector3(0, height + below, 0), quaternion },
  };
}
