// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Sheet and body as they are now. */

import { Quaternion, Vector3 } from 'three';
import type { Body, BodyPose } from './body.ts';
import { Sheet } from './sheet.ts';

const lowest = new Vector3(-1.4, -1, -1.4);
const highest = new Vector3(1.4, 1.6, 1.4);
const pluckSeconds = 0.55;
const pluckHeight = 0.34;
const plucked = [50 * 101 + 50, 36 * 101 + 60, 62 * 101 + 38, 58 * 101 + 64]; // vertices, one after the other

export class Scenery {
  readonly sheet: Sheet;
  body: Body;
  pose: BodyPose;
  sheetHasMoved = true;
  private readonly wake: () => void;
  private pluckTime: number | undefined;
  private pluckCount = 0;

  /** `wake` is called when something has begun to move. */
  constructor(body: Body, isCalm: boolean, wake: () => void) {
    this.sheet = new Sheet(isCalm);
    this.body = body;
    this.pose = body.start;
    this.wake = wake;
  }

  advance(seconds: number): void {
    if (this.sheet.isResting) return;
    if (this.pluckTime !== undefined) this.keepPlucking((this.pluckTime += seconds));
    this.sheet.advance(seconds);
    this.sheetHasMoved = true;
  }

  reset(): void {
    this.pluckTime = undefined;
    this.sheet.reset();
    this.sheetHasMoved = true;
    this.place(this.body.start);
  }

  setBody(body: Body): void {
    this.body = body;
    this.place(body.start);
  }

  /** Places the body, no farther away than the picture shows. */
  place({ translation, quaternion }: BodyPose): void {
    this.pose = { translation: translation.clone().clamp(lowest, highest), quaternion };
    this.wake();
  }

  /** Turns the body about an axis of the world, of length 1, through its origin. */
  turn(axis: Vector3, angle: number): void {
    const quaternion = new Quaternion().setFromAxisAngle(axis, angle).multiply(this.pose.quaternion).normalize();
    this.place({ ...this.pose, quaternion });
  }

  /** Pulls what the sheet is held by. */
  pull(shift: Vector3): void {
    this.pluckTime = undefined;
    this.sheet.pull(shift);
    this.wake();
  }

  /** Pulls the sheet up at some place, and lets it go. */
  pluck(): void {
    if (this.sheet.isHeld) return;
    this.sheet.hold(plucked[this.pluckCount++ % plucked.length]);
    this.pluckTime = 0;
    this.wake();
  }

  private keepPlucking(time: number): void {
    if (time >= pluckSeconds) {
      this.pluckTime = undefined;
      this.sheet.release();
    } else {
      this.sheet.pull(new Vector3(0, pluckHeight * Math.sin((Math.PI / 2) * (time / pluckSeconds)) ** 2, 0));
    }
  }
}
