// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** All pairs of parts as a matrix: what kind of clash each is, to be chosen by a click or by arrow keys. */

import { byId, element } from '../shared/dom.ts';
import type { Clash, Data } from './data.ts';
import { clashWords, partName, shownDistance } from './texts.ts';

/** What stands in a cell: readers who see no colours tell them apart, too. */
const symbols: Record<Clash, string> = {
  hard_clash: '\u2715',
  cannot_tell: '?',
  surfaces_meet: '\u00d7',
  touching: '=',
  clearance: '!',
  clear: '\u00b7',
  surfaces_apart: '\u25e6',
};

const moves: Record<string, readonly [number, number]> = {
  ArrowLeft: [0, -1],
  ArrowRight: [0, 1],
  ArrowUp: [-1, 0],
  ArrowDown: [1, 0],
};

const widestCell = 34; // pixels
const narrowestCell = 15;
const usualWidth = 1020; // of all cells, with the pixel between them

export class Matrix {
  private readonly cells = new Map<string, HTMLButtonElement>(); // by line and column
  private readonly places: (readonly [number, number])[] = []; // by row
  private current: HTMLButtonElement | undefined;

  constructor(data: Data, select: (row: number) => void) {
    const { rows, parts } = data;
    const count = parts.name.length;
    const table = byId('matrix');
    const size = Math.max(narrowestCell, Math.min(widestCell, Math.floor(usualWidth / count) - 1));
    table.style.setProperty('--cell', `${size}px`);
    table.style.setProperty('--count', String(count));
    const lines = parts.name.map((_, part) => {
      const head = element('th', '', partName(data, part));
      head.scope = 'row';
      head.title = partName(data, part);
      return element('tr', '', head, ...Array.from({ length: part }, () => element('td')));
    });
    rows.clash!.forEach((clash, row) => {
      const [column, line] = [rows.a[row], rows.b[row]].sort((a, b) => a - b);
      const accepted = rows.accepted![row] !== null;
      const button = element('button', `${clash}${accepted ? ' accepted' : ''}`, symbols[clash]);
      const names = `${partName(data, line)} and ${partName(data, column)}`;
      const kind = `${clashWords[clash].toLowerCase()}${accepted ? ', accepted' : ''}`;
      button.title = `${names}: ${kind}, ${shownDistance(data, row)}`;
      button.setAttribute('aria-label', button.title);
      button.tabIndex = -1;
      button.dataset.row = String(row);
      lines[line].children[column + 1].append(button);
      this.cells.set(`${line} ${column}`, button);
      this.places[row] = [line, column];
    });
    table.replaceChildren(...lines.map((line, part) => withEnd(line, part)));
    byId('matrix-key').replaceChildren(
      ...(Object.keys(symbols) as Clash[])
        .filter((clash) => rows.clash!.includes(clash))
        .map((clash) => element('span', 'key', element('span', `cell ${clash}`, symbols[clash]), clashWords[clash])),
    );
    table.addEventListener('click', ({ target }) => {
      const chosen = (target as HTMLElement).closest('button')?.dataset.row;
      if (chosen !== undefined) select(Number(chosen));
    });
    table.addEventListener('keydown', (event) => this.press(event, select));
  }

  /** Marks the cell of a row; once a reader has chosen one, brings it into sight. */
  show(row: number): void {
    const before = this.current;
    if (before !== undefined) {
      before.tabIndex = -1;
      before.removeAttribute('aria-current');
    }
    const [line, column] = this.places[row];
    this.current = this.cells.get(`${line} ${column}`)!;
    this.current.tabIndex = 0;
    this.current.setAttribute('aria-current', 'true');
    if (before !== undefined) this.scrollTo(this.current);
  }

  /** Where the matrix is wider than the page, its names stay at the left. */
  private scrollTo(cell: HTMLElement): void {
    const scroll = byId('matrix').parentElement!;
    const [left, width] = [cell.parentElement!.offsetLeft, cell.offsetWidth];
    const names = byId('matrix').querySelector('th')!.offsetWidth;
    if (left - names < scroll.scrollLeft) scroll.scrollLeft = left - names;
    else scroll.scrollLeft = Math.max(scroll.scrollLeft, left + width + 4 - scroll.clientWidth);
  }

  private press(event: KeyboardEvent, select: (row: number) => void): void {
    const move = moves[event.key];
    const at = (event.target as HTMLElement).dataset.row;
    if (move === undefined || at === undefined) return;
    const [line, column] = this.places[Number(at)];
    const next = this.cells.get(`${line + move[0]} ${column + move[1]}`);
    event.preventDefault();
    if (next === undefined) return;
    select(Number(next.dataset.row));
    next.focus();
  }
}

/** The part's number at the diagonal, where its column begins. */
function withEnd(line: HTMLElement, part: number): HTMLElement {
  line.append(element('td', 'end', String(part)));
  return line;
}
