// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** A moment as files that other programs read, and the command that asks the native engine for the same distance. */

import type { TriangleMesh } from './hare.ts';
import type { BodyPose } from './pose.ts';

/** Binary PLY with coordinates of float64: no digit is lost. */
export function plyOf({ vertices, faces }: TriangleMesh): Blob {
  const header = [
    'ply',
    'format binary_little_endian 1.0',
    `element vertex ${vertices.length / 3}`,
    ...['x', 'y', 'z'].map((axis) => `property double ${axis}`),
    `element face ${faces.length / 3}`,
    'property list uchar uint vertex_indices',
    'end_header\n',
  ].join('\n');
  const points = new DataView(new ArrayBuffer(8 * vertices.length));
  vertices.forEach((c, i) => points.setFloat64(8 * i, c, true));
  const corners = new DataView(new ArrayBuffer((13 * faces.length) / 3));
  faces.forEach((vertex, i) => {
    const face = 13 * Math.floor(i / 3);
    corners.setUint8(face, 3);
    corners.setUint32(face + 1 + 4 * (i % 3), vertex, true);
  });
  return new Blob([header, points, corners], { type: 'application/octet-stream' });
}

export function commandFor({ translation, quaternion: [x, y, z, w] }: BodyPose, relativeError: number): string {
  const error = relativeError > 0 ? ` --relative-error ${relativeError}` : '';
  return `limber distance sheet.ply body.ply --pose-b=${[...translation, w, x, y, z].join(',')}${error}`;
}
