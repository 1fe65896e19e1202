// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Where a plane cuts a mesh. */

import { Vector3 } from 'three';
import type { Mesh } from '../shared/surface.ts';

/** The points p with normal . p = offset; `up` is the direction that is up in a drawing of it. */
export interface Plane {
  normal: Vector3;
  offset: number;
  up: Vector3;
}

/** The axis that is most nearly perpendicular to a direction; of equal ones, the first of y, x, z. */
export function mostPerpendicularAxis(along: Vector3): number {
  const [x, y, z] = along.toArray().map(Math.abs);
  const least = Math.min(x, y, z) + 1e-9;
  return y <= least ? 1 : x <= least ? 0 : 2;
}

/**
 * A plane through a point that holds a direction. Its normal is the axis most perpendicular to the direction, as far as
 * the direction allows, and turned by an angle around the direction. It points to the front, the right or the top, from
 * where views look at first, so the drawing is not mirrored next to them. World's up is up in the drawing where it can
 * be; seen from the top, the back is.
 */
export function planeThrough(point: Vector3, along: Vector3, turn: number, worldUp: Vector3): Plane {
  const isZUp = worldUp.z === 1;
  const chosen = mostPerpendicularAxis(along);
  const axis = new Vector3().setComponent(chosen, isZUp && chosen === 1 ? -1 : 1);
  const normal = axis.projectOnPlane(along).normalize().applyAxisAngle(along, turn);
  const back = isZUp ? new Vector3(0, 1, 0) : new Vector3(0, 0, -1);
  const upright = [worldUp, back].map((up) => up.clone().projectOnPlane(normal)).find((up) => up.length() > 0.4);
  return { normal, offset: normal.dot(point), up: (upright ?? along.clone()).normalize() };
}

/**
 * The outlines of a cut. A vertex in the plane counts as above it, so every triangle that is cut has two edges that
 * are, and outlines of closed meshes are closed: they end with the point that they start with.
 */
export function outlinesOf(
  { points, corners }: Mesh,
  { normal, offset }: Pick<Plane, 'normal' | 'offset'>,
): Vector3[][] {
  const count = points.length / 3;
  const heights = new Float64Array(count);
  for (let v = 0; v < count; ++v) {
    heights[v] = normal.x * points[3 * v] + normal.y * points[3 * v + 1] + normal.z * points[3 * v + 2] - offset;
  }
  const pieces: [number, number][] = [];
  for (let t = 0; t < corners.length; t += 3) {
    const [a, b, c] = [corners[t], corners[t + 1], corners[t + 2]];
    const [aboveA, aboveB, aboveC] = [heights[a] >= 0, heights[b] >= 0, heights[c] >= 0];
    if (aboveA === aboveB && aboveB === aboveC) continue;
    const alone = aboveA === aboveB ? c : aboveB === aboveC ? a : b;
    const [one, other] = alone === a ? [b, c] : alone === b ? [c, a] : [a, b];
    const key = (v: number): number => Math.min(alone, v) * count + Math.max(alone, v);
    pieces.push([key(one), key(other)]);
  }
  const pointOn = (edge: number): Vector3 => {
    const [v, w] = [Math.floor(edge / count), edge % count];
    const [from, to] = [v, w].map((vertex) => new Vector3().fromArray(points, 3 * vertex));
    return from.lerp(to, heights[v] / (heights[v] - heights[w]));
  };
  return chainsOf(pieces).map((chain) => chain.map(pointOn));
}

export const isClosed = (line: readonly Vector3[]): boolean => line.length > 2 && line[0].equals(line[line.length - 1]);

/** Pieces of lines, each between two edges of the mesh, joined to chains of edges; each piece is in one of them. */
function chainsOf(pieces: readonly (readonly [number, number])[]): number[][] {
  const piecesAt = new Map<number, number[]>();
  pieces.forEach((ends, piece) => {
    for (const edge of ends) piecesAt.set(edge, [...(piecesAt.get(edge) ?? []), piece]);
  });
  const used = new Uint8Array(pieces.length);
  const follow = (start: number): number[] => {
    const chain = [];
    for (let edge = start; ;) {
      const next = piecesAt.get(edge)!.find((piece) => used[piece] === 0);
      if (next === undefined) return chain;
      used[next] = 1;
      edge = pieces[next][0] === edge ? pieces[next][1] : pieces[next][0];
      chain.push(edge);
    }
  };
  return pieces.flatMap(([start], piece) => {
    if (used[piece] !== 0) return [];
    const forward = follow(start);
    const isClosedChain = forward[forward.length - 1] === start;
    return [[...(isClosedChain ? [] : follow(start).reverse()), start, ...forward]];
  });
}
