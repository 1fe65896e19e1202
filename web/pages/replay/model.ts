// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** A model of a replay: its mesh as it deforms, and where it stands. */

import { cornersOf, numbersOf } from '../shared/decode.ts';
import { PoseFrames, PositionFrames, placed } from '../shared/frames.ts';
import type { Mesh } from '../shared/section.ts';
import { highest, length, lowest, middle, subtract } from '../shared/vectors.ts';
import type { Vec3 } from '../shared/vectors.ts';
import type { Frame } from '../shared/viewer.ts';
import type { ModelData } from './data.ts';

export type Box = [Vec3, Vec3];

const nothing: Box = [
  [Infinity, Infinity, Infinity],
  [-Infinity, -Infinity, -Infinity],
];

export const joined = (a: Box, b: Box): Box => [lowest(a[0], b[0]), highest(a[1], b[1])];

export class ReplayModel {
  readonly data: ModelData;
  readonly mesh: Mesh;
  readonly deforms: boolean;
  readonly moves: boolean;
  /** Of the box in the first frame. */
  readonly diagonal: number;
  private readonly poses: PoseFrames;
  private readonly frames: PositionFrames | undefined;
  private readonly fixed: Float64Array[];
  private readonly origin: Vec3; // of the mesh's own coordinates in the picture
  private readonly center: Vec3; // of the mesh's own box in the first frame

  constructor(data: ModelData) {
    this.data = data;
    const corners = cornersOf(data.corners);
    const vertexCount = corners.reduce((most, v) => Math.max(most, v), 0) + 1;
    this.mesh = { points: new Float32Array(3 * vertexCount), corners };
    this.poses = new PoseFrames(data.poses);
    this.deforms = data.frames !== undefined;
    this.moves = this.poses.count > 1;
    this.frames = data.frames && new PositionFrames(data.frames, vertexCount);
    const { positions } = data;
    this.fixed = positions
      ? [0, 1, 2].map((axis) =>
          numbersOf({ low: positions.low[axis], step: positions.step[axis], data: positions.data[axis] }),
        )
      : [];
    this.origin = data.frames?.low ?? positions?.low ?? [0, 0, 0];
    const [low, high] = this.ownBoxAt(0);
    this.center = middle(low, high);
    this.diagonal = length(subtract(high, low));
  }

  /** Where the middle of the model, as it is in the first frame, stands in another, in the world. */
  centerAt(frame: number): Vec3 {
    return placed(this.poses.at(frame), this.center);
  }

  /** A box around the model in a frame, in the world. */
  boxAt(frame: number): Box {
    const [low, high] = this.ownBoxAt(frame);
    let box = nothing;
    for (let corner = 0; corner < 8; ++corner) {
      const p = [0, 1, 2].map((axis) => ((corner >> axis) & 1 ? high : low)[axis]) as unknown as Vec3;
      const inWorld = placed(this.poses.at(frame), p);
      box = joined(box, [inWorld, inWorld]);
    }
    return box;
  }

  /** Writes the mesh's points as they are in a frame: relative to `origin`, and divided by the frame's size. */
  moveTo(frame: number, { size }: Frame): void {
    const { points } = this.mesh;
    if (this.frames !== undefined) {
      const scale = this.data.frames!.step / size;
      const steps = this.frames.at(frame);
      for (let i = 0; i < points.length; ++i) points[i] = steps[i] * scale;
    } else {
      for (let i = 0; i < points.length; ++i) {
        points[i] = (this.fixed[i % 3][Math.floor(i / 3)] - this.origin[i % 3]) / size;
      }
    }
  }

  /** The rows of the matrix that places the points in the picture. */
  matrixAt(frame: number, { center, size }: Frame): number[] {
    const pose = this.poses.at(frame);
    const origin = placed(pose, this.origin);
    return [0, 1, 2]
      .flatMap((row) => [...pose.subarray(3 * row, 3 * row + 3), (origin[row] - center[row]) / size])
      .concat(0, 0, 0, 1);
  }

  private ownBoxAt(frame: number): Box {
    if (this.frames === undefined) {
      const ends = (pick: (a: number, b: number) => number): Vec3 =>
        this.fixed.map((numbers) => numbers.reduce((a, b) => pick(a, b))) as unknown as Vec3;
      return [ends(Math.min), ends(Math.max)];
    }
    const steps = this.frames.at(frame);
    const { low, step } = this.data.frames!;
    const least = [Infinity, Infinity, Infinity];
    const most = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < steps.length; ++i) {
      least[i % 3] = Math.min(least[i % 3], steps[i]);
      most[i % 3] = Math.max(most[i % 3], steps[i]);
    }
    const inUnits = (ends: number[]): Vec3 => ends.map((k, axis) => low[axis] + step * k) as unknown as Vec3;
    return [inUnits(least), inUnits(most)];
  }
}
