// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** A list of answers, such as one for each pose: the worst first, chosen by a click, and parted by what they say. */

import { byId, element, headOf } from './dom.ts';
import { grouped } from './numbers.ts';

export interface ListedRow {
  /** Its number in the answer. */
  row: number;
  /** What it says, by which readers part the list. */
  kind: string;
  cells: readonly (string | Node)[];
}

export class RowList {
  private readonly lines: readonly HTMLElement[];
  private readonly select: (row: number) => void;
  private current: HTMLElement | undefined;

  /** `rows`: as they are to be listed. `select` is called with the number of a row that a reader chooses. */
  constructor(heads: readonly string[], rows: readonly ListedRow[], select: (row: number) => void) {
    this.select = select;
    byId('rows-head').append(...heads.map((head) => headOf('col', head)));
    this.lines = rows.map(({ row, kind, cells: [first, ...others] }) => {
      const button = element('button', 'row', first);
      button.tabIndex = -1;
      const line = element('tr', '', element('td', '', button), ...others.map((cell) => element('td', '', cell)));
      Object.assign(line.dataset, { row, kind });
      line.addEventListener('click', () => select(row));
      return line;
    });
    byId('rows').append(...this.lines);
    byId('rows').addEventListener('keydown', (event) => {
      const by = { ArrowDown: 1, ArrowUp: -1 }[event.key];
      if (by === undefined) return;
      event.preventDefault();
      this.step(by);
      this.current?.querySelector('button')!.focus();
    });
    this.connectKinds();
  }

  /** Marks a row, and brings it into sight. */
  show(row: number): void {
    this.current?.removeAttribute('aria-current');
    this.current = this.lines.find((line) => line.dataset.row === String(row));
    this.current?.setAttribute('aria-current', 'true');
    this.setTabStop();
    const { offsetTop, offsetHeight } = this.current ?? { offsetTop: 0, offsetHeight: 0 };
    const scroll = byId('rows-scroll');
    const head = byId('rows-head').offsetHeight;
    const most = offsetTop - head;
    scroll.scrollTop = Math.min(most, Math.max(scroll.scrollTop, offsetTop + offsetHeight - scroll.clientHeight));
  }

  /** Chooses a row that stands so many places after the current one. */
  step(by: number): void {
    const listed = this.lines.filter((line) => !line.hidden);
    const next = listed[(this.current === undefined ? -1 : listed.indexOf(this.current)) + by];
    if (next !== undefined) this.select(Number(next.dataset.row));
  }

  /** A button for each kind, where there are several. */
  private connectKinds(): void {
    const counts = new Map([['All', this.lines.length]]);
    for (const { dataset } of this.lines) counts.set(dataset.kind!, (counts.get(dataset.kind!) ?? 0) + 1);
    if (counts.size < 3) return;
    const buttons = [...counts].map(([kind, count]) => {
      const button = element('button', '', `${kind} ${grouped(count)}`);
      button.setAttribute('aria-pressed', String(kind === 'All'));
      button.addEventListener('click', () => {
        for (const line of this.lines) line.hidden = kind !== 'All' && line.dataset.kind !== kind;
        for (const other of buttons) other.setAttribute('aria-pressed', String(other === button));
        this.setTabStop();
        byId('rows-scroll').scrollTop = 0;
      });
      return button;
    });
    byId('rows-kinds').append(...buttons);
  }

  /** Tab stops in the list once: at the current row, or at the first. */
  private setTabStop(): void {
    for (const button of byId('rows').querySelectorAll<HTMLElement>('[tabindex="0"]')) button.tabIndex = -1;
    const isListed = this.current !== undefined && !this.current.hidden;
    const stop = isListed ? this.current : this.lines.find((line) => !line.hidden);
    stop?.querySelector('button')!.setAttribute('tabindex', '0');
  }
}
