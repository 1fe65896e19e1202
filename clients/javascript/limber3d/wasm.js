// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The WebAssembly module: how it is loaded, called and read. Private to the package, but for init().

import { LimberError, codeOf, filterHasThrown, invalid } from "./errors.js";

/**
 * What the module exports; see clients/javascript/src.
 *
 * @typedef {{ memory: WebAssembly.Memory } & { [name: string]: (...values: number[]) => number }} Exports
 */

/** @type {Exports | undefined} */
let loaded;
/** @type {Promise<void> | undefined} */
let loading;

/** Byte addresses in the module's memory. */
let exchange = 0;
let inputAt = 0;
/** The module's memory has 32-bit addresses. */
const mostInputBytes = 2 ** 32 - 2 ** 16;
let inputBytes = 0;

/** Views of the whole memory, until it grows. */
let float64 = new Float64Array(0);
let float32 = new Float32Array(0);
let uint32 = new Uint32Array(0);
let uint8 = new Uint8Array(0);

// limber::web::Exchange: 2 x 16 numbers of poses, 64 numbers and 32 words of results.
const numbersOffset = 2 * 16 * 8;
const wordsOffset = numbersOffset + 64 * 8;

/** @typedef {(a: number, b: number) => boolean} PairFilter */

/** @type {PairFilter | undefined} */
let filter;
/** @type {unknown} */
let thrownByFilter;

function refreshViews() {
  const { buffer } = module_().memory;
  float64 = new Float64Array(buffer);
  float32 = new Float32Array(buffer);
  uint32 = new Uint32Array(buffer);
  uint8 = new Uint8Array(buffer);
}

const imports = {
  limber: {
    now: () => performance.now(),
    /** @type {(a: number, b: number) => number} */
    filter(a, b) {
      try {
        return /** @type {PairFilter} */ (filter)(a >>> 0, b >>> 0) ? 1 : 0;
      } catch (error) {
        thrownByFilter = error;
        return 2;
      }
    },
  },
  env: { emscripten_notify_memory_growth: refreshViews },
  wasi_snapshot_preview1: {
    /** @type {(status: number) => never} */
    proc_exit(status) {
      throw new Error(`limber3d: the module has ended with status ${status}`);
    },
  },
};

/**
 * @param {URL | string | BufferSource | WebAssembly.Module | Response} [source]
 * @returns {Promise<WebAssembly.Instance>}
 */
async function instantiate(source = new URL("./limber.wasm", import.meta.url)) {
  if (source instanceof WebAssembly.Module) return WebAssembly.instantiate(source, imports);
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) {
    return (await WebAssembly.instantiate(source, imports)).instance;
  }
  if (source instanceof URL && source.protocol === "file:") {
    // Node.js does not fetch files. Bundlers are to leave this alone: the name is none that they see.
    const module = ["node:fs", "promises"].join("/");
    const { readFile } = await import(/* webpackIgnore: true */ /* @vite-ignore */ module);
    /** @type {BufferSource} */
    const bytes = await readFile(source);
    return (await WebAssembly.instantiate(bytes, imports)).instance;
  }
  const response = source instanceof Response ? source : await fetch(source);
  const { ok, status, statusText, url } = response;
  if (!ok) throw new LimberError("unreadableFile", `${url}: ${status} ${statusText}`);
  const type = response.headers.get("Content-Type");
  if (type?.startsWith("application/wasm")) {
    return (await WebAssembly.instantiateStreaming(response, imports)).instance;
  }
  // Servers of development answer with a page where there is no file.
  if (type?.startsWith("text/html")) {
    const hint = "a page of HTML, no WebAssembly; init(source) tells where limber.wasm is";
    throw new LimberError("unreadableFile", `${url}: ${hint}`);
  }
  return (await WebAssembly.instantiate(await response.arrayBuffer(), imports)).instance;
}

/**
 * Loads the engine. Must have finished before anything else is called; later calls do nothing.
 *
 * @param {URL | string | BufferSource | WebAssembly.Module | Response} [source] Where limber.wasm is, its bytes, or the
 *   compiled module: next to this file if nothing is given.
 * @returns {Promise<void>}
 */
export function init(source) {
  loading ??= (async () => {
    try {
      const instance = await instantiate(source);
      loaded = /** @type {Exports} */ (/** @type {unknown} */ (instance.exports));
      loaded._initialize();
      refreshViews();
      exchange = loaded.exchange();
    } catch (error) {
      loading = loaded = undefined;
      throw error;
    }
  })();
  return loading;
}

function module_() {
  if (loaded === undefined) throw new LimberError("notInitialized", "limber3d: await init() comes first");
  return loaded;
}

/**
 * The functions of the module, unless a filter is running.
 *
 * @returns {Exports}
 */
export function engine() {
  if (filter !== undefined) throw new LimberError("busy", "limber3d: a filter may not call the library");
  return loaded ?? module_();
}

/**
 * Throws what a function of the module has reported, unless it has succeeded.
 *
 * @param {number} succeeded
 */
export function check(succeeded) {
  if (succeeded !== 0) return;
  const { errorCode, errorWhere, errorText, errorTextSize } = module_();
  const code = errorCode();
  if (code === filterHasThrown) {
    const error = thrownByFilter;
    thrownByFilter = undefined;
    throw error;
  }
  const begin = errorText() >>> 0;
  const text = new TextDecoder().decode(uint8.slice(begin, begin + errorTextSize()));
  throw new LimberError(codeOf(code), text, errorWhere() < 0 ? undefined : errorWhere());
}

/**
 * Calls a function of the module while `wanted` answers for the pairs of triangles, or of objects.
 *
 * @param {PairFilter | undefined} wanted
 * @param {string} name
 * @param {...number} values
 */
export function callWithFilter(wanted, name, ...values) {
  const { [name]: called } = engine();
  filter = wanted;
  let succeeded;
  try {
    succeeded = called(...values);
  } finally {
    filter = undefined;
  }
  check(succeeded);
}

// --- memory ---

/** Number i of the last result. @param {number} i */
export const number = (i) => float64[((exchange + numbersOffset) >>> 3) + i];

/** Word i of the last result. @param {number} i */
export const word = (i) => uint32[((exchange + wordsOffset) >>> 2) + i];

/** Point i of the last result. @param {number} i @returns {[number, number, number]} */
export function point(i) {
  const at = ((exchange + numbersOffset) >>> 3) + i;
  return [float64[at], float64[at + 1], float64[at + 2]];
}

/**
 * Writes the numbers of the first or second pose, unless a filter is running.
 *
 * @param {number} which
 * @param {readonly number[]} values
 */
export function writePoseNumbers(which, values) {
  engine();
  const at = (exchange >>> 3) + 16 * which;
  for (let i = 0; i < values.length; ++i) float64[at + i] = values[i];
}

/** A copy of bytes of the module's memory. @param {number} begin @param {number} bytes */
export const copyOf = (begin, bytes) => uint8.slice(begin, begin + bytes).buffer;

/**
 * Makes room for arrays that the next call reads, unless a filter is running; returns the address.
 *
 * @param {number} bytes
 */
function reserveInput(bytes) {
  const { reserveInput } = engine();
  if (bytes > mostInputBytes) throw new LimberError("outOfMemory", `limber3d: there is no room for ${bytes} bytes`);
  if (bytes > inputBytes) {
    inputAt = reserveInput(bytes) >>> 0;
    if (inputAt === 0) {
      inputBytes = 0;
      check(0);
    }
    inputBytes = bytes;
  }
  return inputAt;
}

/**
 * Writes coordinates, then ids or bytes, for the next call.
 *
 * @param {Float32Array | Float64Array} coordinates
 * @param {Uint32Array | Uint16Array | Int32Array} [ids]
 */
export function writeInput(coordinates, ids) {
  const at = reserveInput(coordinates.byteLength + (ids === undefined ? 0 : 4 * ids.length));
  if (coordinates instanceof Float32Array) float32.set(coordinates, at >>> 2);
  else float64.set(coordinates, at >>> 3);
  if (ids !== undefined) uint32.set(ids, (at + coordinates.byteLength) >>> 2);
}

/**
 * Writes ids, then other ids, for the next call.
 *
 * @param {Uint32Array | Uint16Array} first
 * @param {Uint32Array | Uint16Array} [second]
 */
export function writeIds(first, second) {
  const at = reserveInput(4 * (first.length + (second?.length ?? 0)));
  uint32.set(first, at >>> 2);
  if (second !== undefined) uint32.set(second, (at >>> 2) + first.length);
}

/**
 * Writes bytes, then other bytes, for the next call.
 *
 * @param {Uint8Array} first
 * @param {Uint8Array} second
 */
export function writeBytes(first, second) {
  const at = reserveInput(first.length + second.length);
  uint8.set(first, at);
  uint8.set(second, at + first.length);
}

// --- owners of objects in the module ---

const registry = new FinalizationRegistry(
  /** @param {{ address: number, free: string }} held */
  ({ address, free }) => loaded?.[free](address),
);

/**
 * Where the object of an argument of that name is in the module's memory.
 *
 * @type {(owner: Owner, name: string) => number}
 */
export let ownedAddress;

/** An object of the module, which dispose() frees. Otherwise it is freed some time after it has become unreachable. */
export class Owner {
  /** @type {number} */
  #address;
  /** @type {string} */
  #free;

  /**
   * @param {number} address 0 if the module could not make it
   * @param {string} free the function that frees it
   * @protected
   */
  constructor(address, free) {
    if (address === 0) check(0);
    this.#address = address;
    this.#free = free;
    registry.register(this, { address, free }, this);
  }

  /** Frees the object's memory. Whatever is called with it afterwards throws; dispose() does nothing. */
  dispose() {
    if (this.#address === 0) return;
    engine()[this.#free](this.#address);
    registry.unregister(this);
    this.#address = 0;
  }

  get isDisposed() {
    return this.#address === 0;
  }

  static {
    ownedAddress = (owner, name) => {
      if (typeof owner !== "object" || owner === null || !(#address in owner)) {
        throw invalid(`${name} is not an object of this package`);
      }
      if (owner.#address === 0) throw new LimberError("disposed", `limber3d: ${name} has been disposed of`);
      return owner.#address;
    };
  }
}
