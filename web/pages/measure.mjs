// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What a frame of the live page costs in headless Chromium while the mouse pulls the sheet, beside the body and through
// it. The page comes from a server of this machine that isolates it: only then its clock ticks every 5 us. Prints
// tables in Markdown.
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { gunzipSync } from 'node:zlib';
import { launch, livePage } from './tests/support.mjs';

const seconds = 7; // more than those that the page's table is about
const html = readFileSync(livePage);
const packed = Buffer.from(/id="engine-module">([^<]*)/.exec(html.toString())[1], 'base64');
const headers = {
  'Content-Type': 'text/html',
  'Cross-Origin-Opener-Policy': 'same-origin',
  'Cross-Origin-Embedder-Policy': 'require-corp',
};
const server = createServer((_, response) => response.writeHead(200, headers).end(html)).listen(0, '127.0.0.1');
const browser = await launch();

const first = [];
let page;
for (let start = 0; start < 5; ++start) {
  await page?.close();
  page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  const mark = await page.waitForFunction(() => performance.getEntriesByName('limber-first-frame')[0]?.startTime);
  first.push(await mark.jsonValue());
}
first.sort((a, b) => a - b);

/** The table of times while the sheet is pulled around, held at a place of the view: a part of its width and height. */
async function timesOfPulling(x, y) {
  await page.click('#reset');
  const view = await page.locator('#view').boundingBox();
  const moveTo = (x, y) => page.mouse.move(view.x + x * view.width, view.y + y * view.height);
  await moveTo(x, y);
  await page.mouse.down();
  for (const end = performance.now() + 1000 * seconds; performance.now() < end;) {
    const turn = performance.now() / 700;
    await moveTo(x + 0.08 * Math.sin(turn), y - 0.1 - 0.1 * Math.cos(2 * turn));
    await page.waitForTimeout(8);
  }
  await page.mouse.up();
  const rows = await page.$$eval('#times tr', (all) =>
    all.map((row) => [...row.cells].map((cell) => cell.textContent)),
  );
  return rows.slice(1);
}

const beside = await timesOfPulling(0.82, 0.62);
const through = await timesOfPulling(0.55, 0.62);
await browser.close();
server.close();

const size = (bytes) => `${(bytes / 1000).toFixed(0)} kB`;
console.log(`| engine, WebAssembly | ${size(gunzipSync(packed).length)}, packed ${size(packed.length)} |`);
console.log(`| page | ${size(html.length)} |`);
console.log(`| from navigation to first frame, median of 5 | ${first[2].toFixed(0)} ms |\n`);
console.log('| ms | beside the body: median | 99 % | through it: median | 99 % |\n|:--|--:|--:|--:|--:|');
beside.forEach((row, i) => console.log(`| ${[...row, ...through[i].slice(1)].join(' | ')} |`));
