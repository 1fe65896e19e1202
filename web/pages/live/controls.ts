// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Buttons, sliders, keys and dropped files. */

import { byId, connectCopy, element } from '../shared/dom.ts';
import { grouped, shown } from '../shared/numbers.ts';
import type { Body } from './body.ts';
import type { Questions } from './engine.ts';
import { sides } from './view.ts';

export interface Actions {
  pause(): void;
  step(): void;
  reset(): void;
  pluck(): void;
  look(side: keyof typeof sides): void;
  load(file: File): void;
  hare(): void;
  /** The questions have changed. */
  ask(): void;
  keep(): void;
}

const input = (id: string): HTMLInputElement => byId<HTMLInputElement>(id);

export class Controls {
  private readonly actions: Actions;
  private links: string[] = [];

  constructor(actions: Actions) {
    this.actions = actions;
    for (const id of ['pause', 'step', 'reset', 'pluck', 'hare', 'keep'] as const) {
      byId(id).addEventListener('click', () => actions[id]());
    }
    for (const side of Object.keys(sides) as (keyof typeof sides)[]) {
      byId(side).addEventListener('click', () => actions.look(side));
    }
    for (const id of ['error', 'margin', 'contacts', 'self', 'tree', 'level']) {
      byId(id).addEventListener('input', () => {
        this.writeSettings();
        actions.ask();
      });
    }
    byId('load').addEventListener('click', () => input('file').click());
    input('file').addEventListener('change', () => this.take(input('file').files));
    document.addEventListener('keydown', (event) => this.press(event));
    this.takeDrops();
    connectCopy();
    this.writeSettings();
  }

  get questions(): Questions {
    return {
      relativeError: Number(input('error').value) / 100,
      contactMargin: input('contacts').checked ? this.margin : undefined,
      selfContacts: input('self').checked,
    };
  }

  get isTurning(): boolean {
    return input('drag-turn').checked;
  }

  /** Whose tree is drawn. */
  get tree(): '' | 'sheet' | 'body' {
    return byId<HTMLSelectElement>('tree').value as '' | 'sheet' | 'body';
  }

  /** The level of a tree with that many. */
  levelBelow(count: number): number {
    input('level').max = String(count - 1);
    return Math.min(Number(input('level').value), count - 1);
  }

  showLevel(sphereCount: number): void {
    byId('level-text').textContent = `${input('level').value} of 0 to ${input('level').max}`;
    byId('tree-text').textContent = sphereCount === 1 ? '1 sphere' : `${grouped(sphereCount)} spheres`;
  }

  showPaused(isPaused: boolean): void {
    byId('pause').textContent = isPaused ? 'Go on' : 'Pause';
    byId('spoken').textContent = isPaused ? 'Paused' : '';
  }

  showBody(body: Body): void {
    const isHare = body.name === 'Hare';
    byId('body-name').textContent = isHare ? 'the hare' : body.name;
    byId('hare').hidden = isHare;
    byId('failure').hidden = true;
    byId('spoken').textContent = `${body.name}, ${grouped(body.mesh.faces.length / 3)} triangles, is the body`;
  }

  showFailure(text: string): void {
    const failure = byId('failure');
    failure.textContent = text;
    failure.hidden = false;
  }

  showMoment(files: Record<string, Blob>, command: string): void {
    this.links.forEach((link) => URL.revokeObjectURL(link));
    this.links = [];
    byId('files').replaceChildren(
      ...Object.entries(files).map(([name, content]) => {
        const link = element('a', '', `Save ${name}`);
        link.href = URL.createObjectURL(content);
        link.download = name;
        this.links.push(link.href);
        return link;
      }),
    );
    byId('command').textContent = command;
    byId('copy').textContent = 'Copy';
    byId('making').hidden = false;
  }

  private get margin(): number {
    return (Number(input('margin').value) / 100) ** 2 / 10;
  }

  private writeSettings(): void {
    byId('error-text').textContent = `${input('error').value} %`;
    byId('margin-text').textContent = shown(this.margin, 2);
    input('margin').setAttribute('aria-valuetext', shown(this.margin, 2));
    input('margin').disabled = !input('contacts').checked;
    input('level').disabled = this.tree === '';
    if (this.tree === '') for (const id of ['tree-text', 'level-text']) byId(id).textContent = '';
  }

  private press(event: KeyboardEvent): void {
    const { target } = event;
    if (event.ctrlKey || event.metaKey || event.altKey || !(target instanceof Element)) return;
    if (event.key === ' ' && target.closest('button, input, select, a') === null) {
      event.preventDefault();
      this.actions.pause();
    } else if ((event.key === 'p' || event.key === 'P') && target.closest('select') === null) {
      this.actions.pluck();
    }
  }

  private takeDrops(): void {
    const show = (isShown: boolean): void => {
      byId('drop').hidden = !isShown;
    };
    document.addEventListener('dragover', (event) => {
      event.preventDefault();
      show(true);
    });
    document.addEventListener('dragleave', (event) => {
      if (event.relatedTarget === null) show(false);
    });
    document.addEventListener('drop', (event) => {
      event.preventDefault();
      show(false);
      this.take(event.dataTransfer?.files);
    });
  }

  private take(files: FileList | null | undefined): void {
    const file = files?.[0];
    if (file !== undefined) this.actions.load(file);
    input('file').value = '';
  }
}
