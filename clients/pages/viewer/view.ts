// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/**
 * The models of a row in 3D. View.show() draws them, and marks their names and closest points above; buttons say where
 * to look from, boxes what is shown. Of frames, a model that moves as a whole has a path, and the view may follow it.
 * The view has its own coordinates, in which all that it can show has size 1.
 */

import { Box3, Matrix4, Vector3 } from 'three';
import { increasingIdsOf } from '../shared/decode.ts';
import { byId, onThemeChange } from '../shared/dom.ts';
import { Marks } from '../shared/marks.ts';
import { withUnit } from '../shared/numbers.ts';
import { Surface } from '../shared/surface.ts';
import { Viewer, frameOf, upY, upZ, usualUp } from '../shared/viewer.ts';
import { meetsIn, stretchesThatMeet } from './data.ts';
import type { Data } from './data.ts';
import type { Part } from './models.ts';
import { captionOf, shownBounds } from './texts.ts';

// How things look, and from how near, is a matter of taste: no answer depends on it.
const otherOpacity = 0.1; // of parts that are not asked about
const clearOpacity = 0.3; // of what is seen through to see another
// The closest points are looked at in a sphere of this radius: by their distance, by the size of both boxes, and
// by that size where the models meet.
const closeUp = { smallest: 2e-4, ofDistance: 2.5, mostOfBoxes: 0.6, ofBoxesThatMeet: 0.1 };
const followedSizes = 3; // a view that follows a model shows so many of its sizes across
const mostPathPoints = 1000; // more would be closer than a screen can show

/** From where the buttons look, where y is up; "whole" shows three sides. */
const directions = { whole: [0.55, 0.62, 0.75], top: [0, 1, 1e-4], front: [0, 0, 1], side: [1, 0, 0] } as const;

export class View {
  private readonly data: Data;
  private readonly parts: readonly Part[];
  private readonly viewer: Viewer;
  private readonly marks: Marks;
  private readonly surfaces = [new Surface(), new Surface()] as const;
  private readonly others: readonly Surface[]; // by part, where they stand together
  private readonly viewFromWorldOfAll: Matrix4; // all parts fit into it
  private readonly names = (['A', 'B'] as const).map((name, ab) => ({
    name,
    at: new Vector3(),
    isShown: () => this.surfaces[ab].object.visible,
  }));
  // Of the row that is shown:
  private row = 0;
  private viewFromWorld: Matrix4;
  private pair: readonly Part[] = []; // A and B of the row. So are all lists of two, which `ab` indexes.
  private boxes: readonly Box3[] = []; // of both in all frames, in the view's coordinates
  private closest = { center: new Vector3(), radius: 0.5 };

  /** Shows the row `first`. */
  constructor(data: Data, parts: readonly Part[], first: number) {
    this.data = data;
    this.parts = parts;
    this.viewer = new Viewer(byId('view'), usualUp(data.models.map(({ name }) => name)));
    this.marks = new Marks(this.viewer);
    byId('view').setAttribute('aria-label', `Both models in 3D: ${document.title}`);
    this.viewFromWorldOfAll = frameOf(parts.reduce((all, { bounds }) => all.union(bounds), new Box3()));
    this.viewFromWorld = this.viewFromWorldOfAll;
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

  /** Shows another row; of pairs, from the direction of the one before. Pre: of frames, the page has the row's one. */
  show(row: number): void {
    const { rows, kind } = this.data;
    const isAgain = this.pair.length > 0;
    this.row = row;
    this.pair = [rows.a[row], rows.b[row]].map((part) => this.parts[part]);
    const bounds = this.pair.map((part) => part.bounds);
    // Poses of a list may be far apart: each row has coordinates of its own, in which float32 resolves it.
    this.viewFromWorld = kind === 'pairs' ? frameOf(bounds[0].clone().union(bounds[1])) : this.viewFromWorldOfAll;
    this.boxes = bounds.map((box) => box.clone().applyMatrix4(this.viewFromWorld));
    this.pair.forEach((part, ab) => {
      part.model.moveTo(this.keptFrame);
      this.surfaces[ab].show(part.model.geometry, this.placed(part));
      this.surfaces[ab].mark(increasingIdsOf(rows.intersecting?.[row]?.[ab] ?? ''));
    });
    // Where models meet, each hides the other: a row starts with what shows most, and a reader may change that.
    if (kind !== 'frames') this.box('see-through').checked = meetsIn(this.data, row);
    this.showSurfaces();
    this.showRelief();
    this.showMarks();
    if (isAgain && kind !== 'frames') this.viewer.lookAtBoxes(this.boxes, this.viewer.from);
    if (kind === 'frames' && this.box('follow').checked) this.viewer.moveTo(this.travellerAt(this.keptFrame));
  }

  /**
   * Of frames, rows are those of one playing after the other; the page has the geometry of every `stride`-th frame of a
   * playing, and this is the number of the row's frame among these. 0 of pairs.
   */
  private get keptFrame(): number {
    return (this.row % this.data.frame_count) / this.data.stride;
  }

  private box = (id: string): HTMLInputElement => byId<HTMLInputElement>(id);

  private placed = (part: Part): Matrix4 => this.viewFromWorld.clone().multiply(part.placeAt(this.keptFrame));

  private recolor(): void {
    this.surfaces.forEach((surface, ab) => surface.setColors(`model-${'ab'[ab]}`, 'hit'));
    for (const other of this.others) other.setColors('edge', 'hit');
    this.viewer.request();
  }

  /** Shows and hides surfaces as the boxes say. A model is seen through where they say so, or it encloses the other. */
  private showSurfaces(): void {
    const { solids, inside } = this.data.rows;
    const isOn = (id: string): boolean => document.querySelector<HTMLInputElement>(`#${id}`)?.checked === true;
    this.surfaces.forEach((surface, ab) => {
      const encloses = ab === 0 ? 'b_inside_a' : 'a_inside_b';
      const isAround = solids?.[this.row] === encloses || inside?.[this.row] === encloses;
      surface.setOpacity(isOn('see-through') || isAround ? clearOpacity : 1);
      surface.object.visible = isOn(`show-${'ab'[ab]}`);
    });
    this.others.forEach(({ object }, part) => {
      object.visible = isOn('show-others') && !this.pair.includes(this.parts[part]);
    });
    this.viewer.request();
  }

  /** Makes what is high of a deforming mesh lighter than what is low, and places names at the highest points. */
  private showRelief(): void {
    const { up } = this.viewer;
    this.pair.forEach(({ model }, ab) => {
      const { min, max } = this.boxes[ab];
      if (model.deforms) this.surfaces[ab].shadeByHeight(up, up.dot(min), up.dot(max));
      this.names[ab].at.copy(this.surfaces[ab].farthestAlong(up));
    });
  }

  /** Marks the closest points, or the shared one, if the row has any; tells the button and the caption about them. */
  private showMarks(): void {
    const { rows } = this.data;
    const meets = meetsIn(this.data, this.row);
    const witness = rows.witness[this.row];
    byId('closest').hidden = witness === null;
    byId('closest').textContent = meets ? 'Shared point' : 'Closest points';
    byId('view-caption').textContent = captionOf(this.data, this.row);
    if (witness === null) return this.marks.show({ segment: undefined });
    const [a, b] = [0, 3].map((at) => new Vector3().fromArray(witness, at).applyMatrix4(this.viewFromWorld));
    const size = this.boxes[0].clone().union(this.boxes[1]).getSize(new Vector3()).length();
    const near = Math.min(closeUp.mostOfBoxes * size, closeUp.ofDistance * a.distanceTo(b));
    const radius = meets ? closeUp.ofBoxesThatMeet * size : Math.max(closeUp.smallest, near);
    this.closest = { center: a.clone().lerp(b, 0.5), radius };
    const label = meets ? 'shared point' : withUnit(shownBounds(rows.lower[this.row], rows.upper[this.row]));
    this.marks.show({ segment: { a, b: meets ? a : b, label } });
  }

  /** Looks at both models, wherever they are in any frame, from where a button says. */
  private lookFrom([x, y, z]: readonly [number, number, number]): void {
    this.viewer.lookAtBoxes(this.boxes, this.viewer.up.z === 1 ? new Vector3(x, -z, y) : new Vector3(x, y, z));
  }

  /** Connects the buttons that say where to look from, and the choice of what is up. Starts with the whole pair. */
  private connectDirections(): void {
    for (const [id, from] of Object.entries(directions)) byId(id).addEventListener('click', () => this.lookFrom(from));
    byId('closest').addEventListener('click', () => this.viewer.lookAt(this.closest.center, this.closest.radius));
    const choice = byId<HTMLSelectElement>('up');
    choice.value = this.viewer.up.z === 1 ? 'z' : 'y';
    choice.addEventListener('change', () => {
      this.viewer.setUp(choice.value === 'z' ? upZ : upY);
      this.showRelief();
      this.lookFrom(directions.whole);
    });
    this.lookFrom(directions.whole);
  }

  // --- the model that moves as a whole ---

  /** Which model moves as a whole: B if it does, else A, if any does. */
  private get traveller(): number {
    return this.pair[1].moves ? 1 : 0;
  }

  private travellerAt = (frame: number): Vector3 =>
    this.pair[this.traveller].centerAt(frame).applyMatrix4(this.viewFromWorld);

  /** Connects the controls of path and follower; hides them where no model moves. */
  private connectTraveller(): void {
    const { frame_count, stride } = this.data;
    const part = this.pair[this.traveller];
    const [name, follow, pathBox] = ['AB'[this.traveller], this.box('follow'), this.box('show-path')];
    follow.checked = false; // after a reload, browsers restore boxes, but the view is a new one
    for (const id of ['follow-label', 'path-label']) byId(id).hidden = !part.moves;
    if (!part.moves) return;
    byId('follow-text').textContent = `Follow ${name}`;
    byId('path-caption').textContent = `The line is the path of ${name}, with dots where the models touch.`;
    // The path has a point for every step-th frame of the page. A point has a dot if the models touch in that frame, or
    // in one between it and the next point, of any playing.
    const step = Math.ceil(frame_count / stride / mostPathPoints);
    const count = Math.ceil(frame_count / (step * stride));
    const points = Array.from({ length: count }, (_, i) => this.travellerAt(i * step));
    const touched = stretchesThatMeet(this.data, step * stride);
    const path = { points, dots: points.filter((_, i) => touched.has(i)) };
    const showPath = (): void => this.marks.show({ path: pathBox.checked ? path : undefined });
    showPath();
    pathBox.addEventListener('change', showPath);
    const stop = (): boolean => (follow.checked = false);
    for (const id of [...Object.keys(directions), 'closest']) byId(id).addEventListener('click', stop);
    byId('up').addEventListener('change', stop);
    follow.addEventListener('change', () => {
      if (!follow.checked) return this.lookFrom(directions.whole);
      const radius = ((followedSizes * part.model.size) / 2) * this.viewFromWorld.getMaxScaleOnAxis();
      this.viewer.lookAt(this.travellerAt(this.keptFrame), radius);
    });
  }
}
