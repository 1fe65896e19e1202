// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The charts over the rows: distances, and of frames times and contacts. */

import { Chart } from '../shared/chart.ts';
import type { ChartOptions, Series } from '../shared/chart.ts';
import { byId } from '../shared/dom.ts';
import { inUnit, median, percent, percentile, shownLength, shownTime } from '../shared/numbers.ts';
import { isOfOnePair } from './data.ts';
import type { Data } from './data.ts';
import { contactName, pairName, queryName } from './texts.ts';

const mostLines = 50; // of a chart

export function showCharts(data: Data, jump: (row: number) => void): Chart[] {
  const { kind, rows, contacts, demo } = data;
  const charts = [distanceChart(data)];
  let caption = 'A click goes to a row.';
  if (kind === 'frames') {
    caption = 'Over the frames; a click goes to one.';
    const updates = { name: 'update', color: 'model-a', values: rows.update_us! };
    const queries = [{ name: queryName(data), color: 'model-a', values: rows.query_us }];
    if (demo !== undefined) {
      const { relative_error, query_us } = demo.rough;
      queries.push({ name: `within ${percent(relative_error)}`, color: 'model-b', values: query_us });
    }
    if (rows.update_us!.some((us) => us > 0)) charts.push(timeChart('Time of an update', [updates]));
    charts.push(timeChart('Time of a distance query', queries));
  }
  for (const { name, count, intersecting } of contacts) {
    const all: Series = { kind: 'line', name: 'all', color: 'model-a', values: count };
    const met: Series = { kind: 'dashed', name: 'that intersect', color: 'model-b', values: intersecting };
    charts.push({ title: contactName(name), unit: 'pairs of triangles', series: [all, met] });
  }
  const length = windowLength(rows.status.length);
  if (charts[0].marks!.length > 0) caption += ' Red lines are impacts between frames.';
  if (kind === 'frames' && length > 1) {
    caption +=
      ` Times: lines are medians of ${length} frames, areas reach from the 5th to the 95th percentile, dots are the ` +
      'largest of each, the large one the largest of all.';
  }
  byId('charts-caption').textContent = caption;
  return charts.map((options) => new Chart(byId('charts'), options, jump));
}

/** The rows of each two models, which may stand in many poses. */
function rowsByModels({ rows, parts: { model } }: Data): number[][] {
  const groups = new Map<string, number[]>();
  rows.a.forEach((a, row) => {
    const key = `${model[a]} ${model[rows.b[row]]}`;
    const group = groups.get(key);
    if (group === undefined) groups.set(key, [row]);
    else group.push(row);
  });
  return [...groups.values()];
}

/** A curve for each two models, whose rows need not follow each other. */
function curvesOf(data: Data, name: string, color: string, values: readonly (number | null)[]): Series[] {
  if (data.kind === 'frames') return [{ kind: 'line', name, color, values }];
  const groups = rowsByModels(data);
  const lines = groups.filter((rows) => rows.length > 1).slice(0, mostLines);
  const single = groups.filter((rows) => !lines.includes(rows)).flat();
  return [...lines, ...(single.length > 0 ? [single] : [])].map((rows, i) => {
    const own = new Set(rows);
    const ofOwn = values.map((value, row) => (own.has(row) ? value : null));
    return { kind: rows === single ? 'dot' : 'spanned', name: i === 0 ? name : undefined, color, values: ofOwn };
  });
}

function distanceChart(data: Data): ChartOptions {
  const { kind, rows, impacts, demo, min_clearance } = data;
  const { clash, lower, upper, too_close } = rows;
  const isInterval = lower.some((number, row) => number !== upper[row]);
  const exact = kind === 'frames' ? 'exact' : 'distance';
  const area: Series = { kind: 'area', color: 'model-a', low: lower, values: upper };
  const dotsOf = (name: string, color: string, size: number, isMeant: (row: number) => boolean): Series[] => {
    const values = upper.map((number, row) => (isMeant(row) ? (number ?? lower[row]) : null));
    return values.every((value) => value === null) ? [] : [{ kind: 'dot', name, color, values, size }];
  };
  const isOf = (word: string) => (row: number) => clash?.[row] === word;
  const rough = demo?.rough;
  const certified = `certified interval at ${percent(rough?.relative_error ?? 0)}`;
  const required = shownLength(min_clearance ?? 0);
  return {
    title: 'Distance',
    unit: kind === 'frames' ? inUnit() : `of surfaces, ${inUnit()}; by row`,
    series: [
      ...(isInterval && isOfOnePair(data) ? [area] : []),
      ...(rough ? [{ ...area, name: certified, color: 'model-b', low: rough.lower, values: rough.upper }] : []),
      ...curvesOf(data, isInterval ? 'upper bound' : exact, 'model-a', upper),
      ...(isInterval ? curvesOf(data, 'lower bound', 'model-b', lower) : []),
      ...dotsOf('in contact', 'mark', 6, (row) => kind === 'frames' && rows.status[row] === 'collision'),
      ...dotsOf('hard clash', 'mark', 8, isOf('hard_clash')),
      ...dotsOf('cannot tell', 'ink', 8, isOf('cannot_tell')),
      ...dotsOf('surfaces meet', 'ink', 7, isOf('surfaces_meet')),
      ...dotsOf('touching', 'edge', 7, isOf('touching')),
      ...dotsOf('below the clearance', 'model-b', 6, (row) => isOf('clearance')(row) && too_close[row] === true),
    ],
    limit: min_clearance === null ? undefined : { name: `required clearance ${required}`, value: min_clearance },
    marks: impacts.flatMap((of) => of.lower.flatMap((at, row) => (of.status[row] === 'contact' ? at! : []))),
    names: rows.row.map((number, row) => `${number}${isOfOnePair(data) ? '' : `: ${pairName(data, row)}`}`),
  };
}

interface Times {
  name: string;
  color: string;
  values: readonly number[];
}

/** Of few frames each time; of more, what windows of frames have in common, and the largest of each. */
function timeChart(title: string, times: readonly Times[]): ChartOptions {
  const length = windowLength(times[0].values.length);
  const layers = times.map(({ name, color, values }): Series[] => {
    const some = values.filter((us) => us > 0);
    const most = some.reduce((a, b) => Math.max(a, b), 0);
    const numbers = most > 0 ? `median ${shownTime(median(some))}, max ${shownTime(most)}` : 'none';
    const line: Series = { kind: 'line', name, numbers, color, values };
    if (length === 1) return [line];
    const {
      low,
      high,
      median: middle,
      largest,
    } = windowsOf(
      values.map((us) => (us > 0 ? us : null)),
      length,
    );
    return [
      { kind: 'area', color, low, values: high },
      { ...line, values: middle },
      { kind: 'dot', color, values: largest, size: 4 },
      { kind: 'dot', color, values: largest.map((us) => (us === most ? us : null)), size: 9 },
    ];
  });
  // First the areas of all, then their lines, then dots.
  const series = layers[0].flatMap((_, layer) => layers.map((of) => of[layer]));
  return { title, unit: '\u00b5s, logarithmic', isLogarithmic: true, series };
}

/** Many times in few numbers: percentiles of windows of frames. */
interface Windows {
  /** For each frame, of the window that it is in. */
  median: (number | null)[];
  low: (number | null)[];
  high: (number | null)[];
  /** The largest of each window, at the frame where it is. */
  largest: (number | null)[];
}

const mostAlone = 200; // frames that a chart shows one by one
const mostWindows = 40;
const lengths = [20, 50, 100, 200, 500, 1000, 2000, 5000]; // of 20 and more, the 95th percentile is not the largest

/** How many frames a window has; 1 where there are so few frames that each is shown. */
export function windowLength(count: number): number {
  if (count <= mostAlone) return 1;
  return lengths.find((length) => count / length <= mostWindows) ?? lengths[lengths.length - 1];
}

/** The median, and the 5th and 95th percentiles. The last window has the frames that are left over, too. */
export function windowsOf(values: readonly (number | null)[], length: number): Windows {
  const windows: Windows = { median: [], low: [], high: [], largest: values.map(() => null) };
  const count = Math.max(1, Math.floor(values.length / length));
  for (let w = 0; w < count; ++w) {
    const begin = w * length;
    const inside = values.slice(begin, w + 1 === count ? values.length : begin + length);
    const sorted = inside.filter((value) => value !== null).sort((a, b) => a - b);
    for (const [list, part] of [
      [windows.low, 0.05],
      [windows.median, 0.5],
      [windows.high, 0.95],
    ] as const) {
      list.push(...inside.map(() => percentile(sorted, part) ?? null));
    }
    if (sorted.length > 0) {
      const most = sorted[sorted.length - 1];
      windows.largest[begin + inside.indexOf(most)] = most;
    }
  }
  return windows;
}
