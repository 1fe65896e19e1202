// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Makes the pictures of docs/guide/live_page.md. Run it by ./dev pages pictures.
import { photograph } from './picture_file.mjs';
import { launch, livePage, open } from './tests/support.mjs';

const browser = await launch();

async function moment(name, options, prepare) {
  const page = await open(browser, livePage, { reducedMotion: 'reduce', ...options });
  await page.waitForFunction(() => performance.getEntriesByName('limber-first-frame').length > 0);
  await prepare(page);
  await page.waitForTimeout(1500);
  await page.keyboard.press('Space');
  await page.evaluate(() => document.activeElement.blur());
  await photograph(page, name);
}

/** Holds the sheet at a place of the view, as a part of its width and height, and pulls it. */
async function pull(page, [x, y], [dx, dy]) {
  const box = await page.locator('#view').boundingBox();
  await page.mouse.move(box.x + x * box.width, box.y + y * box.height);
  await page.mouse.down();
  await page.mouse.move(box.x + (x + dx) * box.width, box.y + (y + dy) * box.height, { steps: 8 });
}

await moment('live.png', { width: 1280, height: 900 }, (page) => pull(page, [0.74, 0.6], [0, -0.2]));
await moment('live_tree.png', { width: 400, height: 780, scheme: 'dark' }, async (page) => {
  await page.selectOption('#tree', 'sheet');
  await page.fill('#level', '3');
  await page.fill('#error', '20');
  await page.evaluate(() => scrollTo(0, 0));
  await pull(page, [0.6, 0.62], [0, -0.1]);
});
await browser.close();
