// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The charts over the rows: distances, and of frames times and contacts. */

import { Chart } from '../shared/chart.ts';
import type { ChartOptions, Series } from '../shared/chart.ts';
import { byId } from '../shared/dom.ts';
import { inUnit, median, percent, shownLength, shownTime } from '../shared/numbers.ts';
import { isOfOnePair } from './data.ts';
import type { Data } from './data.ts';
import { contactName, pairName, queryName } from './texts.ts';

export function showCharts(data: Data, jump: (row: number) => void): Chart[] {
  const { kind, rows, contacts, demo } = data;
  const charts = [distanceChart(data)];
  if (kind === 'frames') {
    const queries = [timesOf(queryName(data), 'model-a', rows.query_us)];
    if (demo !== undefined) {
      const { relative_error, query_us } = demo.rough;
      queries.push(timesOf(`within ${percent(relative_error)}`, 'model-b', query_us));
    }
    const updates = [timesOf('update', 'model-a', rows.update_us!)];
    const ofTimes = { unit: '\u00b5s, logarithmic', isLogarithmic: true };
    if (rows.update_us!.some((us) => us > 0)) charts.push({ title: 'Time of an update', ...ofTimes, series: updates });
    charts.push({ title: 'Time of a distance query', ...ofTimes, series: queries });
  }
  for (const { name, count, intersecting } of contacts) {
    const all: Series = { kind: 'line', name: 'all', color: 'model-a', values: count };
    const met: Series = { kind: 'dashed', name: 'that intersect', color: 'model-b', values: intersecting };
    charts.push({ title: contactName(name), unit: 'pairs of triangles', series: [all, met] });
  }
  byId('charts-caption').textContent = `A click goes to a ${kind === 'frames' ? 'frame' : 'row'}.`;
  return charts.map((options) => new Chart(byId('charts'), options, jump));
}

function timesOf(name: string, color: string, values: readonly number[]): Series {
  const most = values.reduce((a, b) => Math.max(a, b), 0);
  const numbers = `median ${shownTime(median(values))}, max ${shownTime(most)}`;
  return { kind: 'line', name, numbers, color, values };
}

/** Rows of one pair are a curve, others are dots. */
function distanceChart(data: Data): ChartOptions {
  const { kind, rows, demo, min_clearance } = data;
  const { lower, upper } = rows;
  const isInterval = lower.some((number, row) => number !== upper[row]);
  const isOnePair = isOfOnePair(data);
  const curve = isOnePair ? 'line' : 'dot';
  const series: Series[] = [];
  if (isInterval && isOnePair) series.push({ kind: 'area', color: 'model-a', low: lower, values: upper });
  if (demo !== undefined) {
    const { relative_error, lower: low, upper: values } = demo.rough;
    series.push({
      kind: 'area',
      name: `certified interval at ${percent(relative_error)}`,
      color: 'model-b',
      low,
      values,
    });
  }
  const name = isInterval ? 'upper bound' : kind === 'frames' ? 'exact' : 'distance';
  series.push({ kind: curve, name, color: 'model-a', values: upper });
  if (isInterval) series.push({ kind: curve, name: 'lower bound', color: 'model-b', values: lower });
  const isOf = (word: string) => (row: number) => rows.clash?.[row] === word;
  const dots: [string, string, (row: number) => boolean][] = [
    ['in contact', 'mark', (row) => kind === 'frames' && rows.status[row] === 'collision'],
    ['hard clash', 'mark', isOf('hard_clash')],
    ['cannot tell', 'ink', isOf('cannot_tell')],
    ['surfaces meet', 'ink', isOf('surfaces_meet')],
    ['touching', 'edge', isOf('touching')],
    ['below the clearance', 'model-b', (row) => isOf('clearance')(row) && rows.too_close[row] === true],
  ];
  for (const [name, color, isMeant] of dots) {
    const values = upper.map((number, row) => (isMeant(row) ? (number ?? lower[row]) : null));
    if (values.some((value) => value !== null)) series.push({ kind: 'dot', name, color, values });
  }
  if (min_clearance !== null) {
    const name = `required clearance ${shownLength(min_clearance)}`;
    series.push({ kind: 'dashed', name, color: 'mark', values: upper.map(() => min_clearance) });
  }
  return {
    title: 'Distance',
    unit: kind === 'frames' ? inUnit() : `of surfaces, ${inUnit()}; by row`,
    series,
    names: rows.row.map((number, row) => `${number}${isOnePair ? '' : `: ${pairName(data, row)}`}`),
  };
}
