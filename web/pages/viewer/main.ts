// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/**
 * The page of `--report`, `limber demo` and `limber haptics`: two models as they stand, a replay of frames if it has
 * rows, or the times of a force loop.
 */

import { showHaptics } from '../haptics/haptics.ts';
import type { HapticData } from '../haptics/haptics.ts';
import { showReplay } from '../replay/replay.ts';
import type { ReplayData } from '../replay/model.ts';
import { showReport } from '../report/report.ts';
import type { ReportData } from '../report/model.ts';
import { byId, connectCopy } from '../shared/dom.ts';
import { showTitle } from './texts.ts';

const data = JSON.parse(byId('data').textContent ?? 'null') as ReportData | ReplayData | HapticData;
const view = 'haptics' in data ? 'haptics' : 'rows' in data ? 'replay' : 'report';
// The page has templates for what only one of the views has; what is of models is of all but the force loop.
for (const part of document.querySelectorAll('template')) {
  if (part.dataset.of === view) part.replaceWith(part.content);
  else part.remove();
}
if ('haptics' in data) {
  for (const part of document.querySelectorAll('.of-models')) part.remove();
  showHaptics(data.haptics);
} else {
  showTitle(data.models);
  if ('rows' in data) showReplay(data);
  else showReport(data);
}
byId('version').textContent = `limber ${data.version}`;
byId('command').textContent = data.command;
connectCopy();
