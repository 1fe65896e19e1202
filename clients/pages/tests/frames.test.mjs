// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Pages of `limber track` and `limber demo`, in a browser.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Session, boxObj, expectGoodLooks, module, picture, rowsOf, screens, settled, sheetObj } from './support.mjs';
import { answerOf, tabThrough, textsOf, tileTexts } from './support.mjs';

const { grouped, inPage, median, shown, shownTime } = await module('shared/numbers.ts');

const session = new Session();
const { answers, data } = session;

before(async () => {
  const box = session.store('box.obj', boxObj([0, 0, 0], [2, 1, 1]));
  const frames = Array.from({ length: 40 }, (_, f) => {
    const height = (x, y) => 0.3 * Math.sin(2 * x + f / 5) * Math.cos(y);
    return session.store(`sheet${f}.obj`, sheetObj(16, height));
  });
  const poses = frames.map((_, f) => `${Math.cos(f / 6)},${Math.sin(f / 6)},${1.5 - f / 50},1,0,0,${f / 40}\n`);
  const moving = ['--b', 'scene:ball', '--poses-b', session.store('poses.csv', poses.join(''))];
  const more = ['--relative-error', '0.3', '--contacts', '--margin', '0.5'];
  const falls = [3, 2.5, 1.6, 4].map((z) => `0,0,${z},1,0,0,0\n`).join('');
  const falling = ['track', '--a', 'scene:ball', '--poses-a', session.store('moves.csv', falls)];
  for (const [name, ...words] of [
    ['replay', 'track', '--a', ...frames, ...moving, ...more],
    ['single', 'track', '--a', box, '--b', 'scene:ball'],
    ['clearance', ...falling, '--b', 'scene:square', '--min-clearance', '2'],
    ['deep', ...falling, '--b', box, '--depth', '--min-clearance', '0.1'],
    ['usual', 'demo'],
    ['few', 'demo', '--frames', '30', '--relative-error', '0.3', '--no-check'],
    ['thinned', 'demo', '--frames', '300', '--dents-per-frame', '60', '--no-check'],
  ]) {
    session.make(name, ...words);
  }
  await session.launch();
});

after(() => session.close());

expectGoodLooks(session, ['replay', 'single', 'clearance', 'usual', 'few', 'thinned'], true);

/** Moves the slider, as the arrow keys do one by one. */
async function go(page, frame) {
  await page.fill('#frame', String(frame));
  await settled(page);
}

const frameText = (page) => page.textContent('#frame-text');

test('a track with a clearance starts with its worst frame, and lists all, the deepest first', async () => {
  await session.show('clearance', async (page) => {
    assert.equal(await frameText(page), '2 of 3');
    assert.equal((await tileTexts(page))[0], '\u2717 2 of 4frames are closer than the required 2');
    const uppers = answers.clearance.map(({ upper }) => shown(upper));
    const verdicts = { 2: 'Too close', 1: 'Too close', 0: 'Kept', 3: 'Kept' };
    const rows = [2, 1, 0, 3].map((row) => [String(row), verdicts[row], uppers[row]]);
    assert.deepEqual(await rowsOf(page, '#rows'), rows);
    await page.click('#rows tr[data-row="3"]');
    assert.equal(await frameText(page), '3 of 3');
    await page.click('#worst');
    assert.equal(await frameText(page), '2 of 3');
  });
  await session.show('deep', async (page) => {
    const { depth } = answers.deep[2];
    assert.ok(depth > 0);
    assert.deepEqual((await rowsOf(page, '#rows'))[0], ['2', 'Contact', `${shown(depth)} deep`]);
    assert.ok((await tileTexts(page)).includes(`${shown(depth)} deepthe deepest, in frame 2`));
    assert.equal((await answerOf(page)).get('Depth, at least'), String(depth));
  });
  await session.show('single', async (page) => {
    assert.ok(!(await page.isVisible('#worst')));
    assert.equal(await page.locator('#rows-section').count(), 0);
  });
});

for (const [name, frames] of [
  ['replay', [0, 7, 6, 39, 0]],
  ['usual', [0, 1, 300, 599, 1, 0]],
]) {
  test(`frames of ${name} have the numbers of the program, to the bit, and pictures that differ`, () =>
    session.show(name, async (page) => {
      const { rows, contacts, demo } = data[name];
      const seen = new Map();
      for (const row of [...frames, Math.max(rows.status.indexOf('collision'), 0)]) {
        await go(page, row);
        assert.equal(await frameText(page), `${row} of ${rows.status.length - 1}`);
        const cells = await answerOf(page);
        const [lower, upper] = [rows.lower[row], rows.upper[row]];
        const told = [cells.get('Distance, lower bound'), cells.get('Distance, upper bound')].map(Number);
        assert.deepEqual(told, [lower, upper]);
        if (name === 'replay') assert.deepEqual(told, [answers.replay[row].lower, answers.replay[row].upper]);
        for (const { count } of contacts) assert.ok(cells.get('Contacts').includes(`${grouped(count[row])} pairs`));
        if (demo) assert.ok(cells.get('Within 10\u00a0%').includes(shown(demo.rough.upper[row])));
        const number = lower === upper ? shown(upper) : `${shown(lower)} to ${shown(upper)}`;
        const meets = rows.status[row] === 'collision';
        assert.equal(await page.textContent('#now-distance'), meets ? 'in contact' : number);
        assert.equal(await page.textContent('.marks .length'), meets ? 'shared point' : number);
        const now = (await picture(page)).text;
        for (const [other, before] of seen) assert.equal(now === before, other === row, `frames ${row} and ${other}`);
        seen.set(row, now);
      }
    }));
}

test('a click in each chart goes to the frame', async () => {
  for (const [name, width, count] of [
    ['replay', 1280, 4],
    ['usual', 400, 3],
  ]) {
    await session.show(name, { width }, async (page) => {
      const last = Number(await page.getAttribute('#frame', 'max'));
      const charts = await page.locator('.u-over').all();
      assert.equal(charts.length, count);
      for (const [i, chart] of charts.entries()) {
        await chart.scrollIntoViewIfNeeded();
        const box = await chart.boundingBox();
        await chart.click({ position: { x: (box.width * (i + 1)) / 5, y: box.height / 2 } });
        const frame = Number(await page.inputValue('#frame'));
        assert.ok(Math.abs(frame - (last * (i + 1)) / 5) < 2, `${frame}`);
      }
    });
  }
});

test('keys and buttons step, and the page plays and pauses', () =>
  session.show('usual', { width: 400 }, async (page) => {
    await page.focus('#frame');
    for (let i = 0; i < 3; ++i) await page.keyboard.press('ArrowRight');
    assert.equal(await frameText(page), '3 of 599');
    await page.click('#forward');
    assert.equal(await frameText(page), '4 of 599');
    await page.click('#back');
    assert.equal(await frameText(page), '3 of 599');
    await page.selectOption('#speed', '50');
    await page.focus('#play');
    await page.keyboard.press('Space');
    assert.equal(await page.textContent('#play'), 'Pause');
    await page.waitForFunction(() => Number(document.getElementById('frame').value) > 20);
    await page.click('#play');
    assert.equal(await page.textContent('#play'), 'Play');
    const stopped = await frameText(page);
    for (let i = 0; i < 5; ++i) await settled(page);
    assert.equal(await frameText(page), stopped);
    assert.deepEqual(page.complaints, []);
  }));

test('a view that follows the ball has it in the middle; its path has a dot for each contact', () =>
  session.show('usual', async (page) => {
    const view = await page.locator('#view').boundingBox();
    const offMiddle = async (frame) => {
      await go(page, frame);
      return Math.abs(Number(await page.getAttribute('.marks .badge.b', 'cx')) - view.width / 2);
    };
    await page.check('#follow');
    for (const frame of [100, 250, 599]) assert.ok((await offMiddle(frame)) < 3, `frame ${frame}`);
    await page.click('#whole');
    assert.equal(await page.isChecked('#follow'), false);
    const off = [await offMiddle(100), await offMiddle(250), await offMiddle(599)];
    assert.ok(Math.max(...off) > 50, `${off}`);
    const dots = await page.getAttribute('.marks .dots', 'd');
    const contacts = data.usual.rows.status.filter((status) => status === 'collision').length;
    assert.equal(dots.split('M').length - 1, contacts);
    await page.uncheck('#show-path');
    await settled(page);
    assert.equal(await page.locator('.marks .path, .marks .dots').count(), 0);
  }));

test('boxes that a browser has restored after a reload say what is shown', () => {
  // Turns both boxes over as soon as they are there, before the page's own script runs.
  const script = `new MutationObserver((_, observer) => {
    const boxes = document.querySelectorAll('#follow, #show-path');
    if (boxes.length < 2) return;
    observer.disconnect();
    for (const box of boxes) box.checked = !box.checked;
  }).observe(document, { childList: true, subtree: true });`;
  return session.show('usual', { script }, async (page) => {
    assert.equal(await page.isChecked('#show-path'), false);
    assert.equal(await page.locator('.marks .path, .marks .dots').count(), 0);
    assert.equal(await page.isChecked('#follow'), false);
    await page.check('#show-path');
    await settled(page);
    assert.ok((await page.locator('.marks .path').count()) > 0);
  });
});

test('charts say their medians and maxima, all in microseconds, and the summary is that of the terminal', async () => {
  for (const name of ['usual', 'few']) {
    await session.show(name, async (page) => {
      const { rows, demo } = data[name];
      const keys = await textsOf(page, '#charts .key');
      for (const [curve, times] of [
        ['update', rows.update_us],
        [name === 'few' ? 'within 30\u00a0%' : 'exact', rows.query_us],
        ['within 10\u00a0%', demo.rough.query_us],
      ]) {
        const text = `${curve}: median ${shownTime(median(times))}, max ${shownTime(Math.max(...times))}`;
        assert.ok(keys.includes(text), `${text} in ${keys}`);
      }
      assert.ok(!/\d\s(ms|ns|us)\b/.test(await page.textContent('main')));
      const summary = await rowsOf(page, '#summary');
      assert.deepEqual(
        summary,
        demo.summary.map(([name, text]) => [name, inPage(text)]),
      );
      const checked = name === 'few' ? 'not checked against brute force' : 'checked against brute force: equal';
      assert.equal(new Map(summary).get('last frame'), checked);
    });
  }
});

test('frames that have been left out are said to be, and charts have them', () =>
  session.show('thinned', async (page) => {
    const { stride } = data.thinned;
    assert.ok(stride > 1);
    assert.match(await page.textContent('#view-caption'), new RegExp(`1 of every ${stride} frames`));
    assert.equal(await page.getAttribute('#frame', 'max'), String(Math.ceil(300 / stride) - 1));
    await page.focus('#frame');
    await page.keyboard.press('ArrowRight');
    assert.equal(await frameText(page), `${stride} of 299`);
  }));

test('everything that is operated has a name, and shows when it has the focus', async () => {
  await session.show('replay', (page) => tabThrough(page));
  await session.show('usual', screens[1], (page) => tabThrough(page));
});
