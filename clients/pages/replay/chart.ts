// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Charts, such as those over the rows of a sequence: linked, with a line at the row that is shown. */

import uPlot from 'uplot';
import { element, onThemeChange, token } from '../shared/dom.ts';
import { roundAbove, roundBelow, shown } from '../shared/numbers.ts';

type Values = readonly (number | null)[];

interface Drawn {
  /** What is without a name has no key. */
  name?: string;
  /** In the key, after the name. */
  numbers?: string;
  /** A token of page.css. */
  color: string;
}

export interface Curve extends Drawn {
  values: Values;
  isDashed?: boolean;
  /** The curve goes on beyond values that are missing; or there are dots alone. Without it, it ends there. */
  gaps?: 'spanned' | 'dots';
}

/** What is between two curves. */
export interface Area extends Drawn {
  low: Values;
  high: Values;
}

export interface Dots extends Drawn {
  values: Values;
  size: number;
}

export interface ChartOptions {
  title: string;
  unit: string;
  areas?: readonly Area[];
  curves: readonly Curve[];
  dots?: readonly Dots[];
  isLogarithmic?: boolean;
  /** Values of x with a line. */
  marks?: readonly number[];
  /** A value with a line across. */
  limit?: { name: string; value: number };
  /** What the rows are called, at the line of the row that is shown, and under the pointer. */
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
    const { areas = [], curves, dots = [], marks = [] } = options;
    this.marks = marks;
    this.limit = options.limit?.value;
    this.names = options.names ?? [];
    const area = element('div', 'plot');
    area.setAttribute('role', 'img');
    area.setAttribute('aria-label', described(options));
    const keys = [
      ...curves.map((curve) => key(curve, curve.isDashed === true ? 'dashed' : 'line')),
      ...areas.map((of) => key(of, 'area')),
      ...dots.map((of) => key(of, 'dot')),
      ...(options.limit === undefined ? [] : [key({ name: options.limit.name, color: 'mark' }, 'dashed')]),
    ].flat();
    const caption = element('p', 'soft keys', element('span', 'unit', options.unit), ...keys);
    host.append(element('div', 'chart', element('h3', '', options.title), caption, area));
    const rows = curves[0].values.map((_, row) => row);
    const series = [
      ...areas.flatMap(({ low, high }) => [high, low]),
      ...[...curves, ...dots].map(({ values }) => values),
    ].map((values) => (options.isLogarithmic === true ? positive(values) : [...values]));
    this.plot = new uPlot(this.settings(options, area.clientWidth), [rows, ...series], area);
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
    const { areas = [], curves, dots = [], isLogarithmic = false } = options;
    const font = `14px ${getComputedStyle(document.body).fontFamily}`;
    const axis = { font, stroke: () => token('soft'), grid: { stroke: () => token('grid'), width: 1 } };
    const edge = { width: 0, points: { show: false } };
    return {
      width,
      height,
      legend: { show: false },
      cursor: { sync: { key: 'rows' }, drag: { x: false, y: false }, points: { show: false } },
      scales: {
        x: { time: false },
        y: isLogarithmic ? { distr: 3, range: roundRange } : { range: this.rangeWithLimit },
      },
      axes: [
        { ...axis, ticks: { show: false }, size: 30, incrs: frameSteps },
        { ...axis, ticks: { show: false }, size: 64, ...labels(isLogarithmic) },
      ],
      series: [
        {},
        ...areas.flatMap(() => [edge, edge]),
        ...curves.map(({ color, isDashed, gaps }) => ({
          stroke: () => token(color),
          paths: gaps === 'dots' ? () => null : undefined,
          spanGaps: gaps === 'spanned',
          width: 1.8,
          dash: isDashed === true ? [5, 4] : undefined,
          points: { show: gaps === 'dots' || curves[0].values.length === 1, size: 6 },
        })),
        ...dots.map(({ color, size }) => ({
          stroke: () => token(color),
          paths: () => null,
          points: { show: true, size, width: 0, fill: () => token(color) },
        })),
      ],
      bands: areas.map(({ color }, i) => ({
        series: [2 * i + 1, 2 * i + 2],
        fill: () => `${token(color)}${opacity}`,
      })),
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
    this.drawName(plot);
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

  /** Beside the line of the row that is shown, where there is more room. */
  private drawName(plot: uPlot): void {
    const name = this.row === undefined ? undefined : this.names[this.row];
    if (name === undefined) return;
    const { ctx, bbox } = plot;
    const x = plot.valToPos(this.row!, 'x', true);
    const isLeft = x > bbox.left + bbox.width / 2;
    ctx.font = `${14 * devicePixelRatio}px ${getComputedStyle(document.body).fontFamily}`;
    ctx.textAlign = isLeft ? 'right' : 'left';
    ctx.textBaseline = 'top';
    ctx.lineWidth = 4 * devicePixelRatio;
    ctx.strokeStyle = token('card');
    ctx.fillStyle = token('ink');
    const at = [x + (isLeft ? -6 : 6) * devicePixelRatio, bbox.top + 2 * devicePixelRatio] as const;
    ctx.strokeText(name, ...at);
    ctx.fillText(name, ...at);
  }
}

function key({ name, numbers, color }: Drawn, symbol: string): HTMLElement[] {
  if (name === undefined) return [];
  const after = numbers === undefined ? [] : [element('span', 'numbers', `: ${numbers}`)];
  const drawn = element('i', symbol);
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

/** Logarithmic axes go from a round number to a round number. */
const roundRange = (_: uPlot, low: number | null, high: number | null): [number, number] => {
  const [bottom, top] = [roundBelow(low ?? 1), roundAbove(high ?? 10)];
  return bottom < top ? [bottom, top] : [bottom, 10 * bottom];
};

/** What a logarithmic axis labels: powers of ten; where they are few, 2 and 5 times them too. */
const powers = (_: uPlot, __: number, low: number, high: number): number[] => {
  const factors = high / low < 200 ? [1, 2, 5] : [1];
  const splits = [];
  for (let exponent = Math.floor(Math.log10(low)); 10 ** exponent <= high; ++exponent) {
    splits.push(...factors.map((factor) => Number(`${factor}e${exponent}`)));
  }
  return splits.filter((split) => split >= low * 0.999 && split <= high * 1.001);
};

/** How an axis is labelled. */
const labels = (isLogarithmic: boolean): Partial<uPlot.Axis> => ({
  values: (_, values) => values.map((v) => (v === null ? '' : shown(v, 4))),
  ...(isLogarithmic ? { splits: powers, filter: (_, splits) => splits } : {}),
});

/** Logarithms need positive numbers: others are gaps. */
const positive = (values: Values): (number | null)[] => values.map((v) => (v !== null && v <= 0 ? null : v));

function described({ title, unit, curves, dots = [], limit }: ChartOptions): string {
  const parts = [...curves, ...dots].flatMap(({ name, values }) => {
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
