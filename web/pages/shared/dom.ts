// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Elements of the page. */

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

export function svgElement<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Record<string, string | number>,
): SVGElementTagNameMap[K] {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
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

/** The data that the program has put into the page. */
export function pageData<T>(): T {
  return JSON.parse(byId('data').textContent ?? 'null') as T;
}

/** Shows the command line, and a button that copies it. */
export function showMaking(version: string, command: string): void {
  byId('version').textContent = `limber ${version}`;
  byId('command').textContent = command;
  const button = byId<HTMLButtonElement>('copy');
  button.addEventListener('click', () => {
    const range = document.createRange();
    range.selectNodeContents(byId('command'));
    getSelection()?.removeAllRanges();
    getSelection()?.addRange(range);
    const said = (copied: boolean): void => {
      button.textContent = copied ? 'Copied' : 'Selected';
    };
    if (navigator.clipboard === undefined) return said(false);
    navigator.clipboard.writeText(command).then(
      () => said(true),
      () => said(false),
    );
  });
}
