// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The frames in 3D; the path of the model that moves as a whole, and a view that goes with it. */

import { Vector3 } from 'three';
import type { Box3 } from 'three';
import { byId } from '../shared/dom.ts';
import { framed, framedBox } from '../shared/viewer.ts';
import type { Frame } from '../shared/viewer.ts';
import { ModelsView, sideNames } from '../viewer/models_view.ts';
import type { ReplayData, ReplayModel } from './model.ts';
import { shownDistance } from './texts.ts';

const mostPoints = 1000; // of the path
const sizesAround = 3; // of the model, in the view that follows it

/** `bounds`: of each model, over all frames. Returns what shows a row and its frame. */
export function showView(
  data: ReplayData,
  models: readonly ReplayModel[],
  frame: Frame,
  bounds: readonly Box3[],
): (row: number, frame: number) => void {
  const view = new ModelsView(models);
  const { viewer, surfaces, marks } = view;
  let now = { row: 0, shownFrame: 0 };
  const show = (row: number, shownFrame: number): void => {
    now = { row, shownFrame };
    models.forEach((model, i) => {
      if (model.deforms) {
        model.moveTo(shownFrame);
        surfaces[i].pointsHaveMoved();
      }
      surfaces[i].place(model.matrixAt(shownFrame, frame));
    });
    view.nameTops();
    const witness = data.rows.witness[row];
    const point = (first: number): Vector3 => framed(frame, new Vector3().fromArray(witness!, first));
    marks.show({
      segment: witness === null ? undefined : { a: point(0), b: point(3), label: shownDistance(data, row) },
    });
    follow(shownFrame);
  };
  const boxes = bounds.map((box) => framedBox(frame, box));
  const shade = (): void =>
    surfaces.forEach((surface, i) => {
      const [low, high] = [boxes[i].min, boxes[i].max].map((end) => viewer.up.dot(end));
      if (models[i].deforms) surface.shadeByHeight(viewer.up, low, high);
    });
  shade();
  const goBack = view.connectDirections(boxes, () => {
    shade();
    show(now.row, now.shownFrame);
  });
  byId('view-caption').textContent = captionOf(data);
  const follow = connectTraveller(data, models, frame, view, goBack);
  return show;
}

function captionOf({ stride, max_megabytes }: ReplayData): string {
  const caption = 'The red segment joins the closest points; where models meet, it is a point.';
  if (stride === 1) return caption;
  return (
    `${caption} Shown is 1 of every ${stride} frames: more would not fit into ${max_megabytes} MB. ` +
    'The charts have all.'
  );
}

/**
 * Connects the controls of path and follower; hides them where no model moves. `goBack` looks at everything again.
 * Returns what has to be told of each frame that is shown.
 */
function connectTraveller(
  data: ReplayData,
  models: readonly ReplayModel[],
  frame: Frame,
  view: ModelsView,
  goBack: () => void,
): (frame: number) => void {
  const { viewer, marks } = view;
  const which = models[1].moves ? 1 : 0;
  const model = models[which];
  const follow = byId<HTMLInputElement>('follow');
  for (const id of ['follow-label', 'path-label']) byId(id).hidden = !model.moves;
  if (!model.moves) return () => {};
  byId('follow-text').textContent = `Follow ${'AB'[which]}`;
  byId('view-caption').textContent += ` The line is the path of ${'AB'[which]}, with dots where the models touch.`;
  const stay = (): void => void (follow.checked = false);
  for (const side of sideNames) byId(side).addEventListener('click', stay);
  byId('up').addEventListener('change', stay);

  const at = (shownFrame: number): Vector3 => framed(frame, model.centerAt(shownFrame));
  const count = Math.ceil(data.frame_count / data.stride);
  const step = Math.ceil(count / mostPoints);
  const shown = Array.from({ length: Math.ceil(count / step) }, (_, i) => i * step);
  const touching = shown.filter((f) => data.rows.status[f * data.stride] === 'collision');
  const path = { points: shown.map(at), dots: touching.map(at) };
  view.connectBox('show-path', true, (isOn) => marks.show({ path: isOn ? path : undefined }));

  let now = 0;
  follow.addEventListener('change', () => {
    if (follow.checked) viewer.lookAt(at(now), (sizesAround * model.diagonal) / 2 / frame.size);
    else goBack();
  });
  return (shownFrame) => {
    now = shownFrame;
    if (follow.checked) viewer.moveTo(at(now));
  };
}
