// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** What apps/limber/reports/distance_report.cpp writes. */

import type { Quantized, QuantizedPoints } from '../shared/decode.ts';

export type Point = [number, number, number];

export interface Witness {
  point_a: Point;
  point_b: Point;
  triangle_a: number;
  triangle_b: number;
  face_a: number;
  face_b: number;
}

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

export interface ReportData {
  status: 'exact' | 'within_error' | 'collision' | 'beyond_limit';
  lower: number;
  upper: number | null;
  witness: Witness | null;
  too_close: boolean | null;
  inside: 'a_in_b' | 'b_in_a' | null;
  build_us: number;
  query_us: number;
  node_tests: number;
  triangle_tests: number;
  min_clearance: number | null;
  max_distance: number | null;
  relative_error: number;
  absolute_error: number;
  intersections: number;
  contact_normal: Point | null;
  witness_corners: [Point[], Point[]] | null;
  models: [ModelData, ModelData];
  version: string;
  command: string;
}
