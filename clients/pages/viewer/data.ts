// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/**
 * What clients/program/reports and verbs/replay.cpp write: answers about pairs of models, row by row, and the models.
 * Names with _ are keys of what is written. readData() completes it, where one kind of data lacks what others have.
 */

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
  positions?: QuantizedPoints; // of a mesh that does not deform
  frames?: FramesData; // of one that does
  faces?: number;
  closed?: boolean;
  low?: Point; // of the box in the model's own frame
  high?: Point;
}

/** Columns that pairs alone have. */
interface PairColumns {
  clash: Clash[];
  solids: ('apart' | 'touching' | 'overlapping' | 'equal' | Nesting | null)[];
  inside: (Nesting | null)[];
  accepted: (number | null)[]; // the line of the file of accepted pairs
  intersecting: ([string, string] | null)[]; // ids of the triangles of A that intersect B, and of B that intersect A
}

/** Columns that frames alone have. */
type FrameColumns = { update_us: number[]; moved_vertices: number[] };

/** Columns: lists with an entry for each answer. */
interface Rows extends Partial<PairColumns>, Partial<FrameColumns> {
  a: number[]; // numbers of parts
  b: number[];
  row: number[]; // its number in the table that the program has written
  status: ('exact' | 'within_error' | 'collision' | 'beyond_limit')[];
  lower: (number | null)[];
  upper: (number | null)[];
  /** Both points; triangles and faces that they lie on. Null also where a frame has been left out. */
  witness: (number[] | null)[];
  too_close: (boolean | null)[]; // null where no clearance is required, or the meshes cannot tell
  depth: (number | null)[]; // a length: no shorter translation takes one model out of the other
  query_us: number[];
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
  /** How many rows are too close and not accepted, while `rows.too_close` says of each whether it is too close. */
  too_close: number;
  /** What only the page of one pair has. */
  pair?: { build_us: number; node_tests: number; primitive_tests: number; intersections: number };
  frame_count: number; // rows are more where a sequence is played again
  stride: number; // of every `stride` frames the page can show the first
  contacts: { name: string; query_us: number[]; count: number[]; intersecting: number[] }[];
  max_megabytes?: number; // of frames: the limit because of which some are left out
  engine?: string; // of frames: what has answered
  /** What only `limber demo` has. */
  demo?: {
    introduction: string;
    summary: [string, string][]; // names and texts, as on the terminal
    /** The second query of each frame. */
    rough: { relative_error: number; lower: number[]; upper: number[]; query_us: number[] };
  };
}

/** What is missing in data of frames: nothing is tolerated or accepted, and totalOf() counts rows, not kinds. */
const missingOfFrames = { tolerance: 0, mesh_error: 0, counts: {}, accepted: 0 };
/** What is missing in data of pairs. */
const missingOfPairs = { frame_count: 1, stride: 1, contacts: [] };

/** The data of the page. Of frames it also makes `worst_first`, `too_close`, and the columns a, b and row. */
export function readData(): Data {
  const written = JSON.parse(byId('data').textContent!) as Partial<Data> & { format: number };
  const expected = document.querySelector<HTMLMetaElement>('meta[name="limber-data"]')!.content;
  if (String(written.format) !== expected) throw new Error(`data of format ${written.format}, not ${expected}`);
  const data = { ...missingOfFrames, ...missingOfPairs, ...written } as Data;
  if (data.kind !== 'frames') return data;
  const { status, too_close } = data.rows;
  Object.assign(data.rows, { a: status.map(() => 0), b: status.map(() => 1), row: status.map((_, row) => row) });
  data.too_close = too_close.filter(Boolean).length;
  data.worst_first = worstFirst(data);
  return data;
}

/** Whether the models of a row have a point in common. */
export const meetsIn = ({ rows }: Pick<Data, 'rows'>, row: number): boolean => rows.status[row] === 'collision';

/** The numbers of the stretches of `length` frames, counted from the first frame, in which the models ever meet. */
export const stretchesThatMeet = ({ rows, frame_count }: Pick<Data, 'rows' | 'frame_count'>, length: number) =>
  new Set(rows.status.flatMap((_, row) => (meetsIn({ rows }, row) ? Math.floor((row % frame_count) / length) : [])));

/** The numbers of frames, the worst first: the deepest, then those where the models touch, then the nearest. */
export function worstFirst(data: Data): number[] {
  const { lower, upper, depth } = data.rows;
  const keys = upper.map((most, row) => {
    const nearness = meetsIn(data, row) ? 0 : (most ?? Infinity);
    return [-(depth[row] ?? 0), nearness, lower[row] ?? Infinity, row];
  });
  const compared = (r: number[], s: number[]): number => {
    const differing = r.findIndex((number, k) => number !== s[k]); // the rows do
    return r[differing] - s[differing];
  };
  return keys.sort(compared).map(([, , , row]) => row);
}

/** How many rows there are: more than the page has, where they are too many for it. */
export const totalOf = ({ kind, counts, accepted, rows }: Data): number =>
  kind === 'frames' ? rows.status.length : Object.values(counts).reduce((sum, number) => sum + number, accepted);

/** Whether all rows are about the same two models, so that pages may call them A and B. */
export function isOfOnePair({ kind, parts: { model }, rows }: Data): boolean {
  const isSame = (side: number[]): boolean => side.every((part) => model[part] === model[side[0]]);
  return kind !== 'parts' && rows.a.length > 0 && isSame(rows.a) && isSame(rows.b);
}
