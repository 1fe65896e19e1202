// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Numbers as people read them. */

/** A number in few digits: 0.4213, 1250, 3.2e-7. */
export function shown(number: number, digits = 5): string {
  const size = Math.abs(number);
  if (size !== 0 && (size < 1e-4 || size >= 1e7)) {
    return String(Number(number.toPrecision(digits)).toExponential()).replace('e+', 'e');
  }
  return String(Number(number.toPrecision(Math.max(digits, Math.trunc(size).toString().length))));
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

/** A length in few digits. */
export const shownLength = (length: number, digits = 5): string => withUnit(shown(length, digits));

/** How many there are of what has that name: "1 pair", "2 pairs". */
export const counted = (count: number, name: string): string => `${grouped(count)} ${name}${count === 1 ? '' : 's'}`;

/** A part of one: "10 %". */
export const percent = (part: number): string => `${shown(100 * part)}\u00a0%`;

/** A count in groups of three digits, by narrow spaces that do not break. */
export const grouped = (count: number): string => String(count).replace(/\B(?=(\d{3})+$)/g, '\u202f');

/** A time in microseconds. */
export const shownTime = (us: number): string => `${us < 10 ? us.toFixed(2) : grouped(Math.round(us))}\u00a0\u00b5s`;

/** A point in full digits. */
export const shownPoint = (point: readonly number[]): string => point.map(String).join(', ');

/** A text of the terminal as a page has it: numbers do not break, nor from their units, which are µs and not us. */
export const inPage = (text: string): string =>
  text
    .replace(/\b(\d{1,3}) (?=\d{3}\b)/g, '$1\u202f')
    .replace(/(\d) us\b/g, '$1\u00a0\u00b5s')
    .replace(/(\d) %/g, '$1\u00a0%');

/** Of at least one value: the smallest that at least half of them are not above. */
export const median = (values: readonly number[]): number =>
  Float64Array.from(values).sort()[Math.ceil(values.length / 2) - 1];
