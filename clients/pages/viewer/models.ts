// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The models of a page, decoded, and where they stand. */

import { Box3, Matrix4, Vector3 } from 'three';
import { PositionFrames, cornersOf, increasingIdsOf, numbersOf, pointsOf, posesOf } from '../shared/decode.ts';
import type { Mesh } from '../shared/surface.ts';
import { matrixInFrame } from '../shared/viewer.ts';
import type { Frame } from '../shared/viewer.ts';
import type { Data, ModelData } from './data.ts';

/** A mesh with a step of the file as its unit, so that float32 holds it exactly. */
export class Model {
  readonly data: ModelData;
  readonly mesh: Mesh;
  readonly deforms: boolean;
  /** To the other model, by vertex. */
  readonly distances: Float32Array | undefined;
  /** From the mesh to the model's own frame. */
  readonly own: Matrix4;
  /** Of the mesh, as it is now. */
  readonly box = new Box3();
  private readonly frames: PositionFrames | undefined;

  constructor(data: ModelData) {
    this.data = data;
    const { frames, positions } = data;
    const corners = cornersOf(data.corners);
    const vertexCount = corners.reduce((most, v) => Math.max(most, v), 0) + 1;
    const origin = new Vector3(...(frames ?? positions)!.low);
    const unit = this.step > 0 ? this.step : 1;
    this.mesh = {
      points: positions === undefined ? new Float32Array(3 * vertexCount) : pointsOf(positions, origin, unit),
      corners,
    };
    this.own = new Matrix4().makeScale(unit, unit, unit).setPosition(origin);
    this.distances = data.distances && Float32Array.from(numbersOf(data.distances));
    this.deforms = frames !== undefined;
    this.frames = frames && new PositionFrames(frames, vertexCount);
    this.box.setFromArray(this.mesh.points);
    this.moveTo(0);
  }

  /** What coordinates are multiples of. */
  get step(): number {
    return this.data.frames?.step ?? Math.max(...this.data.positions!.step);
  }

  get nearest(): number {
    return this.distances!.reduce((a, b) => Math.min(a, b), Infinity);
  }

  get farthest(): number {
    return this.distances!.reduce((a, b) => Math.max(a, b), 0);
  }

  /** The diagonal of the box. */
  get size(): number {
    return this.box.getSize(new Vector3()).length() * this.own.getMaxScaleOnAxis();
  }

  /** Writes the mesh's points as they are in a frame. */
  moveTo(frame: number): void {
    if (this.frames === undefined) return;
    this.mesh.points.set(this.frames.at(frame));
    this.box.setFromArray(this.mesh.points);
  }

  /** The triangles of the mesh that are parts of those of the file. */
  shownTriangles(ids: number[]): number[] {
    if (this.data.parts === undefined) return ids;
    const ends = increasingIdsOf(this.data.parts);
    return ids.flatMap((id) => {
      const first = id === 0 ? 0 : ends[id - 1];
      return Array.from({ length: ends[id] - first }, (_, i) => first + i);
    });
  }
}

/** A model where it stands: in one pose, or in one for each frame. */
export class Part {
  readonly model: Model;
  readonly moves: boolean;
  /** Of all frames, in the world. */
  readonly bounds = new Box3();
  private readonly poses: readonly Matrix4[];
  private readonly center: Vector3; // of the mesh in the first frame

  constructor(model: Model, poses: string, frameCount: number) {
    this.model = model;
    this.poses = posesOf(poses);
    this.moves = this.poses.length > 1;
    this.center = model.box.getCenter(new Vector3());
    for (let frame = 0; frame < (this.moves || model.deforms ? frameCount : 1); ++frame) {
      model.moveTo(frame);
      this.bounds.union(model.box.clone().applyMatrix4(this.placeAt(frame)));
    }
    model.moveTo(0);
  }

  /** Where the middle of the model, as it is in the first frame, stands in another, in the world. */
  centerAt(frame: number): Vector3 {
    return this.center.clone().applyMatrix4(this.placeAt(frame));
  }

  /** Places the mesh in the picture. */
  matrixAt(frame: number, inPicture: Frame): Matrix4 {
    return matrixInFrame(inPicture).multiply(this.placeAt(frame));
  }

  /** Places the mesh in the world. */
  private placeAt(frame: number): Matrix4 {
    return this.poses[this.moves ? frame : 0].clone().multiply(this.model.own);
  }
}

export const modelsOf = (data: Data): Model[] => data.models.map((model) => new Model(model));

export function partsOf({ parts, frame_count, stride }: Data, models: readonly Model[]): Part[] {
  const frameCount = Math.ceil(frame_count / stride);
  return parts.model.map((model, i) => new Part(models[model], parts.poses[i], frameCount));
}
