// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Numbers as people read them. */

/** A number in few digits: 0.4213, 1250, 3.2e-7. */
export function shown(number: number, digits = 5): string {
  if (number === 0) return '0';
  const size = Math.abs(number);
  if (size >= 1e-4 && size < 1e7) return String(Number(number.toPrecision(Math.max(digits, integerDigits(size)))));
  return String(Number(number.toPrecision(digits)).toExponential()).replace('e+', 'e');
}

let unit = '';

/** Sets the unit of lengths, which is none at first. */
export function setUnit(name: string): void {
  unit = name;
}

/** A length in words, with its unit if that is known. */
export const withUnit = (text: string): string => (unit === '' ? text : `${text}\u00a0${unit}`);

/** Which unit lengths are in. */
export const inUnit = (): string => (unit === '' ? 'in the meshes\u2019 unit' : `in ${unit}`);

/** The same where a length stands that does not say its unit; empty if it does. */
export const unitNote = (): string => (unit === '' ? `, ${inUnit()}` : '');

/** A length in few digits. */
export const shownLength = (length: number, digits = 5): string => withUnit(shown(length, digits));

function integerDigits(size: number): number {
  return size < 1 ? 0 : Math.floor(Math.log10(size)) + 1;
}

/** How many there are of what has that name: "1 pair", "2 pairs". */
export const counted = (count: number, name: string): string => `${grouped(count)} ${name}${count === 1 ? '' : 's'}`;

/** A part of one: "10 %". */
export const percent = (part: number): string => `${shown(100 * part)}\u00a0%`;

/** A count in groups of three digits, by narrow spaces that do not break. */
export function grouped(count: number): string {
  return String(count).replace(/\B(?=(\d{3})+$)/g, '\u202f');
}

/** 1, 2 or 5 times a power of ten, the largest that is at most `most`. */
export function roundBelow(most: number): number {
  const power = 10 ** Math.floor(Math.log10(most));
  for (const factor of [5, 2]) {
    if (factor * power <= most) return factor * power;
  }
  return power;
}

/** Multiples of a round step from low to high, at most about `count` of them; no step where there is no range. */
export function ticks(low: number, high: number, count: number): { step: number; values: number[] } {
  let step = high > low ? roundBelow((high - low) / count) : 0;
  if (!(step > 0)) return { step: 0, values: [] };
  while ((high - low) / step > count) step = roundBelow(step * 2.5);
  const first = Math.ceil(low / step - 1e-9);
  const values = Array.from({ length: count + 1 }, (_, i) => (first + i) * step);
  return { step, values: values.filter((value) => value <= high * (1 + 1e-12)) };
}

/** A time in microseconds. */
export function shownTime(microseconds: number): string {
  if (microseconds < 10) return `${microseconds.toFixed(2)}\u00a0\u00b5s`;
  return `${grouped(Math.round(microseconds))}\u00a0\u00b5s`;
}

/** A point in full digits. */
export const shownPoint = (point: readonly number[]): string => point.map(String).join(', ');

/** A text of the terminal as a page has it: numbers do not break, nor from their units, which are µs and not us. */
export const inPage = (text: string): string =>
  text
    .replace(/\b(\d{1,3}) (?=\d{3}\b)/g, '$1\u202f')
    .replace(/(\d) us\b/g, '$1\u00a0\u00b5s')
    .replace(/(\d) %/g, '$1\u00a0%');

/** By the nearest rank: the smallest of the sorted values that at least this part of them is not above. */
export const percentile = (sorted: ArrayLike<number>, part: number): number | undefined =>
  sorted[Math.max(0, Math.ceil(part * sorted.length) - 1)];

/** Of at least one value. */
export const median = (values: readonly number[]): number => percentile(Float64Array.from(values).sort(), 0.5)!;
