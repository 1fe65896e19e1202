// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Many times in few numbers: percentiles of windows of frames. */

export interface Windows {
  /** For each frame, of the window that it is in. */
  median: (number | null)[];
  low: (number | null)[];
  high: (number | null)[];
  /** The largest of each window, at the frame where it is. */
  largest: (number | null)[];
}

const mostAlone = 200; // frames that a chart shows one by one
const mostWindows = 40;
const lengths = [20, 50, 100, 200, 500, 1000, 2000, 5000]; // of 20 and more, the 95th percentile is not the largest

/** How many frames a window has; 1 where there are so few frames that each is shown. */
export function windowLength(count: number): number {
  if (count <= mostAlone) return 1;
  return lengths.find((length) => count / length <= mostWindows) ?? lengths[lengths.length - 1];
}

/** By the nearest rank: the smallest of the sorted values that at least this part of them is not above. */
export const percentile = (sorted: readonly number[], part: number): number | undefined =>
  sorted[Math.max(0, Math.ceil(part * sorted.length) - 1)];

/** The median, and the 5th and 95th percentiles. The last window has the frames that are left over, too. */
export function windowsOf(values: readonly (number | null)[], length: number): Windows {
  const windows: Windows = { median: [], low: [], high: [], largest: values.map(() => null) };
  const count = Math.max(1, Math.floor(values.length / length));
  for (let w = 0; w < count; ++w) {
    const begin = w * length;
    const inside = values.slice(begin, w + 1 === count ? values.length : begin + length);
    const sorted = inside.filter((value) => value !== null).sort((a, b) => a - b);
    for (const [list, part] of [
      [windows.low, 0.05],
      [windows.median, 0.5],
      [windows.high, 0.95],
    ] as const) {
      list.push(...inside.map(() => percentile(sorted, part) ?? null));
    }
    if (sorted.length > 0) {
      const most = sorted[sorted.length - 1];
      windows.largest[begin + inside.indexOf(most)] = most;
    }
  }
  return windows;
}
