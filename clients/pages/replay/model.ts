// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/**
 * What clients/program/verbs/replay.cpp writes, and demo_page.cpp for `limber demo`; and a model of it: its mesh as it
 * deforms, and where it stands.
 */

import { Box3, Matrix4, Vector3 } from 'three';
import { PositionFrames, cornersOf, pointsOf, posesOf } from '../shared/decode.ts';
import type { FramesData, QuantizedPoints } from '../shared/decode.ts';
import type { Mesh } from '../shared/surface.ts';
import { matrixInFrame } from '../shared/viewer.ts';
import type { Frame } from '../shared/viewer.ts';

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

interface Rows {
  lower: (number | null)[];
  upper: (number | null)[];
  status: string[];
  /** Whether the models are closer than the clearance; null where none is required. */
  too_close: (boolean | null)[];
  /** Of the deepest vertex of either model in the other; null where that is not asked. */
  depth: (number | null)[];
  update_us: number[];
  query_us: number[];
  moved_vertices: number[];
  /** Both points and the triangles that they lie on; null also where the frame has been left out. */
  witness: (number[] | null)[];
}

interface ContactRows {
  name: 'contact' | 'self_a' | 'self_b';
  query_us: number[];
  count: number[];
  intersecting: number[];
}

/** What touches first on the way from the row before. */
export interface ImpactRows {
  name: 'impact' | 'impact_self_a' | 'impact_self_b';
  /** Null in frames that none comes before. */
  status: ('clear' | 'contact' | 'initial_contact' | null)[];
  /** When, in frames; null where nothing touches. */
  lower: (number | null)[];
  /** The feature and the triangle of each side; there is no feature where models cross. */
  touch: ([string | null, number, string | null, number] | null)[];
}

/** What only `limber demo` has. */
interface DemoData {
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
  min_clearance: number | null;
  frame_count: number;
  stride: number;
  max_megabytes: number;
  rows: Rows;
  contacts: ContactRows[];
  impacts: ImpactRows[];
  models: [ModelData, ModelData];
  demo?: DemoData;
}

/** Whether the models touch in a row, or on the way to it. */
export const touchesIn = ({ rows, impacts }: ReplayData, row: number): boolean =>
  rows.status[row] === 'collision' ||
  impacts.some(({ name, status }) => name === 'impact' && status[row] !== null && status[row] !== 'clear');

/** The numbers of all rows, the worst first: the deepest, then those where the models touch, then the nearest. */
export function worstFirst(data: ReplayData): number[] {
  const { lower, upper, depth } = data.rows;
  const keys = upper.map((_, row) => [touchesIn(data, row) ? 0 : (upper[row] ?? Infinity), lower[row] ?? Infinity]);
  const order = keys.map((_, row) => row);
  const deeper = (r: number, s: number): number => (depth[s] ?? 0) - (depth[r] ?? 0);
  return order.sort((r, s) => deeper(r, s) || keys[r][0] - keys[s][0] || keys[r][1] - keys[s][1] || r - s);
}

export class ReplayModel {
  readonly data: ModelData;
  /** Points are in steps of the file, from the least coordinates on: float32 holds them exactly. */
  readonly mesh: Mesh;
  readonly deforms: boolean;
  readonly moves: boolean;
  /** Of the box in the first frame. */
  readonly diagonal: number;
  private readonly poses: Matrix4[];
  private readonly frames: PositionFrames | undefined;
  private readonly own: Matrix4; // from the mesh to the model's own frame
  private readonly center: Vector3; // of the mesh's box in the first frame

  constructor(data: ModelData) {
    this.data = data;
    const { frames, positions } = data;
    const corners = cornersOf(data.corners);
    const vertexCount = corners.reduce((most, v) => Math.max(most, v), 0) + 1;
    const origin = new Vector3(...(frames ?? positions)!.low);
    const step = frames?.step ?? Math.max(...positions!.step);
    const unit = step > 0 ? step : 1;
    const points = positions === undefined ? new Float32Array(3 * vertexCount) : pointsOf(positions, origin, unit);
    this.mesh = { points, corners };
    this.own = new Matrix4().makeScale(unit, unit, unit).setPosition(origin);
    this.poses = posesOf(data.poses);
    this.deforms = frames !== undefined;
    this.moves = this.poses.length > 1;
    this.frames = frames && new PositionFrames(frames, vertexCount);
    this.moveTo(0);
    const box = new Box3().setFromArray(points);
    this.center = box.getCenter(new Vector3());
    this.diagonal = Math.hypot(...box.getSize(new Vector3())) * unit;
  }

  /** Where the middle of the model, as it is in the first frame, stands in another, in the world. */
  centerAt(frame: number): Vector3 {
    return this.center.clone().applyMatrix4(this.placeAt(frame));
  }

  /** A box around the model in a frame, in the world. */
  boxAt(frame: number): Box3 {
    this.moveTo(frame);
    return new Box3().setFromArray(this.mesh.points).applyMatrix4(this.placeAt(frame));
  }

  /** Writes the mesh's points as they are in a frame. */
  moveTo(frame: number): void {
    if (this.frames !== undefined) this.mesh.points.set(this.frames.at(frame));
  }

  /** Places the mesh in the picture. */
  matrixAt(frame: number, inPicture: Frame): Matrix4 {
    return matrixInFrame(inPicture).multiply(this.placeAt(frame));
  }

  /** Places the mesh in the world. */
  private placeAt(frame: number): Matrix4 {
    return this.poses[this.moves ? frame : 0].clone().multiply(this.own);
  }
}
