// SPDX-License-Identifier: BSD-3-Clause
// Two arms at one time: the poses of both at a row, what is between them, and what the view shows.
import { number } from './page.js';
import { indexAt, jointsOf, offPath, poseAt, rowOf, stepsOf, valueAt } from './poses.js';

/** The arms of a workcell with their rows, of which those of one number are simultaneous. */
export class Pair {
  /** data: of the page. */
  constructor({ arms, between, conflict }) {
    Object.assign(this, { between, conflict });
    this.arms = arms.map((arm) => ({ ...arm, steps: stepsOf(arm.rows) }));
    this.last = Math.max(...arms.map(({ rows }) => rows.length - 1));
    this.timed = arms.every(({ motion }) => motion);
    this.jointsAt = this.timed && this.arms.map(({ motion, chain }) => jointsOf(motion, chain));
    this.end = this.timed ? arms[0].motion.t.at(-1) : null;
  }
  /** The place of an arm in its rows at a time of the motion. */
  placeAt(arm, t) {
    const { motion } = this.arms[arm];
    return valueAt(motion.layers, indexAt(motion.t, t));
  }
  /** The time at which the first arm is at a place in its rows. */
  timeOf(k) {
    const { t, layers } = this.arms[0].motion;
    return valueAt(t, indexAt(layers, k));
  }
  /** Whether there is anything to play. */
  get moves() {
    return this.last >= 0;
  }
  /**
   * Both arms at row k, not always whole; an arm whose path has ended rests there. t: of the
   * motion, at which the arms may be at places that differ a little, or null.
   */
  posesAt(k, t = null) {
    return this.arms.map(({ rows, steps, cut, chain }, arm) => {
      const at = t === null ? k : this.placeAt(arm, t);
      if (rows.length) {
        const pose = poseAt(rows, steps, Math.min(at, rows.length - 1));
        return t === null ? pose : { ...pose, q: this.jointsAt[arm](t) };
      }
      if (cut) return offPath(cut, null);
      const q = chain.joints.map(() => 0),
        note = 'no pose: drawn with all joints at 0';
      return { q, row: null, pair: null, line: null, hit: false, off: true, note };
    });
  }
  /** One arm at a pose off its path, the other where it is meanwhile. */
  posesBeside(arm, pose) {
    const { rows } = this.arms[1 - arm],
      poses = this.posesAt(rowOf(rows, pose.layer) ?? Math.max(0, rows.length - 1));
    poses[arm] = pose;
    return poses;
  }
  /** Whether row k is where the cheapest paths meet. */
  meetsAt(k) {
    return this.conflict !== null && Math.abs(k - this.conflict.row) < 1e-6;
  }
  /** What is between the arms at row k: that of the nearest row; null where nothing is known. */
  betweenAt(k) {
    const near = this.between[Math.round(k)];
    if (this.meetsAt(k) && !this.conflict.of_motion) {
      const { pair, nearest, text } = this.conflict,
        line = nearest && { points: nearest, text };
      return { mm: near?.mm ?? null, pair, line, hit: true, note: meetingWords(this.conflict) };
    }
    if (!near) return null;
    const { mm, asked_mm, pair, nearest } = near;
    // On the way between two rows nothing is known but the bodies.
    if (this.meetsAt(k))
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
  /** The values between the arms, one a row; nulls where nothing is known. */
  get gaps() {
    return Array.from({ length: this.last + 1 }, (_, k) => this.between[k]?.mm ?? null);
  }
  /** What the arms are asked to keep from each other in all rows, mm; null where rows differ. */
  get asked() {
    const all = new Set(this.between.map(({ asked_mm }) => asked_mm));
    return all.size === 1 ? [...all][0] : null;
  }
  /** Joints of both arms, one after the other. */
  joints(poses) {
    return poses.flatMap(({ q }) => q);
  }
  /** The pose past the end of an arm's paths, or where both meet, as the view takes it. */
  barred() {
    if (this.conflict) {
      const at = this.betweenAt(this.conflict.row);
      return {
        q: this.joints(this.posesAt(this.conflict.row)),
        pair: this.conflict.pair,
        line: at?.line ?? null,
      };
    }
    const arm = this.arms.findIndex(({ cut }) => cut);
    if (arm < 0) return null;
    const pose = offPath(this.arms[arm].cut, null);
    return { ...pose, q: this.joints(this.posesBeside(arm, pose)) };
  }
  /** What the view shows of both. data: of the page. */
  scene(data) {
    const { arms, between } = this;
    const rows = Array.from({ length: this.last + 1 }, (_, k) => ({
      q: this.joints(this.posesAt(k)),
      pair: between[k]?.pair ?? null,
      nearest: between[k]?.nearest ?? null,
      clearance_mm: between[k]?.mm,
    }));
    return {
      ...data,
      rows,
      cut: this.barred(),
      tool_path: arms.flatMap(({ tool_path }) => tool_path),
      paths: arms.map(({ on_leader, tool_path }) => on_leader ?? tool_path),
      on: arms.map(({ leader }) => leader),
      ways: arms.filter(({ on_leader }) => on_leader).map(({ tool_path }) => tool_path),
    };
  }
}

const meetingWords = ({ pair, text, of_motion }) =>
  `the arms meet${of_motion ? ' on the way to the next row' : ''}: ${pair.join(' – ')}` +
  (text ? ` (${text})` : '');
