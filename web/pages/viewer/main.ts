// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The page of `--report` and of `limber demo`: two models as they stand, or a replay of frames if it has rows. */

import { showReplay } from '../replay/replay.ts';
import type { ReplayData } from '../replay/data.ts';
import { showReport } from '../report/report.ts';
import type { ReportData } from '../report/data.ts';
import { pageData, showMaking } from '../shared/dom.ts';
import { showTitle } from './texts.ts';

/** The page has templates for what only one of both views has: puts those of one into place, removes the others. */
function chooseParts(kind: 'report' | 'replay'): void {
  for (const part of document.querySelectorAll('template')) {
    if (part.dataset.of === kind) part.replaceWith(part.content);
    else part.remove();
  }
}

const data = pageData<ReportData | ReplayData>();
const isReplay = 'rows' in data;
chooseParts(isReplay ? 'replay' : 'report');
showTitle(data.models);
if (isReplay) showReplay(data);
else showReport(data);
showMaking(data.version, data.command);
