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

  /** Shows what comes so many frames later. */
  step(by: number): void {
    this.pause();
    this.set(Math.min(Math.max(Number(this.slider.value) + by, 0), this.rows.length - 1));
  }

  private get millisecondsPerFrame(): number {
    return 1000 / Number(this.speed.value);
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
