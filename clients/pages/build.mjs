// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Builds build/pages/viewer.html, one file with everything inside. With --commit the page also takes the place of the
// committed one, clients/program/pages/viewer.html, with which the program is compiled.
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build, transform } from 'esbuild-wasm';

const here = dirname(fileURLToPath(import.meta.url));
const read = (path) => readFileSync(join(here, path), 'utf8');

/** Which data the page reads. The program says the same in clients/program/reports/page_template.h; a change of what
 * viewer/data.ts names raises both. */
const dataFormat = 3;
const sheets = ['node_modules/uplot/dist/uPlot.min.css', 'shared/page.css', 'viewer/page.css'];

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
<meta name="limber-data" content="${dataFormat}">
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

const target = join(here, '../../build/pages/viewer.html');
mkdirSync(dirname(target), { recursive: true });
writeFileSync(target, await built());
if (process.argv.includes('--commit')) copyFileSync(target, join(here, '../program/pages/viewer.html'));
