// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Pictures for docs/images, of at most 256 colours, which makes them small.
import { execFileSync } from 'node:child_process';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { settled } from './tests/support.mjs';

const images = join(dirname(fileURLToPath(import.meta.url)), '../../docs/images');

/** Photographs a page, and closes it. */
export async function photograph(page, name, options) {
  await settled(page);
  await page.screenshot({ path: join(images, name), ...options });
  await page.close();
  execFileSync('pngquant', ['--force', '--strip', '--ext', '.png', join(images, name)]);
}
