// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The answers in words, tiles and tables. */

import { byId, element, fillTable } from '../shared/dom.ts';
import { grouped, inPage, median, shown, shownLength, shownTime, withUnit } from '../shared/numbers.ts';
import { fillModels, shownBounds, tile } from '../viewer/texts.ts';
import { touchesIn } from './model.ts';
import type { ImpactRows, ReplayData, ReplayModel } from './model.ts';

export const percent = (part: number): string => `${shown(100 * part)}\u00a0%`;

/** What was asked for: "exact", or how large an error was allowed. */
export function queryName({ relative_error, absolute_error }: ReplayData): string {
  const allowed = [
    ...(relative_error > 0 ? [percent(relative_error)] : []),
    ...(absolute_error > 0 ? [shown(absolute_error)] : []),
  ];
  return allowed.length === 0 ? 'exact' : `within ${allowed.join(' or ')}`;
}

/** The distance in a row: one number, or an interval; how deep the models are in each other where that is known. */
export function shownDistance({ rows }: ReplayData, row: number): string {
  const deep = rows.depth[row];
  if (deep !== null && deep > 0) return `${shownLength(deep)} deep`;
  if (rows.status[row] === 'collision') return 'in contact';
  return withUnit(shownBounds(rows.lower[row], rows.upper[row]));
}

/** Whether a frame keeps the clearance that is required, in words, and by what readers part frames. */
export function frameText(data: ReplayData, row: number): { kind: string; text: HTMLElement } {
  const isKept = data.rows.too_close[row] !== true;
  const isOnTheWay = data.rows.status[row] !== 'collision' && touchesIn(data, row);
  const kind = isKept ? 'Kept' : touchesIn(data, row) ? 'Contact' : 'Too close';
  return { kind, text: element('span', isKept ? 'good' : 'bad', isOnTheWay ? 'Contact on the way' : kind) };
}

/** The verdict about the clearance that is required. */
function clearanceTiles({ rows, min_clearance }: ReplayData): HTMLElement[] {
  if (min_clearance === null) return [];
  const broken = rows.too_close.filter((is) => is).length;
  const required = shownLength(min_clearance);
  if (broken === 0)
    return [tile('\u2713 Kept', `a clearance of ${required}, in all ${frames(rows.status.length)}`, 'good')];
  const count = `\u2717 ${grouped(broken)} of ${grouped(rows.status.length)}`;
  return [tile(count, `${broken === 1 ? 'frame is' : 'frames are'} closer than the required ${required}`, 'bad')];
}

const frames = (count: number): string => `${grouped(count)} ${count === 1 ? 'frame' : 'frames'}`;

/** What the program was asked for, and what the frames are. */
export function showKind({ rows, demo }: ReplayData): void {
  byId('kind').textContent = `limber ${demo === undefined ? 'track' : 'demo'}, ${frames(rows.status.length)}`;
  byId('introduction').hidden = demo === undefined;
  byId('introduction').textContent = demo === undefined ? '' : inPage(demo.introduction);
}

export function showTiles(data: ReplayData): void {
  const { rows, impacts, demo } = data;
  const contactCount = rows.status.filter((status) => status === 'collision').length;
  const uppers = rows.upper.map((upper) => upper ?? Infinity);
  const least = uppers.reduce((a, b) => Math.min(a, b), Infinity);
  const tiles = clearanceTiles(data);
  if (contactCount > 0) {
    const first = rows.status.indexOf('collision');
    tiles.push(tile(frames(contactCount), `in contact; the first is frame ${grouped(first)}`, 'bad'));
  } else if (Number.isFinite(least)) {
    const row = uppers.indexOf(least);
    const name = rows.lower[row] === least ? 'smallest distance' : 'smallest upper bound';
    tiles.push(tile(shownLength(least), `${name}, in frame ${grouped(row)}`));
  } else {
    tiles.push(tile('Far apart', 'in all frames: beyond the largest distance asked for'));
  }
  const deepest = rows.depth.reduce<number>((most, depth) => Math.max(most, depth ?? 0), 0);
  if (deepest > 0) {
    const row = rows.depth.indexOf(deepest);
    tiles.push(tile(`${shownLength(deepest)} deep`, `the deepest, in frame ${grouped(row)}`, 'bad'));
  }
  for (const { name, status, lower } of impacts) {
    const row = status.indexOf('contact');
    if (row >= 0) tiles.push(tile(shown(lower[row]!), `frame of the first impact: ${impactName(name)}`, 'bad'));
  }
  const updates = rows.update_us.filter((us) => us > 0);
  if (updates.length > 0) tiles.push(tile(shownTime(median(updates)), 'median update of the trees'));
  tiles.push(tile(shownTime(median(rows.query_us)), `median distance query, ${queryName(data)}`));
  if (demo !== undefined) {
    const { query_us, relative_error } = demo.rough;
    tiles.push(tile(shownTime(median(query_us)), `median distance query, within ${percent(relative_error)}`));
  }
  byId('tiles').append(...tiles);
}

/** The row that is shown. */
export function showNow(data: ReplayData, row: number): void {
  const { rows, contacts, impacts, demo } = data;
  const distance = shownDistance(data, row);
  byId('frame-text').textContent = `${row} of ${rows.status.length - 1}`;
  byId('frame').setAttribute('aria-valuetext', `frame ${row}, ${distance}`);
  byId('now-distance').textContent = distance;
  const lines = [
    ['Status', rows.status[row].replace('_', ' ')],
    ['Lower bound', rows.lower[row] === null ? 'none' : String(rows.lower[row])],
    ['Upper bound', rows.upper[row] === null ? 'none' : String(rows.upper[row])],
    ['Time', `update ${shownTime(rows.update_us[row])}, query ${shownTime(rows.query_us[row])}`],
    ['Moved vertices', grouped(rows.moved_vertices[row])],
  ];
  if (demo !== undefined) {
    const { relative_error, lower, upper, query_us } = demo.rough;
    const found = `${shownBounds(lower[row], upper[row])}, in ${shownTime(query_us[row])}`;
    lines.push([`Within ${percent(relative_error)}`, found]);
  }
  if (data.min_clearance !== null) {
    const verdict = rows.too_close[row] === true ? 'not kept' : 'kept';
    lines.push(['Required clearance', `${data.min_clearance}, ${verdict}`]);
  }
  if (rows.depth[row] !== null) lines.push(['Depth, at least', String(rows.depth[row])]);
  const witness = rows.witness[row];
  if (witness !== null) lines.push(['Triangles', `${witness[6]} of A, ${witness[7]} of B`]);
  for (const { name, count, intersecting } of contacts) {
    lines.push([contactName(name), `${grouped(count[row])} pairs, ${grouped(intersecting[row])} of them intersect`]);
  }
  for (const impact of impacts) lines.push([impactName(impact.name), shownImpact(impact, row)]);
  fillTable(byId('now'), lines);
}

/** What is known of the way from the frame before. */
function shownImpact({ status, lower, touch }: ImpactRows, row: number): string {
  if (status[row] === null) return 'no frame comes before';
  const found = touch[row];
  if (found === null) return 'none on the way to this frame';
  const [featureA, triangleA, featureB, triangleB] = found;
  const parts = [
    [featureA, triangleA],
    [featureB, triangleB],
  ].map(([feature, triangle]) => `${feature === null ? '' : `${feature} of `}triangle ${triangle}`);
  return `${status[row] === 'contact' ? 'at' : 'already in'} frame ${lower[row]}: ${parts.join(', ')}`;
}

const impactName = (name: string): string =>
  ({ impact_self_a: 'A meets itself', impact_self_b: 'B meets itself' })[name] ?? 'A meets B';

export const contactName = (name: string): string =>
  ({ contact: 'Contacts', self_a: 'A with itself', self_b: 'B with itself' })[name] ?? name;

/** What the terminal has shown at the end. */
export function showSummary({ demo }: ReplayData): void {
  byId('summary-section').hidden = demo === undefined;
  fillTable(byId('summary'), demo?.summary.map(([name, text]) => [name, inPage(text)]) ?? []);
}

export function showModels(data: ReplayData, models: readonly ReplayModel[]): void {
  fillModels(models, [
    ['Deforms', ({ deforms }) => (deforms ? 'yes' : 'no')],
    [
      'Shown within',
      ({ data: { frames, positions } }) =>
        `${shown((frames?.step ?? Math.max(...(positions?.step ?? [0]))) / 2, 2)} in each coordinate`,
    ],
  ]);
  const settings = [`Engine: ${data.engine}.`];
  if (data.relative_error > 0) settings.push(`Allowed relative error: ${data.relative_error}.`);
  if (data.absolute_error > 0) settings.push(`Allowed absolute error: ${data.absolute_error}.`);
  if (data.max_distance !== null) settings.push(`Largest distance asked for: ${data.max_distance}.`);
  byId('settings').textContent = settings.join(' ');
}
