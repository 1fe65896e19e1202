// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** What clients/program/reports/distance_report.cpp writes, and a model of it, decoded. */

import { Box3, Vector3 } from 'three';
import { cornersOf, increasingIdsOf, numbersOf, pointsOf } from '../shared/decode.ts';
import type { Quantized, QuantizedPoints } from '../shared/decode.ts';
import type { Mesh } from '../shared/surface.ts';
import { framed } from '../shared/viewer.ts';
import type { Frame } from '../shared/viewer.ts';
import type { Clash, Inside, Solids, Tolerances } from '../viewer/clashes.ts';

export type Point = [number, number, number];

export interface ModelData {
  name: string;
  triangles: number;
  vertices: number;
  faces: number;
  closed: boolean;
  low: Point;
  high: Point;
  positions: QuantizedPoints;
  corners: string;
  distances: Quantized;
  intersecting: string;
  parts?: string;
}

export interface ReportData extends Tolerances {
  status: 'exact' | 'within_error' | 'collision' | 'beyond_limit';
  lower: number;
  upper: number | null;
  witness: {
    point_a: Point;
    point_b: Point;
    triangle_a: number;
    triangle_b: number;
    face_a: number;
    face_b: number;
  } | null;
  too_close: boolean | null;
  inside: Inside;
  clash: Clash;
  solids: Solids;
  /** No shorter translation takes one out of the other; of closed models that overlap. */
  depth: number | null;
  build_us: number;
  query_us: number;
  node_tests: number;
  primitive_tests: number;
  min_clearance: number | null;
  max_distance: number | null;
  relative_error: number;
  absolute_error: number;
  intersections: number;
  contact_normal: Point | null;
  witness_corners: [Point[], Point[]] | null;
  models: [ModelData, ModelData];
}

export const boxOf = ({ low, high }: ModelData): Box3 => new Box3(new Vector3(...low), new Vector3(...high));

/** The closest points, or a point that is shared, twice, in the frame. */
export function witnessOf({ witness }: ReportData, frame: Frame): readonly [Vector3, Vector3] | undefined {
  if (witness === null) return undefined;
  return [framed(frame, new Vector3(...witness.point_a)), framed(frame, new Vector3(...witness.point_b))];
}

const smallestRadius = 2e-4;

/** The closest points, or a shared point, and how much around them is worth a look; the whole without them. */
export function closeUp(data: ReportData, frame: Frame): { center: Vector3; radius: number } {
  const witness = witnessOf(data, frame);
  if (witness === undefined) return { center: new Vector3(), radius: 0.5 };
  const [a, b] = witness;
  const near = Math.max(smallestRadius, Math.min(0.6, 2.5 * a.distanceTo(b)));
  return { center: a.clone().lerp(b, 0.5), radius: data.status === 'collision' ? 0.1 : near };
}

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
    diagonal: Math.hypot(...boxOf(data).getSize(new Vector3())),
  };
}

/** Where triangles of the file have been divided: their parts. */
function shownTriangles(ids: number[], parts: string | undefined): number[] {
  if (parts === undefined) return ids;
  const ends = increasingIdsOf(parts);
  return ids.flatMap((id) => {
    const first = id === 0 ? 0 : ends[id - 1];
    return Array.from({ length: ends[id] - first }, (_, i) => first + i);
  });
}
