// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/**
 * The view of `limber distance --pairs --report` and `limber distance --parts --report`: a verdict about many pairs,
 * the worst first, and each of them in 3D.
 */

import { Chart } from '../replay/chart.ts';
import type { ChartOptions, Curve, Dots } from '../replay/chart.ts';
import { limitAt } from '../replay/charts.ts';
import { byId, element } from '../shared/dom.ts';
import { inUnit } from '../shared/numbers.ts';
import { RowList } from '../viewer/row_list.ts';
import { Matrix } from './matrix.ts';
import type { StudyData } from './model.ts';
import {
  clashText,
  isOfOnePair,
  kindOf,
  pairName,
  partName,
  rowName,
  showKind,
  showModels,
  showPair,
  showTiles,
  shownDistance,
} from './texts.ts';
import { StudyView } from './view.ts';

const mostInMatrix = 200; // parts

export function showStudy(data: StudyData): void {
  const { study } = data;
  const order = study.worst_first;
  showKind(data);
  showTiles(study, order[0]);
  showModels(data);
  const isMatrix = study.kind === 'parts' && study.parts.name.length <= mostInMatrix;
  byId(study.kind === 'parts' ? 'charts-section' : 'matrix-section').remove();
  if (study.kind === 'parts' && !isMatrix) byId('matrix-section').remove();
  if (order.length === 0) {
    for (const part of document.querySelectorAll('.pair, section:has(#answer), #matrix-section')) part.remove();
    return;
  }
  const select = (row: number): void => {
    view.show(row);
    showPair(study, row);
    for (const shown of shows) shown.show(row);
  };
  const list = listOf(study, order, select);
  const shows: { show(row: number): void }[] = [list];
  if (isMatrix) shows.push(new Matrix(study, select));
  else if (study.kind === 'pairs') shows.push(new Chart(byId('charts'), chartOf(study), select));
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
    kind: kindOf(study, row),
    cells: [
      String(rows.row[row]),
      ...names.map(() => element('span', 'wrapping', ...namesOf(row))),
      clashText(study, row),
      shownDistance(study, row),
    ],
  }));
  return new RowList([rowName(study), ...names, 'Clash', 'Distance'], listed, select);
}

const mostLines = 50;

/** The rows of each two models, which may stand in many poses. */
function rowsByModels({ rows, parts: { model } }: StudyData['study']): number[][] {
  const groups = new Map<string, number[]>();
  rows.a.forEach((a, row) => {
    const key = `${model[a]} ${model[rows.b[row]]}`;
    groups.set(key, [...(groups.get(key) ?? []), row]);
  });
  return [...groups.values()];
}

/** A curve for each two models, whose rows need not follow each other. */
function curvesOf(study: StudyData['study'], isInterval: boolean): Curve[] {
  const { upper, lower } = study.rows;
  const groups = rowsByModels(study);
  const lines = groups.filter((rows) => rows.length > 1).slice(0, mostLines);
  const single = groups.filter((rows) => !lines.includes(rows)).flat();
  const curves = (name: string, color: string, values: typeof upper): Curve[] =>
    [...lines, ...(single.length > 0 ? [single] : [])].map((rows, i) => {
      const own = new Set(rows);
      const ofOwn = values.map((value, row) => (own.has(row) ? value : null));
      return { name: i === 0 ? name : undefined, color, values: ofOwn, gaps: rows === single ? 'dots' : 'spanned' };
    });
  return [
    ...curves(isInterval ? 'upper bound' : 'distance', 'model-a', upper),
    ...(isInterval ? curves('lower bound', 'model-b', lower) : []),
  ];
}

function chartOf(study: StudyData['study']): ChartOptions {
  const { rows, min_clearance } = study;
  const isInterval = rows.lower.some((lower, row) => lower !== rows.upper[row]);
  const dotsOf = (name: string, color: string, size: number, isMeant: (row: number) => boolean): Dots[] => {
    const values = rows.upper.map((upper, row) => (isMeant(row) ? (upper ?? rows.lower[row]) : null));
    return values.every((value) => value === null) ? [] : [{ name, color, values, size }];
  };
  const { clash, too_close } = rows;
  return {
    title: 'Distance',
    unit: `of surfaces, ${inUnit()}; by row`,
    areas: isInterval && isOfOnePair(study) ? [{ color: 'model-a', low: rows.lower, high: rows.upper }] : [],
    curves: curvesOf(study, isInterval),
    names: rows.row.map((number, row) => `${number}${isOfOnePair(study) ? '' : `: ${pairName(study, row)}`}`),
    dots: [
      ...dotsOf('hard clash', 'mark', 8, (row) => clash[row] === 'hard_clash'),
      ...dotsOf('cannot tell', 'ink', 8, (row) => clash[row] === 'cannot_tell'),
      ...dotsOf('surfaces meet', 'ink', 7, (row) => clash[row] === 'surfaces_meet'),
      ...dotsOf('touching', 'edge', 7, (row) => clash[row] === 'touching'),
      ...dotsOf('below the clearance', 'model-b', 6, (row) => clash[row] === 'clearance' && too_close[row] === true),
    ],
    limit: min_clearance === null ? undefined : limitAt(min_clearance),
  };
}
