// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/**
 * The colours of a map, computed: from dark blue to bright yellow, through grey. Lightness increases in equal steps,
 * and blue turns into yellow, so that readers who do not tell red from green, or see no colours at all, read the same
 * order.
 * The idea is that of cividis [Nunez2018]; the colours are computed in Oklab [Ottosson2020].
 */

export type Rgb = readonly [number, number, number];

const darkest = 0.33;
const brightest = 0.895;
const bluest = -0.115;
const yellowest = 0.165;

function fromLinear(value: number): number {
  const inside = Math.min(1, Math.max(0, value));
  return inside <= 0.0031308 ? 12.92 * inside : 1.055 * inside ** (1 / 2.4) - 0.055;
}

/** sRGB of a colour in Oklab, each from 0 to 1. */
export function fromOklab(lightness: number, a: number, b: number): Rgb {
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    fromLinear(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
    fromLinear(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
    fromLinear(-0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s),
  ];
}

/** The colour of 0 (near) to 1 (far): near is bright. */
export function mapColor(t: number): Rgb {
  const near = 1 - t;
  const lightness = darkest + (brightest - darkest) * near;
  const blueToYellow = bluest + (yellowest - bluest) * near;
  return fromOklab(lightness, -0.035 * Math.sin(Math.PI * near), blueToYellow);
}

export const cssColor = (rgb: Rgb): string => `rgb(${rgb.map((c) => Math.round(255 * c)).join(' ')})`;

/** Bytes of RGBA for a texture: from near to far. */
export function mapTable(count: number): Uint8Array {
  const table = new Uint8Array(4 * count);
  for (let i = 0; i < count; ++i) {
    const rgb = mapColor(i / (count - 1));
    table.set([...rgb.map((c) => Math.round(255 * c)), 255], 4 * i);
  }
  return table;
}

/** The map as a CSS gradient from left (near) to right (far). */
export function mapGradient(): string {
  const stops = Array.from({ length: 17 }, (_, i) => cssColor(mapColor(i / 16)));
  return `linear-gradient(to right, ${stops.join(', ')})`;
}
