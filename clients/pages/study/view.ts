// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** One pair in 3D; of parts that stand together, all others too, for the reader to see through. */

import { Color, Vector3 } from 'three';
import type { Box3, Matrix4 } from 'three';
import { increasingIdsOf, posesOf } from '../shared/decode.ts';
import { byId, tokenRgb } from '../shared/dom.ts';
import { grouped, withUnit } from '../shared/numbers.ts';
import { Surface } from '../shared/surface.ts';
import { frameOf, framed, framedBox } from '../shared/viewer.ts';
import type { Frame } from '../shared/viewer.ts';
import { ModelsView } from '../viewer/models_view.ts';
import { shownBounds } from '../viewer/texts.ts';
import { StudyModel } from './model.ts';
import type { StudyData } from './model.ts';
import { pairName, rowName } from './texts.ts';

const otherOpacity = 0.1; // of parts that are not asked about
const clearOpacity = 0.3; // of what is seen through to see another
const smallestRadius = 2e-4; // of what the closest points are looked at with

export class StudyView {
  private readonly study: StudyData['study'];
  private readonly models: readonly StudyModel[];
  private readonly poses: readonly Matrix4[]; // of parts
  private readonly bounds: readonly Box3[]; // of parts, in the world
  private readonly view: ModelsView;
  private readonly boxes: Box3[] = []; // of the pair, in the picture
  private readonly surfaces = new Map<string, Surface>(); // by side and model
  private readonly others: readonly Surface[]; // by part, where they stand together
  private readonly markColor = { value: new Color() };
  private readonly look: (direction?: Vector3) => void;
  private pair: readonly number[] = []; // parts that are shown
  private row = 0;
  private closest = { center: new Vector3(), radius: 0.5 };

  /** Shows the row `first`. */
  constructor({ study, models }: StudyData, first: number) {
    this.study = study;
    this.models = models.map((model) => new StudyModel(model));
    this.poses = posesOf(study.parts.poses);
    this.bounds = this.poses.map((pose, part) => this.modelOf(part).boxAt(pose));
    const pair = [study.rows.a[first], study.rows.b[first]].map((part) => this.modelOf(part));
    this.view = new ModelsView(
      pair,
      models.map(({ name }) => name),
    );
    this.others = study.kind === 'parts' ? this.madeOthers() : [];
    this.view.color(() => {
      this.markColor.value.setRGB(...tokenRgb('hit'));
      for (const other of this.others) other.setColor(tokenRgb('edge'));
    });
    this.place(first);
    this.view.connectDirections(this.boxes, () => this.view.nameTops());
    this.look = () => this.view.viewer.lookAtBoxes(this.boxes, this.view.viewer.axes.away.negate());
    byId('closest').addEventListener('click', () => {
      this.view.viewer.lookAt(this.closest.center, this.closest.radius);
    });
    byId('others-label').hidden = study.kind !== 'parts';
    this.view.connectBox('show-others', study.kind === 'parts', () => this.showOthers());
    this.view.connectBox('see-through', this.meets(), () => this.showThrough());
  }

  /** Shows another row, from the same side. */
  show(row: number): void {
    this.place(row);
    this.look();
  }

  private modelOf(part: number): StudyModel {
    return this.models[this.study.parts.model[part]];
  }

  private madeOthers(): Surface[] {
    const frame = this.frameAround(this.bounds);
    const firsts = this.models.map(({ mesh }) => new Surface(mesh, this.view.look));
    const made = this.poses.map((pose, part) => {
      const other = firsts[this.study.parts.model[part]].twin();
      other.setOpacity(otherOpacity);
      other.place(this.modelOf(part).matrixAt(pose, frame));
      return other;
    });
    this.view.viewer.add(...made.map(({ object }) => object));
    return made;
  }

  private frameAround(boxes: readonly Box3[]): Frame {
    return frameOf(boxes.slice(1).reduce((all, box) => all.union(box), boxes[0].clone()));
  }

  /** The surface of a side; models that come again share what the graphics card holds. */
  private surfaceOf(side: number, part: number): Surface {
    const number = this.study.parts.model[part];
    const [key, other] = [`${side} ${number}`, `${1 - side} ${number}`];
    const made =
      this.surfaces.get(key) ??
      this.surfaces.get(other)?.twin() ??
      new Surface(this.models[number].mesh, this.view.look);
    this.surfaces.set(key, made);
    return made;
  }

  private place(row: number): void {
    const { rows, kind } = this.study;
    const pair = [rows.a[row], rows.b[row]];
    const bounds = pair.map((part) => this.bounds[part]);
    // Poses of a list may be far apart: each has a frame of its own, in which float32 resolves it.
    const frame = this.frameAround(kind === 'parts' ? this.bounds : bounds);
    this.boxes.splice(0, 2, ...bounds.map((box) => framedBox(frame, box)));
    const surfaces = pair.map((part, side) => {
      const surface = this.surfaceOf(side, part);
      surface.place(this.modelOf(part).matrixAt(this.poses[part], frame));
      surface.mark(increasingIdsOf(rows.intersecting[row]?.[side] ?? ''), this.markColor);
      return surface;
    });
    this.view.replace(surfaces);
    this.pair = pair;
    this.row = row;
    byId<HTMLInputElement>('see-through').checked = this.meets();
    this.showOthers();
    this.showThrough();
    this.showMarks(row, frame);
  }

  private showOthers(): void {
    const isOn = byId<HTMLInputElement>('show-others').checked;
    this.others.forEach(({ object }, part) => (object.visible = isOn && !this.pair.includes(part)));
  }

  /** Where models meet, each hides it from the other side. */
  private meets(): boolean {
    return this.study.rows.status[this.row] === 'collision';
  }

  /** What encloses the other is seen through anyhow. */
  private showThrough(): void {
    const isOn = byId<HTMLInputElement>('see-through').checked;
    const encloses = ['b_inside_a', 'a_inside_b'].indexOf(this.study.rows.solids[this.row] ?? '');
    const inside = ['b_inside_a', 'a_inside_b'].indexOf(this.study.rows.inside[this.row] ?? '');
    this.view.surfaces.forEach((surface, side) => {
      surface.setOpacity(isOn || side === encloses || side === inside ? clearOpacity : 1);
    });
  }

  private showMarks(row: number, frame: Frame): void {
    const { rows } = this.study;
    const witness = rows.witness[row];
    const meets = rows.status[row] === 'collision';
    byId('closest').hidden = witness === null;
    byId('closest').textContent = meets ? 'Shared point' : 'Closest points';
    byId('view-caption').textContent = this.captionOf(row);
    if (witness === null) return this.view.marks.show({ segment: undefined });
    const [a, b] = [0, 3].map((first) => framed(frame, new Vector3().fromArray(witness, first)));
    const size = Math.hypot(...this.boxes[0].clone().union(this.boxes[1]).getSize(new Vector3()).toArray());
    const near = Math.max(smallestRadius, Math.min(0.6 * size, 2.5 * a.distanceTo(b)));
    this.closest = { center: a.clone().lerp(b, 0.5), radius: meets ? 0.1 * size : near };
    const label = meets ? 'shared point' : withUnit(shownBounds(rows.lower[row], rows.upper[row]));
    this.view.marks.show({ segment: { a, b: meets ? a : b, label } });
  }

  private captionOf(row: number): string {
    const { rows } = this.study;
    const start = `${rowName(this.study)} ${grouped(rows.row[row])}: ${pairName(this.study, row)}. `;
    if (rows.witness[row] === null) return `${start}No closest points are known.`;
    if (rows.status[row] !== 'collision') return `${start}The red segment joins the closest points.`;
    const marked = rows.intersecting[row] === null ? '' : ' The triangles that intersect are yellow.';
    return `${start}The models meet at the red point.${marked}`;
  }
}
