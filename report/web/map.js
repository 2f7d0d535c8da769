// SPDX-License-Identifier: BSD-3-Clause
// What the search knows of the lattice: the cells of the (s, phi) map, decoded.
import { bytes, poseValues } from './bytes.js';
import { number } from './page.js';
import { kKnown, kObjects } from './palette.js';

// States in the order of report/lattice_map.hpp.
export const [NO_IK, SINGULAR, LIMIT, UNSEEN, FREE, BLOCKED] = [0, 1, 2, 3, 4, 5];
const kState = 7,
  kAgain = 32,
  kCertified = 64,
  kPosed = 128,
  kUnknown = 65535;
/** The unit of a map's coordinate, and what a value is multiplied with to have it. */
export const unitOf = ({ slides }) =>
  slides ? { unit: 'm', scale: 1 } : { unit: 'deg', scale: 180 / Math.PI };
/** An angle less its whole turns. */
export const wrapped = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));

export class Cells {
  /** objects: names of the scene's objects, in its order. */
  constructor(map, joints, objects) {
    Object.assign(this, map, { objects });
    this.jointNames = joints.map(({ name }) => name);
    this.states = new Uint8Array(bytes(map.states));
    this.causes = new Uint8Array(bytes(map.causes));
    this.clearances = new Uint16Array(bytes(map.clearances));
    this.poseLayers = new Uint16Array(bytes(map.pose_layers)); // counted from the cell's first
    this.posePhis = new Float32Array(bytes(map.pose_phis));
    // None where the tool has no roll to choose.
    this.poseRolls = new Float32Array(bytes(map.pose_rolls));
    this.pose = new Int32Array(this.states.length); // which of the poses is a cell's, -1: none
    let next = 0;
    for (let k = 0; k < this.states.length; ++k)
      this.pose[k] = this.states[k] & kAgain ? next - 1 : this.states[k] & kPosed ? next++ : -1;
    this.poses = poseValues(map.joints, joints.length, {
      rows: this.rows,
      column: this.rows * this.panels.length,
      pose: this.pose,
    });
  }
  index(panel, column, row) {
    return (column * this.panels.length + panel) * this.rows + row;
  }
  state(k) {
    return this.states[k] & kState;
  }
  /** How many cells are of the states that `wanted` accepts. */
  count(wanted) {
    return this.states.reduce((n, state) => n + wanted(state & kState), 0);
  }
  /**
   * Where a value of the coordinate, rad or m, is in a panel, in cells from below: k at the middle
   * of cell k.
   */
  place(value) {
    if (this.slides) return (value - this.low) / this.step;
    const turn = (2 * Math.PI) / this.step,
      before = this.closed ? 0.5 : (turn - (this.angles - 1)) / 2,
      k = (value - this.low) / this.step;
    return k - turn * Math.floor((k + before) / turn);
  }
  /**
   * What a cell stands for; where it has a pose (q), all that is said is of that pose, which may be
   * that of another node of the cell, or beside it.
   */
  at(panel, column, row) {
    const k = this.index(panel, column, row),
      state = this.state(k),
      pose = this.pose[k],
      posed = pose >= 0;
    const layer = column * this.layers_each + (posed ? this.poseLayers[pose] : 0),
      clearance = posed ? this.clearances[pose] : kUnknown;
    const whole = (angle) => (this.slides ? angle : wrapped(angle)),
      value = whole(this.low + this.step * row * this.angles_each),
      { rolls, name, sheet } = this.panels[panel];
    const phi = posed ? whole(this.posePhis[pose]) : rolls ? undefined : value,
      roll = posed && this.poseRolls.length ? this.poseRolls[pose] : rolls ? value : undefined;
    return {
      layer,
      s: this.s[layer],
      phi,
      roll,
      sheet,
      rolls,
      angle: phi === undefined ? NaN : this.place(phi),
      branch: name,
      what:
        this.meaning(k) +
        (state === BLOCKED
          ? this.states[k] & kCertified
            ? ' (proved by a certificate)'
            : ' (found by FCL)'
          : ''),
      q:
        pose < 0
          ? null
          : Array.from(this.poses.subarray(7 * pose, 7 * pose + 7), (v) => v * this.joint_unit),
      pair: state === BLOCKED ? this.blockers[this.causes[k]] : null,
      clearance_mm: clearance === kUnknown ? undefined : clearance / 10,
    };
  }
  meaning(k) {
    const state = this.state(k);
    if (state === LIMIT) return `limit of ${this.jointNames[this.causes[k]]}`;
    if (state === BLOCKED) return `blocked by ${this.blockers[this.causes[k]].join(' - ')}`;
    if (state === FREE)
      return this.states[k] & kCertified ? 'free, proved by a certificate' : 'free, found by FCL';
    return { [NO_IK]: this.nothing, [SINGULAR]: 'singular', [UNSEEN]: 'not looked at' }[state];
  }
  /** colours: those of a theme (palette.js) for what was not asked about. */
  colour(k, { nothing, unseen, limit }) {
    const state = this.state(k);
    if (state === BLOCKED)
      return this.object(k) === null
        ? kKnown.self
        : kObjects[this.objects.indexOf(this.object(k)) % kObjects.length];
    if (state === FREE) return this.states[k] & kCertified ? kKnown.proved : kKnown.found;
    return { [NO_IK]: nothing, [SINGULAR]: kKnown.singular, [LIMIT]: limit, [UNSEEN]: unseen }[
      state
    ];
  }
  /** The object that blocks a cell; null where the robot is in its own way. */
  object(k) {
    return this.blockers[this.causes[k]].find((name) => this.objects.includes(name)) ?? null;
  }
  /** What cells of one colour have in common. */
  group(k) {
    const state = this.state(k);
    if (state === LIMIT) return 'joint limit';
    if (state === BLOCKED) return `blocked by ${this.object(k) ?? 'the robot itself'}`;
    return this.meaning(k);
  }
  /** What tells cells of one colour apart: the joint, or the body that is blocked. */
  detail(k) {
    const state = this.state(k);
    if (state === LIMIT) return this.jointNames[this.causes[k]];
    if (state !== BLOCKED) return null;
    return this.blockers[this.causes[k]].filter((name) => name !== this.object(k)).join(' - ');
  }
  /** Cells of equal state and cause mean the same. */
  kind(k) {
    return ((this.states[k] & ~(kPosed | kAgain)) << 8) | this.causes[k];
  }
  /**
   * { meaning, colour, hatched, details: of what lies within } of what is there, the most telling
   * first.
   */
  legend(colours) {
    const kinds = new Map();
    for (let k = 0; k < this.states.length; ++k)
      if (!kinds.has(this.kind(k))) kinds.set(this.kind(k), k);
    const entries = new Map();
    for (const k of [...kinds.values()].sort((a, b) => this.state(b) - this.state(a))) {
      const meaning = this.group(k),
        detail = this.detail(k);
      if (!entries.has(meaning))
        entries.set(meaning, {
          meaning,
          colour: this.colour(k, colours),
          hatched: this.state(k) === LIMIT,
          details: [],
        });
      if (detail && !entries.get(meaning).details.includes(detail))
        entries.get(meaning).details.push(detail);
    }
    for (const { details } of entries.values()) details.sort();
    return [...entries.values()];
  }
}

const turns = (cells) => cells.panels.some(({ rolls }) => rolls);
/** What the maps of paths are called. */
export function mapTitle(paths) {
  const titles = paths.map(({ cells }) =>
      turns(cells) ? '(s, φ) and (s, ρ) maps' : `(s, ${cells.letter}) map`,
    ),
    names = paths.map(({ label }) => label).filter((label) => label);
  if (!names.length) return titles.join('');
  return (
    [...new Set(titles)].map((title) => title.replace(/map$/, 'maps')).join(', ') +
    ` of ${names.join(' and ')}`
  );
}
/**
 * How a map is to be read. beside: a path is drawn beside the refined one; ended: a line shows
 * where every path has ended.
 */
function mapNote({ cells, result: { lattice }, beside, ended, label }) {
  const unseen = cells.count((state) => state === UNSEEN),
    known = cells.count((state) => state === FREE || state === BLOCKED);
  const several = cells.layers_each * cells.angles_each > 1;
  const { coordinate, letter } = cells,
    own = coordinate === letter ? `position of ${letter}` : `${coordinate} ${letter}`,
    upwards = turns(cells) ? 'arm angle φ or roll ρ' : own;
  return (
    `s to the right, ${upwards} upwards. ` +
    (cells.arcs
      ? 'Solutions lie on arcs: between two nodes of an arc a cell shows the nearer one' +
        (several ? ', of several a blocked one before a free one. ' : '. ')
      : several
        ? `A cell stands for up to ${cells.layers_each} × ${cells.angles_each} of the ` +
          `${number(lattice.nodes)} nodes and shows a blocked one before a free one, ` +
          'and that before the others. '
        : 'A cell is a node. ') +
    (unseen + known
      ? `Of the cells that exist in closed form, ` +
        `${number((100 * unseen) / (unseen + known), 3)} % were never looked at.`
      : '') +
    (lattice.rolls
      ? ' Branches are drawn at the rolls with which the path was found, rolls at its arm angles.'
      : '') +
    (beside.length && !label
      ? ' The thin dashed line is the path that was found on the lattice, before it was refined ' +
        'or timed.'
      : '') +
    (ended ? ' The dashed line is where every path has ended.' : '')
  );
}
/** How the maps of paths are to be read; what is the same of all is said once. */
export function mapNotes(paths) {
  const notes = paths.map((path) => mapNote(path).trim()),
    own = notes.map((note, k) => `${paths[k].label}: ${note}`).join(' '),
    named = (wanted) =>
      paths
        .filter((path) => path.label && wanted(path))
        .map(({ label }) => label)
        .join(' and '),
    empty = named(({ cells }) => !cells.panels.length),
    alone = named(({ beside, refined }) => beside.length && !refined),
    before = named(({ beside, refined }) => beside.length && refined);
  return (
    (new Set(notes).size > 1 ? own : (notes[0] ?? '')) +
    (empty ? ` No pose of ${empty} exists, so that it has no map.` : '') +
    (alone ? ` The thin dashed line is the path that ${alone} would take alone.` : '') +
    (before ? ` The thin dashed line is the path of ${before} before it was refined or timed.` : '')
  );
}
