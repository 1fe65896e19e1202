// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Makes the pictures of docs/guide/reports.md: a gear in a housing, and a ball over a waving sheet. Run it by
// ./dev pages pictures.
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { Folder, launch, limber, open, settled, sheetObj } from './tests/support.mjs';

const images = join(dirname(fileURLToPath(import.meta.url)), '../../docs/images');
const turn = 2 * Math.PI;

/** A ring between two closed curves of as many points, from one height to another, as STL. */
function ringStl(outer, inner, low, high) {
  const facets = [];
  const quad = (a, b, c, d) => facets.push([a, b, c], [a, c, d]);
  outer.forEach(([x0, y0], i) => {
    const next = (i + 1) % outer.length;
    const [x1, y1] = outer[next];
    const [[u0, v0], [u1, v1]] = [inner[i], inner[next]];
    quad([x0, y0, low], [x1, y1, low], [x1, y1, high], [x0, y0, high]);
    quad([u1, v1, low], [u0, v0, low], [u0, v0, high], [u1, v1, high]);
    quad([u0, v0, high], [x0, y0, high], [x1, y1, high], [u1, v1, high]);
    quad([u1, v1, low], [x1, y1, low], [x0, y0, low], [u0, v0, low]);
  });
  const vertex = (p) => `vertex ${p.map((c) => c.toPrecision(9)).join(' ')}\n`;
  const facet = (corners) => `facet normal 0 0 0\nouter loop\n${corners.map(vertex).join('')}endloop\nendfacet\n`;
  return `solid part\n${facets.map(facet).join('')}endsolid part\n`;
}

const count = 360;
const curve = (radius, x = 0, y = 0) =>
  Array.from({ length: count }, (_, i) => {
    const angle = (turn * i) / count;
    return [x + radius(angle) * Math.cos(angle), y + radius(angle) * Math.sin(angle)];
  });

/** Teeth whose flanks take a tenth of the pitch. */
function tooth(angle) {
  const place = ((angle * 18) / turn) % 1;
  const rise = Math.min(Math.max((place - 0.3) / 0.1, 0), 1) - Math.min(Math.max((place - 0.8) / 0.1, 0), 1);
  return 27 + 5 * rise;
}

const folder = new Folder();
process.chdir(folder.path);
folder.store(
  'gear.stl',
  ringStl(
    curve(tooth),
    curve(() => 8),
    -6,
    6,
  ),
);
const square = curve((angle) => Math.min(47, 43 / Math.max(Math.abs(Math.cos(angle)), Math.abs(Math.sin(angle)))));
folder.store(
  'housing.stl',
  ringStl(
    square,
    curve(() => 33.1, 0.6, 0.25),
    -8,
    10,
  ),
);
limber('distance', 'gear.stl', 'housing.stl', '--min-clearance', '0.5', '--json', '--report', 'clearance.html');

const frameCount = 120;
const frames = Array.from({ length: frameCount }, (_, f) => {
  const t = (turn * f) / frameCount;
  return folder.store(
    `sheet_${f}.obj`,
    sheetObj(60, (x, y) => 0.2 * Math.sin(2.2 * x + t) * Math.cos(1.8 * y - 2 * t)),
  );
});
const poses = frames.map((_, f) => {
  const t = (turn * f) / frameCount;
  return `${1.1 * Math.cos(t)},${1.1 * Math.sin(t)},${1.28 + 0.12 * Math.cos(3 * t)},1,0,0,${t}\n`;
});
const moving = ['--b', 'scene:ball', '--poses-b', folder.store('poses.csv', poses.join(''))];
const asked = ['--relative-error', '0.1', '--contacts', '--margin', '0.05', '--json', '--report', 'replay.html'];
limber('track', '--a', ...frames, ...moving, ...asked);

const browser = await launch();
const photograph = async (name, picture, prepare) => {
  const page = await open(browser, folder.file(name), { width: 1240, height: 1000 });
  await prepare(page);
  await settled(page);
  const box = await page.locator('.pair').boundingBox();
  const clip = { x: 0, y: 0, width: 1240, height: Math.ceil(box.y + box.height + 20) };
  await page.screenshot({ path: join(images, picture), fullPage: true, clip });
  await page.close();
};
await photograph('clearance.html', 'report.png', (page) => page.check('#cut'));
await photograph('replay.html', 'replay.png', async (page) => {
  await page.focus('#frame');
  for (let i = 0; i < 37; ++i) await page.keyboard.press('ArrowRight');
  await page.evaluate(() => document.activeElement.blur());
});
await browser.close();
process.chdir('/');
folder.remove();
