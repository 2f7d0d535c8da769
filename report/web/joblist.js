// SPDX-License-Identifier: BSD-3-Clause
// A job's parts in their order, its rows one after the other, and places on its slider.
import { indexAt, jointsOf, poseAt, stepBetween, stepsOf, valueAt } from './poses.js';

const kSame = 1e-6, // of a place in rows
  kApart = 1; // degrees on the slider between strokes that no transition joins

/** `3 door (backwards)`: what a stroke is called. */
export const strokeName = ({ name, reversed }, k) =>
  `${k + 1} ${name}${reversed ? ' (backwards)' : ''}`;

export class JobList {
  /**
   * data: of the page. Each part gets { stroke, rows, first, last (places of its ends in all rows),
   * from, to (on the slider: s in time, or degrees that the fastest joint moves), title }.
   */
  constructor({ strokes, parts, motion, result, chain }) {
    this.strokes = strokes.map((stroke) => ({ ...stroke, steps: stepsOf(stroke.rows) }));
    this.rows = [];
    // The parts of a job have their ends in common; strokes without a job are shown one by one.
    const joined = result.cost !== null;
    this.parts = parts.map((part, p) => {
      const rows = part.stroke === null ? part.rows : strokes[part.stroke].rows,
        shared = joined && p > 0;
      const first = this.rows.length - (shared ? 1 : 0);
      // A stroke's row says more than that of a transition.
      if (shared && part.stroke !== null) this.rows.pop();
      this.rows.push(...(shared && part.stroke === null ? rows.slice(1) : rows));
      return { ...part, rows, first, last: first + rows.length - 1, title: this.title(parts, p) };
    });
    this.timed = motion !== null;
    this.joints = motion && jointsOf(motion, chain);
    this.places = motion?.layers ?? this.rows.map((_, k) => k);
    this.marks = motion?.t ?? this.travel();
    this.end = this.marks.at(-1) ?? 0;
    this.parts.forEach((part, p) => {
      part.from = motion ? motion.begin[p] : this.marks[part.first];
      part.to = motion ? (motion.begin[p + 1] ?? this.end) : this.marks[part.last];
    });
    this.process = this.timed ? this.switched(result.motion.events) : this.processed();
  }
  title(parts, p) {
    const { stroke } = parts[p];
    if (stroke !== null) return strokeName(this.strokes[stroke], stroke);
    const next = parts[p + 1]?.stroke;
    return next === undefined
      ? 'way home'
      : `transition to ${strokeName(this.strokes[next], next)}`;
  }
  /** How far the joint that moves most has moved up to each row, degrees. */
  travel() {
    const begins = new Set(this.parts.map(({ first }) => first)),
      ends = new Set(this.parts.map(({ last }) => last));
    let sum = 0;
    return this.rows.map((row, k) => {
      const apart = begins.has(k) && !ends.has(k); // from the end of another part
      return (sum += !k ? 0 : apart ? kApart : stepBetween(this.rows[k - 1], row));
    });
  }
  /** [from, to] of where the process is on, by the events of a motion. */
  switched(events) {
    const on = events.filter(({ process }) => process === 'on'),
      off = events.filter(({ process }) => process === 'off');
    return on.map(({ t }, k) => [t, off[k]?.t ?? this.end]);
  }
  /** [from, to] of where the process is on, by the rows of strokes. */
  processed() {
    return this.parts
      .filter(({ rows, stroke }) => stroke !== null && rows.some(({ process }) => process))
      .map(({ first, rows }) => [
        this.marks[first + rows.findIndex(({ process }) => process)],
        this.marks[first + rows.findLastIndex(({ process }) => process)],
      ]);
  }
  processOn(x) {
    return this.process.some(([from, to]) => x >= from - kSame && x <= to + kSame);
  }
  /** The place in all rows, not always whole, at a place on the slider; and the other way round. */
  placeOf(x) {
    return valueAt(this.places, indexAt(this.marks, x));
  }
  markOf(place) {
    return valueAt(this.marks, indexAt(this.places, place));
  }
  /** The number of the part in which a place is; of a stroke where two parts meet. */
  partAt(place) {
    const inside = this.parts.map(
      ({ first, last }) => place >= first - kSame && place <= last + kSame,
    );
    const stroke = this.parts.findIndex(({ stroke }, p) => inside[p] && stroke !== null);
    if (stroke >= 0) return stroke;
    return inside.includes(true)
      ? inside.indexOf(true)
      : this.parts.findLastIndex(({ first }) => first <= place);
  }
  /**
   * The pose at a place on the slider; part: the number of its part; row: in a stroke, null in
   * transitions.
   */
  poseAt(x) {
    const pose = this.poseOfRows(this.placeOf(x));
    return this.timed ? { ...pose, q: this.joints(x) } : pose;
  }
  /** As poseAt(), at a place in all rows. */
  poseOfRows(place) {
    const part = this.partAt(place),
      { stroke, rows, first } = this.parts[part],
      at = Math.min(rows.length - 1, Math.max(0, place - first));
    if (stroke !== null) return { ...poseAt(rows, this.strokes[stroke].steps, at), part, stroke };
    const q = rows[0].q.map((_, j) =>
      valueAt(
        rows.map((row) => row.q[j]),
        at,
      ),
    );
    const note = this.parts[part].barred_by
      ? `around ${this.parts[part].barred_by.join(' – ')}`
      : '';
    return { q, part, stroke, row: null, pair: null, line: null, hit: false, off: false, note };
  }
  /** The stroke whose map belongs to a part: its own, or that to which a transition leads. */
  strokeOf(part) {
    const next = this.parts.slice(part).find(({ stroke }) => stroke !== null);
    return (next ?? this.parts.findLast(({ stroke }) => stroke !== null)).stroke;
  }
}
