// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The view of `limber track --report` and `limber demo`: frames that are played. */

import { Box3 } from 'three';
import { byId } from '../shared/dom.ts';
import { frameOf } from '../shared/viewer.ts';
import { showCharts } from './charts.ts';
import { RowList } from '../viewer/row_list.ts';
import { ReplayModel, worstFirst } from './model.ts';
import type { ReplayData } from './model.ts';
import { frameText, showKind, showModels, showNow, showSummary, showTiles, shownDistance } from './texts.ts';
import { showView } from './view.ts';

export function showReplay(data: ReplayData): void {
  const models = data.models.map((model) => new ReplayModel(model));
  const bounds = models.map((model) => {
    const box = new Box3();
    for (let frame = 0; frame < data.frame_count / data.stride; ++frame) box.union(model.boxAt(frame));
    return box;
  });
  const frame = frameOf(bounds[0].clone().union(bounds[1]));

  showKind(data);
  showTiles(data);
  showModels(data, models);
  showSummary(data);
  const charts = showCharts(data, (row) => player.jumpTo(row)); // first, as the view is as high as they are
  const show = showView(data, models, frame, bounds);
  /** Rows whose frame the page has. */
  const keptRows = data.rows.status.map((_, row) => row).filter((row) => (row % data.frame_count) % data.stride === 0);
  const list = data.min_clearance === null ? undefined : listOf(data, (row) => player.jumpTo(row));
  const player = new Player(keptRows, (row) => {
    show(row, (row % data.frame_count) / data.stride);
    showNow(data, row);
    for (const chart of charts) chart.show(row);
    list?.show(row);
  });
  if (list === undefined) return;
  const [worst] = worstFirst(data);
  byId('worst').hidden = false;
  byId('worst').addEventListener('click', () => player.jumpTo(worst));
  player.jumpTo(worst);
}

/** All frames, the worst first. */
function listOf(data: ReplayData, jump: (row: number) => void): RowList {
  byId('rows-section').hidden = false;
  const listed = worstFirst(data).map((row) => {
    const { kind, text } = frameText(data, row);
    return { row, kind, cells: [String(row), text, shownDistance(data, row)] };
  });
  return new RowList(['Frame', 'Clearance', 'Distance'], listed, jump);
}

/** Which row is shown: the slider, play and pause, and jumps. */
class Player {
  private readonly rows: readonly number[];
  private readonly slider = byId<HTMLInputElement>('frame');
  private readonly speed = byId<HTMLSelectElement>('speed');
  private readonly button = byId('play');
  private readonly show: (row: number) => void;
  private isPlaying = false;
  private startedAt = 0; // milliseconds, where the first of `rows` would have been shown

  /** `rows`: those that can be shown. */
  constructor(rows: readonly number[], show: (row: number) => void) {
    this.rows = rows;
    this.show = show;
    this.slider.max = String(rows.length - 1);
    this.slider.addEventListener('input', () => {
      this.pause();
      this.update();
    });
    this.button.addEventListener('click', () => (this.isPlaying ? this.pause() : this.play()));
    this.speed.addEventListener('change', () => this.keepTime());
    byId('back').addEventListener('click', () => this.step(-1));
    byId('forward').addEventListener('click', () => this.step(1));
    this.update();
  }

  /** Shows the row, or the nearest that can be shown. */
  jumpTo(row: number): void {
    this.pause();
    let nearest = 0;
    this.rows.forEach((kept, i) => {
      if (Math.abs(kept - row) < Math.abs(this.rows[nearest] - row)) nearest = i;
    });
    this.set(nearest);
  }

  private get millisecondsPerFrame(): number {
    return 1000 / Number(this.speed.value);
  }

  private step(by: number): void {
    this.pause();
    this.set(Math.min(Math.max(Number(this.slider.value) + by, 0), this.rows.length - 1));
  }

  private set(index: number): void {
    this.slider.value = String(index);
    this.update();
  }

  private update(): void {
    this.show(this.rows[Number(this.slider.value)]);
  }

  private play(): void {
    this.isPlaying = true;
    this.button.textContent = 'Pause';
    this.keepTime();
    const tick = (now: number): void => {
      if (!this.isPlaying) return;
      const index = Math.floor(Math.max(0, now - this.startedAt) / this.millisecondsPerFrame) % this.rows.length;
      if (index !== Number(this.slider.value)) this.set(index);
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  private pause(): void {
    this.isPlaying = false;
    this.button.textContent = 'Play';
  }

  /** Playing goes on from the frame that is shown. */
  private keepTime(): void {
    this.startedAt = performance.now() - Number(this.slider.value) * this.millisecondsPerFrame;
  }
}
