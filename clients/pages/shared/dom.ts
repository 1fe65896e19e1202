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

/** A cell that tells what its row or column has. */
export function headOf(scope: 'row' | 'col', content: string | Node): HTMLElement {
  const made = element('th', '', content);
  made.scope = scope;
  return made;
}

/** Rows of a table: a name, and one or more texts. */
export function fillTable(table: HTMLElement, rows: readonly (readonly (string | Node)[])[]): void {
  table.replaceChildren(
    ...rows.map(([name, ...cells]) =>
      element('tr', '', headOf('row', name), ...cells.map((cell) => element('td', '', cell))),
    ),
  );
}

/** A table with heads above its columns. */
export function fillList(table: HTMLElement, heads: readonly (string | Node)[], rows: (string | Node)[][]): void {
  const body = element('tbody');
  fillTable(body, rows);
  table.classList.add('list');
  table.append(element('thead', '', element('tr', '', ...heads.map((head) => headOf('col', head)))), body);
}

/** Lets a button copy the command line; where the browser does not allow that, it is selected. */
export function connectCopy(): void {
  byId('copy').addEventListener('click', () => {
    const command = byId('command');
    getSelection()?.selectAllChildren(command);
    navigator.clipboard?.writeText(command.textContent!).then(() => (byId('copy').textContent = 'Copied'));
  });
}

/** A colour of page.css. */
export const token = (name: string): string =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** Calls back whenever the reader's screen changes between light and dark, or to paper, which is light. */
export function onThemeChange(callback: () => void): void {
  for (const media of ['(prefers-color-scheme: dark)', 'print']) {
    matchMedia(media).addEventListener('change', callback);
  }
}
