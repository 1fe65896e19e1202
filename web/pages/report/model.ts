// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** A model of the report, decoded. */

import { cornersOf, countsOf, increasingIdsOf, numbersOf, pointsOf } from '../shared/decode.ts';
import type { Mesh } from '../shared/section.ts';
import { length, subtract } from '../shared/vectors.ts';
import type { Frame } from '../shared/viewer.ts';
import type { ModelData } from './data.ts';

export interface ReportModel {
  data: ModelData;
  mesh: Mesh;
  /** To the other model, by vertex. */
  distances: Float32Array;
  nearest: number;
  farthest: number;
  /** Triangles of the mesh that intersect the other model. */
  marked: number[];
  diagonal: number;
}

export function decodedModel(data: ModelData, frame: Frame): ReportModel {
  const distances = numbersOf(data.distances);
  return {
    data,
    mesh: { points: pointsOf(data.positions, frame.center, frame.size), corners: cornersOf(data.corners) },
    distances: Float32Array.from(distances),
    nearest: distances.reduce((a, b) => Math.min(a, b), Infinity),
    farthest: distances.reduce((a, b) => Math.max(a, b), 0),
    marked: shownTriangles(increasingIdsOf(data.intersecting), data.parts),
    diagonal: length(subtract(data.high, data.low)),
  };
}

/** Where triangles of the file have been divided: their parts. */
function shownTriangles(ids: number[], parts: string | undefined): number[] {
  if (parts === undefined) return ids;
  const ends: number[] = [];
  countsOf(parts).reduce((end, count) => (ends[ends.length] = end + count), 0);
  return ids.flatMap((id) => {
    const first = id === 0 ? 0 : ends[id - 1];
    return Array.from({ length: ends[id] - first }, (_, i) => first + i);
  });
}
