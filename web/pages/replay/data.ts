// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** What apps/limber/track_report.cpp writes. */

import type { QuantizedPoints } from '../shared/decode.ts';
import type { FramesData } from '../shared/frames.ts';

export interface ModelData {
  name: string;
  triangles: number;
  vertices: number;
  corners: string;
  /** Of a mesh that does not deform. */
  positions?: QuantizedPoints;
  /** Of one that does. */
  frames?: FramesData;
  poses: string;
}

export interface Rows {
  lower: (number | null)[];
  upper: (number | null)[];
  status: string[];
  update_us: number[];
  query_us: number[];
  moved_vertices: number[];
  /** Both points and the triangles that they lie on. */
  witness: (number[] | null)[];
}

export interface ContactRows {
  name: 'contact' | 'self_a' | 'self_b';
  query_us: number[];
  count: number[];
  intersecting: number[];
}

export interface ReplayData {
  engine: string;
  relative_error: number;
  absolute_error: number;
  max_distance: number | null;
  frame_count: number;
  stride: number;
  max_megabytes: number;
  rows: Rows;
  contacts: ContactRows[];
  models: [ModelData, ModelData];
  version: string;
  command: string;
}
