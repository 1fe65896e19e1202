// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The page of `--report`: two models as they stand, a study of many pairs, or a replay of frames if it has rows. */

import { showReplay } from '../replay/replay.ts';
import type { ReplayData } from '../replay/model.ts';
import { showReport } from '../report/report.ts';
import type { ReportData } from '../report/model.ts';
import { byId, connectCopy } from '../shared/dom.ts';
import { inUnit, setUnit } from '../shared/numbers.ts';
import type { StudyData } from '../study/model.ts';
import { showStudy } from '../study/study.ts';
import { isOfOnePair, usualTitle } from '../study/texts.ts';
import { showMaking, showTitle } from './texts.ts';
import type { Making } from './texts.ts';

type Data = (ReportData | ReplayData | StudyData) & Making & { title?: string; unit?: string };

const data = JSON.parse(byId('data').textContent ?? 'null') as Data;
const view = 'study' in data ? 'study' : 'rows' in data ? 'replay' : 'report';
// The page has templates for what only some of the views have.
for (const part of document.querySelectorAll('template')) {
  if (part.dataset.of?.split(' ').includes(view)) part.replaceWith(part.content);
  else part.remove();
}
setUnit(data.unit ?? '');
for (const place of document.querySelectorAll('.in-unit')) place.textContent = inUnit();
const title = data.title ?? '';
if ('study' in data) {
  const { study, models } = data;
  const pair = [study.rows.a[0], study.rows.b[0]].map((part) => study.parts.name[part]) as [string, string];
  showTitle(title, isOfOnePair(study) ? pair : usualTitle(study, models));
  showStudy(data);
} else {
  showTitle(title, [data.models[0].name, data.models[1].name]);
  if ('rows' in data) showReplay(data);
  else showReport(data);
}
showMaking(data);
connectCopy();
