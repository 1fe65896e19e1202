// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Both models in 3D, with their names, the boxes that hide them, and the buttons that say where to look from. */

import { Vector3 } from 'three';
import type { Box3 } from 'three';
import { byId, onThemeChange, tokenRgb } from '../shared/dom.ts';
import { Marks } from '../shared/marks.ts';
import type { Name } from '../shared/marks.ts';
import { Surface, SurfaceLook } from '../shared/surface.ts';
import type { Mesh } from '../shared/surface.ts';
import { Viewer, upY, upZ, usualUp } from '../shared/viewer.ts';

/** A mesh, and of each vertex the distance to the other model where it is known. */
type ShownModel = { data: { name: string }; mesh: Mesh; distances?: Float32Array };

/** Where the buttons look from where y is up; "whole" shows three sides. */
const sides = { whole: [0.55, 0.62, 0.75], top: [0, 1, 1e-4], front: [0, 0, 1], side: [1, 0, 0] } as const;
export const sideNames = Object.keys(sides) as (keyof typeof sides)[];

export class ModelsView {
  readonly viewer: Viewer;
  readonly marks: Marks;
  readonly look = new SurfaceLook();
  readonly names: readonly Name[];
  private shown: readonly Surface[];

  /** `fileNames`: of all models that may be shown, which say what is up. */
  constructor(models: readonly ShownModel[], fileNames = models.map(({ data }) => data.name)) {
    this.viewer = new Viewer(byId('view'), usualUp(fileNames));
    this.marks = new Marks(this.viewer);
    this.shown = models.map(({ mesh, distances }) => new Surface(mesh, this.look, distances));
    this.viewer.add(...this.shown.map((surface) => surface.object));
    this.color(() => this.recolor());
    this.names = this.shown.map((surface, i) => ({
      name: i === 0 ? 'A' : 'B',
      at: surface.farthestAlong(this.viewer.up),
      isShown: () => this.shown[i].object.visible,
    }));
    this.marks.show({ names: this.names });
    for (const i of [0, 1]) {
      this.connectBox(`show-${'ab'[i]}`, true, (isOn) => (this.shown[i].object.visible = isOn));
    }
  }

  get surfaces(): readonly Surface[] {
    return this.shown;
  }

  /** Shows two other surfaces, which have been placed. */
  replace(surfaces: readonly Surface[]): void {
    this.viewer.remove(...this.shown.map((surface) => surface.object));
    surfaces.forEach(({ object }, i) => (object.visible = this.shown[i].object.visible));
    this.shown = surfaces;
    this.viewer.add(...surfaces.map((surface) => surface.object));
    this.recolor();
    this.nameTops();
  }

  /** Puts the names to the highest points. */
  nameTops(): void {
    this.names.forEach(({ at }, i) => at.copy(this.shown[i].farthestAlong(this.viewer.up)));
  }

  private recolor(): void {
    this.shown.forEach((surface, i) => surface.setColor(tokenRgb(`model-${'ab'[i]}`)));
  }

  /** Colours things now, and whenever the reader's screen changes between light and dark. */
  color(apply: () => void): void {
    const recolor = (): void => {
      apply();
      this.viewer.request();
    };
    recolor();
    onThemeChange(recolor);
  }

  /** Lets a box of the page switch something on and off. */
  connectBox(id: string, isOn: boolean, set: (isOn: boolean) => void): void {
    const box = byId<HTMLInputElement>(id);
    box.checked = isOn;
    const apply = (): void => {
      set(box.checked);
      this.viewer.request();
    };
    apply();
    box.addEventListener('change', apply);
  }

  /**
   * Connects the buttons that say where to look from, and the choice of what is up. Starts by showing all boxes, which
   * what is returned does again. `onUp` is called when the reader has chosen what is up. Boxes may change later.
   */
  connectDirections(boxes: readonly Box3[], onUp: () => void): () => void {
    const { viewer } = this;
    const isZUp = (): boolean => viewer.up.z === 1;
    const look = (side: keyof typeof sides): void => {
      const [x, y, z] = sides[side];
      viewer.lookAtBoxes(boxes, isZUp() ? new Vector3(x, -z, y) : new Vector3(x, y, z));
    };
    for (const side of sideNames) byId(side).addEventListener('click', () => look(side));
    const choice = byId<HTMLSelectElement>('up');
    choice.value = isZUp() ? 'z' : 'y';
    choice.addEventListener('change', () => {
      viewer.setUp(choice.value === 'z' ? upZ : upY);
      look('whole');
      onUp();
    });
    look('whole');
    return () => look('whole');
  }
}
