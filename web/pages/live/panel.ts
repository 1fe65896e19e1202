// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The numbers beside the picture. */

import type { Contacts, DistanceResult } from '../../limber3d/index.js';
import { byId, element, fillTable } from '../shared/dom.ts';
import { grouped, percentile, shown, shownPoint } from '../shared/numbers.ts';
import type { Answers } from './engine.ts';

const names = {
  update: 'Move and commit',
  distance: 'Distance',
  contacts: 'Contacts',
  selfContacts: 'Self-contacts',
  engine: 'Engine, sum',
  sheet: 'Motion of the sheet',
  drawing: 'Drawing, as the page sees it',
  frame: 'From frame to frame',
};
type Name = keyof typeof names;

const seconds = 5;

/** Times of the last seconds. */
class Times {
  private times: { at: number; value: number }[] = [];

  /** Takes in a time, at a time of performance.now(); forgets all where it is not measured any more. */
  add(value: number | undefined, at: number): void {
    if (value === undefined) this.times = [];
    else this.times.push({ at, value });
    while (this.times.length > 0 && this.times[0].at < at - 1000 * seconds) this.times.shift();
  }

  /** Their median, and what 99 of 100 stay below; nothing without any time. */
  get spread(): { median: number; p99: number } | undefined {
    const sorted = Float64Array.from(this.times, ({ value }) => value).sort();
    const [median, p99] = [percentile(sorted, 0.5), percentile(sorted, 0.99)];
    return median === undefined || p99 === undefined ? undefined : { median, p99 };
  }
}

export class Panel {
  private readonly times = new Map((Object.keys(names) as Name[]).map((name) => [name, new Times()]));

  /** Takes in the times of a frame. */
  addTimes(values: Partial<Record<Name, number | undefined>>, now: number): void {
    for (const [name, value] of Object.entries(values)) this.times.get(name as Name)!.add(value, now);
  }

  showAnswers({ distance, contacts, selfContacts }: Answers): void {
    showDistance(distance);
    showContacts(contacts, selfContacts);
  }

  showTimes(isMoving: boolean): void {
    const spreads = new Map([...this.times].map(([name, times]) => [name, times.spread]));
    const rows = [...spreads].flatMap(([name, spread]) => {
      if (spread === undefined) return [];
      const row = tableRow('row', names[name], spread.median.toFixed(2), spread.p99.toFixed(2));
      if (name === 'engine') row.className = 'sum';
      return [row];
    });
    const head = tableRow('col', 'ms', 'median', '99 %');
    byId('times').replaceChildren(element('thead', '', head), element('tbody', '', ...rows));
    const [engine, frame] = [spreads.get('engine'), spreads.get('frame')];
    byId('engine').textContent = engine === undefined ? '\u2013' : `${engine.median.toFixed(1)} ms`;
    byId('engine-note').textContent = engine === undefined ? '' : `99 % within ${engine.p99.toFixed(1)} ms`;
    byId('rate').textContent = isMoving && frame !== undefined ? String(Math.round(1000 / frame.median)) : '\u2013';
    byId('rate-note').textContent = !isMoving
      ? 'nothing moves'
      : frame === undefined
        ? ''
        : `99 % within ${frame.p99.toFixed(0)} ms`;
  }
}

/** Names of a row are in its first cell, names of columns in all. */
function tableRow(scope: 'row' | 'col', ...texts: string[]): HTMLTableRowElement {
  const cells = texts.map((text, i) => {
    if (scope === 'row' && i > 0) return element('td', '', text);
    const head = element('th', '', text);
    head.scope = scope;
    return head;
  });
  return element('tr', '', ...cells);
}

function showDistance({ lower, upper, status, witness, stats }: DistanceResult): void {
  const meets = status === 'collision';
  byId('distance').textContent = shown(upper, 4);
  byId('distance').className = meets ? 'bad' : '';
  byId('distance-note').textContent = meets ? 'they meet' : lower === upper ? 'exact, up to rounding' : 'upper bound';
  byId('interval').textContent = lower === upper ? shown(upper, 4) : `${shown(lower, 3)} to ${shown(upper, 3)}`;
  const width =
    upper > lower ? `upper is ${shown((100 * (upper - lower)) / lower, 2)} % above lower` : 'both ends are equal';
  byId('interval-note').textContent = width;
  fillTable(byId('answer'), [
    ['Lower bound', String(lower)],
    ['Upper bound', String(upper)],
    ['Point of A', witness === null ? '\u2013' : shownPoint(witness.pointA)],
    ['Point of B', witness === null ? '\u2013' : shownPoint(witness.pointB)],
    ['Triangles of A and B', witness === null ? '\u2013' : `${witness.triangleA}, ${witness.triangleB}`],
    ['Pairs compared', `${grouped(stats.nodeTests)} of bounds, ${grouped(stats.primitiveTests)} of triangles`],
  ]);
  for (const [id, row] of [
    ['lower', 0],
    ['upper', 1],
  ] as const) {
    (byId('answer') as HTMLTableElement).rows[row].cells[1].id = id;
  }
}

function showContacts(contacts: Contacts | undefined, selfContacts: Contacts | undefined): void {
  const row = (name: string, found: Contacts | undefined): string[][] =>
    found === undefined ? [] : [[name, counted(found)]];
  fillTable(byId('contact-counts'), [...row('Sheet and body', contacts), ...row('Sheet and itself', selfContacts)]);
}

function counted(contacts: Contacts): string {
  if (contacts.count === 0) return 'none';
  if (!contacts.isComplete) return `more than ${grouped(contacts.count)}`;
  const crossing = contacts.distances.reduce((count, distance) => count + (distance === 0 ? 1 : 0), 0);
  return `${grouped(contacts.count)}, ${grouped(crossing)} intersect`;
}
