// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The section through the closest points, which can be shifted and turned. */

import { byId } from '../shared/dom.ts';
import { shown } from '../shared/numbers.ts';
import { mostPerpendicularAxis, outlinesOf, planeThrough } from '../shared/section.ts';
import type { Mesh, Plane } from '../shared/section.ts';
import { SectionView } from '../shared/section_view.ts';
import type { Point } from '../shared/section_view.ts';
import { direction, dot, middle, subtract } from '../shared/vectors.ts';
import type { Vec3 } from '../shared/vectors.ts';
import { framed } from '../shared/viewer.ts';
import type { Frame } from '../shared/viewer.ts';
import type { ReportData } from './data.ts';
import type { ReportModel } from './model.ts';
import { shownDistance } from './texts.ts';
import { closeUp } from './view.ts';
import type { View } from './view.ts';

const hair = 2e-6; // of the size of both models together

/** What the plane holds: a point and a direction, and both in words. */
interface Anchor {
  point: Vec3;
  along: Vec3;
  segment?: { a: Vec3; b: Vec3; label: string };
  place: string;
  alongName: string;
}

function anchorOf(data: ReportData, frame: Frame): Anchor {
  const centers = data.models.map(({ low, high }) => framed(frame, middle(low, high)));
  const between = direction(subtract(centers[1], centers[0]), [1, 0, 0]);
  if (data.witness === null) {
    const point = middle(centers[0], centers[1]);
    return { point, along: between, place: 'the middle of both models', alongName: 'the line between their centers' };
  }
  const [a, b] = [framed(frame, data.witness.point_a), framed(frame, data.witness.point_b)];
  if (data.status === 'collision') {
    const along = direction(data.contact_normal ?? between, between);
    const segment = { a, b: a, label: 'shared point' };
    return { point: a, along, segment, place: 'a shared point', alongName: 'the normal of the deepest contact' };
  }
  const along = direction(subtract(data.witness.point_b, data.witness.point_a), between);
  const segment = { a, b, label: shownDistance(data) };
  return { point: a, along, segment, place: 'both closest points', alongName: 'the segment between them' };
}

/** How far a mesh reaches along a direction. */
function reach({ points }: Mesh, along: Vec3): [number, number] {
  let [least, most] = [Infinity, -Infinity];
  for (let i = 0; i < points.length; i += 3) {
    const height = along[0] * points[i] + along[1] * points[i + 1] + along[2] * points[i + 2];
    least = Math.min(least, height);
    most = Math.max(most, height);
  }
  return [least, most];
}

/**
 * Where the plane may go, and where it starts: at its anchor, but a hair toward where both models are. A plane in which
 * a whole face lies would show the face or nothing, as rounding decides.
 */
function rangeOf(models: readonly ReportModel[], plane: Plane): { least: number; start: number; most: number } {
  const reaches = models.map(({ mesh }) => reach(mesh, plane.normal));
  const least = Math.min(...reaches.map(([low]) => low));
  const most = Math.max(...reaches.map(([, high]) => high));
  const shared = (Math.max(...reaches.map(([low]) => low)) + Math.min(...reaches.map(([, high]) => high))) / 2;
  const start = plane.offset + Math.max(-hair, Math.min(hair, shared - plane.offset));
  return { least: Math.min(least, start), start, most: Math.max(most, start) };
}

export function showSection(
  data: ReportData,
  models: readonly ReportModel[],
  frame: Frame,
  { viewer, look, onUp }: View,
): void {
  const anchor = anchorOf(data, frame);
  const drawing = new SectionView(byId('section'), frame.size);
  const shift = byId<HTMLInputElement>('shift');
  const turn = byId<HTMLInputElement>('turn');
  let plane = planeThrough(anchor.point, anchor.along, 0, viewer.up);
  const inPlane = (p: Vec3): Point => [dot(p, plane.right), dot(p, plane.up)];

  const apply = (): void => {
    const degrees = Number(turn.value);
    plane = planeThrough(anchor.point, anchor.along, (degrees * Math.PI) / 180, viewer.up);
    const { least, start, most } = rangeOf(models, plane);
    const part = Number(shift.value) / 500;
    const moved = part * (part < 0 ? start - least : most - start);
    plane = { ...plane, offset: start + moved };
    look.cutAt(plane);
    viewer.request();
    const texts = [shown(moved * frame.size, 4), `${degrees}\u00b0`];
    [shift, turn].forEach((slider, i) => slider.setAttribute('aria-valuetext', texts[i]));
    byId('shift-text').textContent = texts[0];
    byId('turn-text').textContent = texts[1];
    byId('section-caption').textContent = captionOf(anchor, plane, moved * frame.size, degrees);
    drawing.show({
      models: models.map(({ mesh }, i) => ({ outlines: outlinesOf(mesh, plane), kind: 'ab'[i] as 'a' | 'b' })),
      segment: anchor.segment && {
        a: inPlane(anchor.segment.a),
        b: inPlane(anchor.segment.b),
        label: anchor.segment.label,
        isInPlane: moved === 0,
      },
    });
  };

  const close = closeUp(data, frame);
  const lookClose = (): void => drawing.lookAt(inPlane(close.center), close.radius);
  const restart = (): void => {
    apply();
    lookClose();
  };
  byId('section-closest').addEventListener('click', lookClose);
  byId('section-whole').addEventListener('click', () => drawing.lookAt(inPlane([0, 0, 0]), 0.53));
  byId('section-reset').addEventListener('click', () => {
    shift.value = '0';
    turn.value = '0';
    restart();
  });
  if (data.status === 'collision') byId('section-closest').textContent = 'Shared point';
  if (data.witness === null) byId('section-closest').hidden = true;
  shift.addEventListener('input', apply);
  turn.addEventListener('input', restart);
  onUp(restart);
  restart();
}

function captionOf(anchor: Anchor, plane: Plane, moved: number, degrees: number): string {
  const axis = 'xyz'[mostPerpendicularAxis(anchor.along)];
  const normal = plane.normal.map((c) => String(Number(c.toFixed(3)) + 0)).join(', ');
  const turned = degrees === 0 ? '' : `, turned by ${degrees}\u00b0 around it`;
  const place = moved === 0 ? `goes through ${anchor.place}` : `lies ${shown(Math.abs(moved), 4)} off ${anchor.place}`;
  return (
    `The plane ${place}. Its normal (${normal}) is the direction closest to the ${axis} axis ` +
    `that is perpendicular to ${anchor.alongName}${turned}.`
  );
}
