// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** What clients/program/reports writes: answers about pairs of models, row by row, and the models. */

import { byId } from '../shared/dom.ts';
import type { FramesData, QuantizedPoints } from '../shared/decode.ts';

export type Clash =
  'hard_clash' | 'cannot_tell' | 'surfaces_meet' | 'touching' | 'clearance' | 'clear' | 'surfaces_apart';
type Nesting = 'a_inside_b' | 'b_inside_a';
type Point = [number, number, number];

export interface ModelData {
  name: string;
  triangles: number;
  vertices: number;
  corners: string;
  /** Of a mesh that does not deform. */
  positions?: QuantizedPoints;
  /** Of one that does. */
  frames?: FramesData;
  faces?: number;
  closed?: boolean;
  /** Of the box in the model's own frame. */
  low?: Point;
  high?: Point;
}

/** Lists with an entry for each answer. */
interface Rows {
  /** Numbers of parts. */
  a: number[];
  b: number[];
  /** Their numbers in the table that the program has written. */
  row: number[];
  status: ('exact' | 'within_error' | 'collision' | 'beyond_limit')[];
  lower: (number | null)[];
  upper: (number | null)[];
  /** Both points; triangles and faces that they lie on. Null also where a frame has been left out. */
  witness: (number[] | null)[];
  /** Null where no clearance is required, or the meshes cannot tell. */
  too_close: (boolean | null)[];
  /** No shorter translation takes one out of the other. */
  depth: (number | null)[];
  query_us: number[];
  // The following are those of pairs.
  clash?: Clash[];
  solids?: ('apart' | 'touching' | 'overlapping' | 'equal' | Nesting | null)[];
  inside?: (Nesting | null)[];
  /** The line of the file of accepted pairs. */
  accepted?: (number | null)[];
  /** Ids of triangles of both that intersect the other. */
  intersecting?: ([string, string] | null)[];
  // The following are those of frames.
  update_us?: number[];
  moved_vertices?: number[];
}

export interface Data {
  version: string;
  made_at: string;
  command: string;
  title: string;
  unit: string;
  /** One pair; pairs of a list; pairs of parts that stand together; two models frame by frame. */
  kind: 'pair' | 'pairs' | 'parts' | 'frames';
  min_clearance: number | null;
  max_distance: number | null;
  relative_error: number;
  absolute_error: number;
  tolerance: number;
  mesh_error: number; // of each mesh
  models: ModelData[];
  /** What stands somewhere: lists of names, of files as typed, of numbers of models, and of poses. */
  parts: { name: string[]; file: string[]; model: number[]; poses: string[] };
  rows: Rows;
  worst_first: number[];
  /** How many rows are of each kind and not accepted, also where the page does not have them all. */
  counts: Partial<Record<Clash, number>>;
  accepted: number;
  /** Without those that are accepted. */
  too_close: number;
  /** What only the page of one pair has. */
  pair?: {
    build_us: number;
    node_tests: number;
    primitive_tests: number;
    intersections: number;
  };
  /** Of frames; rows are more where a sequence is played again. Every `stride`-th is kept. */
  frame_count: number;
  stride: number;
  max_megabytes: number;
  engine: string;
  contacts: { name: string; query_us: number[]; count: number[]; intersecting: number[] }[];
  /** What only `limber demo` has. */
  demo?: {
    introduction: string;
    /** Names and texts, as on the terminal. */
    summary: [string, string][];
    /** The second query of each frame. */
    rough: { relative_error: number; lower: number[]; upper: number[]; query_us: number[] };
  };
}

/** The data of the page, completed where its kind leaves something out. */
export function readData(): Data {
  const written = JSON.parse(byId('data').textContent ?? 'null');
  const expected = document.querySelector<HTMLMetaElement>('meta[name="limber-data"]')!.content;
  if (String(written.format) !== expected) throw new Error(`data of format ${written.format}, not ${expected}`);
  const none = { title: '', unit: '', tolerance: 0, mesh_error: 0, counts: {}, accepted: 0 };
  const data: Data = { ...none, frame_count: 1, stride: 1, contacts: [], ...written };
  if (data.kind !== 'frames') return data;
  const { status, too_close } = data.rows;
  Object.assign(data.rows, { a: status.map(() => 0), b: status.map(() => 1), row: status.map((_, row) => row) });
  data.too_close = too_close.filter((is) => is).length;
  data.worst_first = worstFirst(data);
  return data;
}

export const meetsIn = ({ rows }: Pick<Data, 'rows'>, row: number): boolean => rows.status[row] === 'collision';

/** The numbers of frames, the worst first: the deepest, then those where the models touch, then the nearest. */
export function worstFirst(data: Data): number[] {
  const { lower, upper, depth } = data.rows;
  const keys = upper.map((most, row) => [
    -(depth[row] ?? 0),
    meetsIn(data, row) ? 0 : (most ?? Infinity),
    lower[row] ?? Infinity,
  ]);
  const order = keys.map((_, row) => row);
  const compared = (r: number, s: number, key: number): number =>
    keys[r][key] === keys[s][key] ? 0 : keys[r][key] - keys[s][key];
  return order.sort((r, s) => compared(r, s, 0) || compared(r, s, 1) || compared(r, s, 2) || r - s);
}

/** How many rows there are: more than the page has, where they are too many for it. */
export const totalOf = ({ kind, counts, accepted, rows }: Data): number =>
  kind === 'frames' ? rows.status.length : Object.values(counts).reduce((sum, number) => sum + number, accepted);

/** Whether all rows are about the same two models, so that pages may call them A and B. */
export function isOfOnePair({ kind, parts: { model }, rows }: Data): boolean {
  const isSame = (side: number[]): boolean => side.every((part) => model[part] === model[side[0]]);
  return kind !== 'parts' && rows.a.length > 0 && isSame(rows.a) && isSame(rows.b);
}
