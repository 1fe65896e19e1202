// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** A square sheet with fixed edges that can be pulled, and swings back: the wave equation for each coordinate. */

import type { Vector3 } from 'three';

const squares = 100; // along each side, of two triangles each
const side = squares + 1; // vertices
const width = 2;
const stepsPerSecond = 180;
const tension = 0.36; // (wave speed * step / square)^2; the scheme is stable below 0.5
const smoothing = 0.012; // of velocities, which takes out the waves that the grid does not resolve
const damping = 0.004; // of velocities, each step
const calmDamping = 0.06; // so that the sheet hardly swings
const restSpeed = 1e-6; // a step; slower than that it rests
const grabRadius = 11; // squares around the vertex that is held
const lowest = [-1.25, -0.75, -1.25];
const highest = [1.25, 1.3, 1.25];

interface Grab {
  vertices: number[];
  weights: number[];
  from: Float64Array;
  shift: readonly number[];
}

export class Sheet {
  static readonly squareWidth = width / squares;
  readonly faces: Uint32Array;
  /** In the world: x and z along the sheet, y up. */
  positions: Float64Array = new Float64Array(3 * side * side);
  isResting = true;
  private previous: Float64Array;
  private next: Float64Array;
  private grab: Grab | undefined;
  private readonly damping: number;
  private debt = 0;

  constructor(isCalm: boolean) {
    this.damping = isCalm ? calmDamping : damping;
    this.faces = facesOfGrid();
    this.previous = new Float64Array(this.positions.length);
    this.next = new Float64Array(this.positions.length);
    this.reset();
  }

  /** Flat, and at rest. */
  reset(): void {
    const { positions } = this;
    for (let row = 0, i = 0; row < side; ++row) {
      for (let column = 0; column < side; ++column, i += 3) {
        positions[i] = column * Sheet.squareWidth - width / 2;
        positions[i + 1] = 0;
        positions[i + 2] = row * Sheet.squareWidth - width / 2;
      }
    }
    this.previous.set(positions);
    this.next.set(positions);
    this.grab = undefined;
    this.debt = 0;
    this.isResting = true;
  }

  /** Moves on by that many seconds; not by more than a twentieth, so that slow frames do not become slower. */
  advance(seconds: number): void {
    this.debt += Math.min(seconds, 0.05) * stepsPerSecond;
    for (; this.debt >= 1; --this.debt) this.step();
    this.isResting = this.grab === undefined && this.fastest() < restSpeed;
  }

  /** Holds the sheet around a vertex. */
  hold(vertex: number): void {
    const row = Math.floor(vertex / side);
    const column = vertex % side;
    const vertices: number[] = [];
    const weights: number[] = [];
    for (let r = Math.max(1, row - grabRadius); r <= Math.min(side - 2, row + grabRadius); ++r) {
      for (let c = Math.max(1, column - grabRadius); c <= Math.min(side - 2, column + grabRadius); ++c) {
        const off = ((r - row) ** 2 + (c - column) ** 2) / grabRadius ** 2;
        if (off >= 1) continue;
        vertices.push(r * side + c);
        weights.push((1 - off) ** 2);
      }
    }
    const from = new Float64Array(3 * vertices.length);
    vertices.forEach((v, i) => from.set(this.positions.subarray(3 * v, 3 * v + 3), 3 * i));
    this.grab = { vertices, weights, from, shift: [0, 0, 0] };
    this.isResting = false;
  }

  /** Pulls what is held to where it was, and that much further. */
  pull(shift: Vector3): void {
    if (this.grab !== undefined) this.grab.shift = shift.toArray();
  }

  release(): void {
    this.grab = undefined;
  }

  get isHeld(): boolean {
    return this.grab !== undefined;
  }

  private step(): void {
    const { positions, previous, next } = this;
    const here = tension + smoothing;
    const keep = 1 - this.damping;
    const row = 3 * side;
    for (let r = 1; r < side - 1; ++r) {
      for (let i = r * row + 3, end = (r + 1) * row - 3; i < end; ++i) {
        const p = positions[i];
        const before = previous[i];
        const around = positions[i - 3] + positions[i + 3] + positions[i - row] + positions[i + row] - 4 * p;
        const wasAround = previous[i - 3] + previous[i + 3] + previous[i - row] + previous[i + row] - 4 * before;
        next[i] = p + keep * (p - before) + here * around - smoothing * wasAround;
      }
    }
    if (this.grab !== undefined) this.holdIn(next, this.grab);
    this.next = previous;
    this.previous = positions;
    this.positions = next;
  }

  private holdIn(positions: Float64Array, { vertices, weights, from, shift }: Grab): void {
    for (let i = 0; i < vertices.length; ++i) {
      const w = weights[i];
      for (let axis = 0; axis < 3; ++axis) {
        const at = 3 * vertices[i] + axis;
        const wanted = Math.min(Math.max(from[3 * i + axis] + shift[axis], lowest[axis]), highest[axis]);
        positions[at] += w * (wanted - positions[at]);
      }
    }
  }

  private fastest(): number {
    const { positions, previous } = this;
    let most = 0;
    for (let i = 0; i < positions.length; ++i) most = Math.max(most, Math.abs(positions[i] - previous[i]));
    return most;
  }
}

/** The diagonals of squares alternate, so that the sheet bends alike in all directions. */
function facesOfGrid(): Uint32Array {
  const faces = new Uint32Array(6 * squares * squares);
  for (let row = 0, at = 0; row < squares; ++row) {
    for (let column = 0; column < squares; ++column, at += 6) {
      const a = row * side + column;
      const [b, c, d] = [a + 1, a + side, a + side + 1];
      faces.set((row + column) % 2 === 0 ? [a, c, b, b, c, d] : [a, c, d, a, d, b], at);
    }
  }
  return faces;
}
