// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Contrast of all texts and marks, light and dark, by the formula of WCAG 2; and whether the map can be read by all.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { module, pages } from './support.mjs';

const css = readFileSync(join(pages, 'shared/page.css'), 'utf8');
const blocks = [...css.matchAll(/:root \{([^}]*)\}/g)].map((match) => match[1]);
const tokensOf = (block) =>
  Object.fromEntries([...block.matchAll(/--([\w-]+): (#\w+)/g)].map(([, name, color]) => [name, color]));
const themes = { light: tokensOf(blocks[0]), dark: { ...tokensOf(blocks[0]), ...tokensOf(blocks[1]) } };

const linear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
const luminance = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
const contrast = (a, b) => {
  const [high, low] = [luminance(a), luminance(b)].sort((x, y) => y - x);
  return (high + 0.05) / (low + 0.05);
};

// AA asks for 4.5 where there is text, and for 3 where a mark has to be told from what is around it.
const pairs = [
  ...['ink', 'soft', 'good', 'bad'].flatMap((text) => ['page', 'card'].map((ground) => [text, ground, 4.5])),
  ['ink', 'field', 4.5],
  ['on-accent', 'accent', 4.5],
  ['on-badge', 'badge-a', 4.5],
  ['on-badge', 'badge-b', 4.5],
  ...['accent', 'edge', 'mark', 'model-a', 'model-b'].flatMap((mark) =>
    ['page', 'card'].map((ground) => [mark, ground, 3]),
  ),
];

for (const [name, theme] of Object.entries(themes)) {
  for (const [first, second, least] of pairs) {
    test(`${name}: ${first} on ${second} has a contrast of ${least}`, () => {
      const found = contrast(rgb(theme[first]), rgb(theme[second]));
      assert.ok(found >= least, `${found.toFixed(2)}`);
    });
  }
}

const { mapColor } = await module('shared/palette.ts');
const colors = Array.from({ length: 33 }, (_, i) => mapColor(i / 32));

const lightness = (color) => {
  const y = luminance(color);
  return y > 0.008856 ? 116 * Math.cbrt(y) - 16 : 903.3 * y;
};

test('the map becomes darker in steps that are about equal', () => {
  const steps = colors.slice(1).map((color, i) => lightness(colors[i]) - lightness(color));
  const mean = steps.reduce((a, b) => a + b) / steps.length;
  assert.ok(mean > 1.5, `${mean}`);
  for (const step of steps) assert.ok(step > 0.6 * mean && step < 1.5 * mean, `${step} of ${mean}`);
});

test('the map goes from yellow to blue', () => {
  const [near, far] = [colors[0], colors[32]];
  assert.ok(near[0] > near[2] + 0.3 && near[1] > near[2] + 0.3, `${near}`);
  assert.ok(far[2] > far[0] + 0.2 && far[2] > far[1] + 0.2, `${far}`);
});
