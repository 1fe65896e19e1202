// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Frames of a sequence, as apps/limber/formats/position_frames.cpp writes them. */

import { CountReader, bytesOf } from './decode.ts';
import type { Vec3 } from './vectors.ts';

export interface FramesData {
  low: [number, number, number];
  step: number;
  /** From one frame that stands for itself to the next. */
  run: number;
  data: string[];
}

/**
 * The positions of a deforming mesh, frame by frame. Going forward is cheap; other ways it starts at a frame that
 * stands for itself.
 */
export class PositionFrames {
  readonly count: number;
  private readonly data: FramesData;
  private readonly steps: Float64Array;
  private current = -1;

  constructor(data: FramesData, vertexCount: number) {
    this.data = data;
    this.count = data.data.length;
    this.steps = new Float64Array(3 * vertexCount);
  }

  /** Coordinates as whole steps above `low`, valid until the next call. */
  at(frame: number): Float64Array {
    const start = frame - (frame % this.data.run);
    if (this.current < start || this.current > frame) this.current = start - 1;
    while (this.current < frame) this.read(++this.current);
    return this.steps;
  }

  private read(frame: number): void {
    const { steps } = this;
    const isWhole = frame % this.data.run === 0;
    const counts = new CountReader(bytesOf(this.data.data[frame]));
    let i = 0;
    const advance = (difference: number): void => {
      const before = !isWhole ? steps[i] : i < 3 ? 0 : steps[i - 3];
      steps[i++] = before + difference;
    };
    while (!counts.isAtEnd) {
      const code = counts.next();
      if (code > 0) advance(code % 2 === 0 ? code / 2 : -(code + 1) / 2);
      else for (let zeros = counts.next(); zeros > 0; --zeros) advance(0);
    }
  }
}

/** The rows of a rotation, and a translation. */
export type Pose = Float64Array;

const numbersOfPose = 12;

/** Poses of a model; one alone holds for all frames. */
export class PoseFrames {
  private readonly numbers: Float64Array;

  constructor(base64: string) {
    const bytes = bytesOf(base64);
    const view = new DataView(bytes.buffer);
    this.numbers = Float64Array.from({ length: bytes.length / 8 }, (_, i) => view.getFloat64(8 * i, true));
  }

  get count(): number {
    return this.numbers.length / numbersOfPose;
  }

  at(frame: number): Pose {
    const first = this.count === 1 ? 0 : numbersOfPose * frame;
    return this.numbers.subarray(first, first + numbersOfPose);
  }
}

export function placed(pose: Pose, p: Vec3): Vec3 {
  return [0, 1, 2].map(
    (row) => pose[3 * row] * p[0] + pose[3 * row + 1] * p[1] + pose[3 * row + 2] * p[2] + pose[9 + row],
  ) as unknown as Vec3;
}
