// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Where the label of a segment stands, so that the segment does not run through it. */

export type Pixel = readonly [number, number];

const gap = 10;
const halfLine = 8; // of text, as high as a digit is above the middle

/** The left end of the text's base line, for a text that wide: beside a steep segment, above a flat one. */
export function labelPlace(a: Pixel, b: Pixel, textWidth: number, size: Pixel): [number, number] {
  const [dx, dy] = [Math.abs(b[0] - a[0]), Math.abs(b[1] - a[1])];
  const [x, y] = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  const isFlat = dx > dy;
  const off = isFlat ? gap + Math.min(dy / 2, (textWidth / 2) * (dy / dx)) : gap + (dy > 0 ? halfLine * (dx / dy) : 0);
  let [left, base] = isFlat ? [x - textWidth / 2, y - off] : [x + off, y + halfLine - 2];
  if (!isFlat && left + textWidth > size[0] - 4) left = x - off - textWidth;
  if (isFlat && base < 18) base = y + off + 2 * halfLine - 2;
  left = Math.min(Math.max(left, 4), size[0] - textWidth - 4);
  return [left, base];
}
