// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/**
 * Reads back what reports/page_data.cpp of the program has written: meshes and numbers, frames of a sequence.
 */

import { Matrix4 } from 'three';

type Triple<T> = [T, T, T];

/** Coordinates as low + step * k, where k has 24 bits. */
export interface QuantizedPoints {
  low: Triple<number>;
  step: Triple<number>;
  data: Triple<string>;
}

const bytesOf = (base64: string): Uint8Array<ArrayBuffer> => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));

/** Counts in groups of 7 bits, the lowest first. */
export function countsOf(base64: string): number[] {
  const counts: number[] = [];
  let [count, factor] = [0, 1];
  for (const byte of bytesOf(base64)) {
    count += (byte & 127) * factor;
    factor *= 128;
    if (byte >= 128) continue;
    counts.push(count);
    [count, factor] = [0, 1];
  }
  return counts;
}

/** Ids that increase, written as the differences between them. */
export function increasingIdsOf(base64: string): number[] {
  let id = 0;
  return countsOf(base64).map((difference) => (id += difference));
}

/** Three coordinates for each point, above the lowest ones and divided by `unit`, which float32 resolves well. */
export function pointsOf({ step, data }: QuantizedPoints, unit: number): Float32Array {
  const axes = data.map(bytesOf);
  return Float32Array.from({ length: axes[0].length }, (_, i) => {
    const [bytes, at] = [axes[i % 3], 3 * Math.floor(i / 3)];
    return ((bytes[at] + 256 * bytes[at + 1] + 65536 * bytes[at + 2]) * step[i % 3]) / unit;
  });
}

/** Three vertices for each triangle. */
export function cornersOf(base64: string): Uint32Array {
  const counts = countsOf(base64);
  const corners = new Uint32Array(counts.length);
  let named = 0;
  counts.forEach((back, i) => {
    corners[i] = back === 0 ? named++ : named - back;
  });
  return corners;
}

export interface FramesData {
  low: Triple<number>;
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
  private readonly data: FramesData;
  private readonly steps: Float64Array;
  private current = -1;

  constructor(data: FramesData, vertexCount: number) {
    this.data = data;
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
    let i = 0;
    const advance = (difference: number): void => {
      const before = !isWhole ? steps[i] : i < 3 ? 0 : steps[i - 3];
      steps[i++] = before + difference;
    };
    const codes = countsOf(this.data.data[frame]).values();
    for (const code of codes) {
      if (code > 0) advance(code % 2 === 0 ? code / 2 : -(code + 1) / 2);
      else for (let zeros = codes.next().value ?? 0; zeros > 0; --zeros) advance(0);
    }
  }
}

const numbersOfPose = 12;

/** Poses of a model, each written as the rows of a rotation, and a translation. One alone holds for all frames. */
export function posesOf(base64: string): Matrix4[] {
  const numbers = new Float64Array(bytesOf(base64).buffer);
  return Array.from({ length: numbers.length / numbersOfPose }, (_, pose) => {
    const [a, b, c, d, e, f, g, h, i, x, y, z] = numbers.subarray(numbersOfPose * pose);
    return new Matrix4(a, b, c, x, d, e, f, y, g, h, i, z, 0, 0, 0, 1);
  });
}
