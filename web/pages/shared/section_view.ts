// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The drawing of a section: outlines of both models, the clearance between them, and a scale. */

import { element } from './dom.ts';
import { labelPlace } from './labels.ts';
import { roundBelow, shown } from './numbers.ts';
import type { Outline } from './section.ts';
import { onThemeChange, token } from './theme.ts';

export type Point = readonly [number, number];

/** What is drawn, in the coordinates of the plane. */
export interface Drawing {
  models: { outlines: Outline[]; kind: 'a' | 'b' }[];
  /** The closest points; `isInPlane`: whether the plane goes through them. */
  segment?: { a: Point; b: Point; label: string; isInPlane: boolean };
}

const zoomStep = 1.2;
const moveStep = 40; // pixels
const largestScale = 1e9;

export class SectionView {
  private readonly host: HTMLElement;
  private readonly canvas = element('canvas');
  private drawing: Drawing = { models: [] };
  private readonly unitsPerCoordinate: number;
  private center: Point = [0, 0];
  private scale = 1; // pixels per coordinate
  private wanted: { center: Point; radius: number } = { center: [0, 0], radius: 1 };
  private readonly fingers = new Map<number, Point>();
  private isRequested = false;

  constructor(host: HTMLElement, unitsPerCoordinate: number) {
    this.host = host;
    this.unitsPerCoordinate = unitsPerCoordinate;
    host.append(this.canvas);
    new ResizeObserver(() => this.lookAt(this.wanted.center, this.wanted.radius)).observe(host);
    onThemeChange(() => this.request());
    host.addEventListener('keydown', (event) => this.press(event));
    host.addEventListener('wheel', (event) => this.turnWheel(event), { passive: false });
    host.addEventListener('pointerdown', (event) => this.touch(event));
    host.addEventListener('pointermove', (event) => this.drag(event));
    for (const end of ['pointerup', 'pointercancel'] as const) {
      host.addEventListener(end, (event) => this.fingers.delete(event.pointerId));
    }
  }

  show(drawing: Drawing): void {
    this.drawing = drawing;
    this.request();
  }

  /** Looks at a circle of the plane. */
  lookAt(center: Point, radius: number): void {
    this.wanted = { center, radius };
    this.center = center;
    this.scale = Math.min(this.host.clientWidth, this.host.clientHeight) / 2 / Math.max(radius, 1e-9);
    this.request();
  }

  private request(): void {
    if (this.isRequested) return;
    this.isRequested = true;
    requestAnimationFrame(() => {
      this.isRequested = false;
      this.draw();
    });
  }

  private pixel([u, v]: Point): [number, number] {
    const { clientWidth, clientHeight } = this.host;
    return [clientWidth / 2 + (u - this.center[0]) * this.scale, clientHeight / 2 - (v - this.center[1]) * this.scale];
  }

  private draw(): void {
    const { clientWidth, clientHeight } = this.host;
    const ratio = Math.min(devicePixelRatio, 3);
    this.canvas.width = Math.round(clientWidth * ratio);
    this.canvas.height = Math.round(clientHeight * ratio);
    const context = this.canvas.getContext('2d');
    if (context === null) return;
    context.scale(ratio, ratio);
    context.lineJoin = 'round';
    for (const { outlines, kind } of this.drawing.models) this.drawOutlines(context, outlines, kind);
    if (this.drawing.segment !== undefined) this.drawSegment(context, this.drawing.segment);
    this.drawScale(context, clientHeight);
  }

  private drawOutlines(context: CanvasRenderingContext2D, outlines: Outline[], kind: 'a' | 'b'): void {
    const closed = new Path2D();
    const all = new Path2D();
    for (const { line, isClosed } of outlines) {
      const path = new Path2D();
      for (let i = 0; i < line.length; i += 2) path.lineTo(...this.pixel([line[i], line[i + 1]]));
      all.addPath(path);
      if (isClosed) closed.addPath(path);
    }
    const color = token(`model-${kind}`);
    context.fillStyle = `${color}38`;
    context.fill(closed, 'evenodd');
    context.strokeStyle = color;
    context.lineWidth = 1.8;
    context.stroke(all);
  }

  private drawSegment(context: CanvasRenderingContext2D, segment: NonNullable<Drawing['segment']>): void {
    const [ax, ay] = this.pixel(segment.a);
    const [bx, by] = this.pixel(segment.b);
    const line = new Path2D();
    line.moveTo(ax, ay);
    line.lineTo(bx, by);
    context.setLineDash(segment.isInPlane ? [] : [4, 4]);
    for (const [color, width] of [
      [token('halo'), 6],
      [token('mark'), 2.4],
    ] as const) {
      context.strokeStyle = color;
      context.lineWidth = width;
      context.stroke(line);
    }
    context.setLineDash([]);
    for (const [x, y] of [
      [ax, ay],
      [bx, by],
    ]) {
      context.beginPath();
      context.arc(x, y, 4.2, 0, 2 * Math.PI);
      context.fillStyle = segment.isInPlane ? token('mark') : token('card');
      context.strokeStyle = segment.isInPlane ? token('halo') : token('mark');
      context.lineWidth = 1.8;
      context.fill();
      context.stroke();
    }
    this.drawLabel(context, segment.label, [ax, ay], [bx, by]);
  }

  private drawLabel(context: CanvasRenderingContext2D, text: string, a: Point, b: Point): void {
    context.font = `600 15px ${getComputedStyle(this.host).fontFamily}`;
    const { clientWidth, clientHeight } = this.host;
    const [x, y] = labelPlace(a, b, context.measureText(text).width, [clientWidth, clientHeight]);
    context.lineWidth = 4;
    context.strokeStyle = token('halo');
    context.strokeText(text, x, y);
    context.fillStyle = token('ink');
    context.fillText(text, x, y);
  }

  private drawScale(context: CanvasRenderingContext2D, height: number): void {
    const units = roundBelow((120 / this.scale) * this.unitsPerCoordinate);
    const pixels = (units / this.unitsPerCoordinate) * this.scale;
    const path = new Path2D(`M 14 ${height - 20} v 6 h ${pixels} v -6`);
    context.font = `13px ${getComputedStyle(this.host).fontFamily}`;
    for (const [color, width] of [
      [token('halo'), 4],
      [token('soft'), 1.5],
    ] as const) {
      context.strokeStyle = color;
      context.lineWidth = width;
      context.stroke(path);
    }
    context.lineWidth = 4;
    context.strokeStyle = token('halo');
    context.strokeText(shown(units), 20, height - 20);
    context.fillStyle = token('soft');
    context.fillText(shown(units), 20, height - 20);
  }

  private moveBy(right: number, down: number): void {
    this.center = [this.center[0] - right / this.scale, this.center[1] + down / this.scale];
    this.request();
  }

  /** Zooms so that what is at that pixel stays there. */
  private zoomAt(x: number, y: number, factor: number): void {
    const { clientWidth, clientHeight } = this.host;
    const before = this.scale;
    this.scale = Math.min(largestScale, before * factor);
    const shift = 1 / before - 1 / this.scale;
    this.center = [this.center[0] + (x - clientWidth / 2) * shift, this.center[1] - (y - clientHeight / 2) * shift];
    this.request();
  }

  private turnWheel(event: WheelEvent): void {
    event.preventDefault();
    this.zoomAt(event.offsetX, event.offsetY, zoomStep ** (-event.deltaY / 100));
  }

  private touch(event: PointerEvent): void {
    this.host.setPointerCapture(event.pointerId);
    this.fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
  }

  private drag(event: PointerEvent): void {
    const before = this.fingers.get(event.pointerId);
    if (before === undefined) return;
    const now: Point = [event.offsetX, event.offsetY];
    const other = [...this.fingers].find(([id]) => id !== event.pointerId)?.[1];
    if (other !== undefined) {
      const factor =
        Math.hypot(now[0] - other[0], now[1] - other[1]) / Math.hypot(before[0] - other[0], before[1] - other[1]);
      if (Number.isFinite(factor) && factor > 0) this.zoomAt(other[0], other[1], factor);
    } else {
      this.moveBy(now[0] - before[0], now[1] - before[1]);
    }
    this.fingers.set(event.pointerId, now);
  }

  private press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { clientWidth, clientHeight } = this.host;
    const actions: Record<string, () => void> = {
      ArrowLeft: () => this.moveBy(moveStep, 0),
      ArrowRight: () => this.moveBy(-moveStep, 0),
      ArrowUp: () => this.moveBy(0, moveStep),
      ArrowDown: () => this.moveBy(0, -moveStep),
      '+': () => this.zoomAt(clientWidth / 2, clientHeight / 2, zoomStep),
      '=': () => this.zoomAt(clientWidth / 2, clientHeight / 2, zoomStep),
      '-': () => this.zoomAt(clientWidth / 2, clientHeight / 2, 1 / zoomStep),
      '0': () => this.lookAt(this.wanted.center, this.wanted.radius),
    };
    const action = actions[event.key];
    if (action === undefined) return;
    action();
    event.preventDefault();
  }
}
