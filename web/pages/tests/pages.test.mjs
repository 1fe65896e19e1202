// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The pages that the program writes, in a browser.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import {
  Folder,
  boxObj,
  dataOf,
  focused,
  launch,
  limber,
  module,
  open,
  picture,
  screenFrames,
  settled,
  sheetObj,
} from './support.mjs';

const { grouped, shown } = await module('shared/numbers.ts');
const decode = await module('shared/decode.ts');
const { PositionFrames } = await module('shared/frames.ts');

const folder = new Folder();
const answers = {};
let browser;

const path = (name) => folder.file(`${name}.html`);

before(async () => {
  const box = folder.store('box.obj', boxObj([0, 0, 0], [2, 1, 1]));
  const plate = folder.store('plate.obj', boxObj([-3, -3, -0.5], [5, 4, -0.2]));
  const report = (name, ...words) =>
    (answers[name] = limber('distance', ...words, '--json', '--report', path(name))[0]);
  report('apart', box, plate);
  report('close', box, plate, '--min-clearance', '0.5');
  report('kept', box, plate, '--min-clearance', '0.1');
  report('interval', box, 'scene:soup:1', '--pose-b', '5,3,3,1,0,0,0', '--relative-error', '0.5');
  report('collision', box, 'scene:ball');
  report('beyond', box, 'scene:ball', '--pose-b', '9,0,0,1,0,0,0', '--max-distance', '2');
  report('tiny', box, 'scene:ball', '--pose-b', '0.5,0.5,2.00001,1,0,0,0');
  const corner = (size) => `v ${size} 0 0\nv 0 ${size} 0\nv 0 0 ${size}\nf 1 2 3\n`;
  const [minute, huge] = [folder.store('minute.obj', corner('1e-300')), folder.store('huge.obj', corner('1e60'))];
  report('minute', minute, minute);
  report('huge', huge, folder.store('point.obj', 'v 1 1 3\nf 1 1 1\n'));
  const frames = [];
  for (let f = 0; f < 40; ++f) {
    const z = (x, y) => 0.3 * Math.sin(2 * x + f / 5) * Math.cos(y);
    frames.push(folder.store(`sheet${f}.obj`, sheetObj(16, z)));
  }
  const poses = frames.map((_, f) => `${Math.cos(f / 6)},${Math.sin(f / 6)},${1.5 - f / 50},1,0,0,${f / 40}\n`);
  const track = (name, ...words) => (answers[name] = limber('track', ...words, '--json', '--report', path(name)));
  const moving = ['--b', 'scene:ball', '--poses-b', folder.store('poses.csv', poses.join(''))];
  track('replay', '--a', ...frames, ...moving, '--relative-error', '0.3', '--contacts', '--margin', '0.5');
  track('twice', '--a', ...frames.slice(0, 3), '--b', 'scene:ball', '--loop', '2');
  track('single', '--a', box, '--b', 'scene:ball');
  browser = await launch();
});

after(async () => {
  await browser?.close();
  folder.remove();
});

const reports = ['apart', 'close', 'kept', 'interval', 'collision', 'beyond', 'tiny', 'minute', 'huge'];
const replays = ['replay', 'twice', 'single'];

for (const name of [...reports, ...replays]) {
  for (const [width, scheme] of [
    [1280, 'light'],
    [400, 'dark'],
  ]) {
    test(`${name} draws its pictures without a complaint at ${width} pixels, ${scheme}`, async () => {
      const page = await open(browser, path(name), { width, scheme });
      assert.deepEqual(page.complaints, []);
      const seen = await picture(page, '#view');
      assert.ok(seen.drawn > 0.02 && seen.drawn < 0.98, `${seen.drawn} of the view is drawn`);
      if (reports.includes(name)) assert.ok((await picture(page, '#section')).drawn > 0.01);
      assert.ok((await page.evaluate(() => document.scrollingElement.scrollWidth)) <= width, 'the page is too wide');
      await page.close();
    });
  }
}

test('a page has the parts of its kind alone', async () => {
  const parts = {
    report: ['legend', 'section', 'answer'],
    replay: ['introduction', 'play', 'charts', 'now', 'summary'],
  };
  for (const [name, kind] of [
    ['apart', 'report'],
    ['replay', 'replay'],
  ]) {
    const page = await open(browser, path(name));
    const has = (id) => page.$eval('main', (main, id) => main.querySelector(`#${id}`) !== null, id);
    for (const [owner, ids] of Object.entries(parts)) {
      for (const id of ids) assert.equal(await has(id), owner === kind, `${id} of ${name}`);
    }
    assert.equal(await page.locator('template').count(), 0);
    await page.close();
  }
});

test('the answer is in tile, picture and table', async () => {
  for (const name of ['apart', 'interval', 'tiny']) {
    const page = await open(browser, path(name));
    const { lower, upper, witness } = answers[name];
    const text = lower === upper ? shown(upper) : `${shown(lower)} to ${shown(upper)}`;
    assert.equal(await page.textContent('#tiles b'), text);
    assert.equal(await page.textContent('.marks .length'), text);
    const table = await page.textContent('#answer');
    for (const number of [lower, upper, witness.point_a.join(', '), witness.point_b.join(', ')]) {
      assert.ok(table.includes(String(number)), `${number} in ${table}`);
    }
    await page.close();
  }
  assert.ok(answers.interval.lower < answers.interval.upper);
});

test('verdicts are those of the program', async () => {
  const words = { close: 'Too close', kept: 'Kept', collision: 'They collide', beyond: 'More than' };
  for (const [name, word] of Object.entries(words)) {
    const page = await open(browser, path(name));
    assert.ok((await page.textContent('#tiles')).includes(word), name);
    await page.close();
  }
  assert.equal(answers.close.too_close, true);
  assert.equal(answers.kept.too_close, false);
});

test('the page decodes the meshes', () => {
  const { models } = dataOf(path('apart'));
  for (const { positions, corners, low, high, distances } of models) {
    const points = decode.pointsOf(positions, [0, 0, 0], 1);
    assert.equal(points.length % 3, 0);
    for (let axis = 0; axis < 3; ++axis) {
      const coordinates = points.filter((_, i) => i % 3 === axis);
      assert.ok(Math.abs(Math.min(...coordinates) - low[axis]) < 1e-6);
      assert.ok(Math.abs(Math.max(...coordinates) - high[axis]) < 1e-6);
    }
    const triangles = decode.cornersOf(corners);
    assert.equal(triangles.length % 3, 0);
    assert.equal(triangles.reduce((a, b) => Math.max(a, b)) + 1, points.length / 3);
    assert.equal(decode.numbersOf(distances).length, points.length / 3);
  }
});

test('the page decodes frames, in any order', () => {
  const { models } = dataOf(path('replay'));
  const { frames, corners } = models[0];
  const count = decode.cornersOf(corners).reduce((a, b) => Math.max(a, b)) + 1;
  const forward = new PositionFrames(frames, count);
  const jumping = new PositionFrames(frames, count);
  const all = frames.data.map((_, f) => Float64Array.from(forward.at(f)));
  for (const f of [39, 3, 33, 31, 32, 0, 38]) assert.deepEqual(jumping.at(f), all[f]);
  // The height of the sheet is at most 0.3, and differs between frames.
  const heights = all.map((steps) => steps.filter((_, i) => i % 3 === 2).map((k) => frames.low[2] + k * frames.step));
  for (const z of heights) assert.ok(Math.max(...z) <= 0.3001 && Math.min(...z) >= -0.3001);
  assert.notDeepEqual(heights[4], heights[20]);
});

test('keys, wheel and mouse turn, move and zoom the view', async () => {
  const page = await open(browser, path('apart'));
  let last = (await picture(page, '#view')).text;
  const changes = async (what, action) => {
    await action();
    await settled(page);
    const now = (await picture(page, '#view')).text;
    assert.notEqual(now, last, what);
    last = now;
  };
  const start = last;
  await page.focus('#view');
  for (const key of ['ArrowLeft', 'ArrowUp', 'Shift+ArrowRight', '+', '-']) {
    await changes(key, () => page.keyboard.press(key));
  }
  await changes('0', () => page.keyboard.press('0'));
  assert.equal(last, start);
  const box = await page.locator('#view').boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await changes('wheel', () => page.mouse.wheel(0, -300));
  await changes('drag', async () => {
    await page.mouse.down();
    await page.mouse.move(x + 60, y + 20, { steps: 4 });
    await page.mouse.up();
  });
  for (const id of ['top', 'front', 'side', 'closest', 'whole']) await changes(id, () => page.click(`#${id}`));
  await page.close();
});

test('what is up can be chosen', async () => {
  for (const name of ['apart', 'replay']) {
    const page = await open(browser, path(name));
    const before = (await picture(page, '#view')).text;
    const up = await page.inputValue('#up');
    assert.equal(up, name === 'apart' ? 'y' : 'z'); // two files .obj; a scene
    await page.selectOption('#up', up === 'y' ? 'z' : 'y');
    await settled(page);
    assert.notEqual((await picture(page, '#view')).text, before);
    await page.selectOption('#up', up);
    await settled(page);
    assert.equal((await picture(page, '#view')).text, before);
    await page.close();
  }
});

test('models and colours can be switched off', async () => {
  const page = await open(browser, path('apart'));
  const before = await picture(page, '#view');
  assert.ok(await page.isVisible('#legend'));
  await page.uncheck('#show-map');
  await settled(page);
  assert.ok(!(await page.isVisible('#legend')));
  assert.notEqual((await picture(page, '#view')).text, before.text);
  assert.deepEqual(await page.$$eval('.marks .name', (names) => names.map((name) => name.textContent)), ['A', 'B']);
  await page.uncheck('#show-b');
  await settled(page);
  assert.deepEqual(await page.$$eval('.marks .name', (names) => names.map((name) => name.textContent)), ['A']);
  assert.ok((await picture(page, '#view')).drawn < before.drawn);
  await page.close();
});

test('triangles that intersect are marked', async () => {
  const page = await open(browser, path('collision'));
  assert.ok(dataOf(path('collision')).models[0].intersecting.length > 0);
  const yellow = await page.$eval('#view canvas', (canvas) => {
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const context = copy.getContext('2d');
    context.drawImage(canvas, 0, 0);
    const { data } = context.getImageData(0, 0, copy.width, copy.height);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) count += data[i] > 140 && data[i + 1] > 110 && data[i + 2] < 90 ? 1 : 0;
    return count;
  });
  assert.ok(yellow > 100, `${yellow} yellow pixels`);
  await page.close();
});

test('the section can be shifted, turned and moved', async () => {
  const page = await open(browser, path('apart'));
  const caption = () => page.textContent('#section-caption');
  assert.match(await caption(), /goes through both closest points/);
  const { text: start, drawn } = await picture(page, '#section');
  await page.focus('#shift');
  await page.keyboard.press('End'); // where there is only the plate
  await settled(page);
  assert.ok((await picture(page, '#section')).drawn < 0.8 * drawn);
  assert.match(await caption(), /lies \S+ off both closest points/);
  assert.notEqual(await page.textContent('#shift-text'), '0');
  await page.focus('#turn');
  for (let i = 0; i < 20; ++i) await page.keyboard.press('ArrowRight');
  await settled(page);
  assert.match(await caption(), /turned by 20\u00b0/);
  assert.notEqual((await picture(page, '#section')).text, start);
  await page.click('#section-reset');
  await settled(page);
  assert.equal((await picture(page, '#section')).text, start);
  await page.focus('#section');
  for (const key of ['ArrowLeft', '+']) {
    await page.keyboard.press(key);
    await settled(page);
    assert.notEqual((await picture(page, '#section')).text, start, key);
  }
  await page.keyboard.press('0');
  await settled(page);
  assert.equal((await picture(page, '#section')).text, start);
  await page.close();
});

test('the scale of colours follows its slider', async () => {
  const page = await open(browser, path('apart'));
  const before = await page.textContent('#legend-ticks');
  await page.focus('#map-end');
  await page.keyboard.press('End');
  assert.notEqual(await page.textContent('#legend-ticks'), before);
  await page.close();
});

test('the slider goes from frame to frame', async () => {
  const page = await open(browser, path('replay'));
  const rows = answers.replay;
  const expectRow = async (row) => {
    await settled(page);
    assert.equal(await page.textContent('#frame-text'), `${row} of 39`);
    const { lower, upper, status } = rows[row];
    const number = lower === upper ? shown(upper) : `${shown(lower)} to ${shown(upper)}`;
    assert.equal(await page.textContent('#now-distance'), status === 'collision' ? 'in contact' : number);
    const table = await page.textContent('#now');
    const pairs = `${grouped(rows[row].contact.count)} pairs`;
    for (const part of [String(lower), String(upper), pairs]) assert.ok(table.includes(part), part);
  };
  await expectRow(0);
  const first = (await picture(page, '#view')).text;
  await page.focus('#frame');
  for (let i = 0; i < 7; ++i) await page.keyboard.press('ArrowRight');
  await expectRow(7);
  assert.notEqual((await picture(page, '#view')).text, first);
  await page.click('#back');
  await expectRow(6);
  await page.keyboard.press('Tab');
  await page.click('#forward');
  await expectRow(7);
  await page.focus('#frame');
  await page.keyboard.press('End');
  await expectRow(39);
  await page.keyboard.press('Home');
  await expectRow(0);
  assert.equal((await picture(page, '#view')).text, first);
  await page.close();
});

test('a click in a chart goes to the frame', async () => {
  const page = await open(browser, path('replay'));
  const charts = page.locator('.u-over');
  assert.equal(await charts.count(), 4);
  for (let chart = 0; chart < 4; ++chart) {
    const box = await charts.nth(chart).boundingBox();
    await charts.nth(chart).click({ position: { x: (box.width * 9 * (chart + 1)) / 39, y: box.height / 2 } });
    assert.equal(await page.textContent('#frame-text'), `${9 * (chart + 1)} of 39`);
  }
  await page.close();
});

test('playing advances and pauses', async () => {
  const page = await open(browser, path('replay'));
  await page.selectOption('#speed', '50');
  await page.click('#play');
  assert.equal(await page.textContent('#play'), 'Pause');
  await page.waitForFunction(() => Number(document.getElementById('frame').value) > 3);
  await page.click('#play');
  assert.equal(await page.textContent('#play'), 'Play');
  const stopped = await page.textContent('#frame-text');
  await screenFrames(page, 10);
  assert.equal(await page.textContent('#frame-text'), stopped);
  await page.close();
});

test('everything that is operated has a name, and shows when it has the focus', async () => {
  for (const name of ['apart', 'replay']) {
    const page = await open(browser, path(name));
    const count = await page.$$eval(
      'button, input, select, [tabindex]',
      (all) => all.filter((e) => e.offsetParent !== null).length,
    );
    assert.ok(count > 8);
    const seen = new Set();
    for (let i = 0; i < count; ++i) {
      await page.keyboard.press('Tab');
      const { id, label, outline } = await focused(page);
      assert.notEqual(label, '', `${id} has no name`);
      assert.ok(outline >= 2, `${id} does not show the focus`);
      seen.add(id);
    }
    assert.equal(seen.size, count);
    await page.close();
  }
});

test('without WebGL the page says so, and has all the rest', async () => {
  const script = `const get = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
      return kind.startsWith('webgl') ? null : get.call(this, kind, ...more);
    };`;
  const page = await open(browser, path('apart'), { script });
  assert.deepEqual(page.complaints, []);
  assert.match(await page.textContent('.no-view'), /no 3D view/);
  assert.ok((await picture(page, '#section')).drawn > 0.05);
  assert.ok((await page.textContent('#answer')).includes(String(answers.apart.upper)));
  await page.close();
});
