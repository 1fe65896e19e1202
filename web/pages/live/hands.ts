// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Mouse, fingers and keys on the view: they pull the sheet, and move and turn the body. */

import { add, dot, scale } from '../shared/vectors.ts';
import type { Vec3 } from '../shared/vectors.ts';
import { directionInBody, firstHit, inBody, turned } from './pose.ts';
import type { Scenery } from './scenery.ts';
import type { View } from './view.ts';

const radiansPerPixel = 0.009;
const keyStep = 0.03;
const keyAngle = Math.PI / 36;

interface Drag {
  pointer: number;
  last: [number, number];
  by(dx: number, dy: number): void;
  end(): void;
}

export class Hands {
  private readonly view: View;
  private readonly scenery: Scenery;
  private readonly isTurning: () => boolean;
  private drag: Drag | undefined;

  /** `isTurning` tells whether drags and arrows turn the body; otherwise they move it. */
  constructor(view: View, scenery: Scenery, isTurning: () => boolean) {
    this.view = view;
    this.scenery = scenery;
    this.isTurning = isTurning;
    // In the capturing phase: what the hands hold does not reach the view, which would turn.
    const { host } = view;
    host.addEventListener('pointerdown', (event) => this.grasp(event), true);
    host.addEventListener('pointermove', (event) => this.move(event), true);
    for (const type of ['pointerup', 'pointercancel'] as const) {
      host.addEventListener(type, (event) => this.let(event), true);
    }
    host.addEventListener('keydown', (event) => this.press(event), true);
  }

  private grasp(event: PointerEvent): void {
    if (this.drag !== undefined) return event.stopPropagation(); // a second finger
    const drag = this.dragAt(event);
    if (drag === undefined) return;
    event.stopPropagation();
    this.drag = drag;
    this.view.host.setPointerCapture(event.pointerId);
  }

  private dragAt(event: PointerEvent): Drag | undefined {
    const { from, along } = this.view.ray(event.clientX, event.clientY);
    const { sheet, body, pose } = this.scenery;
    const onSheet = firstHit(sheet.positions, sheet.faces, from, along);
    const inside = [inBody(pose, from), directionInBody(pose, along)] as const;
    const onBody = firstHit(body.mesh.vertices, body.mesh.faces, ...inside);
    const start = { pointer: event.pointerId, last: [event.clientX, event.clientY] as [number, number], end() {} };
    if (onBody !== undefined && (onSheet === undefined || onBody.far < onSheet.far)) {
      const isTurning = this.isTurning() !== (event.shiftKey || event.button === 2);
      return { ...start, by: (dx, dy) => (isTurning ? this.turn(dx, dy, radiansPerPixel) : this.shift(dx, dy)) };
    }
    if (onSheet === undefined || event.button !== 0) return undefined;
    sheet.hold(nearestCorner(sheet, onSheet.triangle, add(from, scale(along, onSheet.far))));
    let pulled: Vec3 = [0, 0, 0];
    const by = (dx: number, dy: number): void => {
      pulled = add(pulled, this.across(dx, dy));
      this.scenery.pull(pulled);
    };
    this.scenery.pull(pulled);
    return { ...start, by, end: () => sheet.release() };
  }

  private move(event: PointerEvent): void {
    const { drag } = this;
    if (drag === undefined) return;
    event.stopPropagation();
    if (event.pointerId !== drag.pointer) return;
    const [x, y] = drag.last;
    drag.last = [event.clientX, event.clientY];
    drag.by(event.clientX - x, event.clientY - y);
  }

  private let(event: PointerEvent): void {
    if (this.drag?.pointer !== event.pointerId) return;
    event.stopPropagation();
    this.drag.end();
    this.drag = undefined;
  }

  private press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const steps: Record<string, Vec3> = {
      ArrowLeft: [-1, 0, 0],
      ArrowRight: [1, 0, 0],
      ArrowUp: [0, 1, 0],
      ArrowDown: [0, -1, 0],
      PageUp: [0, 0, 1],
      PageDown: [0, 0, -1],
    };
    const step = steps[event.key];
    if (step === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    const { right, up, away } = this.view.axes;
    if (this.isTurning() !== event.shiftKey) {
      const axis = step[2] !== 0 ? away : step[1] !== 0 ? right : up;
      this.scenery.place(turned(this.scenery.pose, axis, keyAngle * (step[0] - step[1] + step[2])));
    } else {
      const by = add(add(scale(right, step[0]), scale(up, step[1])), scale(away, step[2]));
      this.moveBody(scale(by, keyStep));
    }
  }

  /** A shift of the picture by pixels, in the world. */
  private across(dx: number, dy: number): Vec3 {
    const { right, up, pixel } = this.view.axes;
    return add(scale(right, dx * pixel), scale(up, -dy * pixel));
  }

  private shift(dx: number, dy: number): void {
    this.moveBody(this.across(dx, dy));
  }

  private moveBody(by: Vec3): void {
    const { pose } = this.scenery;
    this.scenery.place({ ...pose, translation: add(pose.translation, by) });
  }

  private turn(dx: number, dy: number, angle: number): void {
    const { right, up } = this.view.axes;
    this.scenery.place(turned(turned(this.scenery.pose, up, dx * angle), right, dy * angle));
  }
}

function nearestCorner(
  { positions, faces }: { positions: Float64Array; faces: Uint32Array },
  triangle: number,
  p: Vec3,
): number {
  let best = 0;
  let least = Infinity;
  for (const vertex of faces.subarray(3 * triangle, 3 * triangle + 3)) {
    const off = [0, 1, 2].map((i) => positions[3 * vertex + i] - p[i]) as unknown as Vec3;
    if (dot(off, off) < least) [best, least] = [vertex, dot(off, off)];
  }
  return best;
}
