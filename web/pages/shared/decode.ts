// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Reads back what apps/limber/reports/page_data.cpp and position_frames.cpp have written. */

import type { Vec3 } from './vectors.ts';

/** Numbers as low + step * k, where k has 24 bits. */
export interface Quantized {
  low: number;
  step: number;
  data: string;
}

/** The same for three coordinates. */
export interface QuantizedPoints {
  low: [number, number, number];
  step: [number, number, number];
  data: [string, string, string];
}

export function bytesOf(base64: string): Uint8Array {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

/** Reads counts in groups of 7 bits, the lowest first. */
export class CountReader {
  private at = 0;
  private readonly bytes: Uint8Array;

  constructor(bytes: Uint8Array) {
    this.bytes = bytes;
  }

  get isAtEnd(): boolean {
    return this.at >= this.bytes.length;
  }

  next(): number {
    let count = 0;
    for (let factor = 1; ; factor *= 128) {
      const byte = this.bytes[this.at++];
      count += (byte & 127) * factor;
      if (byte < 128) return count;
    }
  }
}

export function countsOf(base64: string): number[] {
  const reader = new CountReader(bytesOf(base64));
  const counts = [];
  while (!reader.isAtEnd) counts.push(reader.next());
  return counts;
}

/** Ids that increase, written as the differences between them. */
export function increasingIdsOf(base64: string): number[] {
  let id = 0;
  return countsOf(base64).map((difference) => (id += difference));
}

export function numbersOf(quantized: Quantized): Float64Array {
  const bytes = bytesOf(quantized.data);
  const numbers = new Float64Array(bytes.length / 3);
  for (let i = 0; i < numbers.length; ++i) {
    const quanta = bytes[3 * i] + 256 * bytes[3 * i + 1] + 65536 * bytes[3 * i + 2];
    numbers[i] = quantized.low + quantized.step * quanta;
  }
  return numbers;
}

/** Three coordinates for each point, moved by -center and divided by `size`, so that float32 resolves them well. */
export function pointsOf(quantized: QuantizedPoints, center: Vec3, size: number): Float32Array {
  const coordinates = [0, 1, 2].map((axis) =>
    numbersOf({ low: quantized.low[axis], step: quantized.step[axis], data: quantized.data[axis] }),
  );
  const points = new Float32Array(3 * coordinates[0].length);
  for (let i = 0; i < coordinates[0].length; ++i) {
    for (let axis = 0; axis < 3; ++axis) points[3 * i + axis] = (coordinates[axis][i] - center[axis]) / size;
  }
  return points;
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
