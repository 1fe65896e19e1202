// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** What clients/program/reports/study.cpp writes, and a model of it, decoded; which answers are worse than others. */

import { Box3, Matrix4, Vector3 } from 'three';
import { cornersOf, pointsOf } from '../shared/decode.ts';
import type { QuantizedPoints } from '../shared/decode.ts';
import type { Mesh } from '../shared/surface.ts';
import { matrixInFrame } from '../shared/viewer.ts';
import type { Frame } from '../shared/viewer.ts';
import type { Clash, Inside, Solids, Tolerances } from '../viewer/clashes.ts';

type Point = [number, number, number];

export interface ModelData {
  name: string;
  triangles: number;
  vertices: number;
  faces: number;
  closed: boolean;
  /** Of the box in the model's own frame. */
  low: Point;
  high: Point;
  positions: QuantizedPoints;
  corners: string;
}

/** Lists with an entry for each pair. */
export interface Rows {
  /** Numbers of parts. */
  a: number[];
  b: number[];
  status: ('exact' | 'within_error' | 'collision' | 'beyond_limit')[];
  lower: (number | null)[];
  upper: (number | null)[];
  /** Both points; triangles and faces that they lie on. */
  witness: (number[] | null)[];
  clash: Clash[];
  solids: Solids[];
  too_close: (boolean | null)[];
  inside: Inside[];
  /** No shorter translation takes one out of the other; of closed models that overlap. */
  depth: (number | null)[];
  /** The line of the file of accepted pairs. */
  accepted: (number | null)[];
  /** Ids of triangles of both that intersect the other. */
  intersecting: ([string, string] | null)[];
  query_us: number[];
  /** Their numbers in the table that the program has written. */
  row: number[];
}

export interface StudyData {
  study: Tolerances & {
    kind: 'pairs' | 'parts';
    min_clearance: number | null;
    max_distance: number | null;
    relative_error: number;
    absolute_error: number;
    /** What stands somewhere: lists of names, of files as typed, of numbers of models; and poses. */
    parts: { name: string[]; file: string[]; model: number[]; poses: string };
    /** How many pairs are of each kind and not accepted, also where the page does not have them all. */
    counts: Partial<Record<Clash, number>>;
    accepted: number;
    /** Without those that are accepted. */
    too_close: number;
    worst_first: number[];
    rows: Rows;
  };
  models: ModelData[];
}

/** A mesh with a step of the file as its unit, so that float32 holds it exactly. */
export class StudyModel {
  readonly data: ModelData;
  readonly mesh: Mesh;
  private readonly own: Matrix4; // from the mesh to the model's own frame
  private readonly box: Box3; // of the mesh

  constructor(data: ModelData) {
    this.data = data;
    const { low, step } = data.positions;
    const [origin, longest] = [new Vector3(...low), Math.max(...step)];
    const unit = longest > 0 ? longest : 1;
    this.mesh = { points: pointsOf(data.positions, origin, unit), corners: cornersOf(data.corners) };
    this.own = new Matrix4().makeScale(unit, unit, unit).setPosition(origin);
    this.box = new Box3().setFromArray(this.mesh.points);
  }

  /** A box around the model in the world. */
  boxAt(pose: Matrix4): Box3 {
    return this.box.clone().applyMatrix4(pose.clone().multiply(this.own));
  }

  /** Places the mesh in the picture. */
  matrixAt(pose: Matrix4, frame: Frame): Matrix4 {
    return matrixInFrame(frame).multiply(pose).multiply(this.own);
  }
}
