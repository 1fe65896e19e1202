// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The frames in 3D. */

import { byId } from '../shared/dom.ts';
import { connectDirections } from '../shared/directions.ts';
import { dot } from '../shared/vectors.ts';
import type { Vec3 } from '../shared/vectors.ts';
import { framed } from '../shared/viewer.ts';
import type { Frame } from '../shared/viewer.ts';
import { ModelsView } from '../viewer/models_view.ts';
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
  const { viewer, surfaces, marks } = new ModelsView(models);
  for (const { object } of surfaces) object.matrixAutoUpdate = false;
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
  byId('view-caption').textContent = captionOf(data);
  const onFrame = connectTraveller(data, models, { marks, viewer, frame, goBack });
  return { show };
}

function captionOf({ stride, max_megabytes }: ReplayData): string {
  const caption = 'The red segment joins the closest points.';
  if (stride === 1) return caption;
  return (
    `${caption} Shown is 1 of every ${stride} frames: more would not fit into ${max_megabytes} MB. ` +
    'The charts have all.'
  );
}
