// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The live page: a sheet that swings, a body over it, and what the engine says of them in each frame. */

import { init } from '../../limber3d/index.js';
import { bytesOf } from '../shared/decode.ts';
import { byId } from '../shared/dom.ts';
import { shown } from '../shared/numbers.ts';
import { bodyOf, hareBody } from './body.ts';
import type { Body, BodyPose } from './body.ts';
import { Controls } from './controls.ts';
import { Engine } from './engine.ts';
import type { Answers } from './engine.ts';
import { Hands } from './hands.ts';
import type { TriangleMesh } from './hare.ts';
import { Panel } from './panel.ts';
import { Scenery } from './scenery.ts';
import { View } from './view.ts';

const stepSeconds = 1 / 60;
const textInterval = 120; // milliseconds from one writing of the numbers to the next, so that they can be read

class Live {
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
    this.view = new View({ vertices: sheet.positions, faces: sheet.faces }, body.mesh);
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
    const goesOn = !this.isPaused && !this.scenery.sheet.isResting;
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
    this.view.viewer.draw();
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

/** A mesh as a file that other programs read: binary PLY with coordinates of float64, so no digit is lost. */
function plyOf({ vertices, faces }: TriangleMesh): Blob {
  const header = [
    'ply',
    'format binary_little_endian 1.0',
    `element vertex ${vertices.length / 3}`,
    ...['x', 'y', 'z'].map((axis) => `property double ${axis}`),
    `element face ${faces.length / 3}`,
    'property list uchar uint vertex_indices',
    'end_header\n',
  ].join('\n');
  const points = new DataView(new ArrayBuffer(8 * vertices.length));
  vertices.forEach((c, i) => points.setFloat64(8 * i, c, true));
  const corners = new DataView(new ArrayBuffer((13 * faces.length) / 3));
  faces.forEach((vertex, i) => {
    const face = 13 * Math.floor(i / 3);
    corners.setUint8(face, 3);
    corners.setUint32(face + 1 + 4 * (i % 3), vertex, true);
  });
  return new Blob([header, points, corners], { type: 'application/octet-stream' });
}

/** What asks the native engine for the same distance. */
function commandFor({ translation, quaternion: { x, y, z, w } }: BodyPose, relativeError: number): string {
  const error = relativeError > 0 ? ` --relative-error ${relativeError}` : '';
  return `limber distance sheet.ply body.ply --pose-b=${[...translation, w, x, y, z].join(',')}${error}`;
}

async function start(): Promise<void> {
  const packed = new Blob([bytesOf(byId('engine-module').textContent ?? '') as BlobPart]);
  const unpacked = packed.stream().pipeThrough(new DecompressionStream('gzip'));
  await init(await new Response(unpacked).arrayBuffer());
  new Live(hareBody());
}

start().catch((error: unknown) => {
  const failure = byId('failure');
  failure.textContent = `The page cannot start in this browser: ${String(error)}`;
  failure.hidden = false;
});
