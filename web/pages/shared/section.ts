// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Where a plane cuts a mesh: lines in the plane's own two coordinates. */

import { axes, cross, direction, dot, length, scale, subtract } from './vectors.ts';
import type { Vec3 } from './vectors.ts';

/** The points p with normal . p = offset; `right` and `up` are the directions of a drawing of it. */
export interface Plane {
  normal: Vec3;
  offset: number;
  right: Vec3;
  up: Vec3;
}

export interface Mesh {
  points: Float32Array;
  corners: Uint32Array;
}

/** Coordinates u, v of one point after the other. */
export interface Outline {
  line: Float64Array;
  isClosed: boolean;
}

/** The axis that is most nearly perpendicular to a direction; of equal ones, the first of y, x, z. */
export function mostPerpendicularAxis(along: Vec3): number {
  const [x, y, z] = along.map((c) => Math.abs(c));
  const least = Math.min(x, y, z) + 1e-9;
  return y <= least ? 1 : x <= least ? 0 : 2;
}

/**
 * A plane through a point that holds a direction. Its normal is the axis most perpendicular to the direction, as far as
 * the direction allows, and turned by an angle around the direction. It points to the front, the right or the top, from
 * where views look at first, so the drawing is not mirrored next to them. World's up is up in the drawing where it can
 * be; seen from the top, the back is.
 */
export function planeThrough(point: Vec3, along: Vec3, turn: number, worldUp: Vec3): Plane {
  const isZUp = worldUp[2] === 1;
  const chosen = mostPerpendicularAxis(along);
  const axis = scale(axes[chosen], isZUp && chosen === 1 ? -1 : 1);
  const first = direction(subtract(axis, scale(along, dot(axis, along))), axis);
  const second = cross(along, first);
  const normal = [0, 1, 2].map((i) => first[i] * Math.cos(turn) + second[i] * Math.sin(turn)) as unknown as Vec3;
  const flat = (axis: Vec3): Vec3 => subtract(axis, scale(normal, dot(axis, normal)));
  const upright = [worldUp, isZUp ? axes[1] : scale(axes[2], -1)].map(flat).find((axis) => length(axis) > 0.4);
  const up = direction(upright ?? along, along);
  return { normal, offset: dot(normal, point), right: cross(up, normal), up };
}

/**
 * The outlines of a cut. A vertex in the plane counts as above it, so every triangle that is cut has two edges that
 * are, and outlines of closed meshes are closed.
 */
export function outlinesOf(mesh: Mesh, plane: Plane): Outline[] {
  const { points, corners } = mesh;
  const count = points.length / 3;
  const heights = new Float64Array(count);
  const [nx, ny, nz] = plane.normal;
  for (let v = 0; v < count; ++v) {
    heights[v] = nx * points[3 * v] + ny * points[3 * v + 1] + nz * points[3 * v + 2] - plane.offset;
  }
  const pieces = new Pieces();
  for (let t = 0; t < corners.length; t += 3) {
    const a = corners[t];
    const b = corners[t + 1];
    const c = corners[t + 2];
    const aboveA = heights[a] >= 0;
    const aboveB = heights[b] >= 0;
    const aboveC = heights[c] >= 0;
    if (aboveA === aboveB && aboveB === aboveC) continue;
    const alone = aboveA === aboveB ? c : aboveB === aboveC ? a : b;
    const [one, other] = alone === a ? [b, c] : alone === b ? [c, a] : [a, b];
    const key = (v: number): number => Math.min(alone, v) * count + Math.max(alone, v);
    pieces.add(key(one), key(other));
  }
  return pieces.chains().map((chain) => {
    const isClosed = chain.length > 2 && chain[0] === chain[chain.length - 1];
    const line = new Float64Array(2 * chain.length);
    chain.forEach((edge, i) => {
      const v = Math.floor(edge / count);
      const w = edge % count;
      const t = heights[v] / (heights[v] - heights[w]);
      for (let axis = 0; axis < 3; ++axis) {
        const p = points[3 * v + axis] + t * (points[3 * w + axis] - points[3 * v + axis]);
        line[2 * i] += p * plane.right[axis];
        line[2 * i + 1] += p * plane.up[axis];
      }
    });
    return { line, isClosed };
  });
}

/** Pieces of lines, each between two edges of the mesh, joined to chains of edges. */
class Pieces {
  private readonly ends: number[] = []; // of piece i: edges 2 i and 2 i + 1
  private readonly piecesAt = new Map<number, number[]>();

  add(one: number, other: number): void {
    const piece = this.ends.length / 2;
    for (const edge of [one, other]) {
      const there = this.piecesAt.get(edge);
      if (there === undefined) this.piecesAt.set(edge, [piece]);
      else there.push(piece);
    }
    this.ends.push(one, other);
  }

  /** Each piece is in one chain. A closed chain ends with the edge that it starts with. */
  chains(): number[][] {
    const count = this.ends.length / 2;
    const used = new Uint8Array(count);
    const follow = (start: number): number[] => {
      const chain = [];
      let edge = start;
      for (;;) {
        const next = this.piecesAt.get(edge)?.find((piece) => used[piece] === 0);
        if (next === undefined) return chain;
        used[next] = 1;
        edge = this.ends[2 * next] === edge ? this.ends[2 * next + 1] : this.ends[2 * next];
        chain.push(edge);
      }
    };
    const chains = [];
    for (let piece = 0; piece < count; ++piece) {
      if (used[piece] !== 0) continue;
      const start = this.ends[2 * piece];
      const forward = follow(start);
      const isClosed = forward[forward.length - 1] === start;
      chains.push(isClosed ? [start, ...forward] : [...follow(start).reverse(), start, ...forward]);
    }
    return chains;
  }
}
