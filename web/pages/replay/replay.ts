// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The view of `limber track --report` and `limber demo`: frames that are played. */

import { frameOf } from '../shared/viewer.ts';
import { showCharts } from './charts.ts';
import type { ReplayData } from './data.ts';
import { ReplayModel, joined } from './model.ts';
import { Player } from './player.ts';
import { showKind, showModels, showNow, showSummary, showTiles } from './texts.ts';
import { showView } from './view.ts';

export function showReplay(data: ReplayData): void {
  const models = data.models.map((model) => new ReplayModel(model));
  const keptFrames = Math.ceil(data.frame_count / data.stride);
  const bounds = models.map((model) => {
    const boxes = Array.from({ length: keptFrames }, (_, frame) => model.boxAt(frame));
    return boxes.reduce(joined);
  });
  const frame = frameOf(...bounds.reduce(joined));

  showKind(data);
  showTiles(data);
  showModels(data, models);
  showSummary(data);
  const charts = showCharts(data, (row) => player.jumpTo(row)); // first, as the view is as high as they are
  const view = showView(data, models, frame, bounds);
  /** Rows whose frame the page has. */
  const keptRows = data.rows.status.map((_, row) => row).filter((row) => (row % data.frame_count) % data.stride === 0);
  const player = new Player(keptRows);
  player.onRow((row) => {
    view.show(row, (row % data.frame_count) / data.stride);
    showNow(data, row);
    for (const chart of charts) chart.show(row);
  });
  player.start();
}
