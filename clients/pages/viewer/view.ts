// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The models of a row in 3D, with their names, what hides them, the path of one that moves, and where to look from. */

import { Box3, Matrix4, Vector3 } from 'three';
import { increasingIdsOf } from '../shared/decode.ts';
import { byId, onThemeChange } from '../shared/dom.ts';
import { Marks } from '../shared/marks.ts';
import { withUnit } from '../shared/numbers.ts';
import { Surface } from '../shared/surface.ts';
import { Viewer, frameOf, upY, upZ, usualUp } from '../shared/viewer.ts';
import { meetsIn } from './data.ts';
import type { Data } from './data.ts';
import type { Part } from './models.ts';
import { captionOf, shownBounds } from './texts.ts';

const otherOpacity = 0.1; // of parts that are not asked about
const clearOpacity = 0.3; // of what is seen through to see another
const smallestRadius = 2e-4; // of what the closest points are looked at with
const mostPathPoints = 1000;
const sizesAround = 3; // of the model, in the view that follows it

/** Where the buttons look from where y is up; "whole" shows three sides. */
const sides = { whole: [0.55, 0.62, 0.75], top: [0, 1, 1e-4], front: [0, 0, 1], side: [1, 0, 0] } as const;

export class View {
  private readonly data: Data;
  private readonly parts: readonly Part[];
  private readonly viewer: Viewer;
  private readonly marks: Marks;
  private readonly surfaces = [new Surface(), new Surface()] as const; // A and B
  private readonly others: readonly Surface[]; // by part, where they stand together
  private readonly whole: Matrix4; // the frame of all parts
  private readonly names = (['A', 'B'] as const).map((name, i) => ({
    name,
    at: new Vector3(),
    isShown: () => this.surfaces[i].object.visible,
  }));
  // Of the row that is shown: how the world is drawn, and what is drawn of it.
  private row = 0;
  private frame: Matrix4;
  private pair: readonly Part[] = [];
  private boxes: readonly Box3[] = [];
  private closest = { center: new Vector3(), radius: 0.5 };

  /** Shows the row `first`. */
  constructor(data: Data, parts: readonly Part[], first: number) {
    this.data = data;
    this.parts = parts;
    this.viewer = new Viewer(byId('view'), usualUp(data.models.map(({ name }) => name)));
    this.marks = new Marks(this.viewer);
    byId('view').setAttribute('aria-label', `Both models in 3D: ${document.title}`);
    this.whole = frameOf(parts.reduce((all, { bounds }) => all.union(bounds), new Box3()));
    this.frame = this.whole;
    this.others = data.kind === 'parts' ? parts.map(() => new Surface()) : [];
    this.others.forEach((other, part) => {
      other.show(parts[part].model.geometry, this.placed(parts[part]));
      other.setOpacity(otherOpacity);
    });
    this.viewer.add(...[...this.surfaces, ...this.others].map(({ object }) => object));
    this.show(first);
    this.marks.show({ names: this.names });
    this.recolor();
    onThemeChange(() => this.recolor());
    this.connectDirections();
    for (const id of ['show-a', 'show-b', 'show-others', 'see-through']) {
      document.getElementById(id)?.addEventListener('change', () => this.showSurfaces());
    }
    if (data.kind === 'frames') this.connectTraveller();
  }

  /** Shows another row; of pairs, from the same side as the one before. */
  show(row: number): void {
    const { rows, kind } = this.data;
    const isAgain = this.pair.length > 0;
    this.row = row;
    this.pair = [rows.a[row], rows.b[row]].map((part) => this.parts[part]);
    const bounds = this.pair.map((part) => part.bounds);
    // Poses of a list may be far apart: each has a frame of its own, in which float32 resolves it.
    this.frame = kind === 'pairs' ? frameOf(bounds[0].clone().union(bounds[1])) : this.whole;
    this.boxes = bounds.map((box) => box.clone().applyMatrix4(this.frame));
    this.pair.forEach((part, side) => {
      part.model.moveTo(this.shownFrame);
      this.surfaces[side].show(part.model.geometry, this.placed(part));
      const met = rows.intersecting?.[row]?.[side];
      this.surfaces[side].mark(increasingIdsOf(met ?? ''));
    });
    if (kind !== 'frames') this.box('see-through').checked = meetsIn(this.data, row);
    this.showSurfaces();
    this.showRelief();
    this.showMarks();
    if (isAgain && kind !== 'frames') this.viewer.lookAtBoxes(this.boxes, this.viewer.from);
    if (kind === 'frames' && this.box('follow').checked) this.viewer.moveTo(this.travellerAt(this.shownFrame));
  }

  /** The number of the frame among those that the page has. */
  private get shownFrame(): number {
    return (this.row % this.data.frame_count) / this.data.stride;
  }

  private box = (id: string): HTMLInputElement => byId<HTMLInputElement>(id);

  private placed = (part: Part): Matrix4 => this.frame.clone().multiply(part.placeAt(this.shownFrame));

  private recolor(): void {
    this.surfaces.forEach((surface, i) => surface.setColors(`model-${'ab'[i]}`, 'hit'));
    for (const other of this.others) other.setColors('edge', 'hit');
    this.viewer.request();
  }

  /** Where models meet, each hides the other; what encloses the other is seen through anyhow. */
  private showSurfaces(): void {
    const { solids, inside } = this.data.rows;
    const isOn = (id: string): boolean => document.querySelector<HTMLInputElement>(`#${id}`)?.checked === true;
    this.surfaces.forEach((surface, side) => {
      const encloses = side === 0 ? 'b_inside_a' : 'a_inside_b';
      const isAround = solids?.[this.row] === encloses || inside?.[this.row] === encloses;
      surface.setOpacity(isOn('see-through') || isAround ? clearOpacity : 1);
      surface.object.visible = isOn(`show-${'ab'[side]}`);
    });
    this.others.forEach(({ object }, part) => {
      object.visible = isOn('show-others') && !this.pair.includes(this.parts[part]);
    });
    this.viewer.request();
  }

  /** Makes what is high of a deforming mesh lighter than what is low, and places names at the highest points. */
  private showRelief(): void {
    const { up } = this.viewer;
    this.pair.forEach(({ model }, i) => {
      const { min, max } = this.boxes[i];
      if (model.deforms) this.surfaces[i].shadeByHeight(up, up.dot(min), up.dot(max));
      this.names[i].at.copy(this.surfaces[i].farthestAlong(up));
    });
  }

  private showMarks(): void {
    const { rows } = this.data;
    const meets = meetsIn(this.data, this.row);
    const witness = rows.witness[this.row];
    byId('closest').hidden = witness === null;
    byId('closest').textContent = meets ? 'Shared point' : 'Closest points';
    byId('view-caption').textContent = captionOf(this.data, this.row);
    if (witness === null) return this.marks.show({ segment: undefined });
    const [a, b] = [0, 3].map((at) => new Vector3().fromArray(witness, at).applyMatrix4(this.frame));
    const size = this.boxes[0].clone().union(this.boxes[1]).getSize(new Vector3()).length();
    const near = Math.max(smallestRadius, Math.min(0.6 * size, 2.5 * a.distanceTo(b)));
    this.closest = { center: a.clone().lerp(b, 0.5), radius: meets ? 0.1 * size : near };
    const label = meets ? 'shared point' : withUnit(shownBounds(rows.lower[this.row], rows.upper[this.row]));
    this.marks.show({ segment: { a, b: meets ? a : b, label } });
  }

  /** Looks at all that may be shown from a direction that a button names. */
  private lookFrom(side: keyof typeof sides): void {
    const [x, y, z] = sides[side];
    this.viewer.lookAtBoxes(this.boxes, this.viewer.up.z === 1 ? new Vector3(x, -z, y) : new Vector3(x, y, z));
  }

  /** The buttons that say where to look from, and the choice of what is up. Starts by showing all. */
  private connectDirections(): void {
    for (const side of Object.keys(sides) as (keyof typeof sides)[]) {
      byId(side).addEventListener('click', () => this.lookFrom(side));
    }
    byId('closest').addEventListener('click', () => this.viewer.lookAt(this.closest.center, this.closest.radius));
    const choice = byId<HTMLSelectElement>('up');
    choice.value = this.viewer.up.z === 1 ? 'z' : 'y';
    choice.addEventListener('change', () => {
      this.viewer.setUp(choice.value === 'z' ? upZ : upY);
      this.showRelief();
      this.lookFrom('whole');
    });
    this.lookFrom('whole');
  }

  // --- the model that moves as a whole ---

  /** Of both, B where it moves. */
  private get traveller(): number {
    return this.pair[1].moves ? 1 : 0;
  }

  private travellerAt = (frame: number): Vector3 => this.pair[this.traveller].centerAt(frame).applyMatrix4(this.frame);

  /** Connects the controls of path and follower; hides them where no model moves. */
  private connectTraveller(): void {
    const { frame_count, stride } = this.data;
    const part = this.pair[this.traveller];
    const [name, follow, showPath] = ['AB'[this.traveller], this.box('follow'), this.box('show-path')];
    for (const id of ['follow-label', 'path-label']) byId(id).hidden = !part.moves;
    if (!part.moves) return;
    byId('follow-text').textContent = `Follow ${name}`;
    byId('path-caption').textContent = `The line is the path of ${name}, with dots where the models touch.`;
    const count = Math.ceil(frame_count / stride);
    const step = Math.ceil(count / mostPathPoints);
    const shown = Array.from({ length: Math.ceil(count / step) }, (_, i) => i * step);
    const dots = shown.filter((frame) => meetsIn(this.data, frame * stride)).map(this.travellerAt);
    const path = { points: shown.map(this.travellerAt), dots };
    this.marks.show({ path });
    showPath.addEventListener('change', () => this.marks.show({ path: showPath.checked ? path : undefined }));
    const stop = (): boolean => (follow.checked = false);
    for (const id of [...Object.keys(sides), 'closest']) byId(id).addEventListener('click', stop);
    byId('up').addEventListener('change', stop);
    follow.addEventListener('change', () => {
      if (!follow.checked) return this.lookFrom('whole');
      const radius = ((sizesAround * part.model.size) / 2) * this.frame.getMaxScaleOnAxis();
      this.viewer.lookAt(this.travellerAt(this.shownFrame), radius);
    });
  }
}
