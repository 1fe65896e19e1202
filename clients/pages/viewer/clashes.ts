// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Kinds of clashes, as the program tells them, in words. */

export type Clash =
  'hard_clash' | 'cannot_tell' | 'surfaces_meet' | 'touching' | 'clearance' | 'clear' | 'surfaces_apart';
export type Solids = 'apart' | 'touching' | 'overlapping' | 'a_inside_b' | 'b_inside_a' | 'equal' | null;
export type Inside = 'a_inside_b' | 'b_inside_a' | null;

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
export const badClashes: readonly Clash[] = ['hard_clash', 'cannot_tell', 'surfaces_meet'];

/** How the models lie, besides their distance; empty where the word of the clash says it all. */
export function placeOf({ clash, solids, inside }: { clash: Clash; solids: Solids; inside: Inside }): string {
  if (solids === 'a_inside_b' || inside === 'a_inside_b') return 'A is enclosed in B';
  if (solids === 'b_inside_a' || inside === 'b_inside_a') return 'B is enclosed in A';
  if (solids === 'equal') return 'both volumes are equal';
  if (clash === 'hard_clash') return 'the volumes overlap';
  if (clash === 'cannot_tell') return 'the errors of the meshes leave it open';
  if (clash === 'touching') return solids === 'touching' ? 'the volumes do not overlap' : 'within the tolerance';
  return solids === null ? 'a model is not closed' : '';
}

/** What numbers are true of. */
export interface Tolerances {
  tolerance: number;
  /** Of each mesh. */
  mesh_error: number;
}

export function toleranceRows({ tolerance, mesh_error: error }: Tolerances): (readonly [string, string])[] {
  return [
    ...(tolerance > 0 ? [['Overlap that is tolerated', String(tolerance)] as const] : []),
    ...(error > 0 ? [['Error of each mesh, in the bounds twice', String(error)] as const] : []),
  ];
}

export const statusWords = {
  exact: 'exact for the meshes: lower and upper are equal',
  within_error: 'within the allowed errors',
  collision: 'collision: the models meet',
  beyond_limit: 'beyond limit: farther apart than the largest distance asked for',
};
