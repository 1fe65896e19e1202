// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The answers in words: titles, tiles and captions. */

import { byId, element } from '../shared/dom.ts';
import { counted, grouped, inPage, inUnit, median, percent, shown, shownLength } from '../shared/numbers.ts';
import { shownTime, withUnit } from '../shared/numbers.ts';
import { isOfOnePair, meetsIn, totalOf } from './data.ts';
import type { Clash, Data } from './data.ts';

export const clashWords: Record<Clash, string> = {
  hard_clash: 'Hard clash',
  cannot_tell: 'Cannot tell',
  surfaces_meet: 'Surfaces meet',
  touching: 'Touching',
  clearance: 'Below the clearance',
  clear: 'Clear',
  surfaces_apart: 'Surfaces are apart',
};

/** What is wrong with a pair whatever the clearance. */
const badClashes: readonly Clash[] = ['hard_clash', 'cannot_tell', 'surfaces_meet'];

/** How the models of a row lie, besides their distance; empty where the word of the clash says it all. */
export function placeOf({ rows }: Data, row: number): string {
  const [clash, solids, inside] = [rows.clash![row], rows.solids![row], rows.inside![row]];
  if (solids === 'a_inside_b' || inside === 'a_inside_b') return 'A is enclosed in B';
  if (solids === 'b_inside_a' || inside === 'b_inside_a') return 'B is enclosed in A';
  if (solids === 'equal') return 'both volumes are equal';
  if (clash === 'hard_clash') return 'the volumes overlap';
  if (clash === 'cannot_tell') return 'the errors of the meshes leave it open';
  if (clash === 'touching') return solids === 'touching' ? 'the volumes do not overlap' : 'within the tolerance';
  return solids === null ? 'a model is not closed' : '';
}

/** A distance: one number, or an interval, whose upper bound is missing where only the lower one is known. */
export function shownBounds(lower: number | null, upper: number | null): string {
  if (upper === null) return lower === null ? 'far apart' : `more than ${shown(lower)}`;
  return lower === null || lower === upper ? shown(upper) : `${shown(lower)} to ${shown(upper)}`;
}

/** The distance in a row; how deep the models are in each other where that is known. */
export function shownDistance(data: Data, row: number): string {
  const { depth, lower, upper } = data.rows;
  if ((depth[row] ?? 0) > 0) return `${shownLength(depth[row]!)} deep`;
  return meetsIn(data, row) ? 'in contact' : withUnit(shownBounds(lower[row], upper[row]));
}

/** A part as the page names it: its number tells equal names apart. */
export const partName = ({ kind, parts }: Data, part: number): string =>
  kind === 'parts' ? `${part} ${parts.name[part]}` : parts.name[part];

/** Both names of a row. */
export const pairName = (data: Data, row: number): string =>
  `${partName(data, data.rows.a[row])} and ${partName(data, data.rows.b[row])}`;

/** What the rows are called, and one of them. */
export const rowName = ({ kind }: Data): string => ({ pair: '', pairs: 'Row', parts: 'Pair', frames: 'Frame' })[kind];
export const numberedRow = (data: Data, row: number): string => `${rowName(data)} ${grouped(data.rows.row[row])}`;

/** What was asked for: "exact", or how large an error was allowed. */
export function queryName({ relative_error, absolute_error }: Data): string {
  const allowed = [
    ...(relative_error > 0 ? [percent(relative_error)] : []),
    ...(absolute_error > 0 ? [shown(absolute_error)] : []),
  ];
  return allowed.length === 0 ? 'exact' : `within ${allowed.join(' or ')}`;
}

export const contactName = (name: string): string =>
  ({ contact: 'Contacts', self_a: 'A with itself', self_b: 'B with itself' })[name] ?? name;

/** What the page is called, by whom, and what it is about. */
export function showTitles(data: Data): void {
  const { kind, title, parts, models, rows, demo } = data;
  const verb = kind !== 'frames' ? 'distance' : demo === undefined ? 'track' : 'demo';
  const about = kind === 'pair' ? '' : `, ${counted(totalOf(data), kind === 'frames' ? 'frame' : 'pair')}`;
  byId('kind').textContent = `limber ${verb}${about}`;
  byId('introduction').hidden = demo === undefined;
  byId('introduction').textContent = inPage(demo?.introduction ?? '');
  const heading = byId(title === '' ? 'title' : 'subtitle');
  const pairs = `${counted(rows.a.length, 'pair')} of ${counted(models.length, 'model')}`;
  let usual = kind === 'pairs' ? pairs : `${grouped(parts.name.length)} parts`;
  if (isOfOnePair(data)) {
    const names = [rows.a[0], rows.b[0]].map((part) => parts.name[part]);
    const spans = names.map((name, i) => element('span', 'model', letter(i), name));
    heading.append(spans[0], element('span', 'joint', ' and '), spans[1]);
    usual = names.join(' and ');
  } else {
    heading.textContent = usual;
  }
  byId('subtitle').hidden = title === '';
  if (title !== '') byId('title').textContent = title;
  document.title = title === '' ? usual : title;
  for (const place of document.querySelectorAll('.in-unit')) place.textContent = inUnit();
}

/** The badge of A or B. */
export const letter = (side: number): HTMLElement => element('span', `letter ${'ab'[side]}`, 'AB'[side]);

/** What the view shows of a row. While frames are played it stays, as its height would otherwise change. */
export function captionOf(data: Data, row: number): string {
  const { rows, kind, stride, max_megabytes } = data;
  if (kind === 'frames') {
    const all = 'The red segment joins the closest points; where models meet, it is a point.';
    if (stride === 1) return all;
    const why = `more would not fit into ${max_megabytes} MB`;
    return `${all} Shown is 1 of every ${stride} frames: ${why}. The charts have all.`;
  }
  const start = kind === 'pair' ? '' : `${numberedRow(data, row)}: ${pairName(data, row)}. `;
  if (rows.witness[row] === null) return `${start}No closest points are known.`;
  if (!meetsIn(data, row)) return `${start}The red segment joins the closest points.`;
  const marked = rows.intersecting![row] === null ? '' : ' The triangles that intersect are yellow.';
  return `${start}The models meet at the red point.${marked}`;
}

/** A number or a verdict, and what it is. */
const tile = (number: string, name: string, kind = ''): HTMLElement =>
  element('div', '', element('b', kind, number), element('span', 'soft', name));

const capital = (text: string): string => text[0].toUpperCase() + text.slice(1);

export function showTiles(data: Data): void {
  const none = `of the parts are within ${shownLength(data.max_distance ?? Infinity)} of each other`;
  const special = { pair: pairTiles, pairs: manyTiles, parts: manyTiles, frames: frameTiles }[data.kind];
  const tiles = totalOf(data) === 0 ? [tile('None', none, 'good')] : [...clearanceTiles(data), ...special(data)];
  byId('tiles').append(...tiles);
}

/** The verdict about the clearance that is required. */
function clearanceTiles(data: Data): HTMLElement[] {
  const { kind, min_clearance, too_close, counts } = data;
  if (min_clearance === null) return [];
  const required = shownLength(min_clearance);
  const isOpen = (counts.cannot_tell ?? 0) > 0;
  if (kind === 'pair') {
    const name = `a clearance of ${required} is required`;
    if (too_close > 0) return [tile('\u2717 Too close', name, 'bad')];
    return [isOpen ? tile('? Cannot tell', name, 'bad') : tile('\u2713 Kept', name, 'good')];
  }
  const [total, rows] = [totalOf(data), kind === 'frames' ? 'frame' : 'pair'];
  if (too_close > 0) {
    const text = `${rows}${too_close === 1 ? ' is' : 's are'} closer than the required ${required}`;
    return [tile(`\u2717 ${grouped(too_close)} of ${grouped(total)}`, text, 'bad')];
  }
  const all = total === 1 ? `the only ${rows}` : `all ${counted(total, rows)}`;
  return isOpen ? [] : [tile('\u2713 Kept', `a clearance of ${required}, in ${all}`, 'good')];
}

function pairTiles(data: Data): HTMLElement[] {
  const { rows, pair } = data;
  const [clash] = rows.clash!;
  const [isBad, meets] = [badClashes.includes(clash), meetsIn(data, 0)];
  const look = isBad ? 'bad' : '';
  const tiles = isBad || meets ? [tile(clashWords[clash], placeOf(data, 0), look)] : [];
  if (rows.depth[0] !== null) tiles.push(tile(shownLength(rows.depth[0]), 'deep at least', look));
  if (meets) return [...tiles, tile(grouped(pair!.intersections), 'pairs of triangles intersect')];
  const ofWhat = `${isBad ? 'between surfaces' : 'clearance'} of the ${data.mesh_error > 0 ? 'parts' : 'meshes'}`;
  return [...tiles, tile(capital(withUnit(shownBounds(rows.lower[0], rows.upper[0]))), ofWhat)];
}

/** The worst, and what kinds there are. */
function manyTiles(data: Data): HTMLElement[] {
  const { rows, counts, accepted, worst_first } = data;
  const [worst] = worst_first;
  const clash = rows.clash![worst];
  const named: readonly Clash[] = [...badClashes, 'touching'];
  const deep = rows.depth[worst] === null ? '' : `, ${shownDistance(data, worst)}`;
  const word = named.includes(clash) ? clashWords[clash] : capital(shownDistance(data, worst));
  const names = isOfOnePair(data) ? '' : `, ${pairName(data, worst)}`;
  const where = `the worst: ${numberedRow(data, worst).toLowerCase()}${names}${deep}`;
  const kinds = named.filter((kind) => (counts[kind] ?? 0) > 0);
  const pairs = (count: number): string => (count === 1 ? 'pair' : 'pairs');
  const ofKinds = kinds.map((kind) => {
    const text = `${pairs(counts[kind]!)}: ${clashWords[kind].toLowerCase()}`;
    return tile(grouped(counts[kind]!), text, kind === 'touching' ? '' : 'bad');
  });
  return [
    tile(word, where, isBad(data, worst) ? 'bad' : ''),
    ...(kinds.length === 0 ? [tile('None', 'of the pairs meet', 'good')] : ofKinds),
    ...(accepted > 0 ? [tile(grouped(accepted), `${pairs(accepted)}: accepted`)] : []),
  ];
}

/** The nearest, contacts and times. */
function frameTiles(data: Data): HTMLElement[] {
  const { rows, demo } = data;
  const tiles = [];
  const contacts = rows.status.filter((status) => status === 'collision').length;
  const uppers = rows.upper.map((upper) => upper ?? Infinity);
  const least = uppers.reduce((a, b) => Math.min(a, b));
  const at = uppers.indexOf(least);
  if (contacts > 0) {
    const first = grouped(rows.status.indexOf('collision'));
    tiles.push(tile(counted(contacts, 'frame'), `in contact; the first is frame ${first}`, 'bad'));
  } else if (Number.isFinite(least)) {
    const name = rows.lower[at] === least ? 'smallest distance' : 'smallest upper bound';
    tiles.push(tile(shownLength(least), `${name}, in frame ${grouped(at)}`));
  } else {
    tiles.push(tile('Far apart', 'in all frames: beyond the largest distance asked for'));
  }
  const deepest = rows.depth.reduce<number>((most, depth) => Math.max(most, depth ?? 0), 0);
  if (deepest > 0) {
    const place = `the deepest, in frame ${grouped(rows.depth.indexOf(deepest))}`;
    tiles.push(tile(`${shownLength(deepest)} deep`, place, 'bad'));
  }
  const updates = rows.update_us!.filter((us) => us > 0);
  if (updates.length > 0) tiles.push(tile(shownTime(median(updates)), 'median update of the trees'));
  const query = 'median distance query,';
  tiles.push(tile(shownTime(median(rows.query_us)), `${query} ${queryName(data)}`));
  if (demo === undefined) return tiles;
  const { query_us, relative_error } = demo.rough;
  return [...tiles, tile(shownTime(median(query_us)), `${query} within ${percent(relative_error)}`)];
}

const isBad = ({ rows }: Data, row: number): boolean =>
  rows.accepted![row] === null && (rows.too_close[row] ?? badClashes.includes(rows.clash![row]));

/** By what readers part the list of rows, and what it says of one. */
export function verdictOf(data: Data, row: number): { kind: string; text: HTMLElement } {
  const { clash, accepted, too_close } = data.rows;
  if (clash === undefined) {
    const isKept = too_close[row] !== true;
    const kind = isKept ? 'Kept' : meetsIn(data, row) ? 'Contact' : 'Too close';
    return { kind, text: element('span', isKept ? 'good' : 'bad', kind) };
  }
  const isAccepted = accepted![row] !== null;
  const look = isBad(data, row) ? 'bad' : isAccepted || data.min_clearance === null ? '' : 'good';
  const word = clashWords[clash[row]];
  const text = element('span', `wrapping ${look}`, word, isAccepted ? ', accepted' : '');
  return { kind: isAccepted ? 'Accepted' : word, text };
}
