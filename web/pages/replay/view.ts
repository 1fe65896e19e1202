// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The frames in 3D. */

import { byId } from '../shared/dom.ts';
import { Marks } from '../shared/marks.ts';
import { Surface, SurfaceLook } from '../shared/surface.ts';
import { onThemeChange, tokenRgb } from '../shared/theme.ts';
import type { Vec3 } from '../shared/vectors.ts';
import { Viewer, framed, upOf } from '../shared/viewer.ts';
import type { Frame } from '../shared/viewer.ts';
import type { ReplayData } from './data.ts';
import type { Box, ReplayModel } from './model.ts';
import { shownDistance } from './texts.ts';

export interface ReplayView {
  show(row: number, frame: number): void;
}

export function showView(data: ReplayData, models: readonly ReplayModel[], frame: Frame, bounds: Box): ReplayView {
  const host = byId('view');
  const viewer = new Viewer(host, upOf(data.models.map((model) => model.name)));
  const look = new SurfaceLook();
  const surfaces = models.map((model) => new Surface(model.mesh, look));
  const recolor = (): void => {
    surfaces.forEach((surface, i) => surface.setColor(tokenRgb(`model-${'ab'[i]}`)));
    viewer.request();
  };
  recolor();
  onThemeChange(recolor);
  for (const { object } of surfaces) object.matrixAutoUpdate = false;
  viewer.add(...surfaces.map((surface) => surface.object));
  const marks = new Marks(host, viewer);
  surfaces.forEach((surface, i) => {
    const box = byId<HTMLInputElement>(`show-${'ab'[i]}`);
    marks.addName('AB'[i], 'ab'[i], [0, 0, 0], () => surface.object.visible);
    box.addEventListener('change', () => {
      surface.object.visible = box.checked;
      viewer.request();
    });
  });
  connectDirections(viewer, [framed(frame, bounds[0]), framed(frame, bounds[1])]);

  models.forEach((model, i) => {
    model.moveTo(0, frame);
    surfaces[i].pointsHaveMoved();
  });
  const show = (row: number, shownFrame: number): void => {
    models.forEach((model, i) => {
      if (model.deforms) {
        model.moveTo(shownFrame, frame);
        surfaces[i].pointsHaveMoved();
      }
      surfaces[i].place(model.matrixAt(shownFrame, frame));
      marks.moveName(i, surfaces[i].farthestAlong(viewer.up));
    });
    const witness = data.rows.witness[row];
    const point = (first: number): Vec3 => framed(frame, witness!.slice(first, first + 3) as unknown as Vec3);
    marks.setSegment(witness === null ? undefined : { a: point(0), b: point(3), label: shownDistance(data, row) });
    viewer.request();
  };
  return { show };
}

function connectDirections(viewer: Viewer, box: Box): void {
  const isZUp = viewer.up[2] === 1;
  const whole = (from: Vec3): void => viewer.lookAtBoxes([box], from);
  byId('whole').addEventListener('click', () => whole(viewer.slanted()));
  byId('top').addEventListener('click', () => whole(isZUp ? [0, -1e-4, 1] : [0, 1, 1e-4]));
  byId('front').addEventListener('click', () => whole(isZUp ? [0, -1, 0] : [0, 0, 1]));
  byId('side').addEventListener('click', () => whole([1, 0, 0]));
  whole(viewer.slanted());
}
