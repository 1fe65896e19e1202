// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** What only sequences show in 3D: how high a mesh that deforms is, and the path of the model that moves as a whole. */

import type { Vector3 } from 'three';
import { byId } from '../shared/dom.ts';
import { framed } from '../shared/viewer.ts';
import { meetsIn } from './data.ts';
import type { Data } from './data.ts';
import type { View } from './view.ts';

const mostPoints = 1000; // of the path
const sizesAround = 3; // of the model, in the view that follows it

/** Makes what is high of a deforming mesh lighter than what is low. */
export function showHeights(view: View): void {
  const shade = (): void =>
    view.pair.forEach(({ model }, i) => {
      const { up } = view.viewer;
      const [low, high] = [view.boxes[i].min, view.boxes[i].max].map((end) => up.dot(end));
      if (model.deforms) view.surfaces[i].shadeByHeight(up, low, high);
    });
  shade();
  view.onUp(shade);
}

/** Connects the controls of path and follower; hides them where no model moves. */
export function connectTraveller(data: Data, view: View): void {
  const { viewer, marks, frame, pair } = view;
  const which = pair[1].moves ? 1 : 0;
  const part = pair[which];
  const follow = byId<HTMLInputElement>('follow');
  for (const id of ['follow-label', 'path-label']) byId(id).hidden = !part.moves;
  if (!part.moves) return;
  byId('follow-text').textContent = `Follow ${'AB'[which]}`;
  byId('path-caption').textContent = `The line is the path of ${'AB'[which]}, with dots where the models touch.`;
  const at = (shownFrame: number): Vector3 => framed(frame, part.centerAt(shownFrame));
  const count = Math.ceil(data.frame_count / data.stride);
  const step = Math.ceil(count / mostPoints);
  const shown = Array.from({ length: Math.ceil(count / step) }, (_, i) => i * step);
  const path = { points: shown.map(at), dots: shown.filter((f) => meetsIn(data, f * data.stride)).map(at) };
  view.connect('show-path', true, (isOn) => marks.show({ path: isOn ? path : undefined }));

  for (const id of ['whole', 'top', 'front', 'side', 'closest', 'up']) {
    byId(id).addEventListener(id === 'up' ? 'change' : 'click', () => (follow.checked = false));
  }
  follow.addEventListener('change', () => {
    if (follow.checked) viewer.lookAt(at(view.shownFrame), (sizesAround * part.model.size) / 2 / frame.size);
    else view.lookFrom('whole');
  });
  view.onShown(() => {
    if (follow.checked) viewer.moveTo(at(view.shownFrame));
  });
}
