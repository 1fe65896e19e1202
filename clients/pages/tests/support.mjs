// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What tests share: modules of the pages, pages that the program writes, and a browser.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild-wasm';
import { chromium } from 'playwright-core';

export const pages = join(dirname(fileURLToPath(import.meta.url)), '..');

/** A module of the pages, ready to be used. */
export async function module(path) {
  const bundle = await build({ entryPoints: [join(pages, path)], bundle: true, format: 'esm', write: false });
  return import(`data:text/javascript;base64,${Buffer.from(bundle.outputFiles[0].contents).toString('base64')}`);
}

/** A folder that is empty at first. */
export class Folder {
  path = mkdtempSync(join(tmpdir(), 'limber-pages-'));

  file = (name) => join(this.path, name);

  store(name, text) {
    writeFileSync(this.file(name), text);
    return this.file(name);
  }

  remove = () => rmSync(this.path, { recursive: true });
}

/** The program's answer, as JSON lines. */
export function limber(...words) {
  const program = process.env.LIMBER_PROGRAM;
  if (program === undefined) throw new Error('LIMBER_PROGRAM does not name the program');
  const { status, stdout, stderr } = spawnSync(program, words, { encoding: 'utf8', maxBuffer: 1 << 28 });
  if (status !== 0 && status !== 3) throw new Error(`limber ${words.join(' ')}: ${stderr}`);
  return stdout
    .split('\n')
    .filter((line) => line !== '')
    .map((line) => JSON.parse(line));
}

/** The data that a page holds. */
export function dataOf(path) {
  const text = readFileSync(path, 'utf8');
  const start = '<script type="application/json" id="data">';
  const begin = text.indexOf(start) + start.length;
  return JSON.parse(text.slice(begin, text.indexOf('</script>', begin)));
}

/** A box as OBJ. */
export function boxObj([x0, y0, z0], [x1, y1, z1]) {
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1 ? x1 : x0, i & 2 ? y1 : y0, i & 4 ? z1 : z0]);
  const faces = ['1 3 4 2', '5 6 8 7', '1 2 6 5', '3 7 8 4', '1 5 7 3', '2 4 8 6'];
  return corners.map((c) => `v ${c.join(' ')}\n`).join('') + faces.map((face) => `f ${face}\n`).join('');
}

/** A sheet of n x n squares over [-2, 2]^2 as OBJ, at heights z(x, y). */
export function sheetObj(n, z) {
  const at = (i) => -2 + (4 * i) / n;
  let text = '';
  for (let j = 0; j <= n; ++j) {
    for (let i = 0; i <= n; ++i) text += `v ${at(i)} ${at(j)} ${z(at(i), at(j))}\n`;
  }
  for (let j = 0; j < n; ++j) {
    for (let i = 0; i < n; ++i) {
      const v = j * (n + 1) + i + 1;
      text += `f ${v} ${v + 1} ${v + n + 2} ${v + n + 1}\n`;
    }
  }
  return text;
}

const patience = 120_000; // milliseconds; where software draws on a busy machine, a frame may take a second

export const launch = () =>
  chromium.launch({
    timeout: patience,
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });

/** Opens a page, which must not say a word on the console, and must not ask for anything but itself. */
export async function open(browser, path, { width = 1280, height = 900, scheme = 'light', script, ...options } = {}) {
  const page = await browser.newPage({ viewport: { width, height }, colorScheme: scheme, ...options });
  page.setDefaultTimeout(patience);
  page.complaints = [];
  page.on('console', (message) => page.complaints.push(`${message.type()}: ${message.text()}`));
  page.on('pageerror', (error) => page.complaints.push(error.message));
  page.on('request', (request) => {
    if (!/^(data:|file:.*\.html$)/.test(request.url())) page.complaints.push(`asks for ${request.url()}`);
  });
  if (script !== undefined) await page.addInitScript(script);
  await page.goto(`file://${path}`);
  await settled(page);
  return page;
}

/** Both ends of what readers have: a wide screen and a narrow one, light and dark. */
export const screens = [
  { width: 1280, scheme: 'light' },
  { width: 400, scheme: 'dark' },
];

/** Rows of a table, each a list of texts. */
export const rowsOf = (page, selector) =>
  page.$$eval(`${selector} tr`, (all) => all.map((tr) => [...tr.children].map((cell) => cell.textContent)));

/** Waits for two frames of the screen: what was asked for has been drawn. */
export const settled = (page) =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

/** Waits until that many frames of the screen have passed: what moves by itself has moved. */
export async function screenFrames(page, count) {
  for (let i = 0; i < count; ++i) await settled(page);
}

/** The pixels of a canvas: how many are drawn and how many yellow, as parts of all, and a text that differs where
 * pixels do. */
export const picture = (page, selector = '#view') =>
  page.$eval(`${selector} canvas`, (canvas) => {
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const context = copy.getContext('2d');
    context.drawImage(canvas, 0, 0);
    const { data } = context.getImageData(0, 0, copy.width, copy.height);
    let [drawn, yellow] = [0, 0];
    for (let i = 0; i < data.length; i += 4) {
      drawn += data[i + 3] > 0 ? 1 : 0;
      yellow += data[i] > 140 && data[i + 1] > 110 && data[i + 2] < 90 ? 1 : 0;
    }
    return { drawn: (4 * drawn) / data.length, yellow: (4 * yellow) / data.length, text: copy.toDataURL() };
  });

/** Whether all that is seen of a page fits, and a view, or what else has a canvas, is drawn on it, in silence. */
export async function expectGoodLooks(page, selector) {
  assert.deepEqual(page.complaints, []);
  const { drawn } = await picture(page, selector);
  assert.ok(drawn > 0.02 && drawn < 0.98, `${drawn} of the view is drawn`);
  const { scrollWidth, clientWidth } = await page.evaluate(() => {
    const { scrollWidth, clientWidth } = document.scrollingElement;
    return { scrollWidth, clientWidth };
  });
  assert.ok(scrollWidth <= clientWidth, 'the page is too wide');
}

/** Goes through all that has the focus after that many tabs; each has a name, and shows the focus. Returns the ids. */
export async function tabThrough(page, count) {
  const seen = new Set();
  for (let i = 0; i < count; ++i) {
    await page.keyboard.press('Tab');
    const { id, label, outline } = await focused(page);
    assert.notEqual(label, '', `${id} has no name`);
    assert.ok(outline >= 2, `${id} does not show the focus`);
    seen.add(id);
  }
  return seen;
}

/** What has the focus: its id, its name for those who cannot see it, and the width of its outline. */
const focused = (page) =>
  page.evaluate(() => {
    const e = document.activeElement;
    const named = e.getAttribute('aria-label') ?? [...(e.labels ?? [])].map((l) => l.textContent).join(' ');
    const outline = parseFloat(getComputedStyle(e).outlineWidth);
    return { id: e.id || e.textContent, label: (named || e.textContent).trim(), outline };
  });
