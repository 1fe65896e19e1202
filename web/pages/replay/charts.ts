// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The charts of a sequence. */

import { Chart } from '../shared/charts.ts';
import type { ChartOptions, Curve } from '../shared/charts.ts';
import { byId } from '../shared/dom.ts';
import type { ReplayData } from './data.ts';
import { contactName } from './texts.ts';

export function showCharts(data: ReplayData, jump: (row: number) => void): Chart[] {
  const { rows, contacts } = data;
  const isInterval = rows.lower.some((lower, row) => lower !== rows.upper[row]);
  const upper: Curve = { name: isInterval ? 'upper bound' : 'exact', color: 'model-a', values: rows.upper };
  const lower: Curve = { name: 'lower bound', color: 'model-b', values: rows.lower };
  const charts: ChartOptions[] = [
    {
      title: 'Distance',
      unit: 'in the meshes\u2019 unit',
      curves: isInterval ? [upper, lower] : [upper],
      isBand: isInterval,
    },
    {
      title: 'Time',
      unit: '\u00b5s, logarithmic',
      isLogarithmic: true,
      curves: [
        { name: 'query', color: 'model-a', values: rows.query_us },
        ...(rows.update_us.some((us) => us > 0)
          ? [{ name: 'update of the trees', color: 'model-b', values: rows.update_us }]
          : []),
      ],
    },
    ...contacts.map(({ name, count, intersecting }) => ({
      title: contactName(name),
      unit: 'pairs of triangles',
      curves: [
        { name: 'all', color: 'model-a', values: count },
        { name: 'that intersect', color: 'model-b', values: intersecting, isDashed: true },
      ],
    })),
  ];
  return charts.map((options) => new Chart(byId('charts'), options, jump));
}
