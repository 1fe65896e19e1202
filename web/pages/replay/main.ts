// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The page of `limber track --report` and `limber demo`. */

import { byId, pageData, showMaking } from '../shared/dom.ts';
import { frameOf } from '../shared/viewer.ts';
import { showCharts } from './charts.ts';
import type { ReplayData } from './data.ts';
import { ReplayModel, joined } from './model.ts';
import { Player } from './player.ts';
import { showModels, showNow, showSummary, showTiles, showTitle } from './texts.ts';
import { showView } from './view.ts';

const data = pageData<ReplayData>();
const models = data.models.map((model) => new ReplayModel(model));

/** Rows whose frame the page has. */
const keptRows = data.rows.status.map((_, row) => row).filter((row) => (row % data.frame_count) % data.stride === 0);
const frameOfRow = (row: number): number => (row % data.frame_count) / data.stride;

const keptFrames = Math.ceil(data.frame_count / data.stride);
const bounds = models.map((model) => {
  const boxes = Array.from({ length: keptFrames }, (_, frame) => model.boxAt(frame));
  return boxes.reduce(joined);
});
const frame = frameOf(...bounds.reduce(joined));

showTitle(data);
showTiles(data);
showModels(data, models);
showSummary(data);
showMaking(data.version, data.command);
const charts = showCharts(data, (row) => player.jumpTo(row)); // first, as the view is as high as they are
const view = showView(data, models, frame, bounds);
const player = new Player(keptRows);
player.onRow((row) => {
  view.show(row, frameOfRow(row));
  showNow(data, row);
  for (const chart of charts) chart.show(row);
});
player.start();
document.title = `${data.models[0].name} and ${data.models[1].name}`;
byId('view').setAttribute('aria-label', `Both models in 3D: ${data.models[0].name} and ${data.models[1].name}`);
