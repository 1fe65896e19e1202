// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Both models in 3D. */

import { byId, element } from '../shared/dom.ts';
import { connectDirections } from '../shared/directions.ts';
import type { Marks } from '../shared/marks.ts';
import { shown, ticks } from '../shared/numbers.ts';
import { mapGradient } from '../shared/palette.ts';
import type { SurfaceLook } from '../shared/surface.ts';
import { tokenRgb } from '../shared/theme.ts';
import { length, middle, subtract } from '../shared/vectors.ts';
import type { Vec3 } from '../shared/vectors.ts';
import { framed } from '../shared/viewer.ts';
import type { Frame, Viewer } from '../shared/viewer.ts';
import { ModelsView } from '../viewer/models_view.ts';
import { Color } from 'three';
import type { ReportData } from './data.ts';
import type { ReportModel } from './model.ts';
import { shownDistance } from './texts.ts';

/** What the section needs of the view. */
export interface View {
  viewer: Viewer;
  look: SurfaceLook;
  /** Calls back when the reader has chosen what is up. */
  onUp(callback: () => void): void;
}

const smallestRadius = 2e-4;

export function showView(data: ReportData, models: readonly ReportModel[], frame: Frame): View {
  const view = new ModelsView(models);
  const { viewer, look, surfaces } = view;
  const markColor = { value: new Color() };
  models.forEach((model, i) => surfaces[i].addMarked(model.marked, markColor));
  view.color(() => {
    look.lineColor.value.setRGB(...tokenRgb('mark'));
    markColor.value.setRGB(...tokenRgb('hit'));
  });
  showMarks(data, frame, view.marks);
  view.connectBox('cut', false, (isOn) => (look.isCut.value = isOn));
  view.connectBox('show-map', data.status !== 'collision', (isOn) => {
    look.isMapped.value = isOn;
    byId('legend').hidden = !isOn;
  });
  const boxes = data.models.map(({ low, high }) => [framed(frame, low), framed(frame, high)] as const);
  const onUp: (() => void)[] = [];
  connectDirections(viewer, boxes, () => onUp.forEach((callback) => callback()));
  connectCloseUp(data, frame, viewer);
  showLegend(data, models, viewer, look);
  byId('view-caption').textContent = captionOf(data);
  return { viewer, look, onUp: (callback) => onUp.push(callback) };
}

function captionOf(data: ReportData): string {
  const divided = data.models.some((model) => model.parts !== undefined);
  if (data.status === 'collision') return 'The triangles that intersect are yellow.';
  const points =
    data.witness === null ? '' : 'The red segment joins the closest points; their triangles are outlined. ';
  return `${points}Distances are measured at the vertices${divided ? ' and at points that divide long edges' : ''}.`;
}

function showMarks(data: ReportData, frame: Frame, marks: Marks): void {
  if (data.witness === null) return;
  const [a, b] = [framed(frame, data.witness.point_a), framed(frame, data.witness.point_b)];
  marks.setSegment({ a, b, label: data.status === 'collision' ? 'shared point' : shownDistance(data) });
  if (data.status === 'collision') return;
  marks.setOutlines((data.witness_corners ?? []).map((corners) => corners.map((p) => framed(frame, p))));
}

/** The closest points, or a shared point, and how much around them is worth a look; the whole without them. */
export function closeUp(data: ReportData, frame: Frame): { center: Vec3; radius: number } {
  if (data.witness === null) return { center: [0, 0, 0], radius: 0.5 };
  const [a, b] = [framed(frame, data.witness.point_a), framed(frame, data.witness.point_b)];
  const apart = length(subtract(b, a));
  const radius = data.status === 'collision' ? 0.1 : Math.max(smallestRadius, Math.min(0.6, 2.5 * apart));
  return { center: middle(a, b), radius };
}

function connectCloseUp(data: ReportData, frame: Frame, viewer: Viewer): void {
  const close = closeUp(data, frame);
  const button = byId('closest');
  button.addEventListener('click', () => viewer.lookAt(close.center, close.radius));
  button.hidden = data.witness === null;
  if (data.status === 'collision') button.textContent = 'Shared point';
}

/** Colours from the smallest distance to one that the reader chooses; at first one that shows what is near. */
function showLegend(data: ReportData, models: readonly ReportModel[], viewer: Viewer, look: SurfaceLook): void {
  const low = Math.min(data.upper ?? Infinity, ...models.map((model) => model.nearest));
  const most = Math.max(...models.map((model) => model.farthest));
  const limit = data.min_clearance ?? 0;
  const near = limit > 0 ? Math.max(4 * limit, 2 * low) : low + Math.min(...models.map((model) => model.diagonal)) / 8;
  const slider = byId<HTMLInputElement>('map-end');
  const range = most - low;
  byId('legend-bar').style.background = mapGradient();
  byId('legend-title').textContent =
    'Distance to the other model; dark lines as on the scale' + (limit > 0 ? `, the red line at ${shown(limit)}` : '');
  look.limit.value = limit;
  const apply = (): void => {
    const high = low + range * (Number(slider.value) / 1000) ** 2;
    const { step, values } = ticks(low, high, 6);
    look.range.value = [low, high];
    look.lineStep.value = step;
    byId('map-end-text').textContent = shown(high, 4);
    slider.setAttribute('aria-valuetext', shown(high, 4));
    showTicks(low, high, values);
    byId('legend-beyond').hidden = high >= most;
    viewer.request();
  };
  slider.value = String(range > 0 ? Math.round(1000 * Math.sqrt(Math.min(1, (near - low) / range))) : 1000);
  slider.min = '20';
  slider.addEventListener('input', apply);
  apply();
}

function showTicks(low: number, high: number, values: readonly number[]): void {
  const at = (value: number): number => (high > low ? (value - low) / (high - low) : 0);
  const inside = values.filter((value) => at(value) > 0.14 && at(value) < 0.86);
  const span = (text: string, place: number, className = ''): HTMLElement => {
    const made = element('span', className, text);
    made.style.left = `${100 * place}%`;
    return made;
  };
  byId('legend-ticks').replaceChildren(
    span(shown(low, 4), 0),
    ...inside.map((value) => span(shown(value, 4), at(value))),
    span(shown(high, 4), 1, 'last'),
  );
}
