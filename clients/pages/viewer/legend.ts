// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Distances in colours: from the smallest to one that the reader chooses; at first one that shows what is near. */

import { byId, element } from '../shared/dom.ts';
import { shown, shownLength, ticks } from '../shared/numbers.ts';
import { mapColors } from '../shared/surface.ts';
import { meetsIn } from './data.ts';
import type { Data } from './data.ts';
import type { View } from './view.ts';

export function connectLegend(data: Data, view: View): void {
  const { viewer, look } = view;
  const models = view.pair.map(({ model }) => model);
  const low = Math.min(data.rows.upper[0] ?? Infinity, ...models.map(({ nearest }) => nearest));
  const most = Math.max(...models.map(({ farthest }) => farthest));
  const limit = data.min_clearance ?? 0;
  const near = limit > 0 ? Math.max(4 * limit, 2 * low) : low + Math.min(...models.map(({ size }) => size)) / 8;
  const slider = byId<HTMLInputElement>('map-end');
  const range = most - low;
  look.limit.value = limit;
  const apply = (): void => {
    const high = low + range * (Number(slider.value) / 1000) ** 2;
    const { step, values } = ticks(low, high, 6);
    const part = limit > low && limit < high ? (limit - low) / (high - low) : undefined;
    const red = part === undefined ? '' : `, the red one at ${shownLength(limit)}`;
    byId('legend-title').textContent = `Distance to the other model; dark lines as on the scale${red}`;
    byId('legend-limit').hidden = part === undefined;
    byId('legend-limit').style.left = `${100 * (part ?? 0)}%`;
    look.range.value = [low, high];
    look.lineStep.value = step;
    byId('map-end-text').textContent = shownLength(high, 4);
    slider.setAttribute('aria-valuetext', shownLength(high, 4));
    showScale(low, high, values);
    byId('legend-beyond').hidden = high >= most;
    viewer.request();
  };
  slider.value = String(range > 0 ? Math.round(1000 * Math.sqrt(Math.min(1, (near - low) / range))) : 1000);
  slider.min = '20';
  slider.addEventListener('input', apply);
  apply();
  view.connect('show-map', !meetsIn(data, 0), (isOn) => {
    look.isMapped.value = isOn;
    byId('legend').hidden = !isOn;
  });
}

/** The colours with the lines that surfaces have, and numbers where there is room. */
function showScale(low: number, high: number, values: readonly number[]): void {
  const at = (value: number): number => (high > low ? (value - low) / (high - low) : 0);
  const lines = values.map((value) => `linear-gradient(#0008 0 0) ${100 * at(value)}% 0 / 2px 100% no-repeat`);
  const colors = `linear-gradient(to right, ${mapColors.join(', ')})`;
  byId('legend-bar').style.background = [...lines, colors].join(', ');
  const inside = values.filter((value) => at(value) > 0.14 && at(value) < 0.86);
  const spans = [low, ...inside, high].map((value) => {
    const made = element('span', '', shown(value, 4));
    made.style.left = `${100 * at(value)}%`;
    return made;
  });
  spans[spans.length - 1].className = 'last';
  byId('legend-ticks').replaceChildren(...spans);
}
