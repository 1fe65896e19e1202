// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The live page: a sheet that swings, a body over it, and what the engine says of them in each frame. */

import { init } from '../../limber3d/index.js';
import { bytesOf } from '../shared/decode.ts';
import { byId } from '../shared/dom.ts';
import { hareBody } from './body.ts';
import { Live } from './live.ts';

async function start(): Promise<void> {
  const packed = new Blob([bytesOf(byId('engine-module').textContent ?? '') as BlobPart]);
  const unpacked = packed.stream().pipeThrough(new DecompressionStream('gzip'));
  await init(await new Response(unpacked).arrayBuffer());
  new Live(hareBody());
}

start().catch((error: unknown) => {
  const failure = byId('failure');
  failure.textContent = `The page cannot start in this browser: ${String(error)}`;
  failure.hidden = false;
});
