// SPDX-License-Identifier: BSD-3-Clause
// Strokes one after the other, by one arm: a job's parts in their order, and what the view shows.
import { Nearness, nearWords, nearWordsAt, placesOf } from './nearness.js';
import { number } from './page.js';
import { indexAt, jointsOf, placeWords, poseAt, stepBetween, stepsOf, valueAt } from './poses.js';

const kSame = 1e-6, // of a place in rows
  kApart = 1, // degrees on the slider between strokes that no transition joins
  kBetween = { path: null, row: null, pair: null, line: null, hit: false, off: false }; // a pose

/** `3 door (backwards)`: what a stroke is called. */
export const strokeName = ({ name, reversed }, k) =>
  `${k + 1} ${name}${reversed ? ' (backwards)' : ''}`;

/**
 * Places on the slider are times, or degrees that the fastest joint moves. It has all that main.js
 * asks of what is shown, as Arms has.
 */
export class Strokes {
  /**
   * data: of the page. Each part gets { stroke, rows, first, last (places of its ends in all rows),
   * from, to, opens (on the slider: its ends, and where it is shown), title, name }.
   */
  constructor(data) {
    const { strokes, parts, motion, result, chain } = data;
    Object.assign(this, { data, showsOne: true, conflict: null, between: [], gap: null });
    this.paths = strokes.map((stroke) => ({
      ...stroke,
      chain,
      label: '',
      result: stroke.run,
      steps: stepsOf(stroke.rows, chain),
    }));
    this.nearness = strokes.map(({ near, rows }) => new Nearness(near, placesOf(rows)));
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
      return {
        ...part,
        rows,
        first,
        last: first + rows.length - 1,
        title: this.title(parts, p),
        name: part.stroke === null ? '' : this.title(parts, p),
      };
    });
    this.moves = parts.length > 0;
    this.motions = motion ? [{ motion, label: '', speed: null }] : [];
    this.joints = motion && jointsOf(motion, chain);
    this.places = motion?.layers ?? this.rows.map((_, k) => k);
    this.marks = motion?.t ?? this.travel();
    this.end = this.marks.at(-1) ?? 0;
    this.duration = motion && this.end;
    // A motion takes its own time at speed 1, a job without one four seconds a part.
    this.seconds = 4 * parts.length;
    this.parts.forEach((part, p) => {
      part.from = motion ? motion.begin[p] : this.marks[part.first];
      part.to = motion ? (motion.begin[p + 1] ?? this.end) : this.marks[part.last];
      part.opens = part.stroke === null ? (part.from + part.to) / 2 : part.from;
    });
    this.process = motion ? this.switched(result.motion.events) : this.processed();
  }
  title(parts, p) {
    const { stroke } = parts[p];
    if (stroke !== null) return strokeName(this.paths[stroke], stroke);
    const next = parts[p + 1]?.stroke;
    return next === undefined ? 'way home' : `transition to ${strokeName(this.paths[next], next)}`;
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
  /** A time is a place on the slider where there is a motion. */
  placeAt(t) {
    return t;
  }
  timeOf(x) {
    return x;
  }
  /** The place in all rows, not always whole, at a place on the slider; and the other way round. */
  placeOf(x) {
    return valueAt(this.places, indexAt(this.marks, x));
  }
  markOfPlace(place) {
    return valueAt(this.marks, indexAt(this.places, place));
  }
  /** The place on the slider of a row of a stroke. */
  markOf(stroke, row) {
    const { first, from } = this.parts.find((part) => part.stroke === stroke);
    return row ? this.markOfPlace(first + row) : from;
  }
  /** The stroke whose map is shown at a place: its own, or that to which a transition leads. */
  pathAt(x) {
    const part = this.partAt(x),
      isStroke = ({ stroke }) => stroke !== null;
    return (this.parts.slice(part).find(isStroke) ?? this.parts.findLast(isStroke)).stroke;
  }
  /** The row of a stroke at a place on the slider, not always whole; NaN elsewhere. */
  rowAt(stroke, x) {
    const part = this.parts[this.partAt(x)];
    return part?.stroke === stroke ? this.placeOf(x) - part.first : NaN;
  }
  stepFrom(x, by) {
    return this.markOfPlace(Math.round(this.placeOf(x)) + by);
  }
  /** The number of the part at a place on the slider; of a stroke where two parts meet. */
  partAt(x) {
    const place = this.placeOf(x),
      inside = this.parts.map(({ first, last }) => place >= first - kSame && place <= last + kSame);
    const stroke = this.parts.findIndex(({ stroke }, p) => inside[p] && stroke !== null);
    if (stroke >= 0) return stroke;
    return inside.includes(true)
      ? inside.indexOf(true)
      : this.parts.findLastIndex(({ first }) => first <= place);
  }
  /**
   * The pose at a place on the slider, in a list; part: the number of its part; path: its stroke,
   * null in transitions. Null where there is none.
   */
  posesAt(x) {
    if (this.moves) {
      const pose = this.poseOfRows(x);
      return [this.joints ? { ...pose, q: this.joints(x) } : pose];
    }
    const { home } = this.data;
    if (!home) return null;
    const note = home.pair ? `at home ${home.pair.join(' – ')} come too near` : 'home';
    return [{ ...kBetween, q: home.q, pair: home.pair, hit: home.pair !== null, note }];
  }
  poseOfRows(x) {
    const part = this.partAt(x),
      { stroke, rows, first, barred_by } = this.parts[part],
      at = Math.min(rows.length - 1, Math.max(0, this.placeOf(x) - first)),
      where = { part, path: stroke };
    if (stroke !== null) return { ...poseAt(rows, this.paths[stroke].steps, at), ...where };
    const q = rows[0].q.map((_, j) =>
      valueAt(
        rows.map((row) => row.q[j]),
        at,
      ),
    );
    return { ...kBetween, q, ...where, note: barred_by ? `around ${barred_by.join(' – ')}` : '' };
  }
  /** A pose off the rows is all that is shown then. */
  posesBeside(pose) {
    return [pose];
  }
  betweenAt() {
    return null;
  }
  /** What is nearest to a body, at a pose on a stroke and along all strokes. */
  nearLines(name, [{ off, row, path }]) {
    const known = this.nearness
      .map((one, k) => ({ near: one.least(name), k }))
      .filter(({ near }) => near)
      .sort((a, b) => a.near.mm - b.near.mm);
    if (!known.length) return [];
    const [{ near, k }] = known,
      here = off || row === null ? null : this.nearness[path].at(name, Math.round(row));
    const lines = [`nearest on strokes: ${nearWordsAt(near, strokeName(this.paths[k], k))}`];
    if (here) lines.unshift(Number.isInteger(row) ? nearWords(here) : nearWordsAt(here));
    return lines;
  }
  /** Where a pose is, in words: of which part, at which s. */
  whereWords(pose, x) {
    const { part, path, off } = pose,
      place = () => placeWords(pose, this.paths[path].map, 4);
    if (off) return place();
    if (part === undefined) return '';
    const { title } = this.parts[part];
    return path === null
      ? title
      : `${title}   process ${this.processOn(x) ? 'on' : 'off'}\n${place()}`;
  }
  /** A place on the slider: in full, and as short as beside it. */
  told(x) {
    const part = this.partAt(x),
      { title } = this.parts[part];
    return this.joints
      ? [`${title}, ${x.toFixed(2)} s`, `${x.toFixed(2)} / ${number(this.end)} s`]
      : [title, `part ${part + 1} / ${this.parts.length}`];
  }
  /** An address names a part (#part=3); it does not follow the cursor. */
  address() {
    return null;
  }
  addressed(named) {
    return this.parts[Number(named.get('part')) - 1]?.opens ?? null;
  }
  /** What the view shows. */
  scene() {
    const begin = ({ rows, tool_path }) =>
      tool_path[
        Math.max(
          0,
          rows.findIndex(({ process }) => process),
        )
      ];
    const { data, paths, parts } = this;
    return {
      ...data,
      rows: this.rows,
      cut: paths.find(({ cut }) => cut)?.cut ?? data.home,
      tool_path: paths.flatMap(({ tool_path }) => tool_path),
      paths: paths.map(({ tool_path }) => tool_path),
      moves: parts
        .filter(({ stroke }) => stroke === null)
        .map(({ rows }) => rows.map(({ q }) => q)),
      numbers: paths.map((one, k) => ({ text: String(k + 1), point: begin(one) })),
    };
  }
}
