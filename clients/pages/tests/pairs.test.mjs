// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Pages of `limber distance`, in a browser: of one pair, of pairs of a list, and of parts.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Session, boxObj, expectGoodLooks, module, picture, rowsOf, screens, settled, tabThrough } from './support.mjs';
import { answerOf, textsOf, tileTexts } from './support.mjs';

const { shown } = await module('shared/numbers.ts');

const session = new Session();
const { answers, data } = session;
const pairs = 'apart close kept interval collision inside flush open beyond tiny minute huge'.split(' ');

before(async () => {
  const store = (name, text) => session.store(name, text);
  const box = store('box.obj', boxObj([0, 0, 0], [2, 1, 1]));
  const plate = store('plate.obj', boxObj([-3, -3, -0.5], [5, 4, -0.2]));
  const room = store('room.obj', boxObj([-2, -2, -2], [3, 3, 3]));
  const corner = (size) => `v ${size} 0 0\nv 0 ${size} 0\nv 0 0 ${size}\nf 1 2 3\n`;
  const minute = store('minute.obj', corner('1e-300'));
  for (const [name, ...words] of [
    ['apart', box, plate],
    ['close', box, plate, '--min-clearance', '0.5'],
    ['kept', box, plate, '--min-clearance', '0.1'],
    ['interval', box, 'scene:ball', '--pose-b', '5,3,3,1,0.2,0.3,0', '--relative-error', '0.5'],
    ['collision', box, 'scene:ball'],
    ['inside', room, 'scene:ball', '--min-clearance', '0.1'],
    ['flush', box, box, '--pose-b', '2,0.25,0,1,0,0,0'],
    ['open', box, 'scene:square'],
    ['beyond', box, 'scene:ball', '--pose-b', '9,0,0,1,0,0,0', '--max-distance', '2'],
    ['tiny', box, 'scene:ball', '--pose-b', '0.5,0.5,2.00001,1,0,0,0'],
    ['minute', minute, minute],
    ['huge', store('huge.obj', corner('1e60')), store('point.obj', 'v 1 1 3\nf 1 1 1\n')],
  ]) {
    session.make(name, 'distance', ...words);
  }
  const study = (name, option, rows, ...words) =>
    session.make(name, 'distance', option, store(`${name}.csv`, rows.map((row) => `${row}\n`).join('')), ...words);
  const heads = 'model_a,model_b,pose_b_tx,pose_b_ty,pose_b_tz';
  const heights = Array.from({ length: 210 }, (_, i) => (i === 150 ? -0.1 : 0.02 + 1.4 * (1 + Math.cos(i / 12))));
  const asPoses = heights.map((z) => `${box},${plate},0,0,${0.2 - z}`);
  study('poses', '--pairs', [heads, ...asPoses], '--min-clearance', '0.5', '--unit', 'mm');
  const mixed = [`${box},scene:ball,0,0,0`, `${room},scene:ball,0,0,0`, `${box},${box},2,0.25,0`];
  study('mixed', '--pairs', [heads, ...mixed, `${box},scene:square,0,0,0`, `${box},${plate},0,0,0`]);
  const partHeads = 'name,model,pose_tx';
  const partRows = [`room,${room},0`, `box,${box},0`, `box,${box},2`, `"box, last",${box},4.1`, 'ball,scene:ball,9'];
  study('parts', '--parts', [partHeads, ...partRows], '--min-clearance', '0.5', '--title', 'All <parts>');
  const accepted = store('accept.csv', 'name_a,name_b,allowed\na,b,all\n');
  study('accepted', '--parts', [partHeads, `a,${box},0`, `b,${box},1`, `c,${box},1.5`], '--accept', accepted);
  study('far', '--parts', [partHeads, `a,${box},0`, `b,${box},9`], '--max-distance', '2', '--min-clearance', '1');
  await session.launch();
});

after(() => session.close());

const listed = async (page) => (await rowsOf(page, '#rows')).map(([row]) => Number(row));

expectGoodLooks(session, [...pairs, 'parts'], false);
expectGoodLooks(session, ['poses', 'mixed'], true);

test('the answer is in tile, picture and table', async () => {
  for (const name of ['apart', 'interval', 'tiny']) {
    await session.show(name, async (page) => {
      const { lower, upper, witness } = answers[name][0];
      const text = lower === upper ? shown(upper) : `${shown(lower)} to ${shown(upper)}`;
      for (const place of ['#tiles b', '#view .length']) assert.equal(await page.textContent(place), text);
      const table = await page.textContent('#answer');
      for (const number of [lower, upper, witness.point_a.join(', '), witness.point_b.join(', ')]) {
        assert.ok(table.includes(String(number)), `${number} in ${table}`);
      }
    });
  }
  assert.ok(answers.interval[0].lower < answers.interval[0].upper);
});

test('verdicts and kinds of clashes are those of the program', async () => {
  for (const [name, tiles, clash] of [
    ['apart', /0\.2/, 'Clear'],
    ['close', /^\u2717 Too close/, 'Below the clearance'],
    ['kept', /^\u2713 Kept/, 'Clear'],
    ['collision', /^Hard clash/, 'Hard clash: the volumes overlap'],
    ['inside', /^\u2717 Too close.*Hard clash/, 'Hard clash: B is enclosed in A'],
    ['flush', /^Touching/, 'Touching: the volumes do not overlap'],
    ['open', /^Surfaces meet/, 'Surfaces meet: a model is not closed'],
    ['beyond', /^More than/, 'Clear'],
  ]) {
    await session.show(name, async (page) => {
      assert.match(await page.textContent('#tiles'), tiles);
      assert.equal((await answerOf(page)).get('Clash'), clash);
    });
  }
});

test('keys, wheel, mouse and buttons turn, move and zoom the view, and what is up can be chosen', () =>
  session.show('apart', async (page) => {
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
    for (const key of ['ArrowLeft', 'Shift+ArrowUp', 'Shift+ArrowRight', '+', '-', '0']) {
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
    assert.equal(await page.inputValue('#up'), 'y'); // both files are .obj
    for (const up of ['z', 'y']) await changes(up, () => page.selectOption('#up', up));
    assert.equal(last, start);
  }));

test('models and other parts can be hidden, and seen through; what encloses is seen through anyhow', async () => {
  for (const [name, box] of [
    ['apart', 'show-b'],
    ['parts', 'show-others'],
  ]) {
    await session.show(name, async (page) => {
      const before = await picture(page);
      await page.uncheck(`#${box}`);
      await settled(page);
      const after = await picture(page);
      assert.ok(after.drawn < before.drawn, `${after.drawn} and ${before.drawn}`);
      const names = name === 'apart' ? ['A'] : ['A', 'B'];
      assert.deepEqual(await textsOf(page, '#view .name'), names);
      await page.check('#see-through');
      await settled(page);
      assert.notEqual((await picture(page)).text, after.text);
    });
  }
  await session.show('inside', async (page) => {
    const { text } = await picture(page);
    await page.uncheck('#show-b'); // which is in A
    await settled(page);
    assert.notEqual((await picture(page)).text, text);
  });
});

test('triangles that intersect are marked', () =>
  session.show('collision', async (page) => {
    const { yellow } = await picture(page);
    assert.ok(yellow > 2e-4, `${yellow} is yellow`);
  }));

test('a study says first whether the clearance is kept, and lists the worst first', () =>
  session.show('poses', async (page) => {
    const { rows } = data.poses;
    const broken = rows.too_close.filter((is) => is).length;
    assert.ok(broken > 0 && broken < 210);
    const [verdict, worst] = await tileTexts(page);
    assert.equal(verdict, `\u2717 ${broken} of 210pairs are closer than the required 0.5\u00a0mm`);
    assert.ok(worst.includes('Hard clash') && worst.includes('row 150'), worst);
    const nearest = rows.upper.map((upper, row) => [upper, row]).sort(([a, i], [b, j]) => a - b || i - j);
    assert.equal(nearest[0][1], 150); // the one that is in the plate
    assert.deepEqual(
      await listed(page),
      nearest.map(([, row]) => row),
    );
    assert.equal(await page.textContent('#answer-title'), 'Row 150: hard clash');
    assert.match(await page.getAttribute('.plot', 'aria-label'), /required clearance 0\.5\u00a0mm: 0\.5$/);
  }));

for (const { width } of screens) {
  test(`a click in list and chart, and steps, show a pair with the program's numbers, at ${width} pixels`, () =>
    session.show('poses', { width }, async (page) => {
      const shownRow = async () => Number(/Row (\d+)/.exec(await page.textContent('#answer-title'))[1]);
      const expectRow = async (row) => {
        await settled(page);
        assert.equal(await shownRow(), row);
        assert.equal(await page.textContent('#rows [aria-current] td'), String(row));
        const { upper, status } = answers.poses[row];
        assert.equal(Number((await answerOf(page)).get('Distance, upper bound')), upper);
        const text = status === 'collision' ? 'shared point' : `${shown(upper)}\u00a0mm`;
        assert.equal(await page.textContent('#view .length'), text);
        return (await picture(page)).text;
      };
      const order = await listed(page);
      const first = await expectRow(order[0]);
      await page.click(`#rows tr[data-row="${order[5]}"]`);
      const fifth = await expectRow(order[5]);
      assert.notEqual(first, fifth);
      await page.click('#forward');
      await expectRow(order[6]);
      await page.click('#back');
      assert.equal(await expectRow(order[5]), fifth);
      await page.focus(`#rows tr[data-row="${order[3]}"] button`);
      for (const key of ['Enter', 'ArrowDown', 'ArrowDown', 'ArrowUp']) await page.keyboard.press(key);
      await expectRow(order[4]);
      assert.equal(await page.locator('#rows button[tabindex="0"]').count(), 1);
      const chart = page.locator('.u-over');
      await chart.scrollIntoViewIfNeeded();
      const { width: across, height } = await chart.boundingBox();
      await chart.click({ position: { x: across / 2, y: height / 2 } });
      const reached = await shownRow();
      assert.ok(Math.abs(reached - 104.5) < 3, `${reached}`);
      await expectRow(reached);
    }));
}

test('the list is parted by kinds of clashes, and pairs of parts have their names', async () => {
  await session.show('mixed', async (page) => {
    const kinds = ['All 5', 'Hard clash 2', 'Surfaces meet 1', 'Touching 1', 'Clear 1'];
    assert.deepEqual(await textsOf(page, '#rows-kinds button'), kinds);
    const words = (await rowsOf(page, '#rows')).map((cells) => cells[2]);
    assert.deepEqual(words, ['Hard clash', 'Hard clash', 'Surfaces meet', 'Touching', 'Clear']);
    await page.click('#rows-kinds button:nth-child(4)');
    assert.deepEqual(await textsOf(page, '#rows tr:not([hidden]) button'), ['2']);
    assert.equal(await page.getAttribute('#rows-kinds button:nth-child(4)', 'aria-pressed'), 'true');
    await page.click('#rows-kinds button:nth-child(1)');
    assert.equal(await page.locator('#rows tr:not([hidden])').count(), 5);
    assert.equal(await page.textContent('#title'), '5 pairs of 5 models');
  });
  await session.show('parts', async (page) => {
    assert.equal(await page.textContent('#title'), 'All <parts>');
    assert.equal(await page.textContent('#subtitle'), '5 parts');
    const rows = new Map((await rowsOf(page, '#rows')).map(([row, ...cells]) => [Number(row), cells]));
    const words = ['Hard clash', 'Touching', 'Below the clearance', 'Clear'];
    const kinds = ['hard_clash', 'touching', 'clearance', 'clear'];
    for (const [row, { clash }] of answers.parts.entries()) assert.equal(rows.get(row)[1], words[kinds.indexOf(clash)]);
    assert.deepEqual(rows.get(4), ['1 box2 box', 'Touching', 'in contact']);
  });
});

test('a study without pairs says so, and accepted pairs are counted apart', async () => {
  await session.show('far', async (page) => {
    assert.deepEqual(await tileTexts(page), ['Noneof the parts are within 2 of each other']);
    assert.equal(await page.locator('.pair, #rows, #answer').count(), 0);
    assert.deepEqual(page.complaints, []);
  });
  await session.show('accepted', async (page) => {
    assert.deepEqual((await tileTexts(page)).slice(1), ['2pairs: hard clash', '1pair: accepted']);
    assert.deepEqual(await textsOf(page, '#rows-kinds button'), ['All 3', 'Hard clash 2', 'Accepted 1']);
  });
});

test('a page names its version and its time', () =>
  session.show('close', async (page) => {
    const { version, made_at } = data.close;
    assert.equal(await page.textContent('#version'), `limber ${version} on ${made_at}`);
  }));

test('on paper, pages are light, true to scale, and without what nobody can press', () =>
  session.show('poses', { scheme: 'dark' }, async (page) => {
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
  }));

test('everything that is operated has a name, and shows when it has the focus', () =>
  session.show('apart', (page) => tabThrough(page)));

test('without WebGL the page says so, and has all the rest', () => {
  const script = `const get = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
      return kind.startsWith('webgl') ? null : get.call(this, kind, ...more);
    };`;
  return session.show('apart', { script }, async (page) => {
    assert.deepEqual(page.complaints, []);
    assert.match(await page.textContent('.no-view'), /no 3D view/);
    assert.ok((await page.textContent('#answer')).includes(String(answers.apart[0].upper)));
  });
});
