// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Times of the last seconds: their median, and what 99 of 100 stay below. */

const seconds = 5;

export interface Spread {
  median: number;
  p99: number;
}

export class Times {
  private at: number[] = [];
  private values: number[] = [];

  /** Takes in a time; `now` is a time of performance.now(). */
  add(value: number, now: number): void {
    this.at.push(now);
    this.values.push(value);
    while (this.at[0] < now - 1000 * seconds) {
      this.at.shift();
      this.values.shift();
    }
  }

  clear(): void {
    this.at = [];
    this.values = [];
  }

  /** Nothing without any time. */
  get spread(): Spread | undefined {
    if (this.values.length === 0) return undefined;
    const sorted = Float64Array.from(this.values).sort();
    return { median: quantile(sorted, 0.5), p99: quantile(sorted, 0.99) };
  }
}

/** The smallest number that at least that fraction of the sorted numbers does not exceed. */
export function quantile(sorted: ArrayLike<number>, fraction: number): number {
  return sorted[Math.max(0, Math.ceil(fraction * sorted.length) - 1)];
}
