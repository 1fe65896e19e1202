// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Charts, such as those over the rows of a sequence: linked, with a line at the row that is shown. */

import uPlot from 'uplot';
import { element, onThemeChange, token } from './dom.ts';
import { shown } from './numbers.ts';

type Values = readonly (number | null)[];

/** What is drawn, from the back to the front. */
export interface Series {
  /** A line, which ends where values are missing; what is above `low`; or dots alone. */
  kind: 'line' | 'dashed' | 'area' | 'dot';
  /** What is without a name has no key. */
  name?: string;
  /** In the key, after the name. */
  numbers?: string;
  /** A token of page.css. */
  color: string;
  values: Values;
  low?: Values;
}

export interface ChartOptions {
  title: string;
  unit: string;
  series: readonly Series[];
  isLogarithmic?: boolean;
  /** What the rows are called, under the pointer. */
  names?: readonly string[];
}

const height = 180;
const rowSteps = [0, 1, 2, 3, 4].flatMap((power) => [1, 2, 5].map((factor) => factor * 10 ** power));

export class Chart {
  private readonly plot: uPlot;
  private row: number | undefined;
  private readonly options: ChartOptions;

  /** Appends the chart to `host`; `jump` is called with the row that a reader points at. */
  constructor(host: HTMLElement, options: ChartOptions, jump: (row: number) => void) {
    this.options = options;
    const { title, unit, series, isLogarithmic } = options;
    const area = element('div', 'plot');
    area.setAttribute('role', 'img');
    area.setAttribute('aria-label', described(options));
    const caption = element('p', 'soft keys', element('span', 'unit', unit), ...series.flatMap(key));
    host.append(element('div', 'chart', element('h3', '', title), caption, area));
    const rows = series[0].values.map((_, row) => row);
    const lists = series.flatMap(({ values, low }) => (low === undefined ? [values] : [values, low]));
    // Logarithms need positive numbers: others are gaps.
    const drawn = lists.map((values) => values.map((v) => (isLogarithmic === true && v !== null && v <= 0 ? null : v)));
    this.plot = new uPlot(this.settings(area.clientWidth), [rows, ...drawn], area);
    new ResizeObserver(() => this.plot.setSize({ width: area.clientWidth, height })).observe(area);
    onThemeChange(() => this.plot.redraw());
    this.followPointer(jump);
  }

  show(row: number): void {
    this.row = row;
    this.plot.redraw(false);
  }

  private followPointer(jump: (row: number) => void): void {
    const { over } = this.plot;
    const rowAt = (event: PointerEvent): number => this.plot.posToIdx(event.offsetX);
    over.addEventListener('pointerdown', (event) => {
      over.setPointerCapture(event.pointerId);
      jump(rowAt(event));
    });
    over.addEventListener('pointermove', (event) => {
      if (event.buttons !== 0) jump(rowAt(event));
      over.title = this.options.names?.[rowAt(event)] ?? '';
    });
  }

  private settings(width: number): uPlot.Options {
    const { isLogarithmic = false } = this.options;
    const series: uPlot.Series[] = [{}];
    const bands: uPlot.Band[] = [];
    for (const { kind, color, values } of this.options.series) {
      const stroke = (): string => token(color);
      const isDot = kind === 'dot';
      if (kind === 'area') {
        // Grid and curves show through.
        bands.push({ series: [series.length, series.length + 1], fill: () => `${token(color)}59` });
        series.push({ width: 0, points: { show: false } }, { width: 0, points: { show: false } });
      } else {
        series.push({
          stroke,
          paths: isDot ? () => null : undefined,
          width: values.length > 200 ? 1.2 : 1.8,
          dash: kind === 'dashed' ? [5, 4] : undefined,
          points: { show: isDot || values.length === 1, size: 7, fill: isDot ? stroke : undefined },
        });
      }
    }
    const font = `14px ${getComputedStyle(document.body).fontFamily}`;
    const grid = { stroke: () => token('grid'), width: 1 };
    const axis = { font, grid, stroke: () => token('soft'), ticks: { show: false } };
    // Axes start at zero, unless the curve would be a line far above it.
    const range = { min: { pad: 1, soft: 0, mode: 3 }, max: { pad: 0.06 } } as const;
    return {
      width,
      height,
      legend: { show: false },
      cursor: { sync: { key: 'rows' }, drag: { x: false, y: false }, points: { show: false } },
      scales: { x: { time: false }, y: isLogarithmic ? { distr: 3 } : { range } },
      axes: [
        { ...axis, size: 30, incrs: rowSteps },
        { ...axis, size: 64, values: (_, all) => all.map((v) => (v === null ? '' : shown(v, 4))) },
      ],
      series,
      bands,
      hooks: { draw: [(plot) => this.drawRow(plot)] },
    };
  }

  /** The row that is shown. */
  private drawRow({ ctx, bbox, valToPos }: uPlot): void {
    if (this.row === undefined) return;
    ctx.fillStyle = token('ink');
    ctx.fillRect(valToPos(this.row, 'x', true) - devicePixelRatio, bbox.top, 2 * devicePixelRatio, bbox.height);
  }
}

function key({ kind, name, numbers, color }: Series): HTMLElement[] {
  if (name === undefined) return [];
  const after = numbers === undefined ? [] : [element('span', 'numbers', `: ${numbers}`)];
  const drawn = element('i', kind);
  drawn.style.color = `var(--${color})`;
  return [element('span', 'key', drawn, name, ...after)];
}

function described({ title, unit, series }: ChartOptions): string {
  const parts = series.flatMap(({ name, values }) => {
    if (name === undefined) return [];
    const numbers = values.filter((v) => v !== null);
    if (numbers.length === 0) return [`${name}: nothing`];
    const [low, high] = [Math.min, Math.max].map((least) => numbers.reduce((a, b) => least(a, b)));
    return [`${name}: ${low === high ? '' : `${shown(low)} to `}${shown(high)}`];
  });
  return `${title}, ${unit}. ${parts.join('; ')}`;
}
