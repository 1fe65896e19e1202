// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Charts, such as those over the rows of a sequence: linked, with a line at the row that is shown. */

import uPlot from 'uplot';
import { element, onThemeChange, token } from './dom.ts';
import { shown } from './numbers.ts';

type Values = readonly (number | null)[];

/** What is drawn, from the back to the front. */
export interface Series {
  /** A line, which ends where values are missing, or goes on beyond them; what is above `low`; or dots alone. */
  kind: 'line' | 'dashed' | 'spanned' | 'area' | 'dot';
  /** What is without a name has no key. */
  name?: string;
  /** In the key, after the name. */
  numbers?: string;
  /** A token of page.css. */
  color: string;
  values: Values;
  low?: Values;
  /** Of dots. */
  size?: number;
}

export interface ChartOptions {
  title: string;
  unit: string;
  series: readonly Series[];
  isLogarithmic?: boolean;
  /** Values of x with a line. */
  marks?: readonly number[];
  /** A value with a line across. */
  limit?: { name: string; value: number };
  /** What the rows are called, under the pointer. */
  names?: readonly string[];
}

const height = 180;
const frameSteps = [0, 1, 2, 3, 4].flatMap((power) => [1, 2, 5].map((factor) => factor * 10 ** power));
const opacity = '59'; // of areas: grid and curves show through

export class Chart {
  private readonly plot: uPlot;
  private row: number | undefined;
  private readonly marks: readonly number[];
  private readonly limit: number | undefined;
  private readonly names: readonly string[];

  /** Appends the chart to `host`; `jump` is called with the row that a reader points at. */
  constructor(host: HTMLElement, options: ChartOptions, jump?: (row: number) => void) {
    const { series, marks = [], limit, isLogarithmic } = options;
    this.marks = marks;
    this.limit = limit?.value;
    this.names = options.names ?? [];
    const area = element('div', 'plot');
    area.setAttribute('role', 'img');
    area.setAttribute('aria-label', described(options));
    const ofLimit = limit === undefined ? [] : key({ kind: 'dashed', name: limit.name, color: 'mark', values: [] });
    const keys = [...series.flatMap(key), ...ofLimit];
    const caption = element('p', 'soft keys', element('span', 'unit', options.unit), ...keys);
    host.append(element('div', 'chart', element('h3', '', options.title), caption, area));
    const rows = series[0].values.map((_, row) => row);
    const lists = series.flatMap(({ values, low }) => (low === undefined ? [values] : [values, low]));
    const drawn = lists.map((values) => (isLogarithmic === true ? positive(values) : [...values]));
    this.plot = new uPlot(this.settings(options, area.clientWidth), [rows, ...drawn], area);
    new ResizeObserver(() => this.plot.setSize({ width: area.clientWidth, height })).observe(area);
    onThemeChange(() => this.plot.redraw());
    if (jump !== undefined) this.followPointer(jump);
  }

  show(row: number): void {
    this.row = row;
    this.plot.redraw(false);
  }

  private followPointer(jump: (row: number) => void): void {
    const { over } = this.plot;
    const rowAt = (event: PointerEvent): number => {
      const row = Math.round(this.plot.posToVal(event.offsetX, 'x'));
      return Math.min(Math.max(row, 0), this.plot.data[0].length - 1);
    };
    const point = (event: PointerEvent): void => jump(rowAt(event));
    over.addEventListener('pointerdown', (event) => {
      over.setPointerCapture(event.pointerId);
      point(event);
    });
    over.addEventListener('pointermove', (event) => {
      if (event.buttons !== 0) point(event);
      over.title = this.names[rowAt(event)] ?? '';
    });
  }

  private settings(options: ChartOptions, width: number): uPlot.Options {
    const { isLogarithmic = false } = options;
    const series: uPlot.Series[] = [{}];
    const bands: uPlot.Band[] = [];
    for (const { kind, color, values, size } of options.series) {
      const stroke = (): string => token(color);
      const isDot = kind === 'dot';
      if (kind === 'area') {
        bands.push({ series: [series.length, series.length + 1], fill: () => `${token(color)}${opacity}` });
        series.push({ width: 0, points: { show: false } }, { width: 0, points: { show: false } });
      } else {
        series.push({
          stroke,
          paths: isDot ? () => null : undefined,
          spanGaps: kind === 'spanned',
          width: 1.8,
          dash: kind === 'dashed' ? [5, 4] : undefined,
          points: { show: isDot || values.length === 1, size: size ?? 6, fill: isDot ? stroke : undefined },
        });
      }
    }
    const font = `14px ${getComputedStyle(document.body).fontFamily}`;
    const axis = { font, stroke: () => token('soft'), grid: { stroke: () => token('grid'), width: 1 } };
    return {
      width,
      height,
      legend: { show: false },
      cursor: { sync: { key: 'rows' }, drag: { x: false, y: false }, points: { show: false } },
      scales: {
        x: { time: false },
        y: isLogarithmic ? { distr: 3, range: logarithmicRange } : { range: this.rangeWithLimit },
      },
      axes: [
        { ...axis, ticks: { show: false }, size: 30, incrs: frameSteps },
        {
          ...axis,
          ticks: { show: false },
          size: 64,
          values: (_, all) => all.map((v) => (v === null ? '' : shown(v, 4))),
          ...(isLogarithmic ? { splits: powers, filter: (_, splits) => splits } : {}),
        },
      ],
      series,
      bands,
      hooks: { draw: [(plot) => this.drawLines(plot)] },
    };
  }

  private readonly rangeWithLimit = (_: uPlot, low: number | null, high: number | null): [number, number] => {
    if (this.limit === undefined) return fromZero(low, high);
    return fromZero(Math.min(low ?? Infinity, this.limit), Math.max(high ?? 0, this.limit));
  };

  /** The row that is shown, the marks, and the limit. */
  private drawLines(plot: uPlot): void {
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.lineWidth = 2 * devicePixelRatio;
    ctx.setLineDash([]);
    const draw = (at: number, color: string): void => {
      const x = plot.valToPos(at, 'x', true);
      ctx.strokeStyle = token(color);
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
    };
    for (const mark of this.marks) draw(mark, 'mark');
    if (this.row !== undefined) draw(this.row, 'ink');
    if (this.limit !== undefined) {
      const y = plot.valToPos(this.limit, 'y', true);
      ctx.strokeStyle = token('mark');
      ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
      ctx.beginPath();
      ctx.moveTo(bbox.left, y);
      ctx.lineTo(bbox.left + bbox.width, y);
      ctx.stroke();
    }
    ctx.restore();
  }
}

function key({ kind, name, numbers, color }: Series): HTMLElement[] {
  if (name === undefined) return [];
  const after = numbers === undefined ? [] : [element('span', 'numbers', `: ${numbers}`)];
  const drawn = element('i', kind);
  drawn.style.color = `var(--${color})`;
  return [element('span', 'key', drawn, name, ...after)];
}

/** Axes start at zero, unless the curve would be a line far above it. */
const fromZero = (low: number | null, high: number | null): [number, number] => {
  const top = high !== null && high > 0 ? high : 1;
  if (low === null || low <= top / 2 || low === top) return [0, 1.06 * top];
  const gap = (top - low) / 10;
  return [low - gap, top + gap];
};

/** Logarithmic axes end at round numbers. */
const logarithmicRange = (_: uPlot, low: number | null, high: number | null): [number, number] =>
  uPlot.rangeLog(low ?? 1, high ?? 10, 10, false) as [number, number];

/** What a logarithmic axis labels: powers of ten; where they are few, 2 and 5 times them too. */
const powers = (_: uPlot, __: number, low: number, high: number): number[] => {
  const first = Math.floor(Math.log10(low));
  const factors = high / low < 200 ? [1, 2, 5] : [1];
  const exponents = Array.from({ length: Math.ceil(Math.log10(high)) - first + 1 }, (_, i) => first + i);
  const splits = exponents.flatMap((exponent) => factors.map((factor) => Number(`${factor}e${exponent}`)));
  return splits.filter((split) => split >= low * 0.999 && split <= high * 1.001);
};

/** Logarithms need positive numbers: others are gaps. */
const positive = (values: Values): (number | null)[] => values.map((v) => (v !== null && v <= 0 ? null : v));

function described({ title, unit, series, limit }: ChartOptions): string {
  const parts = series.flatMap(({ name, values }) => {
    if (name === undefined) return [];
    const numbers = values.filter((v) => v !== null);
    if (numbers.length === 0) return [`${name}: nothing`];
    const low = numbers.reduce((a, b) => Math.min(a, b));
    const high = numbers.reduce((a, b) => Math.max(a, b));
    return [`${name}: ${shown(low)} to ${shown(high)}`];
  });
  if (limit !== undefined) parts.push(limit.name);
  return `${title}, ${unit}. ${parts.join('; ')}`;
}
