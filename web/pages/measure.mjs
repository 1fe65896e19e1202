// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What a frame of the live page costs in headless Chromium while the mouse pulls the sheet. The page comes from a
// server of this machine that isolates it: only then its clock ticks every 5 us. Prints a table in Markdown.
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { join } from 'node:path';
import { gunzipSync } from 'node:zlib';
import { launch, pages } from './tests/support.mjs';

const seconds = 8;
const html = readFileSync(join(pages, '../../apps/limber/pages/live.html'));
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

const view = await page.locator('#view').boundingBox();
const [x, y] = [view.x + 0.62 * view.width, view.y + 0.66 * view.height];
await page.mouse.move(x, y);
await page.mouse.down();
for (const end = performance.now() + 1000 * seconds; performance.now() < end;) {
  const turn = performance.now() / 700;
  await page.mouse.move(x + 90 * Math.sin(turn), y - 60 + 60 * Math.cos(2 * turn));
  await page.waitForTimeout(8);
}
const rows = await page.$$eval('#times tr', (all) => all.map((row) => [...row.cells].map((cell) => cell.textContent)));
await browser.close();
server.close();

const size = (bytes) => `${(bytes / 1000).toFixed(0)} kB`;
console.log(`| engine, WebAssembly | ${size(gunzipSync(packed).length)}, packed ${size(packed.length)} |`);
console.log(`| page | ${size(html.length)} |`);
console.log(`| from navigation to first frame, median of 5 | ${first[2].toFixed(0)} ms |\n`);
rows.splice(
  1,
  0,
  rows[0].map(() => '---'),
);
for (const row of rows) console.log(`| ${row.join(' | ')} |`);
