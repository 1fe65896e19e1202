// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The models of a row in 3D, with their names, what hides them, and where to look from. */

import { Box3, Color, Vector3 } from 'three';
import { increasingIdsOf } from '../shared/decode.ts';
import { byId, connectBox, onThemeChange, tokenRgb } from '../shared/dom.ts';
import { Marks } from '../shared/marks.ts';
import { withUnit } from '../shared/numbers.ts';
import { Surface, SurfaceLook } from '../shared/surface.ts';
import { Viewer, frameOf, framed, framedBox, upY, upZ, usualUp } from '../shared/viewer.ts';
import type { Frame } from '../shared/viewer.ts';
import { meetsIn } from './data.ts';
import type { Data } from './data.ts';
import type { Model, Part } from './models.ts';
import { captionOf, shownBounds } from './texts.ts';

const otherOpacity = 0.1; // of parts that are not asked about
const clearOpacity = 0.3; // of what is seen through to see another
const smallestRadius = 2e-4; // of what the closest points are looked at with

/** Where the buttons look from where y is up; "whole" shows three sides. */
const sides = { whole: [0.55, 0.62, 0.75], top: [0, 1, 1e-4], front: [0, 0, 1], side: [1, 0, 0] } as const;

export class View {
  readonly viewer: Viewer;
  readonly marks: Marks;
  readonly look = new SurfaceLook();
  /** Of the row that is shown: how the world is drawn, and what is drawn of it. */
  frame: Frame;
  pair: readonly Part[] = [];
  surfaces: readonly Surface[] = [];
  /** In the picture. */
  boxes: readonly Box3[] = [];
  closest = { center: new Vector3(), radius: 0.5 };
  private readonly data: Data;
  private readonly parts: readonly Part[];
  private readonly whole: Frame; // of all parts
  private readonly made = new Map<string, Surface>(); // by side and model
  private readonly others: readonly Surface[]; // by part, where they stand together
  private readonly markColor = { value: new Color() };
  private readonly upCallbacks: (() => void)[] = [];
  private readonly moveCallbacks: (() => void)[] = [];
  private row = 0;

  /** Shows the row `first`. */
  constructor(data: Data, parts: readonly Part[], first: number) {
    this.data = data;
    this.parts = parts;
    this.viewer = new Viewer(byId('view'), usualUp(data.models.map(({ name }) => name)));
    this.marks = new Marks(this.viewer);
    byId('view').setAttribute('aria-label', `Both models in 3D: ${document.title}`);
    this.whole = frameOf(parts.reduce((all, { bounds }) => all.union(bounds), new Box3()));
    this.frame = this.whole;
    this.others = data.kind === 'parts' ? this.madeOthers() : [];
    const names = (['A', 'B'] as const).map((name, i) => ({
      name,
      at: new Vector3(),
      isShown: () => this.surfaces[i].object.visible,
    }));
    this.marks.show({ names });
    this.onShown(() => names.forEach(({ at }, i) => at.copy(this.surfaces[i].farthestAlong(this.viewer.up))));
    this.show(first);
    for (const id of ['show-a', 'show-b']) this.connect(id, true, () => this.showSides());
    if (data.kind === 'parts') this.connect('show-others', true, () => this.showOthers());
    if (data.rows.clash !== undefined && data.pair === undefined) {
      this.connect('see-through', meetsIn(data, first), () => this.showThrough());
    }
    onThemeChange(() => this.recolor());
    this.connectDirections();
  }

  /** The number of the frame among those that the page has. */
  get shownFrame(): number {
    return (this.row % this.data.frame_count) / this.data.stride;
  }

  /** Shows another row; of pairs, from the same side as the one before. */
  show(row: number): void {
    const { rows, kind } = this.data;
    const isAgain = this.surfaces.length > 0;
    this.row = row;
    this.pair = [rows.a[row], rows.b[row]].map((part) => this.parts[part]);
    const bounds = this.pair.map((part) => part.bounds);
    // Poses of a list may be far apart: each has a frame of its own, in which float32 resolves it.
    this.frame = kind === 'pairs' ? frameOf(bounds[0].clone().union(bounds[1])) : this.whole;
    this.boxes = bounds.map((box) => framedBox(this.frame, box));
    const at = this.shownFrame;
    const surfaces = this.pair.map(({ model }, side) => this.surfaceOf(model, side));
    this.pair.forEach((part, side) => {
      if (part.model.deforms) {
        part.model.moveTo(at);
        surfaces[side].pointsHaveMoved();
      }
      surfaces[side].place(part.matrixAt(at, this.frame));
      const met = rows.intersecting?.[row]?.[side];
      if (rows.intersecting !== undefined) {
        surfaces[side].mark(part.model.shownTriangles(increasingIdsOf(met ?? '')), this.markColor);
      }
    });
    this.replace(surfaces);
    this.showMarks();
    if (isAgain && kind !== 'frames') this.viewer.lookAtBoxes(this.boxes, this.viewer.from);
    for (const callback of this.moveCallbacks) callback();
  }

  /** Calls back now and whenever a row is shown, or something else is up. */
  onShown(callback: () => void): void {
    this.moveCallbacks.push(callback);
    if (this.surfaces.length > 0) callback();
  }

  /** Calls back when the reader has chosen what is up. */
  onUp(callback: () => void): void {
    this.upCallbacks.push(callback);
  }

  /** Lets a box of the page switch something on and off. */
  connect(id: string, isOn: boolean, set: (isOn: boolean) => void): void {
    connectBox(id, isOn, (is) => {
      set(is);
      this.viewer.request();
    });
  }

  /** Looks at all that may be shown from a direction that a button names. */
  lookFrom(side: keyof typeof sides): void {
    const [x, y, z] = sides[side];
    this.viewer.lookAtBoxes(this.boxes, this.viewer.up.z === 1 ? new Vector3(x, -z, y) : new Vector3(x, y, z));
  }

  private madeOthers(): Surface[] {
    const firsts = new Map<Model, Surface>();
    const made = this.parts.map((part) => {
      const first = firsts.get(part.model) ?? new Surface(part.model.mesh, this.look);
      firsts.set(part.model, first);
      const other = first.twin();
      other.setOpacity(otherOpacity);
      other.place(part.matrixAt(0, this.whole));
      return other;
    });
    this.viewer.add(...made.map(({ object }) => object));
    return made;
  }

  /** The surface of a side; models that come again share what the graphics card holds. */
  private surfaceOf(model: Model, side: number): Surface {
    const number = this.data.models.indexOf(model.data);
    const twin = this.made.get(`${1 - side} ${number}`)?.twin();
    const made = this.made.get(`${side} ${number}`) ?? twin ?? new Surface(model.mesh, this.look, model.distances);
    this.made.set(`${side} ${number}`, made);
    return made;
  }

  private replace(surfaces: readonly Surface[]): void {
    if (surfaces.every((surface, side) => surface === this.surfaces[side])) return this.viewer.request();
    this.viewer.remove(...this.surfaces.map(({ object }) => object));
    this.surfaces = surfaces;
    this.viewer.add(...surfaces.map(({ object }) => object));
    this.showSides();
    this.recolor();
  }

  private recolor(): void {
    this.surfaces.forEach((surface, i) => surface.setColor(tokenRgb(`model-${'ab'[i]}`)));
    for (const other of this.others) other.setColor(tokenRgb('edge'));
    this.look.lineColor.value.setRGB(...tokenRgb('mark'));
    this.markColor.value.setRGB(...tokenRgb('hit'));
    this.viewer.request();
  }

  private showSides(): void {
    const boxes = ['show-a', 'show-b'].map((id) => byId<HTMLInputElement>(id));
    this.surfaces.forEach(({ object }, i) => (object.visible = boxes[i].checked));
  }

  private showOthers(): void {
    const isOn = byId<HTMLInputElement>('show-others').checked;
    this.others.forEach(({ object }, part) => (object.visible = isOn && !this.pair.includes(this.parts[part])));
  }

  /** Where models meet, each hides the other; what encloses the other is seen through anyhow. */
  private showThrough(): void {
    const isOn = byId<HTMLInputElement>('see-through').checked;
    const { solids, inside } = this.data.rows;
    this.surfaces.forEach((surface, side) => {
      const encloses = side === 0 ? 'b_inside_a' : 'a_inside_b';
      const isAround = solids?.[this.row] === encloses || inside?.[this.row] === encloses;
      surface.setOpacity(isOn || isAround ? clearOpacity : 1);
    });
  }

  private showMarks(): void {
    const { rows, pair, kind } = this.data;
    const meets = meetsIn(this.data, this.row);
    if (kind === 'parts') this.showOthers();
    if (kind === 'pairs' || kind === 'parts') {
      byId<HTMLInputElement>('see-through').checked = meets;
      this.showThrough();
    }
    const witness = rows.witness[this.row];
    byId('closest').hidden = witness === null;
    byId('closest').textContent = meets ? 'Shared point' : 'Closest points';
    byId('view-caption').textContent = captionOf(this.data, this.row);
    if (witness === null) return this.marks.show({ segment: undefined });
    const inPicture = (point: number[]): Vector3 => framed(this.frame, new Vector3().fromArray(point));
    const [a, b] = [inPicture(witness.slice(0, 3)), inPicture(witness.slice(3, 6))];
    const size = this.boxes[0].clone().union(this.boxes[1]).getSize(new Vector3()).length();
    const near = Math.max(smallestRadius, Math.min(0.6 * size, 2.5 * a.distanceTo(b)));
    this.closest = { center: a.clone().lerp(b, 0.5), radius: meets ? 0.1 * size : near };
    const label = meets ? 'shared point' : withUnit(shownBounds(rows.lower[this.row], rows.upper[this.row]));
    const corners = meets ? undefined : pair?.witness_corners;
    this.marks.show({
      segment: { a, b: meets ? a : b, label },
      triangles: corners?.map((triangle) => triangle.map(inPicture)),
    });
  }

  /** The buttons that say where to look from, and the choice of what is up. Starts by showing all. */
  private connectDirections(): void {
    const { viewer } = this;
    for (const side of Object.keys(sides) as (keyof typeof sides)[]) {
      byId(side).addEventListener('click', () => this.lookFrom(side));
    }
    byId('closest').addEventListener('click', () => viewer.lookAt(this.closest.center, this.closest.radius));
    const choice = byId<HTMLSelectElement>('up');
    choice.value = viewer.up.z === 1 ? 'z' : 'y';
    choice.addEventListener('change', () => {
      viewer.setUp(choice.value === 'z' ? upZ : upY);
      this.lookFrom('whole');
      for (const callback of [...this.upCallbacks, ...this.moveCallbacks]) callback();
    });
    this.lookFrom('whole');
  }
}
