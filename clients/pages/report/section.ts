// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The section through the closest points, which can be shifted and turned: outlines of both models, and a scale. */

import { Vector3 } from 'three';
import { byId, svgElement } from '../shared/dom.ts';
import { Marks } from '../shared/marks.ts';
import type { Segment } from '../shared/marks.ts';
import { roundBelow, shown, shownLength } from '../shared/numbers.ts';
import type { Mesh } from '../shared/surface.ts';
import { Viewer, framedBox } from '../shared/viewer.ts';
import type { Frame } from '../shared/viewer.ts';
import type { ModelsView } from '../viewer/models_view.ts';
import { isClosed, mostPerpendicularAxis, outlinesOf, planeThrough } from './cut.ts';
import type { Plane } from './cut.ts';
import { boxOf, closeUp, witnessOf } from './model.ts';
import type { ReportData, ReportModel } from './model.ts';
import { shownDistance } from './texts.ts';

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

function anchorOf(data: ReportData, frame: Frame): Anchor {
  const centers = data.models.map((model) => framedBox(frame, boxOf(model)).getCenter(new Vector3()));
  const between = direction(centers[1].clone().sub(centers[0]), new Vector3(1, 0, 0));
  const witness = witnessOf(data, frame);
  if (witness === undefined) {
    const point = centers[0].lerp(centers[1], 0.5);
    return { point, along: between, place: 'the middle of both models', alongName: 'the line between their centers' };
  }
  const [a, b] = witness;
  if (data.status === 'collision') {
    const along = direction(new Vector3(...(data.contact_normal ?? between)), between);
    const segment = { a, b: a, label: 'shared point' };
    return { point: a, along, segment, place: 'a shared point', alongName: 'the normal of the deepest contact' };
  }
  const along = direction(b.clone().sub(a), between);
  const segment = { a, b, label: shownDistance(data) };
  return { point: a, along, segment, place: 'both closest points', alongName: 'the segment between them' };
}

/** How far a mesh reaches along a direction. */
function reach({ points }: Mesh, { x, y, z }: Vector3): [number, number] {
  let [least, most] = [Infinity, -Infinity];
  for (let i = 0; i < points.length; i += 3) {
    const height = x * points[i] + y * points[i + 1] + z * points[i + 2];
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
  const [lows, highs] = [0, 1].map((end) => reaches.map((both) => both[end]));
  const shared = (Math.max(...lows) + Math.min(...highs)) / 2;
  const start = plane.offset + Math.max(-hair, Math.min(hair, shared - plane.offset));
  return { least: Math.min(...lows, start), start, most: Math.max(...highs, start) };
}

/** A round length, as long as some 120 pixels. */
function scaleOf(viewer: Viewer, frame: Frame): SVGElement[] {
  const units = roundBelow(120 * viewer.pixel * frame.size);
  const y = viewer.size[1] - 20;
  const d = `M 14 ${y} v 6 h ${units / viewer.pixel / frame.size} v -6`;
  return [
    svgElement('path', { class: 'scale halo', d }),
    svgElement('path', { class: 'scale', d }),
    svgElement('text', { class: 'units', x: 20, y }, shownLength(units)),
  ];
}

/** Returns what to call when the reader has chosen what is up. */
export function showSection(
  data: ReportData,
  models: readonly ReportModel[],
  frame: Frame,
  { viewer: view, look }: ModelsView,
): () => void {
  const anchor = anchorOf(data, frame);
  const viewer = new Viewer(byId('section'), view.up, true);
  const marks = new Marks(viewer, () => scaleOf(viewer, frame));
  const [shift, turn] = ['shift', 'turn'].map((id) => byId<HTMLInputElement>(id));
  let plane = planeThrough(anchor.point, anchor.along, 0, view.up);

  const apply = (): void => {
    const degrees = Number(turn.value);
    plane = planeThrough(anchor.point, anchor.along, (degrees * Math.PI) / 180, view.up);
    const { least, start, most } = rangeOf(models, plane);
    const part = Number(shift.value) / 500;
    const moved = part * (part < 0 ? start - least : most - start);
    plane.offset = start + moved;
    look.cutAt(plane.normal, plane.offset);
    view.request();
    const texts = [shown(moved * frame.size, 4), `${degrees}\u00b0`];
    [shift, turn].forEach((slider, i) => {
      slider.setAttribute('aria-valuetext', texts[i]);
      byId(`${slider.id}-text`).textContent = texts[i];
    });
    byId('section-caption').textContent = captionOf(anchor, plane, moved * frame.size, degrees);
    marks.show({
      outlines: models.flatMap(({ mesh }, i) => {
        const [closed, open] = [[], []] as Vector3[][][];
        for (const line of outlinesOf(mesh, plane)) (isClosed(line) ? closed : open).push(line);
        const kind = `outline ${'ab'[i]}`;
        return [
          { kind, lines: closed },
          { kind: `${kind} open`, lines: open },
        ];
      }),
      segment: anchor.segment && { ...anchor.segment, isDashed: moved !== 0 },
    });
  };

  const close = closeUp(data, frame);
  const lookClose = (): void => viewer.lookAt(close.center, close.radius, plane.normal);
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
  if (data.status === 'collision') byId('section-closest').textContent = 'Shared point';
  if (data.witness === null) byId('section-closest').hidden = true;
  shift.addEventListener('input', apply);
  turn.addEventListener('input', restart);
  restart();
  return restart;
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
