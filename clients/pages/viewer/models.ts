// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The models of a page, decoded, and where they stand. */

import { Box3, BufferAttribute, Matrix4, Vector3 } from 'three';
import type { BufferGeometry } from 'three';
import { PositionFrames, cornersOf, pointsOf, posesOf } from '../shared/decode.ts';
import { geometryOf } from '../shared/surface.ts';
import type { Data, ModelData } from './data.ts';

/** A mesh with a step of the file as its unit, so that float32 holds it exactly. */
export class Model {
  readonly data: ModelData;
  readonly points: Float32Array;
  readonly corners: Uint32Array;
  readonly geometry: BufferGeometry;
  readonly deforms: boolean;
  /** What coordinates are multiples of. */
  readonly step: number;
  /** From the mesh to the model's own frame. */
  readonly own: Matrix4;
  /** Of the mesh, as it is now. */
  readonly box = new Box3();
  private readonly frames: PositionFrames | undefined;

  constructor(data: ModelData) {
    this.data = data;
    const { frames, positions } = data;
    this.corners = cornersOf(data.corners);
    const vertexCount = this.corners.reduce((most, v) => Math.max(most, v), 0) + 1;
    this.step = frames?.step ?? Math.max(...positions!.step);
    const unit = this.step > 0 ? this.step : 1;
    this.points = positions === undefined ? new Float32Array(3 * vertexCount) : pointsOf(positions, unit);
    this.geometry = geometryOf(new BufferAttribute(this.points, 3), this.corners);
    this.own = new Matrix4().makeScale(unit, unit, unit).setPosition(new Vector3(...(frames ?? positions)!.low));
    this.deforms = frames !== undefined;
    this.frames = frames && new PositionFrames(frames, vertexCount);
    this.box.setFromArray(this.points);
    this.moveTo(0);
  }

  /** The diagonal of the box. */
  get size(): number {
    return this.box.getSize(new Vector3()).length() * this.own.getMaxScaleOnAxis();
  }

  /** Writes the mesh's points as they are in a frame. */
  moveTo(frame: number): void {
    if (this.frames === undefined) return;
    this.points.set(this.frames.at(frame));
    this.geometry.attributes.position.needsUpdate = true;
    this.box.setFromArray(this.points);
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

  /** Places the mesh in the world. */
  placeAt(frame: number): Matrix4 {
    return this.poses[this.moves ? frame : 0].clone().multiply(this.model.own);
  }
}

export const modelsOf = (data: Data): Model[] => data.models.map((model) => new Model(model));

export function partsOf({ parts, frame_count, stride }: Data, models: readonly Model[]): Part[] {
  const frameCount = Math.ceil(frame_count / stride);
  return parts.model.map((model, i) => new Part(models[model], parts.poses[i], frameCount));
}
