// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Points, segments and names above a view: never hidden, and of the same width at every zoom. */

import type { Vector3 } from 'three';
import { svgElement } from './dom.ts';
import type { Viewer } from './viewer.ts';

/** The closest points and their label; dashed where it is not in the plane that is drawn. */
export interface Segment {
  a: Vector3;
  b: Vector3;
  label: string;
  isDashed?: boolean;
}

/** The name of a model at a point of it. */
export interface Name {
  name: 'A' | 'B';
  at: Vector3;
  isShown(): boolean;
}

type Pixel = readonly [number, number];

export interface Shown {
  /** Lines of a class of page.css; what they enclose is filled by the rule of even and odd. */
  outlines?: readonly { kind: string; lines: readonly (readonly Vector3[])[] }[];
  /** A line, and dots on it. */
  path?: { points: readonly Vector3[]; dots: readonly Vector3[] };
  names?: readonly Name[];
  /** Triangles. */
  triangles?: readonly (readonly Vector3[])[];
  segment?: Segment;
}

const digitWidth = 10; // of labels, in pixels
const badgeRadius = 11; // of names

export class Marks {
  private readonly svg = svgElement('svg', { class: 'marks', 'aria-hidden': 'true' });
  private readonly viewer: Viewer;
  readonly shown: Shown = {};

  /** `more` are placed on top. */
  constructor(viewer: Viewer, more: () => SVGElement[] = () => []) {
    this.viewer = viewer;
    viewer.host.append(this.svg);
    viewer.onDrawn(() => {
      this.svg.setAttribute('viewBox', `0 0 ${viewer.size.join(' ')}`);
      this.svg.replaceChildren(...this.placed(), ...more());
    });
  }

  /** Replaces what is named; what is undefined is not shown. */
  show(changes: Shown): void {
    Object.assign(this.shown, changes);
    this.viewer.request();
  }

  private placed(): SVGElement[] {
    const { outlines = [], path, names = [], triangles = [], segment } = this.shown;
    const taken: Pixel[] = []; // by names
    return [
      ...outlines.map(({ kind, lines }) =>
        svgElement('path', { class: kind, d: lines.map((line) => `M${this.projected(line)}`).join('') }),
      ),
      ...(path === undefined ? [] : this.pathMarks(path)),
      ...names.flatMap((name) => (name.isShown() ? this.nameMarks(name, taken) : [])),
      ...triangles.flatMap((corners) => twice('polygon', 'mark', { points: this.projected(corners) })),
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
    const [pointX, pointY] = this.viewer.project(at);
    let x = pointX;
    const y = pointY - 16;
    for (const [otherX, otherY] of taken) {
      if (Math.hypot(x - otherX, y - otherY) < 26) x = otherX + 27;
    }
    taken.push([x, y]);
    return [
      svgElement('circle', { class: `badge ${name.toLowerCase()}`, cx: x, cy: y, r: badgeRadius }),
      svgElement('text', { class: 'name', x, y: y + 5 }, name),
    ];
  }

  private segmentMarks({ a, b, label, isDashed = false }: Segment, taken: readonly Pixel[]): SVGElement[] {
    const ends = [this.viewer.project(a), this.viewer.project(b)] as const;
    const [[x1, y1], [x2, y2]] = ends;
    const [x, y] = labelPlace(...ends, digitWidth * label.length, this.viewer.size, taken);
    const [halo, line] = twice('line', isDashed ? 'mark dashed' : 'mark', { x1, y1, x2, y2 });
    return [
      halo,
      ...ends.map(([cx, cy]) => svgElement('circle', { class: isDashed ? 'end dashed' : 'end', cx, cy, r: 4 })),
      line,
      svgElement('text', { class: 'length', x, y }, label),
    ];
  }
}

/** A halo, and what it surrounds. */
function twice(tag: string, kind: string, attributes: Record<string, string | number>): [SVGElement, SVGElement] {
  return [svgElement(tag, { class: `${kind} halo`, ...attributes }), svgElement(tag, { class: kind, ...attributes })];
}

const gap = 10;
const halfLine = 8; // of text, as high as a digit is above the middle

/**
 * Where the label of a segment stands, so that the segment does not run through it: the left end of the text's base
 * line, for a text that wide, beside a steep segment, above a flat one; on the other side where it would leave the view
 * or cover one of the badges `taken`.
 */
export function labelPlace(a: Pixel, b: Pixel, textWidth: number, size: Pixel, taken: readonly Pixel[] = []): Pixel {
  const [dx, dy] = [Math.abs(b[0] - a[0]), Math.abs(b[1] - a[1])];
  const [x, y] = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  const isFlat = dx > dy;
  const off = isFlat ? gap + Math.min(dy / 2, (textWidth / 2) * (dy / dx)) : gap + (dy > 0 ? halfLine * (dx / dy) : 0);
  let [left, base] = isFlat ? [x - textWidth / 2, y - off] : [x + off, y + halfLine - 2];
  const isCovering = taken.some(
    ([cx, cy]) =>
      cx > left - badgeRadius &&
      cx < left + textWidth + badgeRadius &&
      Math.abs(cy - (base - halfLine + 2)) < badgeRadius + halfLine,
  );
  if (!isFlat && (isCovering || left + textWidth > size[0] - 4)) left = x - off - textWidth;
  if (isFlat && (isCovering || base < 18)) base = y + off + 2 * halfLine - 2;
  return [Math.min(Math.max(left, 4), size[0] - textWidth - 4), base];
}
