// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The view of `limber haptics --report`: what apps/limber/haptics/haptic_page.cpp writes. */

import { Chart } from '../replay/chart.ts';
import type { ChartOptions } from '../replay/chart.ts';
import { byId, fillTable } from '../shared/dom.ts';
import { inPage, shown } from '../shared/numbers.ts';
import { tile } from '../viewer/texts.ts';

export interface Histogram {
  name: string;
  bins: { from_us: number; to_us: number; ticks: number }[];
}

export interface HapticData {
  haptics: {
    rate_hz: number;
    introduction: string;
    tiles: [string, string][];
    work: Histogram[];
    wake_up: Histogram[];
    /** By groups of ticks that lie side by side in a picture. */
    slowest: { group: number; work_us: number[]; query_us: number[]; missed: number[] };
    times: string[][];
    summary: [string, string][];
  };
}

const colors = ['model-a', 'model-b'];
const empty = 0.5; // is drawn where a bin has no tick: below one, at the lower end of the axis

/** Histograms over the bins of all. A curve ends where its last bin does. */
export function stepsOf(histograms: readonly Histogram[]): { edges: number[]; heights: (number | null)[][] } {
  const edges = [...new Set(histograms.flatMap(({ bins }) => bins.flatMap((bin) => [bin.from_us, bin.to_us])))];
  edges.sort((a, b) => a - b);
  const heights = histograms.map(({ bins }) => {
    const ticks = new Map(bins.map((bin) => [bin.from_us, bin.ticks]));
    const last = bins[bins.length - 1].to_us;
    return edges.map((edge) => (edge < bins[0].from_us || edge > last ? null : (ticks.get(edge) ?? empty)));
  });
  return { edges, heights };
}

function histogramChart(title: string, all: readonly Histogram[], marks: readonly number[] = []): ChartOptions | null {
  const histograms = all.filter(({ bins }) => bins.length > 0);
  if (histograms.length === 0) return null;
  const { edges, heights } = stepsOf(histograms);
  return {
    title,
    unit: 'ticks by \u00b5s, both logarithmic',
    isLogarithmic: true,
    x: { values: edges, isLogarithmic: true },
    curves: histograms.map(({ name }, i) => ({ name, color: colors[i], values: heights[i], isStepped: true })),
    marks,
  };
}

export function showHaptics(data: HapticData['haptics']): void {
  document.title = `A haptic loop at ${shown(data.rate_hz)} Hz`;
  byId('kind').textContent = 'limber haptics';
  byId('title').textContent = document.title;
  byId('introduction').textContent = inPage(data.introduction);
  byId('tiles').append(...data.tiles.map(([number, name]) => tile(inPage(number), inPage(name))));
  const { group, work_us, query_us, missed } = data.slowest;
  const seconds = work_us.map((_, i) => (i * group) / data.rate_hz);
  const missedAt = work_us.map((us, i) => (missed.includes(i) ? us : null));
  const charts = [
    histogramChart('Work of a tick; the line is at the period', data.work, [1e6 / data.rate_hz]),
    histogramChart('Late wake-ups: what both loops have in common comes from the machine', data.wake_up),
    {
      title: 'The slowest of the ticks that lie side by side here',
      unit: '\u00b5s, logarithmic, by seconds',
      isLogarithmic: true,
      x: { values: seconds, isLogarithmic: false },
      curves: [
        { name: 'whole tick', color: colors[0], values: work_us },
        { name: 'query', color: colors[1], values: query_us },
      ],
      dots: missed.length > 0 ? [{ name: 'missed', color: 'mark', values: missedAt, size: 6 }] : [],
    },
  ];
  for (const chart of charts) {
    if (chart !== null) new Chart(byId('charts'), chart);
  }
  for (const table of ['times', 'summary'] as const) {
    fillTable(
      byId(table),
      data[table].map((row) => row.map(inPage)),
    );
  }
}
