// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The page of `--report`: answers about pairs of models, in words, in 3D, in a list and in charts. */

import { byId, connectCopy, element } from '../shared/dom.ts';
import { setUnit } from '../shared/numbers.ts';
import { RowList } from '../shared/row_list.ts';
import { showCharts } from './charts.ts';
import { isOfOnePair, readData, totalOf } from './data.ts';
import type { Data } from './data.ts';
import { modelsOf, partsOf } from './models.ts';
import type { Part } from './models.ts';
import { Player } from './player.ts';
import { showAnswer, showMaking, showModels } from './tables.ts';
import { partName, rowName, showTiles, showTitles, shownDistance, verdictOf } from './texts.ts';
import { View } from './view.ts';

/** The page has all that some kind of data needs; what others need leaves. */
function takeParts({ kind, min_clearance, rows }: Data): void {
  for (const part of document.querySelectorAll<HTMLElement>('[data-of]')) {
    if (!part.dataset.of!.split(' ').includes(kind)) part.remove();
  }
  if (kind === 'frames' && min_clearance === null) byId('rows-section').remove();
  if (rows.status.length === 0) {
    for (const part of document.querySelectorAll('.pair, #answer-section, #rows-section')) part.remove();
  } else {
    const beside = { pair: 'answer', pairs: 'rows', parts: 'rows', frames: 'charts' }[kind];
    document.querySelector('.pair')!.append(byId(`${beside}-section`));
  }
}

/** All rows, the worst first. */
function listOf(data: Data, choose: (row: number) => void): RowList {
  const { rows, kind, worst_first } = data;
  const names = kind === 'parts' || !isOfOnePair(data) ? [kind === 'parts' ? 'Parts' : 'Models'] : [];
  const all = totalOf(data) > rows.row.length ? `The worst ${rows.row.length}` : 'All';
  byId('rows-title').textContent = `${all} ${kind === 'frames' ? 'frames' : 'pairs'}, the worst first`;
  const shown = worst_first.map((row) => {
    const { kind: word, text } = verdictOf(data, row);
    const both = [rows.a[row], rows.b[row]].map((part) => element('div', '', partName(data, part)));
    const cells = [...names.map(() => element('span', 'wrapping', ...both)), text, shownDistance(data, row)];
    return { row, kind: word, cells: [String(rows.row[row]), ...cells] };
  });
  const verdict = kind === 'frames' ? 'Clearance' : 'Clash';
  return new RowList([rowName(data), ...names, verdict, 'Distance'], shown, choose);
}

/** Lets the reader choose a row, which everything then shows. */
function showRows(data: Data, parts: readonly Part[]): void {
  const { kind, rows, worst_first, frame_count, stride, min_clearance } = data;
  const [worst] = worst_first;
  const first = kind === 'frames' && min_clearance === null ? 0 : worst;
  const shows: { show(row: number): void }[] = [];
  const show = (row: number): void => shows.forEach((shown) => shown.show(row));
  const choose = (row: number): void => (player === undefined ? show(row) : player.jumpTo(row));
  // Charts come first, as the view is as high as they are.
  if (kind === 'frames' || kind === 'pairs') shows.push(...showCharts(data, choose));
  const list = document.getElementById('rows') === null ? undefined : listOf(data, choose);
  if (list !== undefined) shows.push(list);
  shows.push({ show: (row) => showAnswer(data, row) }, new View(data, parts, first));
  let player: Player | undefined;
  if (kind === 'frames') {
    const keptRows = rows.row.filter((row) => (row % frame_count) % stride === 0);
    player = new Player(keptRows, (row) => {
      show(row);
      byId('frame-text').textContent = `${row} of ${rows.status.length - 1}`;
      byId('frame').setAttribute('aria-valuetext', `frame ${row}, ${shownDistance(data, row)}`);
    });
    byId('worst').hidden = min_clearance === null;
    byId('worst').addEventListener('click', () => choose(worst));
  }
  if (kind !== 'pair') {
    byId('back').addEventListener('click', () => (player ?? list)!.step(-1));
    byId('forward').addEventListener('click', () => (player ?? list)!.step(1));
  }
  choose(first);
}

const data = readData();
takeParts(data);
setUnit(data.unit);
showTitles(data);
showTiles(data);
const models = modelsOf(data);
showModels(data, models);
showMaking(data);
if (data.rows.status.length > 0) showRows(data, partsOf(data, models));
connectCopy();
