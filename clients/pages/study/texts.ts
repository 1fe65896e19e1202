// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The answers in words: tiles, the cells of the list, and the table of one pair. */

import { byId, element, fillTable } from '../shared/dom.ts';
import { grouped, shown, shownLength, shownPoint, shownTime, unitNote, withUnit } from '../shared/numbers.ts';
import { badClashes, clashWords, placeOf, statusWords, toleranceRows } from '../viewer/clashes.ts';
import type { Clash } from '../viewer/clashes.ts';
import { clearanceVerdict, shownBounds, tile } from '../viewer/texts.ts';
import type { ModelData, StudyData } from './model.ts';

type Study = StudyData['study'];

const count = (number: number, one: string, many: string): string => `${grouped(number)} ${number === 1 ? one : many}`;

/** What the rows of the study are called. */
export const rowName = ({ kind }: Study): string => (kind === 'pairs' ? 'Row' : 'Pair');
const numberedRow = (study: Study, row: number): string => `${rowName(study)} ${grouped(study.rows.row[row])}`;

/** How many pairs the study is about: more than the page has, where they are too many for it. */
const totalOf = ({ counts, accepted }: Study): number =>
  Object.values(counts).reduce((sum, number) => sum + number, accepted);

/** Both names of a row. */
export const pairName = (study: Study, row: number): string =>
  `${partName(study, study.rows.a[row])} and ${partName(study, study.rows.b[row])}`;

/** A part as the page names it: its number tells equal names apart. */
export function partName({ kind, parts }: Study, part: number): string {
  return kind === 'pairs' ? parts.name[part] : `${part} ${parts.name[part]}`;
}

/** Whether all pairs are of the same two models, so that rows are poses. */
export function isOfOnePair({ kind, parts: { model }, rows }: Study): boolean {
  const isSame = (side: number[]): boolean => side.every((part) => model[part] === model[side[0]]);
  return kind === 'pairs' && isSame(rows.a) && isSame(rows.b);
}

/** What the study is about, where it has no title of its own. */
export function usualTitle(study: Study, models: readonly ModelData[]): string {
  if (study.kind === 'parts') return `${grouped(study.parts.name.length)} parts`;
  return `${count(study.rows.a.length, 'pair', 'pairs')} of ${count(models.length, 'model', 'models')}`;
}

/** The distance of a row; of models that overlap, how deep that is at least. */
export function shownDistance({ rows: { depth, lower, upper } }: Study, row: number): string {
  const deep = depth[row];
  if (deep !== null) return `${shownLength(deep)} deep`;
  if (upper[row] === 0) return '0';
  return withUnit(shownBounds(lower[row], upper[row]));
}

const isBad = ({ rows }: Study, row: number): boolean =>
  rows.accepted[row] === null && (rows.too_close[row] ?? badClashes.includes(rows.clash[row]));

/** The kinds by which readers part the list. */
export const kindOf = ({ rows }: Study, row: number): string =>
  rows.accepted[row] === null ? clashWords[rows.clash[row]] : 'Accepted';

export function clashText(study: Study, row: number): HTMLElement {
  const accepted = study.rows.accepted[row] !== null;
  const kind = isBad(study, row) ? 'bad' : accepted || study.min_clearance === null ? '' : 'good';
  return element('span', `wrapping ${kind}`, clashWords[study.rows.clash[row]], accepted ? ', accepted' : '');
}

export function showKind({ study }: StudyData): void {
  byId('kind').textContent = `limber distance, ${count(totalOf(study), 'pair', 'pairs')}`;
  const listed = study.rows.row.length;
  if (listed < totalOf(study)) byId('rows-title').textContent = `The worst ${grouped(listed)} pairs, the worst first`;
}

/** The verdict, the worst, and what kinds there are. */
export function showTiles(study: Study, worst: number | undefined): void {
  const { rows, counts, accepted, min_clearance: required } = study;
  const total = totalOf(study);
  const all = total === 1 ? 'the only pair' : `all ${grouped(total)} pairs`;
  const tiles = [];
  if (total === 0) {
    const text = `of the parts are within ${shownLength(study.max_distance ?? Infinity)} of each other`;
    return byId('tiles').append(tile('None', text, 'good'));
  }
  if (required !== null) {
    const broken = study.too_close;
    const open = counts.cannot_tell ?? 0;
    if (broken + open === 0)
      tiles.push(tile('\u2713 Kept', `a clearance of ${shownLength(required)}, in ${all}`, 'good'));
    else if (broken > 0) {
      const text = `${broken === 1 ? 'is' : 'are'} closer than the required ${shownLength(required)}`;
      tiles.push(tile(`\u2717 ${grouped(broken)} of ${grouped(total)}`, text, 'bad'));
    }
  }
  if (worst !== undefined) {
    const deep = rows.depth[worst] === null ? '' : `, ${shownDistance(study, worst)}`;
    const word = [...badClashes, 'touching'].includes(rows.clash[worst])
      ? clashWords[rows.clash[worst]]
      : capital(shownDistance(study, worst));
    const where = `the worst: ${numberedRow(study, worst).toLowerCase()}${pairText(study, worst)}${deep}`;
    tiles.push(tile(word, where, isBad(study, worst) ? 'bad' : ''));
  }
  const kinds = (Object.keys(clashWords) as Clash[])
    .map((clash) => [clash, counts[clash] ?? 0] as const)
    .filter(([clash, number]) => number > 0 && [...badClashes, 'touching'].includes(clash));
  if (kinds.length === 0) tiles.push(tile('None', 'of the pairs meet', 'good'));
  for (const [clash, number] of kinds) {
    tiles.push(tile(grouped(number), plural(clash, number), clash === 'touching' ? '' : 'bad'));
  }
  if (accepted > 0) tiles.push(tile(grouped(accepted), accepted === 1 ? 'pair is accepted' : 'pairs are accepted'));
  byId('tiles').append(...tiles);
}

const plural = (clash: Clash, number: number): string =>
  ({
    hard_clash: number === 1 ? 'hard clash' : 'hard clashes',
    cannot_tell: `${number === 1 ? 'pair' : 'pairs'} of which the meshes cannot tell`,
    surfaces_meet: `${number === 1 ? 'pair of surfaces meets' : 'pairs of surfaces meet'}, not all closed`,
    touching: number === 1 ? 'pair touches' : 'pairs touch',
  })[clash as string] ?? clash;

function pairText(study: Study, row: number): string {
  return isOfOnePair(study) ? '' : `, ${pairName(study, row)}`;
}

const capital = (text: string): string => text[0].toUpperCase() + text.slice(1);

/** The table of one pair, in all digits, and the line that makes a page of it alone. */
export function showPair(study: Study, row: number): void {
  const { rows, parts, min_clearance: required } = study;
  const at = { clash: rows.clash[row], solids: rows.solids[row], inside: rows.inside[row] };
  const [a, b] = [rows.a[row], rows.b[row]];
  const place = placeOf(at);
  const lines: (readonly (string | Node)[])[] = [
    ['A', named(partName(study, a), parts.file[a])],
    ['B', named(partName(study, b), parts.file[b])],
    ['Clash', place === '' ? clashWords[at.clash] : `${clashWords[at.clash]}: ${place}`],
    ['Status', statusWords[rows.status[row]]],
    ['Distance, lower bound', rows.lower[row] === null ? 'none' : String(rows.lower[row])],
    ['Distance, upper bound', rows.upper[row] === null ? 'none' : String(rows.upper[row])],
  ];
  if (required !== null) {
    lines.push(['Required clearance', String(required)], ['Clearance is', clearanceVerdict(rows.too_close[row])]);
  }
  if (rows.depth[row] !== null) lines.push(['Depth, at least', String(rows.depth[row])]);
  lines.push(...toleranceRows(study));
  if (rows.accepted[row] !== null) lines.push(['Accepted by', `line ${rows.accepted[row]} of --accept`]);
  const witness = rows.witness[row];
  if (witness !== null) {
    const kind = rows.status[row] === 'collision' ? 'Shared point' : 'Closest point';
    const [triangleA, triangleB, faceA, faceB] = witness.slice(6);
    lines.push([`${kind} of A`, shownPoint(witness.slice(0, 3))], ['on', `triangle ${triangleA}, face ${faceA} of A`]);
    lines.push([`${kind} of B`, shownPoint(witness.slice(3, 6))], ['on', `triangle ${triangleB}, face ${faceB} of B`]);
  }
  lines.push(['Time', shownTime(rows.query_us[row])]);
  fillTable(byId('answer'), lines);
  byId('answer-title').textContent = `${numberedRow(study, row)}: ${clashWords[at.clash].toLowerCase()}`;
}

/** A name, and the file where that is another text. */
const named = (name: string, file: string): string => (name.endsWith(file) ? name : `${name}: ${file}`);

/** All models, and how precise their pictures are. */
export function showModels({ models, study }: StudyData): void {
  const heads = ['Name', 'Parts', 'Triangles', 'Vertices', 'Surface', `Size of its box${unitNote()}`];
  const rows = models.map((model, i) => [
    model.name,
    grouped(study.parts.model.filter((number) => number === i).length),
    grouped(model.triangles),
    grouped(model.vertices),
    model.closed ? 'closed' : 'not closed',
    withUnit(model.high.map((c, axis) => shown(c - model.low[axis], 5)).join(' \u00d7 ')),
  ]);
  if (study.kind === 'pairs') for (const row of [heads, ...rows]) row.splice(1, 1);
  const head = element('tr', '', ...heads.map((text) => element('th', '', text)));
  byId('models').classList.add('list');
  byId('models').append(element('thead', '', head));
  const body = element('tbody');
  fillTable(body, rows);
  byId('models').append(body);
  const off = Math.max(...models.flatMap(({ positions }) => positions.step)) / 2;
  const allowed = [
    ...(study.relative_error > 0 ? [`Allowed relative error: ${study.relative_error}.`] : []),
    ...(study.absolute_error > 0 ? [`Allowed absolute error: ${study.absolute_error}.`] : []),
    ...(study.max_distance === null ? [] : [`Largest distance asked for: ${study.max_distance}.`]),
  ];
  const within = shownLength(off, 2);
  const precision = `Its pictures hold coordinates within ${within}; numbers in tables are the program\u2019s own.`;
  byId('settings').textContent = [precision, ...allowed].join(' ');
}
