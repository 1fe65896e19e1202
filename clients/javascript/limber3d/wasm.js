// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The WebAssembly module: how it is loaded, called and read. Private to the package, but for init().

import { LimberError, codeOf, invalid } from "./errors.js";

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

// limber::web::Exchange: 2 x 16 numbers of poses, 8 numbers, and the table of one answer.
const numbersOffset = 2 * 16 * 8;
const answerOffset = numbersOffset + 8 * 8;

/**
 * The columns of each table, in order, as clients/javascript/src/tables.h lists them.
 *
 * @type {{ [table: string]: [name: string, kind: keyof typeof kinds, numbersPerAnswer: number][] }}
 */
let tables = {};
const kinds = { Float64Array, Uint32Array, Uint8Array };
/** Views of the tables of one answer, until memory grows. @type {{ [table: string]: any }} */
let rows = {};

function refreshViews() {
  const { buffer } = engine().memory;
  float64 = new Float64Array(buffer);
  float32 = new Float32Array(buffer);
  uint32 = new Uint32Array(buffer);
  uint8 = new Uint8Array(buffer);
  rows = {};
}

const imports = {
  limber: { now: () => performance.now() },
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
      check(loaded.tables());
      tables = JSON.parse(givenText());
    } catch (error) {
      loading = loaded = undefined;
      throw error;
    }
  })();
  return loading;
}

/** The functions of the module. @returns {Exports} */
export function engine() {
  if (loaded === undefined) throw new LimberError("notInitialized", "limber3d: await init() comes first");
  return loaded;
}

/**
 * Throws what a function of the module has reported, unless it has succeeded.
 *
 * @param {number} succeeded
 */
export function check(succeeded) {
  if (succeeded !== 0) return;
  const { errorCode, errorWhere, errorText } = engine();
  errorText();
  throw new LimberError(codeOf(errorCode()), givenText(), errorWhere() < 0 ? undefined : errorWhere());
}

// --- reading ---

/** Number i that the last call has given. @param {number} i */
export const number = (i) => float64[((exchange + numbersOffset) >>> 3) + i];

/** A copy of the bytes that the last call has given. */
export const givenBytes = () => uint8.slice(number(0), number(0) + number(1)).buffer;

const givenText = () => new TextDecoder().decode(givenBytes());

/**
 * Adds the arrays of a table to an object, under their names.
 *
 * @param {any} object
 * @param {string} table
 * @param {number} count of answers
 * @param {ArrayBuffer} buffer
 * @param {number} begin
 */
function addArrays(object, table, count, buffer, begin) {
  let at = begin;
  for (const [name, kind, numbersPerAnswer] of tables[table]) {
    const array = new kinds[kind](buffer, at, numbersPerAnswer * count);
    object[name] = array;
    at += 8 * Math.ceil(array.byteLength / 8);
  }
  return object;
}

/** The last answer, as arrays in the module's memory that the next call changes. @param {string} table */
export const row = (table) => (rows[table] ??= addArrays({}, table, 1, float64.buffer, exchange + answerOffset));

/** Adds a copy of the last answers to an object. @param {object} object @param {string} table @param {number} count */
export const addColumns = (object, table, count) => addArrays(object, table, count, givenBytes(), 0);

// --- writing ---

/**
 * Writes the numbers of the first or second pose.
 *
 * @param {number} which
 * @param {readonly number[]} values
 */
export function writePoseNumbers(which, values) {
  engine();
  const at = (exchange >>> 3) + 16 * which;
  for (let i = 0; i < values.length; ++i) float64[at + i] = values[i];
}

/**
 * Makes room for arrays that the next call reads; returns the address.
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
 * Writes numbers, then ids, for the next call.
 *
 * @param {Float32Array | Float64Array} numbers
 * @param {Uint32Array | Uint16Array} [ids]
 */
export function writeInput(numbers, ids) {
  const at = reserveInput(numbers.byteLength + (ids === undefined ? 0 : 4 * ids.length));
  if (numbers instanceof Float32Array) float32.set(numbers, at >>> 2);
  else float64.set(numbers, at >>> 3);
  if (ids !== undefined) uint32.set(ids, (at + numbers.byteLength) >>> 2);
}

// --- owners of objects in the module ---

const registry = new FinalizationRegistry((/** @type {number} */ address) => loaded?.release(address));

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

  /** @param {number} address 0 if the module could not make it @protected */
  constructor(address) {
    if (address === 0) check(0);
    this.#address = address;
    registry.register(this, address, this);
  }

  /** Frees the object's memory. Whatever is called with it afterwards throws; dispose() does nothing. */
  dispose() {
    if (this.#address === 0) return;
    engine().release(this.#address);
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
