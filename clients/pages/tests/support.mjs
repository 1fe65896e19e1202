// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What tests share: modules of the page, pages that the program writes, and a browser.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild-wasm';
import { chromium } from 'playwright-core';

export const pages = join(dirname(fileURLToPath(import.meta.url)), '..');

/** A module of the pages, ready to be used. */
export async function module(path) {
  const bundle = await build({ entryPoints: [join(pages, path)], bundle: true, format: 'esm', write: false });
  return import(`data:text/javascript;base64,${Buffer.from(bundle.outputFiles[0].contents).toString('base64')}`);
}

/** The program's answer, as JSON lines; the demonstration has none. */
function limber(...words) {
  const program = process.env.LIMBER_PROGRAM;
  if (program === undefined) throw new Error('LIMBER_PROGRAM does not name the program');
  const isDemo = words[0] === 'demo';
  const options = { encoding: 'utf8', maxBuffer: 1 << 28 };
  const { status, stdout, stderr } = spawnSync(program, isDemo ? words : [...words, '--json'], options);
  if (status !== 0 && status !== 3) throw new Error(`limber ${words.join(' ')}: ${stderr}`);
  return (isDemo ? '' : stdout)
    .split('\n')
    .filter((line) => line !== '')
    .map((line) => JSON.parse(line));
}

const start = '<script type="application/json" id="data">';

/** The page that the sources give, which need not be the one that the program has. */
const viewer = () => readFileSync(join(pages, '../../build/pages/viewer.html'), 'utf8');

/** Pages that the program makes, in a folder of their own, and a browser that shows them. */
export class Session {
  folder = mkdtempSync(join(tmpdir(), 'limber-pages-'));
  answers = {};
  data = {};

  async launch() {
    this.browser = await launch();
  }

  file = (name) => join(this.folder, name);
  page = (name) => this.file(`${name}.html`);

  store(name, text) {
    writeFileSync(this.file(name), text);
    return this.file(name);
  }

  /** Keeps what the program answers, and the data of its page, which it puts into the page that the sources give. */
  make(name, ...words) {
    this.answers[name] = limber(...words, '--report', this.page(name));
    const written = readFileSync(this.page(name), 'utf8');
    const begin = written.indexOf(start) + start.length;
    const data = written.slice(begin, written.indexOf('</script>', begin));
    this.data[name] = JSON.parse(data);
    writeFileSync(
      this.page(name),
      viewer().replace('"data of the page"', () => data),
    );
  }

  /** What the program answers. */
  ask = (...words) => limber(...words);

  /** Opens a page for a while; options may be left out. */
  async show(name, ...words) {
    const [use, options] = words.reverse();
    const page = await open(this.browser, this.page(name), options);
    await use(page);
    await page.close();
  }

  async close() {
    await this.browser?.close();
    rmSync(this.folder, { recursive: true });
  }
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

const launch = () =>
  chromium.launch({
    timeout: patience,
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });

/** Opens a page, which must not say a word on the console, and must not ask for anything but itself. */
async function open(browser, path, { width = 1280, height = 900, scheme = 'light', script, ...options } = {}) {
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

/** The answer that is shown, by the names of its lines. */
export const answerOf = async (page) => new Map(await rowsOf(page, '#answer'));

/** Waits for two frames of the screen: what was asked for has been drawn. */
export const settled = (page) =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

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

/** Texts of all that a selector finds. */
export const textsOf = (page, selector) => page.$$eval(selector, (all) => all.map((found) => found.textContent));

export const tileTexts = (page) => textsOf(page, '#tiles > div');

/** Tests whether all that is seen of pages fits, views are drawn, and charts where there are some, in silence. */
export function expectGoodLooks(session, names, hasCharts) {
  const look = (width) => async (page) => {
    assert.deepEqual(page.complaints, []);
    const { drawn } = await picture(page);
    assert.ok(drawn > 0.02 && drawn < 0.98, `${drawn} of the view is drawn`);
    assert.ok(await page.evaluate(() => document.scrollingElement.scrollWidth <= innerWidth), 'the page is too wide');
    const charts = await page.$$eval('.plot canvas', (all) => all.map((canvas) => canvas.clientWidth));
    assert.equal(charts.length > 0, hasCharts);
    for (const chart of charts) assert.ok(chart > 250 && chart <= width, `${chart} pixels`);
    assert.equal(await page.locator('main h2:empty').count(), 0);
  };
  for (const name of names) {
    test(`${name} draws its pictures without a complaint, wide and light, narrow and dark`, async () => {
      for (const screen of screens) await session.show(name, screen, look(screen.width));
    });
  }
}

/** Goes through all that can have the focus; each has a name, and shows the focus. */
export async function tabThrough(page) {
  const ids = await page.$$eval('button, input, select, summary, [tabindex]', (all) =>
    all.filter((e) => e.offsetParent !== null).map((e) => e.id),
  );
  assert.ok(ids.length > 8);
  const seen = new Set();
  for (let i = 0; i < ids.length; ++i) {
    await page.keyboard.press('Tab');
    const { id, label, outline } = await focused(page);
    assert.notEqual(label, '', `${id} has no name`);
    assert.ok(outline >= 2, `${id} does not show the focus`);
    seen.add(id);
  }
  assert.deepEqual([...seen].sort(), ids.sort());
}

/** What has the focus: its id, its name for those who cannot see it, and the width of its outline. */
const focused = (page) =>
  page.evaluate(() => {
    const e = document.activeElement;
    const named = e.getAttribute('aria-label') ?? [...(e.labels ?? [])].map((l) => l.textContent).join(' ');
    const outline = parseFloat(getComputedStyle(e).outlineWidth);
    return { id: e.id || e.textContent, label: (named || e.textContent).trim(), outline };
  });
