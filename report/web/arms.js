// SPDX-License-Identifier: BSD-3-Clause
// One arm, or two at one time: their poses at a row, what is between them, and what the view shows.
import { Nearness, placesOf } from './nearness.js';
import { number } from './page.js';
import {
  indexAt,
  jointsOf,
  offPath,
  placeWords,
  poseAt,
  rowOf,
  stepsOf,
  valueAt,
} from './poses.js';

/**
 * Rows of one number are simultaneous, and places on the slider are their numbers. It has all that
 * main.js asks of what is shown, as Strokes has.
 */
export class Arms {
  /** data: of the page, of one arm or with `arms`. */
  constructor(data) {
    const { arms = [data], between = [], conflict = null, result, near } = data;
    Object.assign(this, { data, between, conflict, gap: gapOf(between), showsOne: false });
    this.paths = arms.map((arm, k) => ({
      ...arm,
      label: arm.name ?? '',
      result: result.arms?.[k] ?? result,
      steps: stepsOf(arm.rows, arm.chain),
    }));
    this.both = arms.length > 1;
    this.last = Math.max(...arms.map(({ rows }) => rows.length - 1));
    this.end = Math.max(0, this.last);
    this.moves = this.last >= 0;
    // A motion takes its own time at speed 1, paths without one eight seconds.
    this.seconds = 8;
    const timed = arms.every(({ motion }) => motion);
    // The speed of a follower's tool is bounded on its leader's; the plot is of the base frame.
    this.motions = timed
      ? this.paths.map(({ motion, leader, label }, k) => ({
          motion,
          label,
          speed:
            (leader ?? null) === null
              ? 1e3 * (result.motion.arms?.[k] ?? result.motion).speed
              : null,
        }))
      : [];
    this.jointsAt = timed && arms.map(({ motion, chain }) => jointsOf(motion, chain));
    this.duration = timed ? arms[0].motion.t.at(-1) : null;
    const rows = Array.from({ length: this.last + 1 }, (_, row) => `row ${row}`);
    this.nearness = new Nearness(near, this.both ? rows : placesOf(data.rows));
  }
  /** The place on the slider, or that of one of several arms in its rows, at a motion's time. */
  placeAt(t, arm = 0) {
    const { motion } = this.paths[arm];
    return valueAt(motion.layers, indexAt(motion.t, t));
  }
  /** The time at which the first arm is at a place in its rows. */
  timeOf(x) {
    const { t, layers } = this.paths[0].motion;
    return valueAt(t, indexAt(layers, x));
  }
  /** The place on the slider of a row of an arm. */
  markOf(arm, row) {
    return row;
  }
  /** The row of an arm at a place, not always whole, nor one that the arm has. */
  rowAt(arm, x) {
    return x;
  }
  /** The path that is shown at a place, where one is at a time. */
  pathAt() {
    return null;
  }
  stepFrom(x, by) {
    return Math.round(x) + by;
  }
  /**
   * All arms at a place, not always whole; an arm whose path has ended rests there. t: of the
   * motion, at which the arms may be at places that differ a little, or null.
   */
  posesAt(x, t = null) {
    return this.paths.map(({ rows, steps, cut, chain }, path) => {
      if (rows.length) {
        const place = t === null || !this.both ? x : this.placeAt(t, path),
          pose = { ...poseAt(rows, steps, Math.min(place, rows.length - 1)), path };
        return t === null ? pose : { ...pose, q: this.jointsAt[path](t) };
      }
      if (cut) return { ...offPath(cut, null), path };
      const q = chain.joints.map(() => 0),
        note = 'no pose: drawn with all joints at 0';
      return { q, row: null, pair: null, line: null, hit: false, off: true, note, path };
    });
  }
  /** One arm at a pose off its path, the other where it is meanwhile. */
  posesBeside(pose) {
    const other = this.paths[1 - pose.path]?.rows ?? [],
      poses = this.posesAt(rowOf(other, pose.layer) ?? Math.max(0, other.length - 1));
    poses[pose.path] = pose;
    return poses;
  }
  /** Whether the cheapest paths meet at a place. */
  meetsAt(x) {
    return this.conflict !== null && Math.abs(x - this.conflict.row) < 1e-6;
  }
  /** What is between the arms at a place: that of the nearest row; null where nothing is known. */
  betweenAt(x) {
    const near = this.between[Math.round(x)];
    if (this.meetsAt(x) && !this.conflict.of_motion) {
      const { pair, nearest, text } = this.conflict,
        line = nearest && { points: nearest, text };
      return { mm: near?.mm ?? null, pair, line, hit: true, note: meetingWords(this.conflict) };
    }
    if (!near) return null;
    const { mm, asked_mm, pair, nearest } = near;
    // On the way between two rows nothing is known but the bodies.
    if (this.meetsAt(x))
      return {
        mm,
        pair: this.conflict.pair,
        line: null,
        hit: true,
        note: meetingWords(this.conflict),
      };
    return {
      mm,
      pair,
      hit: mm < asked_mm - 0.051, // the check forgives 0.05 mm
      line: nearest && { points: nearest, text: mm > 0 ? `${number(mm, 3)} mm` : 'they touch' },
      note:
        `arms ${mm > 0 ? `${number(mm, 4)} mm apart` : 'touch'} (asked ${number(asked_mm)}): ` +
        pair.join(' – '),
    };
  }
  /** What is nearest to a body, at a place and along all rows. */
  nearLines(name, poses, x) {
    const row = poses.some(({ off }) => off) ? null : x,
      isWhole = Number.isInteger(row) && !(this.both && this.duration !== null);
    return this.nearness.lines(name, row, this.both ? 'along the paths' : undefined, isWhole);
  }
  /** Where a pose is, in words. */
  whereWords(pose) {
    return pose.s === undefined ? '' : placeWords(pose, this.paths[pose.path].map, 4);
  }
  /** A place and a time: in full, and as short as beside the slider. */
  told(x, t) {
    const isTimed = this.duration !== null,
      place = this.both
        ? `row ${Math.round(x)} of ${this.last}`
        : `s ${valueAt(placesS(this.data), x).toFixed(3)} m`;
    return [
      `${place}${isTimed ? `, ${t.toFixed(2)} s` : ''}`,
      `${Math.round(x)} / ${this.last}` +
        `${isTimed ? `, ${t.toFixed(2)} / ${number(this.duration)} s` : ''}`,
    ];
  }
  /** What an address says of a place, and the place that one names (#s=0.34, #row=12), or null. */
  address(x) {
    return this.both ? `row=${Math.round(x)}` : `s=${valueAt(placesS(this.data), x).toFixed(4)}`;
  }
  addressed(named) {
    const value = Number(named.get(this.both ? 'row' : 's') ?? NaN);
    if (!Number.isFinite(value) || !this.moves) return null;
    if (this.both) return value;
    const all = placesS(this.data);
    return all.length > 1 && value > all[0] ? indexAt(all, value) : 0;
  }
  /** The pose past the end of an arm's paths, or where both meet, as the view takes it. */
  barred() {
    const joined = (poses) => poses.flatMap(({ q }) => q);
    if (this.conflict) {
      const { row, pair } = this.conflict;
      return { q: joined(this.posesAt(row)), pair, line: this.betweenAt(row)?.line ?? null };
    }
    const path = this.paths.findIndex(({ cut }) => cut);
    if (path < 0) return null;
    const pose = { ...offPath(this.paths[path].cut, null), path };
    return { ...pose, q: joined(this.posesBeside(pose)) };
  }
  /** What the view shows. */
  scene() {
    if (!this.both) return this.data;
    const { paths, between } = this;
    const rows = Array.from({ length: this.last + 1 }, (_, k) => ({
      q: this.posesAt(k).flatMap(({ q }) => q),
      pair: between[k]?.pair ?? null,
      nearest: between[k]?.nearest ?? null,
      clearance_mm: between[k]?.mm,
    }));
    return {
      ...this.data,
      rows,
      cut: this.barred(),
      tool_path: paths.flatMap(({ tool_path }) => tool_path),
      paths: paths.map(({ on_leader, tool_path }) => on_leader ?? tool_path),
      on: paths.map(({ leader }) => leader),
      ways: paths.filter(({ on_leader }) => on_leader).map(({ tool_path }) => tool_path),
    };
  }
}

/** What is plotted between the arms along their rows; null where nothing is known. */
function gapOf(between) {
  if (!between.length) return null;
  // A bound is drawn where it is the same in all rows.
  const asked = new Set(between.map(({ asked_mm }) => asked_mm));
  return {
    title: 'clearance between the arms',
    unit: 'mm',
    values: between.map(({ mm }) => mm),
    of: ({ mm }) => mm,
    low: asked.size === 1 ? [...asked][0] : null,
    high: null,
    from0: true,
  };
}
const placesS = ({ rows }) => rows.map(({ s }) => s);
const meetingWords = ({ pair, text, of_motion }) =>
  `the arms meet${of_motion ? ' on the way to the next row' : ''}: ${pair.join(' – ')}` +
  (text ? ` (${text})` : '');
