// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The tables of a page: one answer in all digits, the models, and how the page was made. */

import { byId, element, fillList, fillTable } from '../shared/dom.ts';
import { grouped, inPage, percent, shown, shownLength, shownPoint, shownTime, withUnit } from '../shared/numbers.ts';
import { isOfOnePair, meetsIn } from './data.ts';
import type { Data } from './data.ts';
import type { Model } from './models.ts';
import { clashWords, contactName, letter, numberedRow, partName, placeOf } from './texts.ts';
import { shownBounds, shownDistance } from './texts.ts';

type Cell = string | Node;
type Line = readonly [string, Cell | null | undefined];

const statusWords = {
  exact: 'exact for the meshes: lower and upper are equal',
  within_error: 'within the allowed errors',
  collision: 'collision: the models meet',
  beyond_limit: 'beyond limit: farther apart than the largest distance asked for',
};

/** A number in all digits; nothing where there is none. */
const digits = (number: number | null): string | null => (number === null ? null : String(number));

/** An allowance, which is no line where it is 0. */
const positive = (number: number): string | null => (number > 0 ? String(number) : null);

/** The answer of a row. */
export function showAnswer(data: Data, row: number): void {
  const { rows, pair, kind, demo } = data;
  const isListed = kind === 'pairs' || kind === 'parts';
  const clash = rows.clash && clashWords[rows.clash[row]];
  const title = kind === 'frames' ? 'This frame' : 'Answer';
  byId('answer-title').textContent = isListed ? `${numberedRow(data, row)}: ${clash!.toLowerCase()}` : title;
  byId('now-distance').textContent = kind === 'pair' ? '' : shownDistance(data, row);
  const isKept = rows.too_close[row] === false;
  const verdict = isKept ? 'at least' : rows.too_close[row] === true ? 'below' : 'not known for the parts';
  const query = shownTime(rows.query_us[row]);
  const place = clash === undefined ? '' : placeOf(data, row);
  const accepted = rows.accepted?.[row] ?? null;
  const lines: Line[] = [
    ['A', isListed ? named(data, rows.a[row]) : null],
    ['B', isListed ? named(data, rows.b[row]) : null],
    ['Clash', place === '' ? clash : `${clash}: ${place}`],
    ['Status', statusWords[rows.status[row]]],
    ['Distance, lower bound', digits(rows.lower[row]) ?? 'none'],
    ['Distance, upper bound', digits(rows.upper[row]) ?? 'none'],
    ['Required clearance', digits(data.min_clearance)],
    ['Clearance is', data.min_clearance === null ? null : element('span', isKept ? 'good' : 'bad', verdict)],
    ['Depth, at least', digits(rows.depth[row])],
    ['Overlap that is tolerated', positive(data.tolerance)],
    ['Error of each mesh, in the bounds twice', positive(data.mesh_error)],
    ['Accepted by', accepted === null ? null : `line ${accepted} of --accept`],
    ['Pairs of triangles that intersect', pair && meetsIn(data, row) ? grouped(pair.intersections) : null],
    ...witnessLines(data, row),
    ...data.contacts.map(({ name, count, intersecting }): Line => {
      const text = `${grouped(count[row])} pairs, ${grouped(intersecting[row])} of them intersect`;
      return [contactName(name), text];
    }),
    ['Query', pair === undefined ? query : `${query}; trees ${shownTime(pair.build_us)}`],
    ['Update', rows.update_us && shownTime(rows.update_us[row])],
    ['Moved vertices', rows.moved_vertices && grouped(rows.moved_vertices[row])],
    ['Tests', pair && `${grouped(pair.node_tests)} of nodes, ${grouped(pair.primitive_tests)} of triangles`],
    [`Within ${percent(demo?.rough.relative_error ?? 0)}`, demo && shownRough(demo.rough, row)],
  ];
  fillTable(
    byId('answer'),
    lines.filter((line): line is [string, Cell] => (line[1] ?? null) !== null),
  );
}

/** A name, and the file where that is another text. */
function named(data: Data, part: number): string {
  const [name, file] = [partName(data, part), data.parts.file[part]];
  return name.endsWith(file) ? name : `${name}: ${file}`;
}

function witnessLines(data: Data, row: number): Line[] {
  const witness = data.rows.witness[row];
  if (witness === null) return [];
  const kind = meetsIn(data, row) ? 'Shared point' : 'Closest point';
  return [0, 1].flatMap((side): Line[] => [
    [`${kind} of ${'AB'[side]}`, shownPoint(witness.slice(3 * side, 3 * side + 3))],
    ['on', `triangle ${witness[6 + side]}, face ${witness[8 + side]} of ${'AB'[side]}`],
  ]);
}

const shownRough = ({ lower, upper, query_us }: NonNullable<Data['demo']>['rough'], row: number): string =>
  `${shownBounds(lower[row], upper[row])}, in ${shownTime(query_us[row])}`;

/** All models in a list, and how precise their pictures are. */
export function showModels(data: Data, models: readonly Model[]): void {
  const partCount = (model: Model): number =>
    data.parts.model.filter((number) => data.models[number] === model.data).length;
  const columns: [string, (model: Model, side: number) => Cell | undefined][] = [
    ['Name', ({ data: { name } }, i) => element('span', '', ...(isOfOnePair(data) ? [letter(i)] : []), name)],
    ['Parts', (model) => (data.kind === 'parts' ? grouped(partCount(model)) : undefined)],
    ['Triangles', ({ data }) => grouped(data.triangles)],
    ['Vertices', ({ data }) => grouped(data.vertices)],
    ['Faces', ({ data: { faces } }) => (faces === undefined ? faces : grouped(faces))],
    ['Surface', ({ data: { closed } }) => (closed === undefined ? closed : closed ? 'closed' : 'not closed')],
    [
      'Size of its box',
      ({ data: { low, high } }) => low && withUnit(high!.map((c, axis) => shown(c - low[axis])).join(' \u00d7 ')),
    ],
    ['Deforms', ({ deforms }) => (data.kind === 'frames' ? (deforms ? 'yes' : 'no') : undefined)],
  ];
  const told = columns.filter(([, text]) => text(models[0], 0) !== undefined);
  const lines = models.map((model, i) => told.map(([, text]) => text(model, i)!));
  fillList(
    byId('models'),
    told.map(([head]) => head),
    lines,
  );
  const off = Math.max(...models.map(({ step }) => step)) / 2;
  byId('settings').textContent = [
    ...(data.kind === 'frames' ? [`Models: ${data.engine}.`] : []),
    `Its pictures hold coordinates within ${shownLength(off, 2)}; numbers in tables are the program\u2019s own.`,
    ...(data.relative_error > 0 ? [`Allowed relative error: ${data.relative_error}.`] : []),
    ...(data.absolute_error > 0 ? [`Allowed absolute error: ${data.absolute_error}.`] : []),
    ...(data.max_distance === null ? [] : [`Largest distance asked for: ${data.max_distance}.`]),
  ].join(' ');
}

/** When the page was made, by which version; and what the terminal has shown at the end. */
export function showMaking({ version, made_at, command, demo }: Data): void {
  byId('version').textContent = `limber ${version} on ${made_at}`;
  const words = command.split(' ').map((word) => element('span', 'word', word));
  byId('command').replaceChildren(...words.flatMap((word) => [' ', word]).slice(1));
  byId('summary-section').hidden = demo === undefined;
  fillTable(byId('summary'), demo?.summary.map(([name, text]) => [name, inPage(text)]) ?? []);
}
