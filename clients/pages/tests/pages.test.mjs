// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The pages that the program writes, in a browser.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Vector3 } from 'three';
import {
  Folder,
  boxObj,
  dataOf,
  expectGoodLooks,
  launch,
  limber,
  module,
  open,
  picture,
  rowsOf,
  screenFrames,
  screens,
  settled,
  sheetObj,
  tabThrough,
} from './support.mjs';

const { grouped, inPage, shown, shownTime } = await module('shared/numbers.ts');
const decode = await module('shared/decode.ts');

const folder = new Folder();
const answers = {};
let browser;

const path = (name) => folder.file(`${name}.html`);
const look = (name, options) => open(browser, path(name), options);
const reports = [
  'apart',
  'close',
  'kept',
  'interval',
  'collision',
  'inside',
  'flush',
  'open',
  'beyond',
  'tiny',
  'minute',
  'huge',
];
const tracks = ['replay', 'twice', 'single', 'clearance'];
const studies = ['poses', 'mixed', 'parts'];
const demos = ['usual', 'few', 'thinned'];

before(async () => {
  const box = folder.store('box.obj', boxObj([0, 0, 0], [2, 1, 1]));
  const plate = folder.store('plate.obj', boxObj([-3, -3, -0.5], [5, 4, -0.2]));
  const corner = (size) => `v ${size} 0 0\nv 0 ${size} 0\nv 0 0 ${size}\nf 1 2 3\n`;
  const [minute, huge] = [folder.store('minute.obj', corner('1e-300')), folder.store('huge.obj', corner('1e60'))];
  const asked = {
    apart: [box, plate],
    close: [box, plate, '--min-clearance', '0.5'],
    kept: [box, plate, '--min-clearance', '0.1'],
    interval: [box, 'scene:soup:1', '--pose-b', '5,3,3,1,0,0,0', '--relative-error', '0.5'],
    collision: [box, 'scene:ball'],
    inside: [folder.store('room.obj', boxObj([-2, -2, -2], [3, 3, 3])), 'scene:ball', '--min-clearance', '0.1'],
    flush: [box, box, '--pose-b', '2,0.25,0,1,0,0,0'],
    open: [box, 'scene:square'],
    beyond: [box, 'scene:ball', '--pose-b', '9,0,0,1,0,0,0', '--max-distance', '2'],
    tiny: [box, 'scene:ball', '--pose-b', '0.5,0.5,2.00001,1,0,0,0'],
    minute: [minute, minute],
    huge: [huge, folder.store('point.obj', 'v 1 1 3\nf 1 1 1\n')],
  };
  for (const name of reports) [answers[name]] = limber('distance', ...asked[name], '--json', '--report', path(name));
  const frames = Array.from({ length: 40 }, (_, f) =>
    folder.store(
      `sheet${f}.obj`,
      sheetObj(16, (x, y) => 0.3 * Math.sin(2 * x + f / 5) * Math.cos(y)),
    ),
  );
  const poses = frames.map((_, f) => `${Math.cos(f / 6)},${Math.sin(f / 6)},${1.5 - f / 50},1,0,0,${f / 40}\n`);
  const moving = ['--b', 'scene:ball', '--poses-b', folder.store('poses.csv', poses.join(''))];
  const track = (name, ...words) => (answers[name] = limber('track', ...words, '--json', '--report', path(name)));
  const more = ['--contacts', '--margin', '0.5', '--continuous'];
  track('replay', '--a', ...frames, ...moving, '--relative-error', '0.3', ...more);
  track('twice', '--a', ...frames.slice(0, 3), '--b', 'scene:ball', '--loop', '2');
  track('single', '--a', box, '--b', 'scene:ball');
  const moves = folder.store('moves.csv', [3, 2.5, 1.6, 4].map((z) => `0,0,${z},1,0,0,0\n`).join(''));
  track('clearance', '--a', 'scene:ball', '--b', 'scene:square', '--poses-a', moves, '--min-clearance', '2');
  track('deep', '--a', 'scene:ball', '--b', box, '--poses-a', moves, '--depth', '--min-clearance', '0.1');
  const study = (name, option, rows, ...words) => {
    const file = folder.store(`${name}.csv`, rows.map((row) => `${row}\n`).join(''));
    answers[name] = limber('distance', option, file, ...words, '--json', '--report', path(name));
  };
  const room = folder.file('room.obj');
  const heads = 'model_a,model_b,pose_b_tx,pose_b_ty,pose_b_tz';
  const heights = Array.from({ length: 210 }, (_, i) => (i === 150 ? -0.1 : 0.02 + 1.4 * (1 + Math.cos(i / 12))));
  const asPoses = heights.map((z) => `${box},${plate},0,0,${0.2 - z}`);
  study('poses', '--pairs', [heads, ...asPoses], '--min-clearance', '0.5', '--unit', 'mm');
  const mixed = [`${box},scene:ball,0,0,0`, `${room},scene:ball,0,0,0`, `${box},${box},2,0.25,0`];
  study('mixed', '--pairs', [heads, ...mixed, `${box},scene:square,0,0,0`, `${box},${plate},0,0,0`]);
  const partRows = [`room,${room},0`, `box,${box},0`, `box,${box},2`, `"box, last",${box},4.1`, 'ball,scene:ball,9'];
  const partHeads = 'name,model,pose_tx';
  study('parts', '--parts', [partHeads, ...partRows], '--min-clearance', '0.5', '--title', 'All <parts>');
  const accepted = folder.store('accept.csv', 'name_a,name_b,allowed\na,b,all\n');
  study('accepted', '--parts', [partHeads, `a,${box},0`, `b,${box},1`, `c,${box},1.5`], '--accept', accepted);
  study('far', '--parts', [partHeads, `a,${box},0`, `b,${box},9`], '--max-distance', '2', '--min-clearance', '1');
  const demo = (name, ...words) => limber('demo', '--json', '--report', path(name), ...words);
  demo('usual');
  demo('few', '--frames', '30', '--relative-error', '0.3', '--no-check');
  demo('thinned', '--frames', '300', '--dents-per-frame', '60', '--no-check');
  browser = await launch();
});

after(async () => {
  await browser?.close();
  folder.remove();
});

/** The outlines of the section, as they are drawn, and how long they are. */
const section = async (page) => {
  await settled(page);
  return page.$eval('#section .marks', (marks) => ({
    text: marks.innerHTML,
    length: [...marks.querySelectorAll('.outline')].reduce((sum, outline) => sum + outline.getTotalLength(), 0),
  }));
};

/** Moves the slider, as the arrow keys do one by one. */
async function go(page, frame) {
  await page.fill('#frame', String(frame));
  await settled(page);
}

for (const name of [...reports, ...tracks, ...studies, ...demos]) {
  for (const { width, scheme } of screens) {
    test(`${name} draws its pictures without a complaint at ${width} pixels, ${scheme}`, async () => {
      const page = await look(name, { width, scheme });
      await expectGoodLooks(page);
      if (reports.includes(name)) assert.ok((await section(page)).length > 50);
      const charts = await page.$$eval('.plot canvas', (all) => all.map((canvas) => canvas.clientWidth));
      assert.equal(charts.length > 0, !reports.includes(name) && name !== 'parts');
      for (const chart of charts) assert.ok(chart > 250 && chart <= width, `${chart} pixels`);
      await page.close();
    });
  }
}

test('a page has the parts of its kind alone', async () => {
  const parts = {
    apart: ['legend', 'section', 'answer'],
    replay: ['introduction', 'play', 'now', 'summary'],
    poses: ['see-through', 'charts-section'],
    parts: ['matrix-section'],
  };
  for (const name of Object.keys(parts)) {
    const page = await look(name);
    for (const [owner, ids] of Object.entries(parts)) {
      for (const id of ids) {
        const isThere = owner === name || (id === 'see-through' && name === 'parts');
        const isShared = id === 'answer' && ['poses', 'parts'].includes(name);
        assert.equal(await page.locator(`main #${id}`).count(), isThere || isShared ? 1 : 0, `${id} in ${name}`);
      }
    }
    assert.equal(await page.locator('template').count(), 0);
    await page.close();
  }
});

test('the answer is in tile, picture and table', async () => {
  for (const name of ['apart', 'interval', 'tiny']) {
    const page = await look(name);
    const { lower, upper, witness } = answers[name];
    const text = lower === upper ? shown(upper) : `${shown(lower)} to ${shown(upper)}`;
    for (const place of ['#tiles b', '#view .length', '#section .length']) {
      assert.equal(await page.textContent(place), text);
    }
    const table = await page.textContent('#answer');
    for (const number of [lower, upper, witness.point_a.join(', '), witness.point_b.join(', ')]) {
      assert.ok(table.includes(String(number)), `${number} in ${table}`);
    }
    await page.close();
  }
  assert.ok(answers.interval.lower < answers.interval.upper);
});

test('verdicts are those of the program', async () => {
  const words = {
    close: 'Too close',
    kept: 'Kept',
    collision: 'Hard clash',
    inside: 'Hard clash',
    flush: 'Touching',
    open: 'Surfaces meet',
    beyond: 'More than',
  };
  for (const [name, word] of Object.entries(words)) {
    const page = await look(name);
    assert.ok((await page.textContent('#tiles')).includes(word), name);
    await page.close();
  }
  const first = await look('close');
  assert.match((await tileTexts(first))[0], /^\u2717 Too close/);
  await first.close();
  assert.equal(answers.close.too_close, true);
  assert.equal(answers.inside.too_close, true);
  assert.equal(answers.kept.too_close, false);
});

test('the kind of clash is in the table, and which model is enclosed', async () => {
  const words = {
    apart: 'Clear',
    close: 'Below the clearance',
    collision: 'Hard clash: the volumes overlap',
    inside: 'Hard clash: B is enclosed in A',
    flush: 'Touching: the volumes do not overlap',
    open: 'Surfaces meet: a model is not closed',
  };
  for (const [name, text] of Object.entries(words)) {
    const page = await look(name);
    assert.equal(new Map(await rowsOf(page, '#answer')).get('Clash'), text);
    await page.close();
  }
});

test('the page decodes the meshes', () => {
  for (const { positions, corners, low, high, distances } of dataOf(path('apart')).models) {
    const points = decode.pointsOf(positions, new Vector3(), 1);
    for (let axis = 0; axis < 3; ++axis) {
      const coordinates = points.filter((_, i) => i % 3 === axis);
      assert.ok(Math.abs(Math.min(...coordinates) - low[axis]) < 1e-6);
      assert.ok(Math.abs(Math.max(...coordinates) - high[axis]) < 1e-6);
    }
    const triangles = decode.cornersOf(corners);
    assert.equal(triangles.length % 3, 0);
    assert.equal(3 * (Math.max(...triangles) + 1), points.length);
    assert.equal(3 * decode.numbersOf(distances).length, points.length);
  }
});

test('the page decodes frames, in any order', () => {
  const { frames, corners } = dataOf(path('replay')).models[0];
  const count = Math.max(...decode.cornersOf(corners)) + 1;
  const [forward, jumping] = [new decode.PositionFrames(frames, count), new decode.PositionFrames(frames, count)];
  const all = frames.data.map((_, f) => Float64Array.from(forward.at(f)));
  for (const f of [39, 3, 33, 31, 32, 0, 38]) assert.deepEqual(jumping.at(f), all[f]);
  // The height of the sheet is at most 0.3, and differs between frames.
  const heights = all.map((steps) => steps.filter((_, i) => i % 3 === 2).map((k) => frames.low[2] + k * frames.step));
  for (const z of heights) assert.ok(Math.max(...z) <= 0.3001 && Math.min(...z) >= -0.3001);
  assert.notDeepEqual(heights[4], heights[20]);
});

test('keys, wheel, mouse and buttons turn, move and zoom the view', async () => {
  const page = await look('apart');
  const start = (await picture(page)).text;
  let last = start;
  const changes = async (what, action) => {
    await action();
    await settled(page);
    const now = (await picture(page)).text;
    assert.notEqual(now, last, what);
    last = now;
  };
  await page.focus('#view');
  for (const key of ['ArrowLeft', 'ArrowUp', 'Shift+ArrowRight', '+', '-', '0']) {
    await changes(key, () => page.keyboard.press(key));
  }
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
    const page = await look(name);
    const before = (await picture(page)).text;
    const up = await page.inputValue('#up');
    assert.equal(up, name === 'apart' ? 'y' : 'z'); // two files .obj; a scene
    for (const chosen of [up === 'y' ? 'z' : 'y', up]) {
      await page.selectOption('#up', chosen);
      await settled(page);
      assert.equal((await picture(page)).text === before, chosen === up);
    }
    await page.close();
  }
});

test('models and colours can be switched off', async () => {
  const page = await look('apart');
  const names = () => page.$$eval('#view .name', (all) => all.map((name) => name.textContent).join(' '));
  const before = await picture(page);
  assert.ok(await page.isVisible('#legend'));
  await page.uncheck('#show-map');
  await settled(page);
  assert.ok(!(await page.isVisible('#legend')));
  assert.notEqual((await picture(page)).text, before.text);
  assert.equal(await names(), 'A B');
  await page.uncheck('#show-b');
  await settled(page);
  assert.equal(await names(), 'A');
  assert.ok((await picture(page)).drawn < before.drawn);
  await page.close();
});

const tileTexts = (page) => page.$$eval('#tiles > div', (all) => all.map((tile) => tile.textContent));
const listed = async (page) => (await rowsOf(page, '#rows')).map(([row]) => Number(row));

test('a study says first whether the clearance is kept, and starts with the worst', async () => {
  const page = await look('poses');
  const { rows } = dataOf(path('poses')).study;
  const broken = rows.too_close.filter((is) => is).length;
  assert.ok(broken > 0 && broken < 210);
  const [verdict, worst] = await tileTexts(page);
  assert.equal(verdict, `\u2717 ${broken} of 210are closer than the required 0.5\u00a0mm`);
  const order = await listed(page);
  assert.equal(order[0], 150); // the one that is in the plate
  assert.ok(worst.includes('Hard clash') && worst.includes('row 150'), worst);
  assert.equal(order.length, 200);
  const nearest = rows.upper.map((upper, row) => [upper, row]).sort(([a, i], [b, j]) => a - b || i - j);
  assert.deepEqual(
    order,
    nearest.slice(0, 200).map(([, row]) => row),
  );
  assert.equal(await page.textContent('#answer-title'), 'Row 150: hard clash');
  assert.match(await page.getAttribute('.plot', 'aria-label'), /required clearance 0\.5\u00a0mm$/);
  assert.equal(await page.textContent('#rows-count'), 'The first 200 of 210.');
  await page.click('#rows-more');
  assert.equal((await listed(page)).length, 210);
  assert.ok(!(await page.isVisible('#rows-rest')));
  await page.close();
});

test('a click in the list, in the chart and steps show a pair with the numbers of the program', async () => {
  for (const width of [1280, 400]) {
    const page = await look('poses', { width });
    const shownRow = async () => Number(/Row (\d+)/.exec(await page.textContent('#answer-title'))[1]);
    const expectRow = async (row) => {
      await settled(page);
      assert.equal(await shownRow(), row);
      assert.equal(await page.textContent('#rows [aria-current] td'), String(row));
      const cells = new Map(await rowsOf(page, '#answer'));
      assert.equal(Number(cells.get('Distance, upper bound')), answers.poses[row].upper);
      const text =
        answers.poses[row].status === 'collision' ? 'shared point' : `${shown(answers.poses[row].upper)}\u00a0mm`;
      assert.equal(await page.textContent('#view .length'), text);
      return (await picture(page)).text;
    };
    const order = await listed(page);
    const pictures = [await expectRow(order[0])];
    await page.click(`#rows tr[data-row="${order[5]}"]`);
    pictures.push(await expectRow(order[5]));
    await page.click('#forward');
    await expectRow(order[6]);
    await page.click('#back');
    assert.equal(await expectRow(order[5]), pictures[1]);
    assert.notEqual(pictures[0], pictures[1]);
    await page.focus(`#rows tr[data-row="${order[3]}"] button`);
    await page.keyboard.press('Enter');
    await expectRow(order[3]);
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('ArrowUp');
    await expectRow(order[4]);
    assert.equal(await page.locator('#rows button[tabindex="0"]').count(), 1);
    const chart = page.locator('.u-over');
    await chart.scrollIntoViewIfNeeded();
    const { width: across, height } = await chart.boundingBox();
    await chart.click({ position: { x: across / 2, y: height / 2 } });
    const reached = await shownRow();
    assert.ok(Math.abs(reached - 104.5) < 3, `${reached}`);
    await expectRow(reached);
    await page.close();
  }
});

test('the list is parted by kinds of clashes', async () => {
  const page = await look('mixed');
  const kinds = await page.$$eval('#rows-kinds button', (all) => all.map((button) => button.textContent));
  assert.deepEqual(kinds, ['All 5', 'Hard clash 2', 'Surfaces meet 1', 'Touching 1', 'Clear 1']);
  const words = (await rowsOf(page, '#rows')).map((cells) => cells[2]);
  assert.deepEqual(words, ['Hard clash', 'Hard clash', 'Surfaces meet', 'Touching', 'Clear']);
  await page.click('#rows-kinds button:nth-child(4)');
  assert.deepEqual(await listed(page), [2]);
  assert.equal(await page.getAttribute('#rows-kinds button:nth-child(4)', 'aria-pressed'), 'true');
  await page.click('#rows-kinds button:nth-child(1)');
  assert.equal((await listed(page)).length, 5);
  assert.equal(await page.textContent('#title'), '5 pairs of 5 models');
  const far = await look('far');
  assert.deepEqual(await tileTexts(far), ['Noneof the parts are within 2 of each other']);
  assert.equal(await far.locator('.pair, #matrix, #answer').count(), 0);
  await far.close();
  await page.close();
});

test('tiles and kinds of the list count accepted pairs apart', async () => {
  const page = await look('accepted');
  assert.deepEqual((await tileTexts(page)).slice(1), ['2hard clashes', '1pair is accepted']);
  const kinds = await page.$$eval('#rows-kinds button', (all) => all.map((button) => button.textContent));
  assert.deepEqual(kinds, ['All 3', 'Hard clash 2', 'Accepted 1']);
  await page.close();
});

test('a matrix of parts has the word of each pair, and shows it', async () => {
  for (const width of [1280, 400]) {
    const page = await look('parts', { width });
    const { rows } = dataOf(path('parts')).study;
    const cells = await page.$$eval('#matrix button', (all) =>
      all.map(({ className, dataset, title }) => ({ kind: className, row: Number(dataset.row), title })),
    );
    assert.equal(cells.length, 10);
    for (const { kind, row } of cells) assert.equal(kind, answers.parts[row].clash);
    assert.deepEqual(new Set(rows.clash), new Set(['hard_clash', 'touching', 'clearance', 'clear']));
    assert.match(cells.find(({ row }) => row === 4).title, /^2 box and 1 box: touching, 0$/);
    await page.click('#matrix button[data-row="4"]');
    assert.equal(await page.textContent('#answer-title'), 'Pair 4: touching');
    assert.equal(await page.textContent('#rows [aria-current] td'), '4');
    await page.keyboard.press('ArrowDown');
    assert.match(await page.textContent('#answer-title'), /^Pair 5: /);
    assert.equal(await page.$eval('#matrix button[tabindex="0"]', (button) => button.dataset.row), '5');
    assert.equal(await page.textContent('#title'), 'All <parts>');
    assert.equal(await page.textContent('#subtitle'), '5 parts');
    await page.close();
  }
});

test('the cell of a pair that a reader chooses is brought into sight', async () => {
  const page = await look('parts', { width: 250 });
  const { left, right, cellLeft, cellRight } = await page.evaluate(() => {
    document.querySelector('#rows tr[data-row="9"]').click();
    const { left: cellLeft, right: cellRight } = document
      .querySelector('#matrix [aria-current]')
      .getBoundingClientRect();
    const { right } = document.querySelector('.scroll:has(#matrix)').getBoundingClientRect();
    return { left: document.querySelector('#matrix th').getBoundingClientRect().right, right, cellLeft, cellRight };
  });
  assert.ok(left <= cellLeft && cellRight <= right, `${cellLeft} to ${cellRight} in ${left} to ${right}`);
  await page.close();
});

test('other parts can be hidden, and what encloses is seen through', async () => {
  const page = await look('parts');
  const start = await picture(page);
  assert.ok((await page.textContent('#answer')).includes('enclosed in A'));
  assert.ok(await page.isVisible('#others-label'));
  await page.uncheck('#show-others');
  await settled(page);
  const alone = await picture(page);
  assert.ok(alone.drawn < start.drawn, `${alone.drawn} and ${start.drawn}`);
  await page.check('#see-through');
  await settled(page);
  assert.notEqual((await picture(page)).text, alone.text);
  await page.close();
  const poses = await look('poses');
  assert.ok(!(await poses.isVisible('#others-label')));
  await poses.close();
});

test('a track with a clearance starts with its worst frame, and lists all', async () => {
  const page = await look('clearance');
  assert.equal(await page.textContent('#frame-text'), '2 of 3');
  const [verdict] = await tileTexts(page);
  assert.equal(verdict, '\u2717 2 of 4frames are closer than the required 2');
  assert.deepEqual(await rowsOf(page, '#rows'), [
    ['2', 'Too close', shown(answers.clearance[2].upper)],
    ['1', 'Too close', shown(answers.clearance[1].upper)],
    ['0', 'Kept', shown(answers.clearance[0].upper)],
    ['3', 'Kept', shown(answers.clearance[3].upper)],
  ]);
  await page.click('#rows tr[data-row="3"]');
  assert.equal(await page.textContent('#frame-text'), '3 of 3');
  await page.click('#worst');
  assert.equal(await page.textContent('#frame-text'), '2 of 3');
  assert.match(await page.getAttribute('.plot', 'aria-label'), /required clearance 2$/);
  await page.close();
  const without = await look('single');
  assert.ok(!(await without.isVisible('#worst')) && !(await without.isVisible('#rows-section')));
  await without.close();
});

test('a track says how deep bodies are in each other, and lists the deepest first', async () => {
  const page = await look('deep');
  const { depth } = answers.deep[2];
  assert.ok(depth > 0);
  assert.deepEqual((await rowsOf(page, '#rows'))[0], ['2', 'Contact', `${shown(depth)} deep`]);
  assert.ok((await tileTexts(page)).includes(`${shown(depth)} deepthe deepest, in frame 2`));
  assert.equal(new Map(await rowsOf(page, '#now')).get('Depth, at least'), String(depth));
  await page.close();
});

test('a page names its files, their digests and its time', async () => {
  const page = await look('close');
  const { inputs, version, made_at } = dataOf(path('close'));
  assert.equal(await page.textContent('#version'), `limber ${version} on ${made_at}`);
  assert.deepEqual(
    (await rowsOf(page, '#inputs')).slice(1),
    inputs.map(({ name, bytes, sha256 }) => [name, grouped(bytes), sha256]),
  );
  assert.equal(inputs.length, 2);
  await page.close();
});

test('the scale has the lines of its numbers', async () => {
  const page = await look('apart');
  const numbers = await page.locator('#legend-ticks span').count();
  const lines = (await page.$eval('#legend-bar', (bar) => bar.style.background)).split('no-repeat').length - 1;
  assert.ok(numbers > 2 && lines >= numbers - 2, `${numbers} numbers, ${lines} lines`);
  await page.close();
});

test('the scale has a line at the clearance where surfaces have one, and says so then alone', async () => {
  const close = await look('close');
  assert.ok(await close.isVisible('#legend-limit'));
  assert.match(await close.textContent('#legend-title'), /the red one at 0\.5$/);
  await close.fill('#map-end', '20');
  assert.ok(!(await close.isVisible('#legend-limit')));
  assert.doesNotMatch(await close.textContent('#legend-title'), /red/);
  await close.close();
  const kept = await look('kept'); // the clearance is below all distances
  assert.ok(!(await kept.isVisible('#legend-limit')));
  assert.doesNotMatch(await kept.textContent('#legend-title'), /red/);
  await kept.close();
});

test('the triangles of the closest points do not have the colour of their distance', async () => {
  const page = await look('apart');
  const colors = await page.$$eval('#view line.mark:not(.halo), #view polygon.mark:not(.halo)', (all) =>
    all.map((mark) => `${mark.tagName} ${getComputedStyle(mark).stroke}`),
  );
  const [polygon, line] = ['polygon', 'line'].map(
    (tag) => colors.find((color) => color.startsWith(tag)).split(' ', 2)[1],
  );
  assert.notEqual(polygon, line);
  await page.close();
});

test('on paper, pages are light, true to scale, and without what nobody can press', async () => {
  const page = await look('poses', { scheme: 'dark' });
  await page.emulateMedia({ media: 'print' });
  await settled(page);
  const looks = await page.evaluate(() => ({
    ink: getComputedStyle(document.body).color,
    list: document.getElementById('rows-scroll').clientHeight >= document.getElementById('rows').clientHeight,
    // A page that is printed is laid out again, but not drawn again.
    fits: [...document.querySelectorAll('canvas')].map((canvas) => getComputedStyle(canvas).objectFit),
    help: document.getElementById('view-help').checkVisibility(),
  }));
  assert.deepEqual(looks, { ink: 'rgb(35, 40, 45)', list: true, fits: ['contain', 'contain'], help: false });
  await page.close();
});

test('triangles that intersect are marked', async () => {
  const page = await look('collision');
  assert.ok(dataOf(path('collision')).models[0].intersecting.length > 0);
  const { yellow } = await picture(page);
  assert.ok(yellow > 2e-4, `${yellow} is yellow`);
  await page.close();
});

test('the section can be shifted, turned, moved and zoomed', async () => {
  const page = await look('apart');
  const caption = () => page.textContent('#section-caption');
  assert.match(await caption(), /goes through both closest points/);
  const { text: start } = await section(page);
  await page.click('#section-whole');
  const { length } = await section(page);
  await page.focus('#shift');
  await page.keyboard.press('End'); // where there is only the plate
  assert.ok((await section(page)).length < 0.8 * length);
  assert.match(await caption(), /lies \S+ off both closest points/);
  assert.notEqual(await page.textContent('#shift-text'), '0');
  await page.focus('#turn');
  for (let i = 0; i < 20; ++i) await page.keyboard.press('ArrowRight');
  assert.match(await caption(), /turned by 20\u00b0/);
  assert.ok((await section(page)).text !== start);
  await page.click('#section-reset');
  assert.ok((await section(page)).text === start);
  await page.focus('#section');
  const { x, y, width, height } = await page.locator('#section').boundingBox();
  await page.mouse.move(x + width / 3, y + height / 3);
  const drag = async () => {
    await page.mouse.down();
    await page.mouse.move(x + width / 2, y + height / 2, { steps: 3 });
    await page.mouse.up();
  };
  const [press, turnWheel] = [(key) => page.keyboard.press(key), () => page.mouse.wheel(0, -300)];
  for (const action of [() => press('ArrowLeft'), () => press('ArrowUp'), () => press('+'), turnWheel, drag]) {
    await action();
    assert.ok((await section(page)).text !== start, `${action}`);
    await press('0');
    assert.ok((await section(page)).text === start);
  }
  await page.close();
});

test('the scale of colours follows its slider', async () => {
  const page = await look('apart');
  const before = await page.textContent('#legend-ticks');
  await page.focus('#map-end');
  await page.keyboard.press('End');
  assert.notEqual(await page.textContent('#legend-ticks'), before);
  await page.close();
});

test('frames have the numbers of the program, to the bit, and pictures that differ', async () => {
  for (const [name, frames] of [
    ['replay', [0, 7, 6, 39, 0]],
    ['usual', [0, 1, 300, 599, 1, 0]],
  ]) {
    const page = await look(name);
    const { rows, contacts, impacts, demo } = dataOf(path(name));
    const seen = new Map();
    for (const row of [...frames, Math.max(rows.status.indexOf('collision'), 0)]) {
      await go(page, row);
      assert.equal(await page.textContent('#frame-text'), `${row} of ${rows.status.length - 1}`);
      const cells = new Map(await rowsOf(page, '#now'));
      const [lower, upper] = [rows.lower[row], rows.upper[row]];
      assert.deepEqual([cells.get('Lower bound'), cells.get('Upper bound')].map(Number), [lower, upper]);
      if (name === 'replay') assert.deepEqual([lower, upper], [answers.replay[row].lower, answers.replay[row].upper]);
      for (const { count } of contacts) assert.ok(cells.get('Contacts').includes(`${grouped(count[row])} pairs`));
      for (const { status, lower } of impacts) {
        const text = status[row] === null ? 'no frame' : status[row] === 'clear' ? 'none' : `frame ${lower[row]}: `;
        assert.ok(cells.get('A meets B').includes(text), cells.get('A meets B'));
      }
      if (demo) assert.ok(cells.get('Within 10\u00a0%').includes(shown(demo.rough.upper[row])));
      const number = lower === upper ? shown(upper) : `${shown(lower)} to ${shown(upper)}`;
      const text = rows.status[row] === 'collision' ? 'in contact' : number;
      assert.equal(await page.textContent('#now-distance'), text);
      assert.equal(await page.textContent('.marks .length'), text);
      const now = (await picture(page)).text;
      for (const [other, before] of seen) assert.equal(now === before, other === row, `frames ${row} and ${other}`);
      seen.set(row, now);
    }
    await page.close();
  }
});

test('a click in a chart goes to the frame', async () => {
  for (const [name, width] of [
    ['replay', 1280],
    ['usual', 400],
  ]) {
    const page = await look(name, { width });
    const last = Number(await page.getAttribute('#frame', 'max'));
    const charts = await page.locator('.u-over').all();
    assert.equal(charts.length, name === 'replay' ? 4 : 3);
    for (const [i, chart] of charts.entries()) {
      await chart.scrollIntoViewIfNeeded();
      const box = await chart.boundingBox();
      await chart.click({ position: { x: (box.width * (i + 1)) / 5, y: box.height / 2 } });
      const frame = Number(await page.inputValue('#frame'));
      assert.ok(Math.abs(frame - (last * (i + 1)) / 5) < 2, `${frame}`);
    }
    await page.close();
  }
});

test('keys and buttons step, and the page plays and pauses', async () => {
  const page = await look('usual', { width: 400 });
  const text = () => page.textContent('#frame-text');
  await page.focus('#frame');
  for (let i = 0; i < 3; ++i) await page.keyboard.press('ArrowRight');
  assert.equal(await text(), '3 of 599');
  for (const [id, frame] of [
    ['forward', 4],
    ['back', 3],
  ]) {
    await page.focus(`#${id}`);
    await page.keyboard.press('Enter');
    assert.equal(await text(), `${frame} of 599`);
  }
  await page.selectOption('#speed', '50');
  await page.focus('#play');
  await page.keyboard.press('Space');
  assert.equal(await page.textContent('#play'), 'Pause');
  await page.waitForFunction(() => Number(document.getElementById('frame').value) > 20);
  await page.click('#play');
  assert.equal(await page.textContent('#play'), 'Play');
  const stopped = await text();
  await screenFrames(page, 5);
  assert.equal(await text(), stopped);
  assert.deepEqual(page.complaints, []);
  await page.close();
});

test('a view that follows the ball has it in the middle', async () => {
  const page = await look('usual');
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
  await page.close();
});

test('the path of the ball has a dot for each contact, and can be hidden', async () => {
  const page = await look('usual');
  const dots = () =>
    page.$$eval('.marks .dots', (all) => all.map((dot) => dot.getAttribute('d').split('M').length - 1));
  const contacts = dataOf(path('usual')).rows.status.filter((status) => status === 'collision').length;
  assert.deepEqual(await dots(), [contacts, contacts]);
  await page.uncheck('#show-path');
  await settled(page);
  assert.deepEqual(await dots(), []);
  assert.equal(await page.locator('.marks .path').count(), 0);
  await page.close();
});

const median = (values) => [...values].sort((a, b) => a - b)[Math.ceil(values.length / 2) - 1];

test('charts say their medians and maxima, all in microseconds', async () => {
  for (const name of demos) {
    const page = await look(name);
    const { rows, demo } = dataOf(path(name));
    const keys = await page.$$eval('#charts .key', (all) => all.map((key) => key.textContent));
    for (const [curve, times] of [
      ['update', rows.update_us],
      [name === 'few' ? 'within 30\u00a0%' : 'exact', rows.query_us],
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

test('the summary is that of the terminal', async () => {
  const page = await look('usual');
  const rows = await rowsOf(page, '#summary');
  const { summary } = dataOf(path('usual')).demo;
  const expected = summary.map(([name, text]) => [name, inPage(text)]);
  assert.deepEqual(rows, expected);
  const last = rows.find(([name]) => name === 'last frame'); // a program with checks adds a row behind it
  assert.deepEqual(last, ['last frame', 'checked against brute force: equal']);
  await page.close();
});

test('frames that have been left out are said to be, and charts have them', async () => {
  const page = await look('thinned');
  const { stride } = dataOf(path('thinned'));
  assert.ok(stride > 1);
  assert.match(await page.textContent('#view-caption'), new RegExp(`1 of every ${stride} frames`));
  assert.equal(await page.getAttribute('#frame', 'max'), String(Math.ceil(300 / stride) - 1));
  await page.focus('#frame');
  await page.keyboard.press('ArrowRight');
  assert.equal(await page.textContent('#frame-text'), `${stride} of 299`);
  await page.close();
});

test('everything that is operated has a name, and shows when it has the focus', async () => {
  for (const name of ['apart', 'replay', 'usual']) {
    const page = await look(name, name === 'usual' ? screens[1] : screens[0]);
    const ids = await page.$$eval('button, input, select, summary, [tabindex]', (all) =>
      all.filter((e) => e.offsetParent !== null).map((e) => e.id),
    );
    assert.ok(ids.length > 8);
    assert.deepEqual([...(await tabThrough(page, ids.length))].sort(), ids.sort());
    await page.close();
  }
});

test('without WebGL the page says so, and has all the rest', async () => {
  const script = `const get = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
      return kind.startsWith('webgl') ? null : get.call(this, kind, ...more);
    };`;
  const page = await look('apart', { script });
  assert.deepEqual(page.complaints, []);
  assert.match(await page.textContent('.no-view'), /no 3D view/);
  assert.ok((await section(page)).length > 50);
  assert.ok((await page.textContent('#answer')).includes(String(answers.apart.upper)));
  await page.close();
});
