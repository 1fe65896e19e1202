// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The colours of page.css for what CSS does not draw: canvases and surfaces in 3D. */

export const token = (name: string): string =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** A token that is a colour #rrggbb, as three numbers from 0 to 1. */
export function tokenRgb(name: string): [number, number, number] {
  const color = token(name);
  return [1, 3, 5].map((i) => parseInt(color.slice(i, i + 2), 16) / 255) as [number, number, number];
}

/** Calls back whenever the reader's screen changes between light and dark. */
export function onThemeChange(callback: () => void): void {
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', callback);
}
