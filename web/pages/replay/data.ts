// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** What apps/limber/verbs/replay.cpp writes, and demo_page.cpp for `limber demo`. */

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
  /** Both points and the triangles that they lie on; null also where the frame has been left out. */
  witness: (number[] | null)[];
}

export interface ContactRows {
  name: 'contact' | 'self_a' | 'self_b';
  query_us: number[];
  count: number[];
  intersecting: number[];
}

/** What only `limber demo` has. */
export interface DemoData {
  introduction: string;
  /** Names and texts, as on the terminal. */
  summary: [string, string][];
  /** The second query of each frame. */
  rough: { relative_error: number; lower: number[]; upper: number[]; query_us: number[] };
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
  demo?: DemoData;
  version: string;
  command: string;
}
