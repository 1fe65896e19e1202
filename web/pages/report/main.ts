// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The page of `limber distance --report`. */

import { byId, pageData, showMaking } from '../shared/dom.ts';
import { highest, lowest } from '../shared/vectors.ts';
import { frameOf } from '../shared/viewer.ts';
import type { ReportData } from './data.ts';
import { decodedModel } from './model.ts';
import { showSection } from './section.ts';
import { showAnswer, showModels, showTiles, showTitle } from './texts.ts';
import { showView } from './view.ts';

const data = pageData<ReportData>();
const [a, b] = data.models;
const frame = frameOf(lowest(a.low, b.low), highest(a.high, b.high));
const models = data.models.map((model) => decodedModel(model, frame));

showTitle(data);
showTiles(data, models);
showAnswer(data);
showModels(data, models);
showMaking(data.version, data.command);
const view = showView(data, models, frame);
showSection(data, models, frame, view);
document.title = `${a.name} and ${b.name}`;
byId('view').setAttribute('aria-label', `Both models in 3D: ${a.name} and ${b.name}`);
