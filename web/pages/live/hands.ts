// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Mouse, fingers and keys on the view: they pull the sheet, and move and turn the body. */

import { Vector3 } from 'three';
import type { Scenery } from './scenery.ts';
import type { View } from './view.ts';

const radiansPerPixel = 0.009;
const keyStep = 0.03;
const keyAngle = Math.PI / 36;

/** To the right, up, and away. */
const steps: Record<string, readonly [number, number, number]> = {
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, 1, 0],
  ArrowDown: [0, -1, 0],
  PageUp: [0, 0, 1],
  PageDown: [0, 0, -1],
};

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
    const { host } = view.viewer;
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
    this.view.viewer.host.setPointerCapture(event.pointerId);
  }

  private dragAt(event: PointerEvent): Drag | undefined {
    const { sheet } = this.scenery;
    const hit = this.view.hit(event);
    const start = { pointer: event.pointerId, last: [event.clientX, event.clientY] as [number, number], end() {} };
    if (hit === 'body') {
      const isTurning = this.isTurning() !== (event.shiftKey || event.button === 2);
      return { ...start, by: (dx, dy) => (isTurning ? this.turn(dx, dy) : this.shift(this.view.across(dx, dy))) };
    }
    if (hit === undefined || event.button !== 0) return undefined;
    sheet.hold(hit);
    const pulled = new Vector3();
    this.scenery.pull(pulled);
    const by = (dx: number, dy: number): void => this.scenery.pull(pulled.add(this.view.across(dx, dy)));
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
    const step = steps[event.key];
    if (step === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    const { right, up, away } = this.view.viewer.axes;
    const [x, y, z] = step;
    if (this.isTurning() !== event.shiftKey) {
      this.scenery.turn(z !== 0 ? away : y !== 0 ? right : up, keyAngle * (x - y + z));
    } else {
      this.shift(right.multiplyScalar(x).addScaledVector(up, y).addScaledVector(away, z).multiplyScalar(keyStep));
    }
  }

  private shift(by: Vector3): void {
    const { translation, quaternion } = this.scenery.pose;
    this.scenery.place({ translation: translation.clone().add(by), quaternion });
  }

  private turn(dx: number, dy: number): void {
    const { right, up } = this.view.viewer.axes;
    this.scenery.turn(up, dx * radiansPerPixel);
    this.scenery.turn(right, dy * radiansPerPixel);
  }
}
