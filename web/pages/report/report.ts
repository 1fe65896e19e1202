// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The view of `limber distance --report`: two models as they stand. */

import { byId } from '../shared/dom.ts';
import { highest, lowest } from '../shared/vectors.ts';
import { frameOf } from '../shared/viewer.ts';
import type { ReportData } from './data.ts';
import { decodedModel } from './model.ts';
import { showSection } from './section.ts';
import { showAnswer, showModels, showTiles } from './texts.ts';
import { showView } from './view.ts';

export function showReport(data: ReportData): void {
  const [a, b] = data.models;
  const frame = frameOf(lowest(a.low, b.low), highest(a.high, b.high));
  const models = data.models.map((model) => decodedModel(model, frame));
  byId('kind').textContent = 'limber distance';
  showTiles(data, models);
  showAnswer(data);
  showModels(data, models);
  const view = showView(data, models, frame);
  showSection(data, models, frame, view);
}
