// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The section through the closest points, which can be shifted and turned: outlines of both models, and a scale. */

import { Plane as ThreePlane, Vector3 } from 'three';
import { byId, svgElement } from '../shared/dom.ts';
import { Marks } from '../shared/marks.ts';
import type { Segment } from '../shared/marks.ts';
import { roundBelow, shown, shownLength } from '../shared/numbers.ts';
import type { Surface } from '../shared/surface.ts';
import { Viewer } from '../shared/viewer.ts';
import { isClosed, mostPerpendicularAxis, outlinesOf, planeThrough } from './cut.ts';
import type { Plane } from './cut.ts';
import { meetsIn } from './data.ts';
import type { Data } from './data.ts';
import type { View } from './view.ts';

const hair = 2e-6; // of the size of both models together

/** What the plane holds: a point and a direction, and both in words. */
interface Anchor {
  point: Vector3;
  along: Vector3;
  segment?: Segment;
  place: string;
  alongName: string;
}

/** The direction of a vector; `otherwise` where it has none. */
const direction = (v: Vector3, otherwise: Vector3): Vector3 => (v.lengthSq() > 0 ? v.normalize() : otherwise);

function anchorOf(data: Data, { marks, boxes }: View): Anchor {
  const centers = boxes.map((box) => box.getCenter(new Vector3()));
  const between = direction(centers[1].clone().sub(centers[0]), new Vector3(1, 0, 0));
  const { segment } = marks.shown;
  if (segment === undefined) {
    const point = centers[0].lerp(centers[1], 0.5);
    return { point, along: between, place: 'the middle of both models', alongName: 'the line between their centers' };
  }
  const { a, b } = segment;
  if (meetsIn(data, 0)) {
    const along = direction(new Vector3(...(data.pair!.contact_normal ?? between)), between);
    return { point: a, along, segment, place: 'a shared point', alongName: 'the normal of the deepest contact' };
  }
  const along = direction(b.clone().sub(a), between);
  return { point: a, along, segment, place: 'both closest points', alongName: 'the segment between them' };
}

/**
 * Where the plane may go, and where it starts: at its anchor, but a hair toward where both models are. A plane in which
 * a whole face lies would show the face or nothing, as rounding decides.
 */
function rangeOf(
  surfaces: readonly Surface[],
  { normal, offset }: Plane,
): { least: number; start: number; most: number } {
  const lows = surfaces.map((surface) => normal.dot(surface.farthestAlong(normal.clone().negate())));
  const highs = surfaces.map((surface) => normal.dot(surface.farthestAlong(normal)));
  const shared = (Math.max(...lows) + Math.min(...highs)) / 2;
  const start = offset + Math.max(-hair, Math.min(hair, shared - offset));
  return { least: Math.min(...lows, start), start, most: Math.max(...highs, start) };
}

/** The outlines of a surface as it is placed. */
function outlinesIn({ mesh, object }: Surface, { normal, offset }: Plane): Vector3[][] {
  const own = new ThreePlane(normal.clone(), -offset).applyMatrix4(object.matrix.clone().invert());
  const lines = outlinesOf(mesh, { normal: own.normal, offset: -own.constant });
  return lines.map((line) => line.map((p) => p.applyMatrix4(object.matrix)));
}

/** A round length, as long as some 120 pixels. */
function scaleOf(viewer: Viewer, size: number): SVGElement[] {
  const units = roundBelow(120 * viewer.pixel * size);
  const y = viewer.size[1] - 20;
  const d = `M 14 ${y} v 6 h ${units / viewer.pixel / size} v -6`;
  return [
    svgElement('path', { class: 'scale halo', d }),
    svgElement('path', { class: 'scale', d }),
    svgElement('text', { class: 'units', x: 20, y }, shownLength(units)),
  ];
}

export function connectSection(data: Data, view: View): void {
  const { surfaces, look, frame } = view;
  const anchor = anchorOf(data, view);
  const viewer = new Viewer(byId('section'), view.viewer.up, true);
  const marks = new Marks(viewer, () => scaleOf(viewer, frame.size));
  const [shift, turn] = ['shift', 'turn'].map((id) => byId<HTMLInputElement>(id));
  let plane = planeThrough(anchor.point, anchor.along, 0, view.viewer.up);

  const apply = (): void => {
    const degrees = Number(turn.value);
    plane = planeThrough(anchor.point, anchor.along, (degrees * Math.PI) / 180, view.viewer.up);
    const { least, start, most } = rangeOf(surfaces, plane);
    const part = Number(shift.value) / 500;
    const moved = part * (part < 0 ? start - least : most - start);
    plane.offset = start + moved;
    look.cutAt(plane.normal, plane.offset);
    view.viewer.request();
    const texts = [shown(moved * frame.size, 4), `${degrees}\u00b0`];
    [shift, turn].forEach((slider, i) => {
      slider.setAttribute('aria-valuetext', texts[i]);
      byId(`${slider.id}-text`).textContent = texts[i];
    });
    byId('section-caption').textContent = captionOf(anchor, plane, moved * frame.size, degrees);
    marks.show({
      outlines: surfaces.flatMap((surface, i) => {
        const [closed, open] = [[], []] as Vector3[][][];
        for (const line of outlinesIn(surface, plane)) (isClosed(line) ? closed : open).push(line);
        const kind = `outline ${'ab'[i]}`;
        return [
          { kind, lines: closed },
          { kind: `${kind} open`, lines: open },
        ];
      }),
      segment: anchor.segment && { ...anchor.segment, isDashed: moved !== 0 },
    });
  };

  const { center, radius } = view.closest;
  const lookClose = (): void => viewer.lookAt(center, radius, plane.normal);
  const restart = (): void => {
    apply();
    viewer.setUp(plane.up);
    lookClose();
  };
  byId('section-closest').addEventListener('click', lookClose);
  byId('section-whole').addEventListener('click', () => viewer.lookAt(new Vector3(), 0.53, plane.normal));
  byId('section-reset').addEventListener('click', () => {
    shift.value = '0';
    turn.value = '0';
    restart();
  });
  byId('section-closest').textContent = byId('closest').textContent;
  byId('section-closest').hidden = byId('closest').hidden;
  shift.addEventListener('input', apply);
  turn.addEventListener('input', restart);
  restart();
  view.onUp(restart);
  // What is around a clash would hide it.
  view.connect('cut', data.rows.clash![0] === 'hard_clash', (isOn) => (look.isCut.value = isOn));
}

function captionOf(anchor: Anchor, plane: Plane, moved: number, degrees: number): string {
  const axis = 'xyz'[mostPerpendicularAxis(anchor.along)];
  const normal = plane.normal.toArray().map((c) => String(Number(c.toFixed(3)) + 0));
  const turned = degrees === 0 ? '' : `, turned by ${degrees}\u00b0 around it`;
  const place = moved === 0 ? `goes through ${anchor.place}` : `lies ${shown(Math.abs(moved), 4)} off ${anchor.place}`;
  return (
    `The plane ${place}. Its normal (${normal.join(', ')}) is the direction closest to the ${axis} axis ` +
    `that is perpendicular to ${anchor.alongName}${turned}.`
  );
}
