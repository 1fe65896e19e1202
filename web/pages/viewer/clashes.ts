// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Kinds of clashes, as the program tells them, in words. */

export type Clash = 'hard_clash' | 'touching' | 'clearance' | 'clear' | 'surfaces_meet' | 'surfaces_apart';
export type Solids = 'apart' | 'touching' | 'overlapping' | 'a_inside_b' | 'b_inside_a' | 'equal' | null;
export type Inside = 'a_inside_b' | 'b_inside_a' | null;

export const clashWords: Record<Clash, string> = {
  hard_clash: 'Hard clash',
  touching: 'Touching',
  clearance: 'Below the clearance',
  clear: 'Clear',
  surfaces_meet: 'Surfaces meet',
  surfaces_apart: 'Surfaces are apart',
};

/** How the models lie, besides their distance; empty where the word of the clash says it all. */
export function placeOf({ clash, solids, inside }: { clash: Clash; solids: Solids; inside: Inside }): string {
  if (solids === 'a_inside_b' || inside === 'a_inside_b') return 'A is enclosed in B';
  if (solids === 'b_inside_a' || inside === 'b_inside_a') return 'B is enclosed in A';
  if (solids === 'equal') return 'both volumes are equal';
  if (clash === 'hard_clash') return 'the volumes overlap';
  if (clash === 'touching') return 'the volumes do not overlap';
  return solids === null ? 'a model is not closed' : '';
}

export const statusWords = {
  exact: 'exact: lower and upper are equal',
  within_error: 'within the allowed error',
  collision: 'collision: the models meet',
  beyond_limit: 'beyond limit: farther apart than the largest distance asked for',
};
