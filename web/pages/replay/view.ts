// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The frames in 3D. */

import { byId } from '../shared/dom.ts';
import { connectDirections } from '../shared/directions.ts';
import { Marks } from '../shared/marks.ts';
import { Surface, SurfaceLook } from '../shared/surface.ts';
import { onThemeChange, tokenRgb } from '../shared/theme.ts';
import { dot } from '../shared/vectors.ts';
import type { Vec3 } from '../shared/vectors.ts';
import { Viewer, framed, usualUp } from '../shared/viewer.ts';
import type { Frame } from '../shared/viewer.ts';
import type { ReplayData } from './data.ts';
import type { Box, ReplayModel } from './model.ts';
import { shownDistance } from './texts.ts';
import { connectTraveller } from './traveller.ts';

export interface ReplayView {
  show(row: number, frame: number): void;
}

/** `bounds`: of each model, over all frames. */
export function showView(
  data: ReplayData,
  models: readonly ReplayModel[],
  frame: Frame,
  bounds: readonly Box[],
): ReplayView {
  const host = byId('view');
  const viewer = new Viewer(host, usualUp(data.models.map((model) => model.name)));
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
  let now = { row: 0, shownFrame: 0 };

  models.forEach((model, i) => {
    model.moveTo(0, frame);
    surfaces[i].pointsHaveMoved();
  });
  const show = (row: number, shownFrame: number): void => {
    now = { row, shownFrame };
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
    onFrame(shownFrame);
    viewer.request();
  };
  const boxes = bounds.map(([low, high]) => [framed(frame, low), framed(frame, high)] as const);
  const shade = (): void =>
    surfaces.forEach((surface, i) => {
      const [low, high] = boxes[i].map((end) => dot(viewer.up, end));
      if (models[i].deforms) surface.shadeByHeight(viewer.up, low, high);
    });
  shade();
  const goBack = connectDirections(viewer, boxes, () => {
    shade();
    show(now.row, now.shownFrame);
  });
  const onFrame = connectTraveller(data, models, { marks, viewer, frame, goBack });
  return { show };
}
