// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Elements of the page, and its colours for what CSS does not draw: canvases and surfaces in 3D. */

/** The element with an id. Throws where the page has none. */
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (found === null) throw new Error(`the page has no element ${id}`);
  return found as T;
}

/** A new element with text or children inside. */
export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  className = '',
  ...content: (string | Node)[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  if (className !== '') made.className = className;
  made.append(...content);
  return made;
}

export function svgElement(tag: string, attributes: Record<string, string | number>, text = ''): SVGElement {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag) as SVGElement;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  made.textContent = text;
  return made;
}

/** Rows of a table: a name, and one or more texts. */
export function fillTable(table: HTMLElement, rows: readonly (readonly (string | Node)[])[]): void {
  table.replaceChildren(
    ...rows.map(([name, ...cells]) => {
      const head = element('th', '', name);
      head.scope = 'row';
      return element('tr', '', head, ...cells.map((cell) => element('td', '', cell)));
    }),
  );
}

/** Lets a box of the page switch something on and off. */
export function connectBox(id: string, isOn: boolean, set: (isOn: boolean) => void): void {
  const box = byId<HTMLInputElement>(id);
  box.checked = isOn;
  box.addEventListener('change', () => set(box.checked));
  set(isOn);
}

/** Lets a button copy the command line; where the browser does not allow that, it is selected. */
export function connectCopy(): void {
  const [button, command] = [byId('copy'), byId('command')];
  button.addEventListener('click', () => {
    getSelection()?.selectAllChildren(command);
    const copying = navigator.clipboard?.writeText(command.textContent ?? '') ?? Promise.reject();
    copying.then(
      () => (button.textContent = 'Copied'),
      () => (button.textContent = 'Selected'),
    );
  });
}

/** A colour of page.css. */
export const token = (name: string): string =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** A colour #rrggbb as three numbers from 0 to 1. */
export const rgbOf = (color: string): [number, number, number] =>
  [1, 3, 5].map((i) => parseInt(color.slice(i, i + 2), 16) / 255) as [number, number, number];

export const tokenRgb = (name: string): [number, number, number] => rgbOf(token(name));

/** Calls back whenever the reader's screen changes between light and dark, or to paper, which is light. */
export function onThemeChange(callback: () => void): void {
  for (const media of ['(prefers-color-scheme: dark)', 'print']) {
    matchMedia(media).addEventListener('change', callback);
  }
}
