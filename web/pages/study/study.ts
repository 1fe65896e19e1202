// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/**
 * The view of `limber distance --pairs --report` and `limber distance --parts --report`: a verdict about many pairs,
 * the worst first, and each of them in 3D.
 */

import { Chart } from '../replay/chart.ts';
import type { ChartOptions, Dots } from '../replay/chart.ts';
import { limitAt } from '../replay/charts.ts';
import { byId, element } from '../shared/dom.ts';
import { inUnit } from '../shared/numbers.ts';
import { clashWords } from '../viewer/clashes.ts';
import { RowList } from '../viewer/row_list.ts';
import { Matrix } from './matrix.ts';
import { worstFirst } from './model.ts';
import type { StudyData } from './model.ts';
import {
  clashText,
  isOfOnePair,
  partName,
  rowName,
  showKind,
  showModels,
  showPair,
  showTiles,
  shownDistance,
} from './texts.ts';
import { StudyView } from './view.ts';

export function showStudy(data: StudyData): void {
  const { study } = data;
  const order = worstFirst(study.rows);
  showKind(data);
  showTiles(study, order[0]);
  showModels(data);
  const select = (row: number): void => {
    view.show(row);
    showPair(study, row);
    for (const shown of shows) shown.show(row);
  };
  const list = listOf(study, order, select);
  const isMatrix = study.kind === 'parts';
  byId(isMatrix ? 'charts-section' : 'matrix-section').remove();
  const map = isMatrix ? new Matrix(study, select) : new Chart(byId('charts'), chartOf(study), select);
  const shows = [list, map];
  byId('back').addEventListener('click', () => list.step(-1));
  byId('forward').addEventListener('click', () => list.step(1));
  const view = new StudyView(data, order[0]);
  showPair(study, order[0]);
  for (const shown of shows) shown.show(order[0]);
}

function listOf(study: StudyData['study'], order: readonly number[], select: (row: number) => void): RowList {
  const { rows } = study;
  const names = isOfOnePair(study) ? [] : [study.kind === 'pairs' ? 'Models' : 'Parts'];
  const namesOf = (row: number): Node[] =>
    [rows.a, rows.b].map((side) => element('div', '', partName(study, side[row])));
  const listed = order.map((row) => ({
    row,
    kind: clashWords[rows.clash[row]],
    cells: [
      String(row),
      ...names.map(() => element('span', 'wrapping', ...namesOf(row))),
      clashText(study, row),
      shownDistance(study, row),
    ],
  }));
  return new RowList([rowName(study), ...names, 'Clash', 'Distance'], listed, select);
}

function chartOf({ rows, min_clearance }: StudyData['study']): ChartOptions {
  const isInterval = rows.lower.some((lower, row) => lower !== rows.upper[row]);
  const dotsOf = (name: string, color: string, size: number, isMeant: (row: number) => boolean): Dots[] => {
    const values = rows.upper.map((upper, row) => (isMeant(row) ? (upper ?? rows.lower[row]) : null));
    return values.every((value) => value === null) ? [] : [{ name, color, values, size }];
  };
  const { clash, too_close } = rows;
  return {
    title: 'Distance',
    unit: `of surfaces, ${inUnit()}; by row`,
    areas: isInterval ? [{ color: 'model-a', low: rows.lower, high: rows.upper }] : [],
    curves: [
      { name: isInterval ? 'upper bound' : 'distance', color: 'model-a', values: rows.upper },
      ...(isInterval ? [{ name: 'lower bound', color: 'model-b', values: rows.lower }] : []),
    ],
    dots: [
      ...dotsOf('hard clash', 'mark', 8, (row) => clash[row] === 'hard_clash'),
      ...dotsOf('surfaces meet', 'ink', 7, (row) => clash[row] === 'surfaces_meet'),
      ...dotsOf('touching', 'edge', 7, (row) => clash[row] === 'touching'),
      ...dotsOf('below the clearance', 'model-b', 6, (row) => clash[row] === 'clearance' && too_close[row] === true),
    ],
    limit: min_clearance === null ? undefined : limitAt(min_clearance),
  };
}
