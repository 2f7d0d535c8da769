// SPDX-License-Identifier: BSD-3-Clause
// How near bodies come to those that they must keep clear of, row by row.
import { samples } from './bytes.js';
import { number } from './page.js';

const kMicrometre = 1e-3; // mm

export class Nearness {
  /**
   * near: { names, distance, other } of the page's data (src/page/page_rows.cpp), or null; places:
   * of each of its rows, in words.
   */
  constructor(near, places) {
    this.places = near ? places : [];
    this.names = near?.names ?? [];
    [this.distances, this.others] = near
      ? [near.distance, near.other].map((place) => samples(place, near.names.length))
      : [[], []];
  }
  /** The nearest of all to a body at a row: { mm, other, place }; null where nothing is known. */
  at(name, row) {
    const body = this.names.indexOf(name);
    if (body < 0 || !this.places[row]) return null;
    const k = row * this.names.length + body;
    return {
      mm: kMicrometre * this.distances[k],
      other: this.names[this.others[k]],
      place: this.places[row],
    };
  }
  /** As at(), of the first row at which the body is nearest to something. */
  least(name) {
    return this.places.reduce((best, _, row) => {
      const here = this.at(name, row);
      return here && (!best || here.mm < best.mm) ? here : best;
    }, null);
  }
  /**
   * What is nearest to a body at a row, not always whole, or null off the rows, and at all of them
   * (`along`), a line each. isWhole: whether the pose that is shown is that of the row.
   */
  lines(name, row, along = 'along the path', isWhole = Number.isInteger(row)) {
    const least = this.least(name),
      here = row === null ? null : this.at(name, Math.round(row));
    if (!least) return [];
    const lines = [`nearest ${along}: ${nearWordsAt(least)}`];
    if (here) lines.unshift(isWhole ? nearWords(here) : nearWordsAt(here));
    return lines;
  }
}

/** The places of rows of one path, in words. */
export const placesOf = (rows) => rows.map(({ s }) => `s ${s.toFixed(4)} m`);
/** What is nearest to a body, in words. near: of Nearness. */
export const nearWords = ({ mm, other }) =>
  mm > 0 ? `${number(mm, 3)} mm from ${other}` : `touches ${other}`;
/** As nearWords(), with where that is. */
export const nearWordsAt = (near, stroke = '') =>
  `${nearWords(near)} at ${near.place}${stroke && ` of ${stroke}`}`;
