// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The view of `limber distance --report`: two models as they stand. */

import { Color, Vector3 } from 'three';
import { byId, element, tokenRgb } from '../shared/dom.ts';
import { shown, shownLength, ticks } from '../shared/numbers.ts';
import { mapColors } from '../shared/surface.ts';
import { frameOf, framed, framedBox } from '../shared/viewer.ts';
import type { Frame } from '../shared/viewer.ts';
import { ModelsView } from '../viewer/models_view.ts';
import { boxOf, closeUp, decodedModel, witnessOf } from './model.ts';
import type { ReportData, ReportModel } from './model.ts';
import { showSection } from './section.ts';
import { showAnswer, showModels, showTiles, shownDistance } from './texts.ts';

export function showReport(data: ReportData): void {
  const boxes = data.models.map(boxOf);
  const frame = frameOf(boxes[0].clone().union(boxes[1]));
  const models = data.models.map((model) => decodedModel(model, frame));
  byId('kind').textContent = 'limber distance';
  showTiles(data, models);
  showAnswer(data);
  showModels(data, models);
  const view = new ModelsView(models);
  const { look, surfaces } = view;
  const markColor = { value: new Color() };
  models.forEach((model, i) => surfaces[i].mark(model.marked, markColor));
  view.color(() => {
    look.lineColor.value.setRGB(...tokenRgb('mark'));
    markColor.value.setRGB(...tokenRgb('hit'));
  });
  showMarks(data, frame, view);
  const isHidden = data.clash === 'hard_clash'; // by what is around the clash
  view.connectBox('cut', isHidden, (isOn) => (look.isCut.value = isOn));
  view.connectBox('show-map', data.status !== 'collision', (isOn) => {
    look.isMapped.value = isOn;
    byId('legend').hidden = !isOn;
  });
  view.connectDirections(
    boxes.map((box) => framedBox(frame, box)),
    () => restartSection(),
  );
  showLegend(data, models, view);
  byId('view-caption').textContent = captionOf(data);
  const restartSection = showSection(data, models, frame, view);
}

function captionOf(data: ReportData): string {
  const divided = data.models.some((model) => model.parts !== undefined);
  if (data.status === 'collision') return 'The triangles that intersect are yellow.';
  const points =
    data.witness === null ? '' : 'The red segment joins the closest points; their triangles are outlined. ';
  return `${points}Distances are measured at the vertices${divided ? ' and at points that divide long edges' : ''}.`;
}

/** The closest points, or a shared point, and the button that looks at them. */
function showMarks(data: ReportData, frame: Frame, { marks, viewer }: ModelsView): void {
  const [witness, button] = [witnessOf(data, frame), byId('closest')];
  const close = closeUp(data, frame);
  button.hidden = witness === undefined;
  button.addEventListener('click', () => viewer.lookAt(close.center, close.radius));
  if (witness === undefined) return;
  const [a, b] = witness;
  if (data.status === 'collision') {
    button.textContent = 'Shared point';
    return marks.show({ segment: { a, b, label: 'shared point' } });
  }
  const triangles = data.witness_corners ?? [];
  marks.show({
    segment: { a, b, label: shownDistance(data) },
    triangles: triangles.map((corners) => corners.map((p) => framed(frame, new Vector3(...p)))),
  });
}

/** Colours from the smallest distance to one that the reader chooses; at first one that shows what is near. */
function showLegend(data: ReportData, models: readonly ReportModel[], { viewer, look }: ModelsView): void {
  const low = Math.min(data.upper ?? Infinity, ...models.map((model) => model.nearest));
  const most = Math.max(...models.map((model) => model.farthest));
  const limit = data.min_clearance ?? 0;
  const near = limit > 0 ? Math.max(4 * limit, 2 * low) : low + Math.min(...models.map((model) => model.diagonal)) / 8;
  const slider = byId<HTMLInputElement>('map-end');
  const range = most - low;
  look.limit.value = limit;
  const apply = (): void => {
    const high = low + range * (Number(slider.value) / 1000) ** 2;
    const { step, values } = ticks(low, high, 6);
    const hasLimit = limit > low && limit < high;
    byId('legend-title').textContent = `Distance to the other model; dark lines as on the scale${
      hasLimit ? `, the red one at ${shownLength(limit)}` : ''
    }`;
    showLimit(hasLimit ? (limit - low) / (high - low) : undefined);
    look.range.value = [low, high];
    look.lineStep.value = step;
    byId('map-end-text').textContent = shownLength(high, 4);
    slider.setAttribute('aria-valuetext', shownLength(high, 4));
    showScale(low, high, values);
    byId('legend-beyond').hidden = high >= most;
    viewer.request();
  };
  slider.value = String(range > 0 ? Math.round(1000 * Math.sqrt(Math.min(1, (near - low) / range))) : 1000);
  slider.min = '20';
  slider.addEventListener('input', apply);
  apply();
}

/** A red line on the scale where surfaces have it, as a part of the scale's length. */
function showLimit(part: number | undefined): void {
  const line = byId('legend-limit');
  line.hidden = part === undefined;
  if (part !== undefined) line.style.left = `${100 * part}%`;
}

/** The colours with the lines that surfaces have, and numbers where there is room. */
function showScale(low: number, high: number, values: readonly number[]): void {
  const at = (value: number): number => (high > low ? (value - low) / (high - low) : 0);
  const lines = values.map((value) => `linear-gradient(#0008 0 0) ${100 * at(value)}% 0 / 2px 100% no-repeat`);
  const colors = `linear-gradient(to right, ${mapColors.join(', ')})`;
  byId('legend-bar').style.background = [...lines, colors].join(', ');
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
