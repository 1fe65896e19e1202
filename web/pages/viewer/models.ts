// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Both models in 3D, with their names and the boxes that hide them. */

import { byId } from '../shared/dom.ts';
import { Marks } from '../shared/marks.ts';
import type { Mesh } from '../shared/section.ts';
import { Surface, SurfaceLook } from '../shared/surface.ts';
import { onThemeChange, tokenRgb } from '../shared/theme.ts';
import { Viewer, usualUp } from '../shared/viewer.ts';

export interface ShownModel {
  data: { name: string };
  mesh: Mesh;
  /** To the other model, by vertex. */
  distances?: Float32Array;
}

export interface ModelsView {
  viewer: Viewer;
  look: SurfaceLook;
  surfaces: readonly Surface[];
  marks: Marks;
}

export function showModelsIn3D(models: readonly ShownModel[]): ModelsView {
  const host = byId('view');
  const viewer = new Viewer(host, usualUp(models.map(({ data }) => data.name)));
  const look = new SurfaceLook();
  const surfaces = models.map(({ mesh, distances }) => new Surface(mesh, look, distances));
  const marks = new Marks(host, viewer);
  viewer.add(...surfaces.map((surface) => surface.object));
  onTheme(viewer, () => surfaces.forEach((surface, i) => surface.setColor(tokenRgb(`model-${'ab'[i]}`))));
  surfaces.forEach((surface, i) => {
    marks.addName('AB'[i], 'ab'[i], surface.farthestAlong(viewer.up), () => surface.object.visible);
    connectBox(viewer, `show-${'ab'[i]}`, true, (isOn) => (surface.object.visible = isOn));
  });
  return { viewer, look, surfaces, marks };
}

/** Colours what the view has, now and whenever the reader's screen changes between light and dark. */
export function onTheme(viewer: Viewer, color: () => void): void {
  const recolor = (): void => {
    color();
    viewer.request();
  };
  recolor();
  onThemeChange(recolor);
}

/** A box that switches something in the view on and off. */
export function connectBox(viewer: Viewer, id: string, isOn: boolean, set: (isOn: boolean) => void): void {
  const box = byId<HTMLInputElement>(id);
  box.checked = isOn;
  const apply = (): void => {
    set(box.checked);
    viewer.request();
  };
  box.addEventListener('change', apply);
  apply();
}
