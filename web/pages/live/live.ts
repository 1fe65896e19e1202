// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Frame by frame: moves the sheet, asks the engine, shows what it says. */

import { byId } from '../shared/dom.ts';
import { shown } from '../shared/numbers.ts';
import type { Body } from './body.ts';
import { hareBody, bodyOf } from './body.ts';
import { Controls } from './controls.ts';
import { Engine } from './engine.ts';
import type { Answers } from './engine.ts';
import { Hands } from './hands.ts';
import { commandFor, plyOf } from './moment.ts';
import { Panel } from './panel.ts';
import { Scenery } from './scenery.ts';
import { View } from './view.ts';

const stepSeconds = 1 / 60;
const textInterval = 120; // milliseconds from one writing of the numbers to the next, so that they can be read

export class Live {
  private readonly scenery: Scenery;
  private readonly engine: Engine;
  private readonly view: View;
  private readonly panel = new Panel();
  private readonly controls: Controls;
  private isPaused = false;
  private isAwake = false;
  private lastFrame: number | undefined;
  private lastText = -Infinity;
  private answers: Answers;
  private label = '';
  private isSheetNew = false;

  constructor(body: Body) {
    const isCalm = matchMedia('(prefers-reduced-motion: reduce)').matches;
    this.scenery = new Scenery(body, isCalm, () => this.wake());
    const { sheet } = this.scenery;
    this.engine = new Engine(sheet, body.mesh);
    this.view = new View(byId('view'), { vertices: sheet.positions, faces: sheet.faces });
    this.view.setBody(body.mesh);
    this.controls = new Controls({
      pause: () => this.pause(!this.isPaused),
      step: () => this.step(),
      reset: () => this.scenery.reset(),
      pluck: () => this.pluck(),
      look: (side) => this.view.lookFrom(side),
      load: (file) => void this.load(file),
      hare: () => this.replaceBody(hareBody()),
      ask: () => this.wake(),
      keep: () => this.keepMoment(),
    });
    new Hands(this.view, this.scenery, () => this.controls.isTurning);
    this.answers = this.ask();
    if (!isCalm) this.scenery.pluck();
    this.frame();
    performance.mark('limber-first-frame');
  }

  /** Frames follow one another until nothing moves. */
  private wake(): void {
    if (this.isAwake) return;
    this.isAwake = true;
    requestAnimationFrame(() => this.frame());
  }

  private frame(): void {
    this.isAwake = false;
    const now = performance.now(); // late frames may be called with the time of the one before
    const interval = this.lastFrame === undefined ? undefined : now - this.lastFrame;
    if (!this.isPaused) this.scenery.advance((interval ?? stepSeconds * 1000) / 1000);
    const moved = performance.now();
    this.answers = this.ask();
    const goesOn = !this.isPaused && !this.scenery.isResting;
    // Numbers are written now and then while things move, and always when they have come to rest.
    const isTime = !goesOn || now - this.lastText >= textInterval;
    if (isTime) this.writeAnswers(now);
    const drawn = this.draw();
    const { times } = this.answers;
    const engine = times.update + times.distance + (times.contacts ?? 0) + (times.selfContacts ?? 0);
    this.panel.addTimes({ ...times, engine, sheet: moved - now, drawing: drawn }, now);
    if (interval !== undefined) this.panel.addTimes({ frame: interval }, now);
    if (isTime) this.panel.showTimes(goesOn);
    this.lastFrame = goesOn ? now : undefined;
    if (goesOn) this.wake();
  }

  private ask(): Answers {
    const { scenery } = this;
    const moved = scenery.sheetHasMoved ? scenery.sheet.positions : undefined;
    scenery.sheetHasMoved = false;
    this.isSheetNew ||= moved !== undefined;
    return this.engine.ask(moved, scenery.pose, this.controls.questions);
  }

  /** Returns the milliseconds that the page has spent on it. */
  private draw(): number {
    const started = performance.now();
    if (this.isSheetNew) this.view.moveSheet(this.scenery.sheet.positions);
    this.isSheetNew = false;
    this.view.moveBody(this.scenery.pose);
    this.view.show(this.answers, this.label);
    this.showTree();
    this.view.draw();
    return performance.now() - started;
  }

  private showTree(): void {
    const { tree } = this.controls;
    const model = tree === 'sheet' ? this.engine.sheet : this.engine.body;
    if (tree === '') return this.view.showSpheres(new Float64Array(), undefined);
    const level = this.controls.levelBelow(model.treeStats().levels);
    const spheres = model.nodeSpheres(level);
    this.controls.showLevel(spheres.length / 4);
    this.view.showSpheres(spheres, tree === 'sheet' ? undefined : this.scenery.pose);
  }

  private writeAnswers(now: number): void {
    const { lower, upper } = this.answers.distance;
    this.lastText = now;
    this.label = lower === upper ? shown(upper, 3) : `\u2264 ${shown(upper, 3)}`;
    this.panel.showAnswers(this.answers);
  }

  private pause(isPaused: boolean): void {
    this.isPaused = isPaused;
    this.lastFrame = undefined;
    this.controls.showPaused(isPaused);
    this.wake();
  }

  private step(): void {
    this.pause(true);
    this.scenery.advance(stepSeconds);
    this.wake();
  }

  private pluck(): void {
    if (this.isPaused) this.pause(false);
    this.scenery.pluck();
  }

  private async load(file: File): Promise<void> {
    try {
      this.replaceBody(await bodyOf(file));
    } catch (error) {
      const text = error instanceof Error ? error.message : String(error);
      this.controls.showFailure(`${text}. The scene is as it was.`);
    }
  }

  private replaceBody(body: Body): void {
    this.engine.replaceBody(body.mesh);
    this.view.setBody(body.mesh);
    this.scenery.setBody(body);
    this.controls.showBody(body);
  }

  private keepMoment(): void {
    this.pause(true);
    const { sheet, body, pose } = this.scenery;
    this.engine.forgetHistory(sheet);
    this.isSheetNew = true;
    this.scenery.sheetHasMoved = false;
    const sheetMesh = { vertices: sheet.positions, faces: sheet.faces };
    const command = commandFor(pose, this.controls.questions.relativeError);
    this.controls.showMoment({ 'sheet.ply': plyOf(sheetMesh), 'body.ply': plyOf(body.mesh) }, command);
  }
}
