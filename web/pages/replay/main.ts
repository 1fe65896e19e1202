// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The page of `limber track --report`. */

import { byId, pageData, showMaking } from '../shared/dom.ts';
import { highest, lowest } from '../shared/vectors.ts';
import { frameOf } from '../shared/viewer.ts';
import { showCharts } from './charts.ts';
import type { ReplayData } from './data.ts';
import { ReplayModel } from './model.ts';
import type { Box } from './model.ts';
import { Player } from './player.ts';
import { showModels, showNow, showTiles, showTitle } from './texts.ts';
import { showView } from './view.ts';

const data = pageData<ReplayData>();
const models = data.models.map((model) => new ReplayModel(model));

/** Rows whose frame the page has. */
const keptRows = data.rows.status.map((_, row) => row).filter((row) => (row % data.frame_count) % data.stride === 0);
const frameOfRow = (row: number): number => (row % data.frame_count) / data.stride;

const keptFrames = Math.ceil(data.frame_count / data.stride);
let bounds: Box | undefined;
for (let frame = 0; frame < keptFrames; ++frame) {
  for (const model of models) {
    const box = model.boxAt(frame);
    bounds = bounds === undefined ? box : [lowest(bounds[0], box[0]), highest(bounds[1], box[1])];
  }
}
const frame = frameOf(
  ...(bounds ?? [
    [0, 0, 0],
    [1, 1, 1],
  ]),
);

showTitle(data);
showTiles(data);
showModels(data, models);
showMaking(data.version, data.command);
const view = showView(
  data,
  models,
  frame,
  bounds ?? [
    [0, 0, 0],
    [1, 1, 1],
  ],
);
const player = new Player(keptRows);
const charts = showCharts(data, (row) => player.jumpTo(row));
player.onRow((row) => {
  view.show(row, frameOfRow(row));
  showNow(data, row);
  for (const chart of charts) chart.show(row);
});
player.start();
document.title = `${data.models[0].name} and ${data.models[1].name}`;
byId('view').setAttribute('aria-label', `Both models in 3D: ${data.models[0].name} and ${data.models[1].name}`);
