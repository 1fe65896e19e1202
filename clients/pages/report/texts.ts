// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The answer in words, tiles and tables. */

import { byId, fillTable } from '../shared/dom.ts';
import { grouped, shown, shownLength, shownPoint, shownTime, unitNote, withUnit } from '../shared/numbers.ts';
import { badClashes, clashWords, placeOf, statusWords, toleranceRows } from '../viewer/clashes.ts';
import { clearanceVerdict, fillModels, shownBounds, tile } from '../viewer/texts.ts';
import type { ModelData, ReportData, ReportModel } from './model.ts';

/** The distance as it stands next to the closest points. */
export const shownDistance = ({ lower, upper }: ReportData): string => withUnit(shownBounds(lower, upper));

export function showTiles(data: ReportData, models: readonly ReportModel[]): void {
  const tiles = [];
  if (data.min_clearance !== null) {
    const required = shownLength(data.min_clearance);
    if (data.too_close === null) tiles.push(tile('? Cannot tell', `a clearance of ${required} is required`, 'bad'));
    else if (!data.too_close) tiles.push(tile('\u2713 Kept', `a clearance of ${required} is required`, 'good'));
    else tiles.push(tile('\u2717 Too close', `a clearance of ${required} is required${missing(data)}`, 'bad'));
  }
  const [isBad, meets] = [badClashes.includes(data.clash), data.status === 'collision'];
  if (isBad || meets) tiles.push(tile(clashWords[data.clash], placeOf(data), isBad ? 'bad' : ''));
  if (data.depth !== null) tiles.push(tile(shownLength(data.depth), 'deep at least', isBad ? 'bad' : ''));
  if (meets) tiles.push(tile(grouped(data.intersections), 'pairs of triangles intersect'));
  else
    tiles.push(
      tile(capital(shownDistance(data)), `${isBad ? 'between surfaces' : 'clearance'} ${ofMeshes(data)}${unitNote()}`),
    );
  for (const [i, { data: model }] of models.entries()) {
    tiles.push(tile(grouped(model.triangles), `triangles of ${'AB'[i]}, ${shownSize(model, 4)}`));
  }
  byId('tiles').append(...tiles);
}

/** Whether curved parts may be nearer than their meshes. */
export const ofMeshes = ({ mesh_error: error }: ReportData): string => (error > 0 ? 'of the parts' : 'of the meshes');

function missing({ min_clearance: required, upper, status, clash }: ReportData): string {
  if (required === null || upper === null || status !== 'exact' || clash === 'hard_clash') return '';
  return `; ${shownLength(required - upper)} are missing`;
}

const capital = (text: string): string => text[0].toUpperCase() + text.slice(1);

export function showAnswer(data: ReportData): void {
  const [word, place] = [clashWords[data.clash], placeOf(data)];
  const rows: (readonly (string | Node)[])[] = [
    ['Clash', place === '' ? word : `${word}: ${place}`],
    ['Status', statusWords[data.status]],
    ['Distance, lower bound', String(data.lower)],
  ];
  if (data.upper !== null) rows.push(['Distance, upper bound', String(data.upper)]);
  if (data.min_clearance !== null) {
    rows.push([`Required clearance`, String(data.min_clearance)], ['Clearance is', clearanceVerdict(data.too_close)]);
  }
  if (data.depth !== null) rows.push(['Depth, at least', String(data.depth)]);
  rows.push(...toleranceRows(data));
  if (data.max_distance !== null) rows.push(['Largest distance asked for', String(data.max_distance)]);
  if (data.relative_error > 0) rows.push(['Allowed relative error', String(data.relative_error)]);
  if (data.absolute_error > 0) rows.push(['Allowed absolute error', String(data.absolute_error)]);
  if (data.status === 'collision') rows.push(['Pairs of triangles that intersect', grouped(data.intersections)]);
  if (data.witness !== null) {
    const { point_a, point_b, triangle_a, triangle_b, face_a, face_b } = data.witness;
    const kind = data.status === 'collision' ? 'Shared point' : 'Closest point';
    rows.push([`${kind} of A`, shownPoint(point_a)], ['on', `triangle ${triangle_a}, face ${face_a} of A`]);
    rows.push([`${kind} of B`, shownPoint(point_b)], ['on', `triangle ${triangle_b}, face ${face_b} of B`]);
  }
  const tests = `${grouped(data.node_tests)} of nodes, ${grouped(data.primitive_tests)} of triangles`;
  rows.push(['Time', `trees ${shownTime(data.build_us)}, query ${shownTime(data.query_us)}`], ['Tests', tests]);
  fillTable(byId('answer'), rows);
}

export function showModels(data: ReportData, models: readonly ReportModel[]): void {
  fillModels(models, [
    ['Faces in the file', ({ data }) => grouped(data.faces)],
    ['Surface', ({ data }) => (data.closed ? 'closed' : 'not closed')],
    ['Box, low', ({ data }) => shownPoint(data.low)],
    ['Box, high', ({ data }) => shownPoint(data.high)],
    ['Box, size', ({ data }) => shownSize(data, 8)],
    ['Diagonal', ({ diagonal }) => shown(diagonal, 8)],
    [
      'Distance of its surface from the other',
      ({ nearest, farthest }) => `${shown(Math.min(nearest, data.upper ?? Infinity))} to ${shown(farthest)}`,
    ],
  ]);
  const off = models.map((model) => shown(Math.max(...model.data.positions.step) / 2, 2));
  byId('settings').textContent =
    `Its pictures hold coordinates of A within ${off[0]} and of B within ${off[1]}; ` +
    'numbers in tables are the program\u2019s own.';
}

const shownSize = ({ low, high }: ModelData, digits: number): string =>
  withUnit(high.map((c, axis) => shown(c - low[axis], digits)).join(' \u00d7 '));
