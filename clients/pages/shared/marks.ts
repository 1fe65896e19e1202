// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Points, segments and names above a view: never hidden, and of the same width at every zoom. */

import type { Vector3 } from 'three';
import type { Viewer } from './viewer.ts';

/** The name of a model at a point of it. */
export interface Name {
  name: 'A' | 'B';
  at: Vector3;
  isShown(): boolean;
}

type Pixel = readonly [number, number];

export interface Shown {
  /** A line, and dots on it. */
  path?: { points: readonly Vector3[]; dots: readonly Vector3[] };
  names?: readonly Name[];
  /** The closest points and their label. */
  segment?: { a: Vector3; b: Vector3; label: string };
}

function svgElement(tag: string, attributes: Record<string, string | number>, text = ''): SVGElement {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag) as SVGElement;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  made.textContent = text;
  return made;
}

/** A halo, and what it surrounds. */
const twice = (tag: string, kind: string, attributes: Record<string, string | number>): [SVGElement, SVGElement] => [
  svgElement(tag, { class: `${kind} halo`, ...attributes }),
  svgElement(tag, { class: kind, ...attributes }),
];

export class Marks {
  private readonly svg = svgElement('svg', { class: 'marks', 'aria-hidden': 'true' });
  private readonly viewer: Viewer;
  private readonly shown: Shown = {};

  constructor(viewer: Viewer) {
    this.viewer = viewer;
    viewer.host.append(this.svg);
    viewer.onDrawn(() => {
      this.svg.setAttribute('viewBox', `0 0 ${viewer.size.join(' ')}`);
      this.svg.replaceChildren(...this.placed());
    });
  }

  /** Replaces what is named; what is undefined is not shown. */
  show(changes: Shown): void {
    Object.assign(this.shown, changes);
    this.viewer.request();
  }

  private placed(): SVGElement[] {
    const { path, names = [], segment } = this.shown;
    const taken: Pixel[] = []; // by names
    return [
      ...(path === undefined ? [] : this.pathMarks(path)),
      ...names.flatMap((name) => (name.isShown() ? this.nameMarks(name, taken) : [])),
      ...(segment === undefined ? [] : this.segmentMarks(segment, taken)),
    ];
  }

  /** Points on the view, as SVG takes them. */
  private projected(points: readonly Vector3[]): string {
    return points.map((p) => this.viewer.project(p).map((c) => c.toFixed(1))).join(' ');
  }

  private pathMarks({ points, dots }: NonNullable<Shown['path']>): SVGElement[] {
    const d = dots.map((dot) => `M${this.projected([dot])}h0`).join('');
    return [...twice('polyline', 'path', { points: this.projected(points) }), ...twice('path', 'dots', { d })];
  }

  /** A badge above a point, moved aside where one of those `taken` is in the way. */
  private nameMarks({ name, at }: Name, taken: Pixel[]): SVGElement[] {
    let [x, y] = this.viewer.project(at);
    y -= 16;
    for (const [otherX, otherY] of taken) {
      if (Math.hypot(x - otherX, y - otherY) < 26) x = otherX + 27;
    }
    taken.push([x, y]);
    return [
      svgElement('circle', { class: `badge ${name.toLowerCase()}`, cx: x, cy: y, r: 11 }),
      svgElement('text', { class: 'name', x, y: y + 5 }, name),
    ];
  }

  private segmentMarks({ a, b, label }: NonNullable<Shown['segment']>, taken: readonly Pixel[]): SVGElement[] {
    const ends = [this.viewer.project(a), this.viewer.project(b)] as const;
    const [[x1, y1], [x2, y2]] = ends;
    const [halo, line] = twice('line', 'mark', { x1, y1, x2, y2 });
    const [x, y] = labelPlace(...ends, this.viewer.size, taken);
    return [
      halo,
      ...ends.map(([cx, cy]) => svgElement('circle', { class: 'end', cx, cy, r: 4 })),
      line,
      svgElement('text', { class: 'length', x, y }, label),
    ];
  }
}

/**
 * Where the middle of a segment's label stands: beyond its upper end, or beyond the lower one where the view ends, or
 * one of the badges `taken` is in the way.
 */
export function labelPlace(a: Pixel, b: Pixel, [width, height]: Pixel, taken: readonly Pixel[] = []): Pixel {
  const room = 60; // for half of a label
  const [upper, lower] = a[1] < b[1] ? [a, b] : [b, a];
  const below: Pixel = [lower[0], lower[1] + 26];
  const [x, y] = upper[1] < 34 ? below : [upper[0], upper[1] - 14];
  const isTaken = taken.some(([cx, cy]) => Math.abs(cx - x) < room && Math.abs(cy - y + 6) < 20);
  const [left, base] = isTaken ? below : [x, y];
  return [Math.min(Math.max(left, room), width - room), Math.min(base, height - 6)];
}
