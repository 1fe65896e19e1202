// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Makes the pictures of docs/guide/reports.md, a gear in a housing and a ball over a waving sheet, and those of `limber
// demo` for the README and docs/guide/demo.md. Run it by ./dev pages pictures.
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { Folder, launch, limber, open, pages, settled, sheetObj } from './tests/support.mjs';

const images = join(pages, '../../docs/images');

/** Photographs a page in at most 256 colours, which make the file small, and closes it. */
async function photograph(page, name, options) {
  await settled(page);
  await page.screenshot({ path: join(images, name), ...options });
  await page.close();
  execFileSync('pngquant', ['--force', '--strip', '--ext', '.png', join(images, name)]);
}

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

/** Of several runs of the demonstration, the page of the least disturbed: its longest time is the shortest. */
function quietDemo() {
  const runs = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => {
    const name = `demo_${i}.html`;
    const [{ update_us, query_us, rough_query_us }] = limber('demo', '--no-check', '--json', '--report', name);
    return { name, longest: Math.max(update_us.max, query_us.max, rough_query_us.max) };
  });
  return runs.reduce((a, b) => (a.longest < b.longest ? a : b)).name;
}

/** The picture of the README is the view, with the medians in its corners, and the charts of times; texts of 14 pixels
 * are read where it is shown 400 pixels wide. */
const demoWidth = 540;
const demoStyle = `
  :root { --page: #ffffff; --card: #ffffff; --soft: #23282d; }
  body { padding: 0 6px 6px; }
  main { position: relative; }
  header, .player, .tools, section h2, section > p, main > section { display: none; }
  .chart:first-child, .numbers, .badge.a, .badge.a + .name { display: none; }
  .pair { display: block; }
  .pair > section { border: 0; padding: 0; margin: 0; }
  .stage { height: 326px; border: 0; margin: 0; }
  .tiles { margin: 0; display: block; }
  .tiles > div { position: absolute; z-index: 1; width: 150px; padding: 0; border: 0; background: none; }
  .tiles > div:nth-child(1) { top: 6px; left: 0; }
  .tiles > div:nth-child(2) { top: 6px; right: 0; text-align: right; }
  .tiles > div:nth-child(3) { top: 250px; left: 0; }
  .tiles > div:nth-child(4) { top: 250px; right: 0; text-align: right; }
  .tiles .soft { line-height: 1.25; display: block; }
  #charts { display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 0 14px; }
  #charts h3 { margin: 8px 0 0; }
  .unit { flex-basis: 100%; }
`;

const browser = await launch();
const show = (page, part) =>
  page.evaluate((part) => {
    const slider = document.getElementById('frame');
    slider.value = Math.round(part * slider.max);
    slider.dispatchEvent(new Event('input'));
    document.activeElement.blur();
  }, part);
/** The upper part of a page, to the end of its pictures. */
const upperPart = async (name, picture, prepare) => {
  const page = await open(browser, folder.file(name), { width: 1240, height: 1000 });
  await prepare(page);
  const box = await page.locator('.pair').boundingBox();
  const clip = { x: 0, y: 0, width: 1240, height: Math.ceil(box.y + box.height + 20) };
  await photograph(page, picture, { fullPage: true, clip });
};
/** What a dark and narrow screen shows where a part of a page begins. */
const narrowPart = async (name, picture, selector, prepare) => {
  const page = await open(browser, folder.file(name), { width: 400, height: 780, scheme: 'dark' });
  await prepare(page);
  await page.$eval(selector, (part) => part.scrollIntoView());
  await photograph(page, picture);
};
await upperPart('clearance.html', 'report.png', (page) => page.check('#cut'));
await narrowPart('clearance.html', 'report_narrow.png', 'body', (page) => page.check('#cut'));
await upperPart('replay.html', 'replay.png', (page) => show(page, 0.31));
await narrowPart('replay.html', 'replay_narrow.png', '.pair', (page) => show(page, 0.31));

const demo = quietDemo();
const page = await open(browser, folder.file(demo), { width: demoWidth, height: 800, deviceScaleFactor: 2 });
await page.addStyleTag({ content: demoStyle });
await settled(page);
await page.$eval('#whole', (button) => button.click());
await show(page, 0.7);
const box = await page.locator('main').boundingBox();
await photograph(page, 'demo.png', {
  clip: { x: 0, y: 0, width: demoWidth, height: Math.ceil(box.y + box.height + 6) },
});
await upperPart(demo, 'demo_page.png', (page) => show(page, 0.62));
await narrowPart(demo, 'demo_narrow.png', '.pair', async (page) => {
  await show(page, 0.62);
  await page.check('#follow');
});
process.chdir('/');
folder.remove();

await browser.close();
