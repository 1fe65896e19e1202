// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The charts of a sequence. */

import { byId } from '../shared/dom.ts';
import { inUnit, median, percentile, shownLength, shownTime } from '../shared/numbers.ts';
import { Chart } from './chart.ts';
import type { Area, ChartOptions, Curve, Dots } from './chart.ts';
import type { ReplayData } from './model.ts';
import { contactName, percent, queryName } from './texts.ts';

export function showCharts(data: ReplayData, jump: (row: number) => void): Chart[] {
  const { rows, contacts, demo } = data;
  const queries: Times[] = [{ name: queryName(data), color: 'model-a', values: rows.query_us }];
  if (demo !== undefined) {
    queries.push({
      name: `within ${percent(demo.rough.relative_error)}`,
      color: 'model-b',
      values: demo.rough.query_us,
    });
  }
  const updates: Times[] = [{ name: 'update', color: 'model-a', values: rows.update_us }];
  const charts: ChartOptions[] = [
    distanceChart(data),
    ...(rows.update_us.some((us) => us > 0) ? [timeChart('Time of an update', updates)] : []),
    timeChart('Time of a distance query', queries),
    ...contacts.map(({ name, count, intersecting }) => ({
      title: contactName(name),
      unit: 'pairs of triangles',
      curves: [
        { name: 'all', color: 'model-a', values: count },
        { name: 'that intersect', color: 'model-b', values: intersecting, isDashed: true },
      ],
    })),
  ];
  const length = windowLength(rows.status.length);
  if (charts[0].marks!.length > 0) byId('charts-caption').textContent += ' Red lines are impacts between frames.';
  if (length > 1) {
    byId('charts-caption').textContent +=
      ` Times: lines are medians of ${length} frames, areas reach from the 5th to the 95th percentile, dots are the ` +
      'largest of each, the large one the largest of all.';
  }
  return charts.map((options) => new Chart(byId('charts'), options, jump));
}

/** The clearance that is required, as charts have it. */
export const limitAt = (clearance: number): { name: string; value: number } => ({
  name: `required clearance ${shownLength(clearance)}`,
  value: clearance,
});

function distanceChart({ rows, impacts, demo, min_clearance }: ReplayData): ChartOptions {
  const isInterval = rows.lower.some((lower, row) => lower !== rows.upper[row]);
  const upper: Curve = { name: isInterval ? 'upper bound' : 'exact', color: 'model-a', values: rows.upper };
  const lower: Curve = { name: 'lower bound', color: 'model-b', values: rows.lower };
  const areas: Area[] = isInterval ? [{ color: 'model-a', low: rows.lower, high: rows.upper }] : [];
  if (demo !== undefined) {
    const name = `certified interval at ${percent(demo.rough.relative_error)}`;
    areas.push({ name, color: 'model-b', low: demo.rough.lower, high: demo.rough.upper });
  }
  const contact = rows.status.map((status) => (status === 'collision' ? 0 : null));
  const dots: Dots[] = contact.includes(0) ? [{ name: 'in contact', color: 'mark', values: contact, size: 6 }] : [];
  return {
    title: 'Distance',
    unit: inUnit(),
    areas,
    curves: isInterval ? [upper, lower] : [upper],
    dots,
    limit: min_clearance === null ? undefined : limitAt(min_clearance),
    marks: impacts.flatMap(({ status, lower }) => lower.flatMap((at, row) => (status[row] === 'contact' ? at! : []))),
  };
}

interface Times {
  name: string;
  color: string;
  values: readonly number[];
}

/** Of few frames each time; of more, what windows of frames have in common, and the largest of each. */
function timeChart(title: string, times: readonly Times[]): ChartOptions {
  const named = times.map(({ name, color, values }) => {
    const some = values.filter((us) => us > 0);
    if (some.length === 0) return { name, numbers: 'none', color, values };
    const most = some.reduce((a, b) => Math.max(a, b));
    return { name, numbers: `median ${shownTime(median(some))}, max ${shownTime(most)}`, color, values };
  });
  const chart = { title, unit: '\u00b5s, logarithmic', isLogarithmic: true };
  const length = windowLength(times[0].values.length);
  if (length === 1) return { ...chart, curves: named };
  const summed = named.map(({ name, numbers, color, values }) => ({
    name,
    numbers,
    color,
    most: values.reduce((a, b) => Math.max(a, b)),
    ...windowsOf(
      values.map((us) => (us > 0 ? us : null)),
      length,
    ),
  }));
  return {
    ...chart,
    areas: summed.map(({ color, low, high }) => ({ color, low, high })),
    curves: summed.map(({ name, numbers, color, median }) => ({ name, numbers, color, values: median })),
    dots: summed.flatMap(({ color, largest, most }) => [
      { color, values: largest, size: 4 },
      { color, values: largest.map((us) => (us === most ? us : null)), size: 9 },
    ]),
  };
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
