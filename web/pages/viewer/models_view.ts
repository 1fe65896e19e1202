// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Both models in 3D, with their names and the boxes that hide them. */

import { byId } from '../shared/dom.ts';
import { Marks } from '../shared/marks.ts';
import type { Mesh } from '../shared/section.ts';
import { Surface, SurfaceLook } from '../shared/surface.ts';
import { onThemeChange, tokenRgb } from '../shared/theme.ts';
import { Viewer, usualUp } from '../shared/viewer.ts';

/** A mesh, and of each vertex the distance to the other model where it is known. */
type ShownModel = { data: { name: string }; mesh: Mesh; distances?: Float32Array };

export class ModelsView {
  readonly viewer: Viewer;
  readonly marks: Marks;
  readonly look = new SurfaceLook();
  readonly surfaces: readonly Surface[];

  constructor(models: readonly ShownModel[]) {
    this.viewer = new Viewer(byId('view'), usualUp(models.map(({ data }) => data.name)));
    this.marks = new Marks(byId('view'), this.viewer);
    this.surfaces = models.map(({ mesh, distances }) => new Surface(mesh, this.look, distances));
    this.viewer.add(...this.surfaces.map((surface) => surface.object));
    this.color(() => this.surfaces.forEach((surface, i) => surface.setColor(tokenRgb(`model-${'ab'[i]}`))));
    this.surfaces.forEach((surface, i) => {
      const top = surface.farthestAlong(this.viewer.up);
      this.marks.addName('AB'[i], 'ab'[i], top, () => surface.object.visible);
      this.connectBox(`show-${'ab'[i]}`, true, (isOn) => (surface.object.visible = isOn));
    });
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
}
