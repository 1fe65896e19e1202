// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The modules and the colours of the pages, without a browser.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { module, pages } from './support.mjs';

const { shown, grouped, inPage, median } = await module('shared/numbers.ts');
const { labelPlace } = await module('shared/marks.ts');
const { stretchesThatMeet, worstFirst } = await module('viewer/data.ts');

test('numbers are shown in few digits, texts of the terminal with the units of pages', () => {
  assert.deepEqual(
    [0.45314912, 1250, 12345678, 3.2e-7, 0, -0.5, 123456.7, 4.0000001].map((x) => shown(x)),
    ['0.45315', '1250', '1.2346e7', '3.2e-7', '0', '-0.5', '123457', '4'],
  );
  assert.equal(grouped(1234567), '1\u202f234\u202f567');
  assert.deepEqual([[3], [4, 1], [9, 1, 5]].map(median), [3, 1, 5]);
  const words = inPage('1 234 567 moves in 3 of 20 000, 10 %, median 17 us, p99 141 us, max 8 115 us, users');
  const [n, u] = ['\u202f', '\u00a0'];
  const times = `median 17${u}\u00b5s, p99 141${u}\u00b5s, max 8${n}115${u}\u00b5s, users`;
  assert.equal(words, `1${n}234${n}567 moves in 3 of 20${n}000, 10${u}%, ${times}`);
});

test('the worst frames come first', () => {
  const depth = Array(6).fill(null);
  const bounds = { lower: [2, 0, 1, 9, 1, 7], upper: [2, 0, 1.5, null, 1, 7], depth };
  const rows = { status: ['exact', 'collision', 'exact', 'beyond_limit', 'exact', 'exact'], ...bounds };
  const deep = { ...rows, depth: [0.5, 0, 1, 0, 0, 0] };
  assert.deepEqual(worstFirst({ rows }), [1, 4, 2, 0, 5, 3]);
  assert.deepEqual(worstFirst({ rows: deep }), [2, 0, 1, 4, 5, 3]);
});

test('stretches of frames meet where one of their frames does, in any playing', () => {
  const status = Array.from({ length: 14 }, (_, row) => ([3, 6, 11].includes(row) ? 'collision' : 'exact'));
  const met = (length) => [...stretchesThatMeet({ rows: { status }, frame_count: 7 }, length)].join(' ');
  assert.deepEqual([1, 2, 4].map(met), ['3 6 4', '1 3 2', '0 1']);
});

test('labels stay off their segment and off badges, and inside', () => {
  const size = [400, 300];
  for (const [a, b, taken, expected] of [
    [[100, 150], [200, 110], [], [200, 96]],
    [[100, 20], [110, 60], [], [110, 86]],
    [[390, 100], [392, 200], [], [340, 86]],
    [[100, 150], [200, 110], [[190, 90]], [100, 176]],
  ]) {
    assert.deepEqual(labelPlace(a, b, size, taken), expected);
  }
});

// Contrast of all texts and marks by the formula of WCAG 2.
const css = readFileSync(join(pages, 'shared/page.css'), 'utf8');
const [light, dark] = [...css.matchAll(/:root \{([^}]*)\}/g)].map(([, block]) =>
  Object.fromEntries([...block.matchAll(/--([\w-]+): (#\w+)/g)].map(([, name, color]) => [name, color])),
);
const linear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
function luminance(hex) {
  const [r, g, b] = [1, 3, 5].map((i) => linear(parseInt(hex.slice(i, i + 2), 16) / 255));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

// AA asks for 4.5 where there is text, and for 3 where a mark has to be told from what is around it.
const grounds = [
  [4.5, ['page', 'card'], ['ink', 'soft', 'good', 'bad']],
  [4.5, ['field'], ['ink']],
  [4.5, ['accent'], ['on-accent']],
  [4.5, ['badge-a', 'badge-b'], ['on-badge']],
  [3, ['page', 'card'], ['accent', 'edge', 'mark', 'model-a', 'model-b']],
];

test('texts and marks are told from their ground, light and dark', () => {
  for (const theme of [light, { ...light, ...dark }]) {
    for (const [least, ground, marks] of grounds) {
      for (const [first, second] of marks.flatMap((mark) => ground.map((on) => [mark, on]))) {
        const [low, high] = [luminance(theme[first]), luminance(theme[second])].sort((a, b) => a - b);
        const contrast = (high + 0.05) / (low + 0.05);
        assert.ok(contrast >= least, `${first} on ${second}: ${contrast}`);
      }
    }
  }
});
