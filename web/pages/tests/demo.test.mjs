// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The page of the demonstration, in a browser.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Folder, dataOf, focused, launch, limber, module, open, picture, screenFrames, settled } from './support.mjs';

const { inPage, shown, shownTime } = await module('shared/numbers.ts');

const folder = new Folder();
const path = (name) => folder.file(`${name}.html`);
const data = {};
let browser;

before(async () => {
  const demo = (name, ...words) => {
    limber('demo', '--json', '--out', path(name), ...words);
    data[name] = dataOf(path(name));
  };
  demo('usual');
  demo('few', '--frames', '30', '--relative-error', '0.3', '--no-check');
  demo('thinned', '--frames', '300', '--dents-per-frame', '60', '--no-check');
  browser = await launch();
});

after(async () => {
  await browser?.close();
  folder.remove();
});

/** Moves the slider, as the arrow keys do one by one. */
async function go(page, frame) {
  await page.fill('#frame', String(frame));
  await settled(page);
}

for (const name of ['usual', 'few', 'thinned']) {
  for (const [width, scheme] of [
    [1280, 'light'],
    [400, 'dark'],
  ]) {
    test(`the ${name} page starts without a complaint at ${width} pixels, ${scheme}`, async () => {
      const page = await open(browser, path(name), { width, scheme });
      const seen = await picture(page, '#view');
      assert.ok(seen.drawn > 0.05 && seen.drawn < 0.98, `${seen.drawn} of the view is drawn`);
      const charts = page.locator('.plot canvas');
      assert.equal(await charts.count(), 3);
      for (let i = 0; i < 3; ++i) {
        const box = await charts.nth(i).boundingBox();
        assert.ok(box.width > 250 && box.x + box.width <= width, `${box.width} pixels`);
      }
      assert.ok((await page.evaluate(() => document.scrollingElement.scrollWidth)) <= width, 'the page is too wide');
      assert.deepEqual(page.complaints, []);
      await page.close();
    });
  }
}

test('the numbers of a frame are those of the data, to the bit', async () => {
  const page = await open(browser, path('usual'));
  const { rows, demo } = data.usual;
  const contact = rows.status.indexOf('collision');
  assert.ok(contact > 0);
  for (const row of [0, 1, 300, contact, 599]) {
    await go(page, row);
    assert.equal(await page.textContent('#frame-text'), `${row} of 599`);
    const cells = new Map(
      await page.$$eval('#now tr', (all) => all.map((tr) => [...tr.children].map((c) => c.textContent))),
    );
    assert.equal(Number(cells.get('Lower bound')), rows.lower[row]);
    assert.equal(Number(cells.get('Upper bound')), rows.upper[row]);
    assert.ok(cells.get('Within 10\u00a0%').includes(shown(demo.rough.upper[row])), cells.get('Within 10\u00a0%'));
    const text = row === contact ? 'in contact' : shown(rows.upper[row]);
    assert.equal(await page.textContent('#now-distance'), text);
    assert.equal(await page.textContent('.marks .length'), text);
  }
  await page.close();
});

test('the slider moves the sheet', async () => {
  const page = await open(browser, path('usual'));
  for (const id of ['#show-b', '#show-path']) await page.uncheck(id);
  const seen = new Map();
  for (const frame of [0, 1, 31, 32, 599, 33, 0]) {
    await go(page, frame);
    const { text } = await picture(page, '#view');
    if (seen.has(frame)) assert.equal(text, seen.get(frame));
    else for (const other of seen.values()) assert.notEqual(text, other);
    seen.set(frame, text);
  }
  await page.close();
});

test('keys step, and the page plays and pauses', async () => {
  const page = await open(browser, path('usual'), { width: 400 });
  await page.focus('#frame');
  for (let i = 0; i < 3; ++i) await page.keyboard.press('ArrowRight');
  assert.equal(await page.textContent('#frame-text'), '3 of 599');
  await page.focus('#forward');
  await page.keyboard.press('Enter');
  assert.equal(await page.textContent('#frame-text'), '4 of 599');
  await page.focus('#play');
  await page.keyboard.press('Space');
  assert.equal(await page.textContent('#play'), 'Pause');
  await page.waitForFunction(() => Number(document.getElementById('frame').value) > 20);
  await page.keyboard.press('Space');
  const stopped = await page.textContent('#frame-text');
  await screenFrames(page, 5);
  assert.equal(await page.textContent('#frame-text'), stopped);
  assert.deepEqual(page.complaints, []);
  await page.close();
});

test('a view that follows the ball has it in the middle', async () => {
  const page = await open(browser, path('usual'));
  const view = await page.locator('#view').boundingBox();
  const offMiddle = async (frame) => {
    await go(page, frame);
    const x = Number(await page.getAttribute('.marks .badge.b', 'cx'));
    return Math.abs(x - view.width / 2);
  };
  await page.check('#follow');
  for (const frame of [100, 250, 599]) assert.ok((await offMiddle(frame)) < 3, `frame ${frame}`);
  await page.click('#whole');
  assert.equal(await page.isChecked('#follow'), false);
  const off = [await offMiddle(100), await offMiddle(250), await offMiddle(599)];
  assert.ok(Math.max(...off) > 50, `${off}`);
  await page.close();
});

test('the path of the ball can be hidden', async () => {
  const page = await open(browser, path('usual'));
  const dots = () =>
    page.$$eval('.marks .dots', (all) => all.map((dot) => dot.getAttribute('d').split('M').length - 1));
  const contacts = data.usual.rows.status.filter((status) => status === 'collision').length;
  assert.deepEqual(await dots(), [contacts, contacts]);
  await page.uncheck('#show-path');
  await settled(page);
  assert.deepEqual(await dots(), []);
  assert.equal(await page.locator('.marks .path').count(), 0);
  await page.close();
});

const median = (values) => [...values].sort((a, b) => a - b)[Math.ceil(values.length / 2) - 1];

test('charts say their medians and maxima, all in microseconds', async () => {
  for (const name of ['usual', 'few', 'thinned']) {
    const page = await open(browser, path(name));
    const { rows, demo } = data[name];
    const keys = await page.$$eval('#charts .key', (all) => all.map((key) => key.textContent));
    const first = name === 'few' ? 'within 30\u00a0%' : 'exact';
    for (const [curve, times] of [
      ['update', rows.update_us],
      [first, rows.query_us],
      ['within 10\u00a0%', demo.rough.query_us],
    ]) {
      const text = `${curve}: median ${shownTime(median(times))}, max ${shownTime(Math.max(...times))}`;
      assert.ok(keys.includes(text), `${text} in ${keys}`);
    }
    const words = await page.textContent('main');
    assert.ok(!/\d\s(ms|ns|us)\b/.test(words));
    assert.equal(/medians of 20 frames/.test(words), name !== 'few');
    await page.close();
  }
});

test('a click in a chart goes to the frame', async () => {
  const page = await open(browser, path('usual'), { width: 400 });
  for (let i = 0; i < 3; ++i) {
    const chart = page.locator('.u-over').nth(i);
    await chart.scrollIntoViewIfNeeded();
    const { width, height } = await chart.boundingBox();
    await chart.click({ position: { x: (width * (i + 1)) / 4, y: height / 2 } });
    const frame = Number(await page.inputValue('#frame'));
    assert.ok(Math.abs(frame - (599 * (i + 1)) / 4) < 2, `${frame}`);
  }
  await page.close();
});

test('the summary is that of the terminal', async () => {
  const page = await open(browser, path('usual'));
  const rows = await page.$$eval('#summary tr', (all) => all.map((tr) => [...tr.children].map((c) => c.textContent)));
  assert.deepEqual(
    rows,
    data.usual.demo.summary.map(([name, text]) => [name, inPage(text)]),
  );
  assert.deepEqual(rows.at(-1), ['last frame', 'checked against brute force: equal']);
  await page.close();
});

test('frames that have been left out are said to be, and charts have them', async () => {
  const page = await open(browser, path('thinned'));
  const { stride } = data.thinned;
  assert.ok(stride > 1);
  assert.match(await page.textContent('#view-caption'), new RegExp(`1 of every ${stride} frames`));
  assert.equal(await page.getAttribute('#frame', 'max'), String(Math.ceil(300 / stride) - 1));
  await page.focus('#frame');
  await page.keyboard.press('ArrowRight');
  assert.equal(await page.textContent('#frame-text'), `${stride} of 299`);
  await page.close();
});

test('everything that is operated has a name, and shows when it has the focus', async () => {
  const page = await open(browser, path('usual'), { width: 400, scheme: 'dark' });
  const seen = new Set();
  for (let i = 0; i < 18; ++i) {
    await page.keyboard.press('Tab');
    const { id, label, outline } = await focused(page);
    assert.notEqual(label, '', `${id} has no name`);
    assert.ok(outline >= 2, `${id} does not show the focus`);
    seen.add(id);
  }
  for (const id of ['view', 'play', 'frame', 'back', 'forward', 'speed', 'follow', 'show-path', 'up']) {
    assert.ok(seen.has(id), `${id} cannot be reached`);
  }
  await page.close();
});
