// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Points, segments and names above a view in 3D: never hidden, and of the same width at every zoom. */

import { svgElement } from './dom.ts';
import { labelPlace } from './labels.ts';
import type { Vec3 } from './vectors.ts';
import type { Viewer } from './viewer.ts';

const digitWidth = 10; // of labels, in pixels

export class Marks {
  private readonly svg = svgElement('svg', { class: 'marks', 'aria-hidden': 'true' });
  private readonly viewer: Viewer;
  private segment: { a: Vec3; b: Vec3; label: string } | undefined;
  private path: { points: readonly Vec3[]; dots: readonly Vec3[] } | undefined;
  private readonly outlines: Vec3[][] = [];
  private readonly names: { at: Vec3; name: string; kind: string; isShown: () => boolean }[] = [];

  constructor(host: HTMLElement, viewer: Viewer) {
    this.viewer = viewer;
    host.append(this.svg);
    viewer.onDrawn(() => this.place());
  }

  /** The closest points and their label; nothing without them. */
  setSegment(segment: { a: Vec3; b: Vec3; label: string } | undefined): void {
    this.segment = segment;
    this.viewer.request();
  }

  /** A line, and dots on it; nothing without them. */
  setPath(path: { points: readonly Vec3[]; dots: readonly Vec3[] } | undefined): void {
    this.path = path;
    this.viewer.request();
  }

  /** Triangles that are outlined. */
  setOutlines(outlines: Vec3[][]): void {
    this.outlines.splice(0, Infinity, ...outlines);
    this.viewer.request();
  }

  /** The name of a model at a point of it. */
  addName(name: string, kind: string, at: Vec3, isShown: () => boolean): void {
    this.names.push({ at, name, kind, isShown });
  }

  /** Moves a name that addName() has added. */
  moveName(index: number, at: Vec3): void {
    this.names[index].at = at;
  }

  private place(): void {
    const [width, height] = this.viewer.size;
    this.svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
    const placed: SVGElement[] = this.path === undefined ? [] : this.pathMarks(this.path);
    const taken: [number, number][] = [];
    for (const { at, name, kind, isShown } of this.names) {
      if (isShown()) placed.push(...this.nameAt(name, kind, at, taken));
    }
    for (const outline of this.outlines) {
      const points = this.projected(outline).join(' ');
      placed.push(svgElement('polygon', { class: 'halo', points }), svgElement('polygon', { class: 'mark', points }));
    }
    if (this.segment !== undefined) placed.push(...this.segmentMarks(this.segment));
    this.svg.replaceChildren(...placed);
  }

  /** Points on the view, as SVG takes them. */
  private projected(points: readonly Vec3[]): string[] {
    return points.map((p) => {
      const [x, y] = this.viewer.project(p);
      return `${x.toFixed(1)},${y.toFixed(1)}`;
    });
  }

  private pathMarks({ points, dots }: { points: readonly Vec3[]; dots: readonly Vec3[] }): SVGElement[] {
    const line = this.projected(points).join(' ');
    const d = this.projected(dots)
      .map((dot) => `M${dot}h0`)
      .join('');
    return [
      svgElement('polyline', { class: 'path halo', points: line }),
      svgElement('polyline', { class: 'path', points: line }),
      svgElement('path', { class: 'dots halo', d }),
      svgElement('path', { class: 'dots', d }),
    ];
  }

  /** A badge above a point, moved aside where one of those `taken` is in the way. */
  private nameAt(name: string, kind: string, at: Vec3, taken: [number, number][]): SVGElement[] {
    const [pointX, pointY] = this.viewer.project(at);
    let x = pointX;
    const y = pointY - 16;
    for (const [otherX, otherY] of taken) {
      if (Math.hypot(x - otherX, y - otherY) < 26) x = otherX + 27;
    }
    taken.push([x, y]);
    const text = svgElement('text', { class: 'name', x, y: y + 5 });
    text.textContent = name;
    return [svgElement('circle', { class: `badge ${kind}`, cx: x, cy: y, r: 11 }), text];
  }

  private segmentMarks({ a, b, label }: { a: Vec3; b: Vec3; label: string }): SVGElement[] {
    const [ax, ay] = this.viewer.project(a);
    const [bx, by] = this.viewer.project(b);
    const line = { x1: ax, y1: ay, x2: bx, y2: by };
    const ends = [
      [ax, ay],
      [bx, by],
    ];
    const [x, y] = labelPlace([ax, ay], [bx, by], digitWidth * label.length, this.viewer.size);
    const text = svgElement('text', { class: 'length', x, y });
    text.textContent = label;
    return [
      svgElement('line', { class: 'halo', ...line }),
      ...ends.map(([cx, cy]) => svgElement('circle', { class: 'end', cx, cy, r: 4 })),
      svgElement('line', { class: 'mark', ...line }),
      text,
    ];
  }
}
