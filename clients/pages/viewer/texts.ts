// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Texts that a report and a replay have in common. */

import { byId, element, fillTable } from '../shared/dom.ts';
import { grouped, shown } from '../shared/numbers.ts';

const letter = (name: 'A' | 'B'): HTMLElement => element('span', `letter ${name.toLowerCase()}`, name);

/** What the page is called: a title that it was given, or else what it is about. */
export function showTitle(given: string, usual: string | readonly [string, string]): void {
  const heading = given === '' ? byId('title') : byId('subtitle');
  if (typeof usual === 'string') heading.textContent = usual;
  else {
    const names = usual.map((name, i) => element('span', 'model', letter(i === 0 ? 'A' : 'B'), name));
    heading.append(names[0], element('span', 'joint', ' and '), names[1]);
  }
  byId('subtitle').hidden = given === '';
  if (given !== '') byId('title').textContent = given;
  const about = typeof usual === 'string' ? usual : usual.join(' and ');
  document.title = given === '' ? about : given;
  byId('view').setAttribute('aria-label', `Both models in 3D: ${about}`);
}

/** When the page was made, by which version, of which files. */
export function showMaking({ version, made_at, command, inputs = [] }: Making): void {
  byId('version').textContent = `limber ${version} on ${made_at}`;
  const words = command.split(' ').map((word) => element('span', 'word', word));
  byId('command').replaceChildren(...words.flatMap((word) => [' ', word]).slice(1));
  const part = byId<HTMLDetailsElement>('inputs-part');
  part.hidden = inputs.length === 0;
  part.open = inputs.length <= mostInputsAtOnce;
  byId('inputs-title').textContent =
    inputs.length === 1 ? 'The file that was read' : `The ${grouped(inputs.length)} files that were read`;
  const heads = ['Name', 'Bytes', 'SHA-256'].map((head) => element('th', '', head));
  const body = element('tbody');
  fillTable(
    body,
    inputs.map(({ name, bytes, sha256 }) => [
      element('span', 'wrapping', name),
      grouped(bytes),
      element('span', 'digest', sha256),
    ]),
  );
  byId('inputs').append(element('thead', '', element('tr', '', ...heads)), body);
}

const mostInputsAtOnce = 12;

export interface Making {
  version: string;
  made_at: string;
  command: string;
  inputs?: { name: string; bytes: number; sha256: string }[];
}

/** A number or a verdict, and what it is. */
export const tile = (number: string, name: string, kind = ''): HTMLElement =>
  element('div', '', element('b', kind, number), element('span', 'soft', name));

/** Whether a clearance is kept. */
export const clearanceVerdict = (isTooClose: boolean | null): HTMLElement =>
  isTooClose === false
    ? element('span', 'good', 'at least')
    : element('span', 'bad', isTooClose ? 'below' : 'not known for the parts');

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
