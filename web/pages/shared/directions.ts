// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The buttons that say where a view looks from, and the choice of what is up. */

import { byId } from './dom.ts';
import type { Vec3 } from './vectors.ts';
import { sides } from './viewer.ts';
import type { Up, Viewer } from './viewer.ts';

/**
 * Starts by showing all boxes, which what is returned does again. `onUp` is called when the reader has chosen what is
 * up.
 */
export function connectDirections(
  viewer: Viewer,
  boxes: readonly (readonly [Vec3, Vec3])[],
  onUp: () => void,
): () => void {
  const look = (side: (typeof sides)[number]): void => viewer.lookAtBoxes(boxes, viewer.from(side));
  for (const side of sides) byId(side).addEventListener('click', () => look(side));
  const choice = byId<HTMLSelectElement>('up');
  choice.value = viewer.up[1] === 1 ? 'y' : 'z';
  choice.addEventListener('change', () => {
    viewer.setUp(choice.value as Up);
    look('whole');
    onUp();
  });
  look('whole');
  return () => look('whole');
}
