// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** A list of answers, such as one for each pose: the worst first, chosen by a click, and parted by what they say. */

import { byId, element } from './dom.ts';
import { grouped } from './numbers.ts';

export interface ListedRow {
  /** Its number in the answer. */
  row: number;
  /** What it says, by which readers part the list. */
  kind: string;
  cells: readonly (string | Node)[];
}

const mostAtFirst = 200;

export class RowList {
  private readonly rows: readonly ListedRow[];
  private readonly select: (row: number) => void;
  private listed: readonly ListedRow[];
  private current = -1;
  private room = mostAtFirst;

  /** `rows`: as they are to be listed. `select` is called with the number of a row that a reader chooses. */
  constructor(heads: readonly string[], rows: readonly ListedRow[], select: (row: number) => void) {
    this.rows = rows;
    this.listed = rows;
    this.select = select;
    byId('rows-head').replaceChildren(
      ...heads.map((head) => {
        const cell = element('th', '', head);
        cell.scope = 'col';
        return cell;
      }),
    );
    byId('rows').addEventListener('click', (event) => {
      const chosen = (event.target as HTMLElement).closest('tr')?.dataset.row;
      if (chosen !== undefined) this.select(Number(chosen));
    });
    byId('rows').addEventListener('keydown', (event) => {
      const by = { ArrowDown: 1, ArrowUp: -1 }[event.key];
      if (by === undefined) return;
      event.preventDefault();
      this.step(by);
      this.currentLine()?.querySelector('button')!.focus();
    });
    byId('rows-more').addEventListener('click', () => {
      this.room = Infinity;
      this.fill();
    });
    this.connectKinds();
    this.fill();
  }

  /** Marks a row, and brings it into sight where the list has it. */
  show(row: number): void {
    this.current = row;
    const place = this.listed.findIndex((listed) => listed.row === row);
    if (place >= this.room) {
      this.room = Infinity;
      this.fill();
    }
    this.markCurrent();
    const shown = this.currentLine();
    const scroll = byId('rows-scroll');
    if (shown === null) return;
    const [above, below] = [shown.offsetTop, shown.offsetTop + shown.offsetHeight];
    const head = byId('rows-head').offsetHeight;
    if (above - head < scroll.scrollTop) scroll.scrollTop = above - head;
    else if (below > scroll.scrollTop + scroll.clientHeight) scroll.scrollTop = below - scroll.clientHeight;
  }

  /** Chooses a row that stands so many places after the current one. */
  step(by: number): void {
    const place = this.listed.findIndex((listed) => listed.row === this.current);
    const next = Math.min(Math.max(place + by, 0), this.listed.length - 1);
    if (next !== place) this.select(this.listed[next].row);
  }

  /** A button for each kind, where there are several. */
  private connectKinds(): void {
    const counts = new Map<string, number>();
    for (const { kind } of this.rows) counts.set(kind, (counts.get(kind) ?? 0) + 1);
    if (counts.size < 2) return;
    const all = [['All', this.rows.length] as const, ...counts];
    const buttons = all.map(([kind, count]) => {
      const button = element('button', '', `${kind} ${grouped(count)}`);
      button.addEventListener('click', () => {
        this.listed = kind === 'All' ? this.rows : this.rows.filter((listed) => listed.kind === kind);
        buttons.forEach((other) => other.setAttribute('aria-pressed', String(other === button)));
        this.fill();
        byId('rows-scroll').scrollTop = 0;
      });
      button.setAttribute('aria-pressed', String(kind === 'All'));
      return button;
    });
    byId('rows-kinds').append(...buttons);
  }

  private fill(): void {
    const shown = this.listed.slice(0, this.room);
    byId('rows').replaceChildren(
      ...shown.map(({ row, cells }) => {
        const [first, ...others] = cells;
        const button = element('button', 'row', first);
        const line = element('tr', '', element('td', '', button), ...others.map((cell) => element('td', '', cell)));
        line.dataset.row = String(row);
        return line;
      }),
    );
    byId('rows-rest').hidden = shown.length === this.listed.length;
    byId('rows-count').textContent = `The first ${grouped(shown.length)} of ${grouped(this.listed.length)}.`;
    this.markCurrent();
  }

  private currentLine(): HTMLElement | null {
    return byId('rows').querySelector<HTMLElement>('[aria-current]');
  }

  /** Tab stops in the list once: at the current row, or at the first. */
  private markCurrent(): void {
    const lines = [...byId('rows').querySelectorAll('tr')];
    for (const line of lines) {
      if (line.dataset.row === String(this.current)) line.setAttribute('aria-current', 'true');
      else line.removeAttribute('aria-current');
    }
    const stop = this.currentLine() ?? lines[0];
    for (const line of lines) line.querySelector('button')!.tabIndex = line === stop ? 0 : -1;
  }
}
