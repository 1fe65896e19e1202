// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Texts that a report and a replay have in common. */

import { byId, element, fillTable } from '../shared/dom.ts';
import { grouped, shown } from '../shared/numbers.ts';

const letter = (name: 'A' | 'B'): HTMLElement => element('span', `letter ${name.toLowerCase()}`, name);

/** Both names, where the page, its window and its view have them. */
export function showTitle([a, b]: readonly { name: string }[]): void {
  const [nameA, nameB] = [element('span', 'model', letter('A'), a.name), element('span', 'model', letter('B'), b.name)];
  byId('title').append(nameA, element('span', 'joint', ' and '), nameB);
  document.title = `${a.name} and ${b.name}`;
  byId('view').setAttribute('aria-label', `Both models in 3D: ${document.title}`);
}

/** A number or a verdict, and what it is. */
export const tile = (number: string, name: string, kind = ''): HTMLElement =>
  element('div', '', element('b', kind, number), element('span', 'soft', name));

/** The table of both models: what both views tell of them, and `more`. */
export function fillModels<Model extends { data: { name: string; triangles: number; vertices: number } }>(
  models: readonly Model[],
  more: readonly (readonly [string, (model: Model) => string])[],
): void {
  const rows = [
    ['Name', ({ data }: Model) => data.name],
    ['Triangles', ({ data }: Model) => grouped(data.triangles)],
    ['Vertices', ({ data }: Model) => grouped(data.vertices)],
    ...more,
  ] as const;
  fillTable(byId('models'), [
    ['', letter('A'), letter('B')],
    ...rows.map(([name, text]) => [name, ...models.map(text)]),
  ]);
}

/** A distance: one number, or an interval, whose upper bound is missing where only the lower one is known. */
export function shownBounds(lower: number | null, upper: number | null): string {
  if (upper === null) return lower === null ? 'far apart' : `more than ${shown(lower)}`;
  return lower === null || lower === upper ? shown(upper) : `${shown(lower)} to ${shown(upper)}`;
}
