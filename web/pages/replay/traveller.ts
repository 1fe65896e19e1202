// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The model that moves as a whole: its path, and a view that goes with it. */

import { byId } from '../shared/dom.ts';
import type { Marks } from '../shared/marks.ts';
import type { Vec3 } from '../shared/vectors.ts';
import { framed, sides } from '../shared/viewer.ts';
import type { Frame, Viewer } from '../shared/viewer.ts';
import type { ReplayData } from './data.ts';
import type { ReplayModel } from './model.ts';

const mostPoints = 1000; // of the path
const sizesAround = 3; // of the model, in the view that follows it

/** What has to be told of each frame that is shown. */
export type OnFrame = (frame: number) => void;

/** Connects the controls; hides them where no model moves. `goBack` looks at everything again. */
export function connectTraveller(
  data: ReplayData,
  models: readonly ReplayModel[],
  { marks, viewer, frame, goBack }: { marks: Marks; viewer: Viewer; frame: Frame; goBack: () => void },
): OnFrame {
  const which = models[1].moves ? 1 : 0;
  const model = models[which];
  const [follow, path] = ['follow', 'show-path'].map((id) => byId<HTMLInputElement>(id));
  for (const id of ['follow-label', 'path-label']) byId(id).hidden = !model.moves;
  if (!model.moves) return () => {};
  byId('follow-text').textContent = `Follow ${'AB'[which]}`;
  byId('view-caption').textContent += ` The line is the path of ${'AB'[which]}, with dots where the models touch.`;
  const stay = (): void => void (follow.checked = false);
  for (const side of sides) byId(side).addEventListener('click', stay);
  byId('up').addEventListener('change', stay);

  const at = (shownFrame: number): Vec3 => framed(frame, model.centerAt(shownFrame));
  const count = Math.ceil(data.frame_count / data.stride);
  const step = Math.ceil(count / mostPoints);
  const shown = Array.from({ length: Math.ceil(count / step) }, (_, i) => i * step);
  const touching = shown.filter((f) => data.rows.status[f * data.stride] === 'collision');
  const line = { points: shown.map(at), dots: touching.map(at) };
  const showPath = (): void => marks.setPath(path.checked ? line : undefined);
  path.addEventListener('change', showPath);
  showPath();

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
