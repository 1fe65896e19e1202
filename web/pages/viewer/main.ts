// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The page of `--report` and of `limber demo`: two models as they stand, or a replay of frames if it has rows. */

import { showReplay } from '../replay/replay.ts';
import type { ReplayData } from '../replay/model.ts';
import { showReport } from '../report/report.ts';
import type { ReportData } from '../report/model.ts';
import { byId, connectCopy } from '../shared/dom.ts';
import { showTitle } from './texts.ts';

const data = JSON.parse(byId('data').textContent ?? 'null') as ReportData | ReplayData;
const isReplay = 'rows' in data;
// The page has templates for what only one of both views has.
for (const part of document.querySelectorAll('template')) {
  if (part.dataset.of === (isReplay ? 'replay' : 'report')) part.replaceWith(part.content);
  else part.remove();
}
showTitle(data.models);
if (isReplay) showReplay(data);
else showReport(data);
byId('version').textContent = `limber ${data.version}`;
byId('command').textContent = data.command;
connectCopy();
