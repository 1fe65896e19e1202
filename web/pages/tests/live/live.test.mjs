// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The live page, in a browser. What it says is compared with the native program.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import {
  Folder,
  boxObj,
  expectGoodLooks,
  launch,
  limber,
  livePage,
  open,
  pages,
  picture,
  rowsOf,
  screenFrames,
  screens,
  settled,
  tabThrough,
} from '../support.mjs';

const still = { reducedMotion: 'reduce' }; // the sheet begins at rest, and hardly swings

const folder = new Folder();
let browser;

before(async () => {
  browser = await launch();
});

after(async () => {
  await browser?.close();
  folder.remove();
});

async function live(options) {
  const page = await open(browser, livePage, options);
  await page.waitForFunction(() => performance.getEntriesByName('limber-first-frame').length > 0);
  await settled(page);
  return page;
}

const upper = async (page) => Number(await page.textContent('#upper'));
const lower = async (page) => Number(await page.textContent('#lower'));
/** Waits until the upper bound is another one than before. */
const otherThan = (page, before) =>
  page.waitForFunction((before) => Number(document.getElementById('upper').textContent) !== before, before);
const atRest = (page) =>
  page.waitForFunction(() => document.getElementById('rate-note').textContent === 'nothing moves');

/** A drag by pixels, from a point that the page marks. */
async function drag(page, [x, y], [dx, dy], { hold = false } = {}) {
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + dx, y + dy, { steps: 5 });
  await settled(page);
  if (!hold) await page.mouse.up();
  await settled(page);
}

/** Where the ends of the segment are on the page: on the sheet, and on the body. */
async function ends(page) {
  await page.locator('#view').scrollIntoViewIfNeeded();
  const view = await page.locator('#view').boundingBox();
  const circles = await page.$$eval('.marks .end', (all) =>
    all.map((c) => ['cx', 'cy'].map((n) => +c.getAttribute(n))),
  );
  return circles.map(([x, y]) => [view.x + x, view.y + y]);
}
const onSheet = async (page) => (await ends(page))[0].map((c, i) => c + [30, 30][i]);
const onBody = async (page) => (await ends(page))[1].map((c, i) => c + [0, -8][i]);

/** Drops a file on the page. */
const drop = (page, name, bytes) =>
  page.evaluate(
    ([name, bytes]) => {
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([Uint8Array.from(bytes)], name));
      document.body.dispatchEvent(new DragEvent('drop', { dataTransfer, bubbles: true, cancelable: true }));
    },
    [name, [...Buffer.from(bytes)]],
  );

/** What the native program says of this moment, exactly, and with the page's own command. */
async function native(page) {
  await page.click('#keep');
  await settled(page);
  for (const name of ['sheet.ply', 'body.ply']) {
    const [file] = await Promise.all([page.waitForEvent('download'), page.click(`text=Save ${name}`)]);
    await file.saveAs(folder.file(name));
  }
  const words = (await page.textContent('#command')).split(' ').slice(1);
  const placed = words.map((word) => (/\.ply$/.test(word) ? folder.file(word) : word));
  const exact = placed.filter((word, i) => word !== '--relative-error' && placed[i - 1] !== '--relative-error');
  return { asked: limber(...placed, '--json')[0], exact: limber(...exact, '--json')[0] };
}

/** The answer on the page, once the moment is written, has the bits of the native program's. */
async function expectNativeBits(page) {
  const { asked, exact } = await native(page);
  const rows = (await rowsOf(page, '#answer')).map(([, cell]) => cell.split(', ').map(Number));
  const { lower, upper, witness } = asked;
  const ids = [witness.triangle_a, witness.triangle_b];
  assert.deepEqual(rows.slice(0, 5), [[lower], [upper], witness.point_a, witness.point_b, ids]);
  return exact;
}

for (const { width, scheme } of screens) {
  test(`the page starts without a complaint at ${width} pixels, ${scheme}`, async () => {
    const page = await live({ width, scheme });
    await expectGoodLooks(page);
    // The sheet swings, so the distance depends on when it is read. It is 0 at times, but not always.
    await page.waitForFunction(() => {
      const distance = Number(document.getElementById('upper').textContent);
      return distance > 0 && distance < 0.5;
    });
    await otherThan(page, await upper(page));
    await page.click('#self');
    await page.click('#pluck');
    await otherThan(page, await upper(page));
    assert.deepEqual(page.complaints, []);
    await page.close();
  });
}

test('a drag of the body changes the distance, and leaves the view', async () => {
  const page = await live(still);
  const before = await upper(page);
  const corner = () => page.$eval('.marks .badge.a', (badge) => badge.getAttribute('cx') + badge.getAttribute('cy'));
  const place = await corner();
  await drag(page, await onBody(page), [0, -40]);
  const raised = await upper(page);
  assert.ok(raised > before + 0.05, `${before}, then ${raised}`);
  const box = await page.locator('#view').boundingBox();
  await page.mouse.move(box.x + 20, box.y + 20);
  await page.mouse.move(box.x + 90, box.y + 50);
  await page.keyboard.press('Space');
  await settled(page);
  assert.equal(await corner(), place);
  await page.close();
});

test('a finger drags the body', async () => {
  const page = await live({ ...still, hasTouch: true, width: 400 });
  const before = await upper(page);
  const [x, y] = await onBody(page);
  const session = await page.context().newCDPSession(page);
  const touch = (type, ...touchPoints) => session.send('Input.dispatchTouchEvent', { type, touchPoints });
  await touch('touchStart', { x, y });
  for (let i = 1; i <= 5; ++i) await touch('touchMove', { x, y: y - 6 * i });
  await touch('touchEnd');
  await settled(page);
  const raised = await upper(page);
  assert.ok(raised > before + 0.05, `${before}, then ${raised}`);
  await page.close();
});

test('the sheet follows the mouse, and swings back', async () => {
  const page = await live(still);
  const before = await upper(page);
  await drag(page, await onSheet(page), [-20, -50], { hold: true });
  await page.waitForFunction((before) => Number(document.getElementById('upper').textContent) < before - 0.03, before);
  await page.mouse.up();
  await atRest(page);
  assert.ok(Math.abs((await upper(page)) - before) < 1e-3);
  await page.close();
});

test('what is around sheet and body turns the view, and leaves the distance', async () => {
  const page = await live(still);
  const [number, seen] = [await upper(page), (await picture(page)).text];
  const box = await page.locator('#view').boundingBox();
  await drag(page, [box.x + 20, box.y + 20], [80, 30]);
  assert.equal(await upper(page), number);
  assert.notEqual((await picture(page)).text, seen);
  await page.close();
});

test('the numbers are those of the native engine, to the bit', async () => {
  const page = await live(still);
  await drag(page, await onBody(page), [30, -20]);
  await page.check('#drag-turn');
  await drag(page, await onBody(page), [25, 40]);
  // The trees and the cache of the page have a history by then, those of the program have none.
  for (const pull of [
    [-30, -40],
    [20, -35],
    [-25, -50],
  ]) {
    const before = await upper(page);
    await drag(page, await onSheet(page), pull, { hold: true });
    await otherThan(page, before);
    await page.keyboard.press('Space');
    await page.mouse.up();
    const exact = await expectNativeBits(page);
    assert.ok(exact.upper > 0);
    await page.click('#pause');
  }
  await page.close();
});

test('the interval at an error holds the exact distance, and is as narrow as asked', async () => {
  const page = await live(still);
  await page.focus('#view');
  for (let i = 0; i < 12; ++i) await page.keyboard.press('ArrowUp');
  const widths = [];
  for (const percent of [0, 5, 20, 50]) {
    await page.fill('#error', String(percent));
    await settled(page);
    const [low, high] = [await lower(page), await upper(page)];
    const { asked, exact } = await native(page);
    assert.ok(low <= exact.upper && exact.upper <= high, `${low} <= ${exact.upper} <= ${high}`);
    assert.ok(high <= low * (1 + percent / 100) * (1 + 1e-12), `${low} to ${high} at ${percent} %`);
    assert.ok(asked.lower <= exact.upper && exact.upper <= asked.upper);
    widths.push(high - low);
  }
  assert.equal(widths[0], 0);
  assert.ok(widths[3] > 0, 'an error of half the distance widens the interval');
  await page.close();
});

test('a bad file is refused in one line, and the scene stays', async () => {
  const page = await live(still);
  const answer = await page.textContent('#answer');
  const files = {
    'bad.obj': 'v 0 0 0\nv 1 0 0\nf 1 2 3\n',
    'empty.ply': '',
    'text.stl': 'this is no mesh',
    'notes.txt': 'neither is this',
    'point.obj': 'v 1 1 1\nf 1 1 1\n',
    'nan.obj': 'v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n',
  };
  for (const [name, text] of Object.entries(files)) {
    await drop(page, name, text);
    await page.waitForFunction((name) => document.getElementById('failure').textContent.startsWith(name), name);
    const line = await page.innerText('#failure');
    assert.ok(await page.isVisible('#failure'));
    assert.ok(!line.includes('\n') && line.length < 200, line);
    assert.equal(await page.textContent('#answer'), answer, name);
    assert.equal(await page.textContent('#body-name'), 'the hare');
  }
  await page.keyboard.press('ArrowUp');
  await page.focus('#view');
  await page.keyboard.press('ArrowUp');
  await settled(page);
  assert.notEqual(await page.textContent('#answer'), answer, 'the scene still answers');
  assert.deepEqual(page.complaints, []);
  await page.close();
});

test('a dropped file takes the place of the body', async () => {
  const page = await live(still);
  const facet = 'facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 2\nendloop\nendfacet\n';
  const files = {
    'box.obj': [boxObj([0, 0, 0], [2, 1, 1]), 12],
    'facet.stl': [`solid f\n${facet}endsolid f\n`, 1],
    'indexed.glb': [readFileSync(join(pages, '../../fuzz/corpus/gltf/indexed.glb')), 4],
  };
  await drop(page, 'bad.obj', 'f 1 2 3\n');
  await page.waitForSelector('#failure:visible');
  for (const [name, [bytes, triangles]] of Object.entries(files)) {
    const seen = (await picture(page)).text;
    await drop(page, name, bytes);
    await page.waitForFunction((name) => document.getElementById('body-name').textContent === name, name);
    await settled(page);
    assert.ok(!(await page.isVisible('#failure')));
    assert.notEqual((await picture(page)).text, seen);
    assert.match(await page.textContent('#spoken'), new RegExp(`${triangles} triangles`));
    await expectNativeBits(page);
  }
  await page.click('#hare');
  assert.equal(await page.textContent('#body-name'), 'the hare');
  await page.close();
});

test('keys pause, step, pluck, move and turn', async () => {
  const page = await live(still);
  const start = await upper(page);
  await page.focus('#view');
  await page.keyboard.press('ArrowUp');
  await settled(page);
  const moved = await upper(page);
  assert.ok(moved > start, 'up');
  await page.keyboard.press('Shift+ArrowLeft');
  await page.keyboard.press('Shift+ArrowUp');
  await settled(page);
  assert.notEqual(await upper(page), moved, 'turned');
  await page.click('#reset');
  await settled(page);
  assert.equal(await upper(page), start, 'reset');

  await page.focus('#view');
  await page.keyboard.press('p');
  await otherThan(page, start);
  await page.keyboard.press('Space');
  assert.equal(await page.textContent('#pause'), 'Go on');
  await settled(page);
  const paused = await upper(page);
  await screenFrames(page, 5);
  for (const percent of ['5', '0']) {
    await page.fill('#error', percent);
    await settled(page);
  }
  // Which of several equally close pairs is named depends on the pair before; the last bits of the distance with it.
  assert.ok(Math.abs((await upper(page)) - paused) <= 1e-14, 'paused');
  await page.click('#step');
  await settled(page);
  assert.notEqual(await upper(page), paused, 'stepped');
  await page.keyboard.press('Space'); // on the button: it steps once more
  assert.equal(await page.textContent('#pause'), 'Go on');
  await page.click('#pause');
  assert.equal(await page.textContent('#pause'), 'Pause');
  await atRest(page);
  await page.close();
});

test('contacts are counted and drawn where sheet and body are close', async () => {
  const page = await live(still);
  const contacts = () => page.textContent('#contact-counts');
  assert.equal(await contacts(), 'Sheet and bodynone');
  await page.focus('#view');
  for (let i = 0; i < 10; ++i) await page.keyboard.press('ArrowDown');
  await settled(page);
  assert.equal(await page.textContent('#distance-note'), 'they meet');
  assert.equal(await upper(page), 0);
  const [, all, crossing] = /^Sheet and body(.+), (.+) intersect$/.exec(await contacts());
  const number = (text) => Number(text.replace(/\D/g, ''));
  assert.ok(number(crossing) > 0 && number(all) > number(crossing), `${all}, ${crossing}`);
  const drawn = (await picture(page)).text;
  await page.fill('#margin', '0');
  await settled(page);
  assert.match(await contacts(), new RegExp(`^Sheet and body${crossing}, ${crossing} intersect$`));
  await page.uncheck('#contacts');
  await settled(page);
  assert.equal(await contacts(), '');
  assert.notEqual((await picture(page)).text, drawn);
  await page.close();
});

test('folds of the sheet are self-contacts', async () => {
  const page = await live(still);
  await page.check('#self');
  await settled(page);
  assert.match(await page.textContent('#contact-counts'), /Sheet and itselfnone$/);
  await page.click('#top');
  const box = await page.locator('#view').boundingBox();
  await drag(page, [box.x + box.width * 0.4, box.y + box.height * 0.72], [box.width * 0.3, 0], { hold: true });
  await page.waitForFunction(() => /itself(more than )?\d/.test(document.getElementById('contact-counts').textContent));
  await page.mouse.up();
  await page.close();
});

test('levels of both trees are drawn', async () => {
  const page = await live(still);
  const seen = new Set([(await picture(page)).text]);
  for (const tree of ['sheet', 'body']) {
    await page.selectOption('#tree', tree);
    const counts = [];
    for (let level = 0; level < 5; ++level) {
      await page.fill('#level', String(level));
      await settled(page);
      assert.equal(await page.textContent('#level-text'), `${level} of 0 to 4`);
      counts.push(Number((await page.textContent('#tree-text')).replace(/\D/g, '')));
      seen.add((await picture(page)).text);
    }
    assert.equal(counts[0], 1);
    for (let i = 1; i < 5; ++i) assert.ok(counts[i] > counts[i - 1] && counts[i] <= 8 * counts[i - 1], `${counts}`);
    assert.ok(8 * counts[4] >= 20000);
  }
  assert.equal(seen.size, 11);
  await page.close();
});

test('nothing moves by itself for readers who want less motion', async () => {
  const page = await live(still);
  const before = await upper(page);
  await screenFrames(page, 10);
  assert.equal(await upper(page), before);
  assert.equal(await page.textContent('#rate-note'), 'nothing moves');
  await page.close();
});

test('everything that is operated has a name, and shows when it has the focus', async () => {
  const page = await live(still);
  await page.click('#keep');
  await page.click('#pause');
  await page.keyboard.press('Shift+Tab');
  const seen = await tabThrough(page, 20);
  const ids = 'pause step reset pluck slanted view error contacts margin self tree load copy drag-move keep'.split(' ');
  for (const id of ids) assert.ok(seen.has(id), `${id} cannot be reached`);
  await page.close();
});

test('the page has the licenses of all that is inside, in full', () => {
  const notices = /<script type="text\/plain" id="notices">([^<]*)/.exec(readFileSync(livePage, 'utf8'))[1];
  const owners = [
    'The limber authors',
    'three.js authors',
    'The Emscripten Authors',
    'fast_float',
    'Rich Felker',
    'Niels Lohmann',
  ];
  for (const owner of owners) assert.ok(notices.includes(owner), owner);
  assert.equal([...notices.matchAll(/to\s+permit\s+persons\s+to/g)].length, 3, 'licenses of MIT');
});
