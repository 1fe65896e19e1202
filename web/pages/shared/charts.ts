// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Charts over the rows of a sequence: linked, with a line at the row that is shown. */

import uPlot from 'uplot';
import { element } from './dom.ts';
import { shown } from './numbers.ts';
import { onThemeChange, token } from './theme.ts';

export interface Curve {
  name: string;
  /** A token of page.css. */
  color: string;
  values: readonly (number | null)[];
  isDashed?: boolean;
}

export interface ChartOptions {
  title: string;
  unit: string;
  curves: readonly Curve[];
  isLogarithmic?: boolean;
  /** Fills what is between the first two curves. */
  isBand?: boolean;
}

const height = 170;

export class Chart {
  private readonly plot: uPlot;
  private row = 0;

  /** Appends the chart to `host`; `jump` is called with the row that a reader points at. */
  constructor(host: HTMLElement, options: ChartOptions, jump: (row: number) => void) {
    const keys = options.curves.map(({ name, color, isDashed }) => {
      const line = element('i', isDashed === true ? 'dashed' : '');
      line.style.color = `var(--${color})`;
      return element('span', 'key', line, name);
    });
    const area = element('div', 'plot');
    area.setAttribute('role', 'img');
    area.setAttribute('aria-label', described(options));
    const caption = element('p', 'soft keys', element('span', 'unit', options.unit), ...keys);
    host.append(element('h3', '', options.title), caption, area);
    const rows = options.curves[0].values.map((_, row) => row);
    const series = options.curves.map((curve) => positiveWhere(options.isLogarithmic === true, curve.values));
    this.plot = new uPlot(this.settings(options, area.clientWidth), [rows, ...series], area);
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
    const point = (event: PointerEvent): void => {
      const row = Math.round(this.plot.posToVal(event.offsetX, 'x'));
      jump(Math.min(Math.max(row, 0), this.plot.data[0].length - 1));
    };
    over.addEventListener('pointerdown', (event) => {
      over.setPointerCapture(event.pointerId);
      point(event);
    });
    over.addEventListener('pointermove', (event) => {
      if (event.buttons !== 0) point(event);
    });
  }

  private settings(options: ChartOptions, width: number): uPlot.Options {
    const font = `13px ${getComputedStyle(document.body).fontFamily}`;
    const axis = { font, stroke: () => token('soft'), grid: { stroke: () => token('grid'), width: 1 } };
    const number = (_: uPlot, values: number[]): string[] => values.map((v) => (v === null ? '' : shown(v, 4)));
    return {
      width,
      height,
      legend: { show: false },
      cursor: { sync: { key: 'rows' }, drag: { x: false, y: false }, points: { show: false } },
      scales: { x: { time: false }, y: options.isLogarithmic === true ? { distr: 3 } : { range: fromZero } },
      axes: [
        { ...axis, ticks: { show: false }, size: 30, incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500, 1e3, 2e3, 5e3, 1e4] },
        { ...axis, ticks: { show: false }, size: 64, values: number },
      ],
      series: [
        {},
        ...options.curves.map(({ name, color, isDashed }) => ({
          label: name,
          stroke: () => token(color),
          width: 1.6,
          dash: isDashed === true ? [5, 4] : undefined,
          points: { show: options.curves[0].values.length === 1 },
        })),
      ],
      bands: options.isBand === true ? [{ series: [1, 2], fill: () => `${token(options.curves[0].color)}40` }] : [],
      hooks: { draw: [(plot) => this.drawRow(plot)] },
    };
  }

  /** The row that is shown, as a line. */
  private drawRow(plot: uPlot): void {
    const { ctx, bbox } = plot;
    const x = plot.valToPos(this.row, 'x', true);
    ctx.save();
    ctx.strokeStyle = token('mark');
    ctx.lineWidth = 2 * devicePixelRatio;
    ctx.setLineDash([]);
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.restore();
  }
}

/** Axes start at zero, unless the curve would be a line far above it. */
const fromZero = (_: uPlot, low: number | null, high: number | null): [number, number] => {
  const top = high !== null && high > 0 ? high : 1;
  if (low === null || low <= top / 2 || low === top) return [0, 1.06 * top];
  const gap = (top - low) / 10;
  return [low - gap, top + gap];
};

/** Logarithms need positive numbers: others are gaps. */
const positiveWhere = (isAsked: boolean, values: readonly (number | null)[]): (number | null)[] =>
  values.map((v) => (isAsked && v !== null && v <= 0 ? null : v));

function described({ title, unit, curves }: ChartOptions): string {
  const parts = curves.map(({ name, values }) => {
    const numbers = values.filter((v) => v !== null);
    if (numbers.length === 0) return `${name}: nothing`;
    const low = numbers.reduce((a, b) => Math.min(a, b));
    const high = numbers.reduce((a, b) => Math.max(a, b));
    return `${name}: ${shown(low)} to ${shown(high)}`;
  });
  return `${title}, ${unit}. ${parts.join('; ')}`;
}
