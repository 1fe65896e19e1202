// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Builds the pages that the program is compiled with: one file each in apps/limber/pages, with everything inside. With
// --check it writes nothing, and fails where a committed page is not what the sources give.
import { createHash } from 'node:crypto';
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gunzipSync, gzipSync } from 'node:zlib';
import { build, transform } from 'esbuild';

const here = dirname(fileURLToPath(import.meta.url));
const pages = join(here, '../../apps/limber/pages');
const all = {
  report: { title: 'limber distance', sheets: ['shared/page.css'] },
  replay: {
    title: 'limber track',
    sheets: ['node_modules/uplot/dist/uPlot.min.css', 'shared/page.css', 'replay/page.css'],
  },
  live: { title: 'limber live', sheets: ['shared/page.css', 'live/page.css'] },
};
const placeholder = '"data of the page"'; // apps/limber/page_template.cpp puts the data there
const engineElement = /<script type="text\/plain" id="engine-module">([^<]*)<\/script>/;

/** The digest of all that pages are made of; tests/program/check_pages.cmake computes it too, without npm. */
function digestOfSources() {
  const names = readdirSync(here, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map((entry) =>
      join(entry.parentPath, entry.name)
        .slice(here.length + 1)
        .replaceAll('\\', '/'),
    )
    .filter((name) => /^(report|replay|live|shared)\/.*\.(ts|css|html)$|^(build\.mjs|package-lock\.json)$/.test(name));
  const parts = readdirSync(join(here, '../limber3d')).filter((name) => name.endsWith('.js'));
  names.push(...parts.map((name) => `../limber3d/${name}`));
  const lines = names.sort().map((name) => `${sha256(readFileSync(join(here, name)))} ${name}\n`);
  return sha256(lines.join(''));
}

const sha256 = (content) => createHash('sha256').update(content).digest('hex');

/** What a page has inside beside its program: the data of a report, or the engine, packed, for the live page. */
function contentOf(name) {
  if (name !== 'live') return `<script type="application/json" id="data">${placeholder}</script>`;
  return `<script type="text/plain" id="engine-module">${packedEngine()}</script>`;
}

/**
 * The engine that --engine names, unless the committed page has it; otherwise that of the page. Versions of Node.js
 * pack differently, and the page is not to change with them.
 */
function packedEngine() {
  const packed = engineElement.exec(readFileSync(join(pages, 'live.html'), 'utf8'))?.[1] ?? '';
  const option = process.argv.indexOf('--engine');
  if (option === -1) return packed;
  const engine = readFileSync(process.argv[option + 1]);
  const isSame = packed !== '' && gunzipSync(Buffer.from(packed, 'base64')).equals(engine);
  return isSame ? packed : gzipSync(engine, { level: 9 }).toString('base64');
}

/** The licenses of limber and of all that a page has inside, in the words of their owners. */
function noticesOf(name, inputs) {
  const packages = new Set(inputs.map((path) => /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(path)?.[1]));
  packages.delete(undefined);
  const files = [['limber', '../../LICENSE']];
  for (const library of [...packages].sort()) files.push([library, `node_modules/${library}/LICENSE`]);
  if (name === 'live') files.push(['limber.wasm', '../NOTICES.txt']);
  return files
    .map(([title, path]) => `=== ${title} ===\n\n${readFileSync(join(here, path), 'utf8').trim()}\n`)
    .join('\n');
}

async function page(name, digest) {
  const { title, sheets } = all[name];
  const read = (path) => readFileSync(join(here, path), 'utf8');
  const bundle = await build({
    entryPoints: [join(here, name, 'main.ts')],
    bundle: true,
    minify: true,
    format: 'iife',
    target: 'es2022',
    charset: 'ascii',
    legalComments: 'none', // noticesOf() has the licenses in full
    metafile: true,
    write: false,
    logLevel: 'warning',
    external: ['node:*'], // limber3d reads its module by itself in Node.js alone
    logOverride: { 'empty-import-meta': 'silent' },
  });
  const style = await transform(sheets.map(read).join('\n'), {
    loader: 'css',
    minify: true,
    charset: 'ascii',
    legalComments: 'none',
  });
  const notices = noticesOf(name, [...sheets, ...Object.keys(bundle.metafile.inputs)]);
  return `<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta name="limber-sources" content="${digest}">
<title>${title}</title>
<link rel="icon" href="data:,">
<style>${style.code.trim()}</style>
</head>
${read(`${name}/page.html`).trim()}
${contentOf(name)}
<script>${bundle.outputFiles[0].text.trim()}</script>
<script type="text/plain" id="notices">
${notices}</script>
</body>
</html>
`;
}

/** A page whose engine is older than the sources of C++ is not wrong: ./dev pages live renews it. */
const withoutEngine = (html) => html.replace(engineElement, '');

const isCheck = process.argv.includes('--check');
const digest = digestOfSources();
let failed = false;
for (const name of Object.keys(all)) {
  const path = join(pages, `${name}.html`);
  const built = await page(name, digest);
  if (!isCheck) {
    writeFileSync(path, built);
    console.log(`${path}: ${built.length} bytes`);
  } else if (withoutEngine(readFileSync(path, 'utf8')) !== withoutEngine(built)) {
    console.error(`${path} is not what web/pages gives; run ./dev pages`);
    failed = true;
  }
}
process.exitCode = failed ? 1 : 0;
