// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Builds clients/program/pages/viewer.html, one file with everything inside, which is committed: the program is
// compiled with it. With --check it writes nothing, and fails where the committed page is not what the sources give.
import { createHash } from 'node:crypto';
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build, transform } from 'esbuild-wasm';

const here = dirname(fileURLToPath(import.meta.url));
const read = (path) => readFileSync(join(here, path), 'utf8');
const sha256 = (content) => createHash('sha256').update(content).digest('hex');

const target = join(here, '../program/pages/viewer.html');
const sheets = ['node_modules/uplot/dist/uPlot.min.css', 'shared/page.css', 'viewer/page.css'];

/** The digest of all that the viewer is made of; check_pages.cmake computes it too, without npm. */
function digestOfSources() {
  const names = readdirSync(here, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map((entry) =>
      join(entry.parentPath, entry.name)
        .slice(here.length + 1)
        .replaceAll('\\', '/'),
    )
    .filter((name) =>
      /^(viewer|report|replay|study|shared)\/.*\.(ts|css|html)$|^(build\.mjs|package-lock\.json)$/.test(name),
    );
  const lines = names.sort().map((name) => `${sha256(readFileSync(join(here, name)))} ${name}\n`);
  return sha256(lines.join(''));
}

/**
 * Leaves out the shaders of three.js that draw nothing here, more than a fourth of a page: those of its own materials,
 * of environments, of effects on whole pictures and of virtual reality, with the classes that have them.
 */
const withoutShaders = {
  name: 'without-shaders',
  setup({ onLoad, onResolve }) {
    const classes = /(PMREMGenerator|WebGLCubeRenderTarget|WebGLOutput|WebXRDepthSensing)\.js$/;
    onResolve({ filter: /^three$/ }, () => ({ path: join(here, 'node_modules/three/src/Three.js') }));
    onLoad({ filter: classes }, ({ path }) => ({ contents: `export class ${classes.exec(path)[1]} {}` }));
    onLoad({ filter: /shaders.Shader(Chunk|Lib).\w+\.glsl\.js$/ }, ({ path }) => {
      const isUsed = path.includes('colorspace_pars');
      return isUsed ? undefined : { contents: `export default ''; export const vertex = '', fragment = '';` };
    });
  },
};

/** The licenses of limber and of all that a page has inside, in the words of their owners. */
function noticesOf(inputs) {
  const packages = new Set(inputs.map((path) => /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(path)?.[1]));
  packages.delete(undefined);
  const libraries = [...packages].sort().map((library) => [library, `node_modules/${library}/LICENSE`]);
  return [['limber', '../../LICENSE'], ...libraries]
    .map(([title, path]) => `=== ${title} ===\n\n${read(path).trim()}\n`)
    .join('\n');
}

/** The page. The program puts its data where the placeholder is: see clients/program/reports/page_template.cpp. */
async function built() {
  const bundle = await build({
    entryPoints: [join(here, 'viewer/main.ts')],
    bundle: true,
    plugins: [withoutShaders],
    minify: true,
    format: 'iife',
    target: 'es2022',
    charset: 'ascii',
    legalComments: 'none', // noticesOf() has the licenses in full
    metafile: true,
    write: false,
    logLevel: 'warning',
  });
  const style = await transform(sheets.map(read).join('\n'), {
    loader: 'css',
    minify: true,
    charset: 'ascii',
    legalComments: 'none',
  });
  return `<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta name="limber-sources" content="${digestOfSources()}">
<title>limber</title>
<link rel="icon" href="data:,">
<style>${style.code.trim()}</style>
</head>
${read('viewer/page.html').trim()}
<script type="application/json" id="data">"data of the page"</script>
<script>${bundle.outputFiles[0].text.trim()}</script>
<script type="text/plain" id="notices">
${noticesOf([...sheets, ...Object.keys(bundle.metafile.inputs)])}</script>
</body>
</html>
`;
}

const html = await built();
if (!process.argv.includes('--check')) {
  writeFileSync(target, html);
  console.log(`${target}: ${html.length} bytes`);
} else if (readFileSync(target, 'utf8') !== html) {
  console.error(`${target} is not what clients/pages gives; run ./dev pages`);
  process.exitCode = 1;
}
