// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Which frame of a sequence is shown: the slider, play and pause, and jumps. */

import { byId } from '../shared/dom.ts';

export class Player {
  private readonly rows: readonly number[];
  private readonly slider = byId<HTMLInputElement>('frame');
  private readonly speed = byId<HTMLSelectElement>('speed');
  private readonly button = byId('play');
  private readonly show: (row: number) => void;
  private isPlaying = false;

  /** `rows`: those that can be shown. */
  constructor(rows: readonly number[], show: (row: number) => void) {
    this.rows = rows;
    this.show = show;
    this.slider.max = String(rows.length - 1);
    this.slider.addEventListener('input', () => this.stopAt(this.index));
    this.button.addEventListener('click', () => (this.isPlaying ? this.stopAt(this.index) : this.play()));
  }

  /** Shows the row, or the nearest that can be shown. */
  jumpTo(row: number): void {
    const away = this.rows.map((kept) => Math.abs(kept - row));
    this.stopAt(away.indexOf(away.reduce((least, next) => Math.min(least, next))));
  }

  /** Shows what comes so many frames later. */
  step(by: number): void {
    this.stopAt(this.index + by);
  }

  private get index(): number {
    return Number(this.slider.value);
  }

  private stopAt(index: number): void {
    this.isPlaying = false;
    this.button.textContent = 'Play';
    this.set(index);
  }

  /** The slider keeps within its ends. */
  private set(index: number): void {
    this.slider.value = String(index);
    this.show(this.rows[this.index]);
  }

  private play(): void {
    this.isPlaying = true;
    this.button.textContent = 'Pause';
    let [before, due] = [performance.now(), 0]; // frames that are to come, and a part of one
    const tick = (now: number): void => {
      if (!this.isPlaying) return;
      due += (Math.max(0, now - before) / 1000) * Number(this.speed.value);
      before = now;
      if (due >= 1) this.set((this.index + Math.floor(due)) % this.rows.length);
      due %= 1;
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }
}
