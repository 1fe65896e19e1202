// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The numbers beside the picture. */

import type { Contacts, DistanceResult } from '../../limber3d/index.js';
import { byId, element, fillTable } from '../shared/dom.ts';
import { grouped, shown, shownPoint } from '../shared/numbers.ts';
import type { Answers } from './engine.ts';
import { Times } from './statistics.ts';
import type { Spread } from './statistics.ts';

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

export class Panel {
  private readonly times = Object.fromEntries(Object.keys(names).map((name) => [name, new Times()])) as Record<
    Name,
    Times
  >;

  /** Takes in the times of a frame. */
  addTimes(values: Partial<Record<Name, number | undefined>>, now: number): void {
    for (const name of Object.keys(values) as Name[]) {
      const value = values[name];
      if (value === undefined) this.times[name].clear();
      else this.times[name].add(value, now);
    }
  }

  showAnswers({ distance, contacts, selfContacts }: Answers): void {
    showDistance(distance);
    showContacts(contacts, selfContacts);
  }

  showTimes(isMoving: boolean): void {
    const spreads = Object.fromEntries(
      Object.entries(this.times).map(([name, times]) => [name, times.spread]),
    ) as Record<Name, Spread | undefined>;
    const rows = (Object.keys(names) as Name[]).flatMap((name) => {
      const spread = spreads[name];
      if (spread === undefined) return [];
      const row = element('tr', name === 'engine' ? 'sum' : '', element('th', '', names[name]));
      (row.firstChild as HTMLTableCellElement).scope = 'row';
      row.dataset.time = name;
      row.append(element('td', '', spread.median.toFixed(2)), element('td', '', spread.p99.toFixed(2)));
      return [row];
    });
    const heads = ['ms', 'median', '99 %'].map((text) => {
      const head = element('th', '', text);
      head.scope = 'col';
      return head;
    });
    byId('times').replaceChildren(element('thead', '', element('tr', '', ...heads)), element('tbody', '', ...rows));
    const { engine, frame } = spreads;
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
    ['Pairs compared', `${grouped(stats.nodeTests)} of bounds, ${grouped(stats.triangleTests)} of triangles`],
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
