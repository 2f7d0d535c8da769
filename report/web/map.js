// SPDX-License-Identifier: BSD-3-Clause
// What the search knows of the lattice: the cells of the (s, phi) map, decoded.
import { bytes } from './bytes.js';

// States in the order of report/lattice_map.hpp.
export const [NO_IK, SINGULAR, LIMIT, UNSEEN, FREE, BLOCKED] = [0, 1, 2, 3, 4, 5];
const kState = 7, kCertified = 64, kPosed = 128, kUnknown = 65535;
// After Okabe & Ito's palette, told apart by all kinds of colour vision: one hue for limits, one for each object in the way.
const LIMITS = '#a6d3ef', SELF = '#6a4c93', OBJECTS = ['#d55e00', '#e6b800', '#8c2d04', '#f39a6b', '#7a6000', '#c23b22'];

export class Cells {
  /** objects: names of the scene's objects, in its order. */
  constructor(map, joints, objects) {
    Object.assign(this, map, { objects });
    this.jointNames = joints.map(({ name }) => name);
    this.states = new Uint8Array(bytes(map.states));
    this.causes = new Uint8Array(bytes(map.causes));
    this.poses = new Int16Array(bytes(map.joints));
    this.clearances = new Uint16Array(bytes(map.clearances));
    this.pose = new Int32Array(this.states.length);  // which of the poses is a cell's, -1: none
    let next = 0;
    for (let k = 0; k < this.states.length; ++k) this.pose[k] = this.states[k] & kPosed ? next++ : -1;
  }
  index(panel, column, row) { return (column * this.panels.length + panel) * this.rows + row; }
  state(k) { return this.states[k] & kState; }
  /** How many cells are of the states that `wanted` accepts. */
  count(wanted) { return this.states.reduce((n, state) => n + wanted(state & kState), 0); }
  at(panel, column, row) {
    const k = this.index(panel, column, row), state = this.state(k), pose = this.pose[k];
    const layer = Math.min(this.layers - 1, column * this.layers_each), clearance = pose < 0 ? kUnknown : this.clearances[pose];
    const angle = -Math.PI + (2 * Math.PI * row * this.angles_each) / this.angles, { rolls, name } = this.panels[panel];
    return {
      layer, s: this.s[layer], ...(rolls ? { roll: angle } : { phi: angle }), branch: name,
      what: this.meaning(k) + (state === BLOCKED ? (this.states[k] & kCertified ? ' (proved by a certificate)' : ' (found by FCL)') : ''),
      q: pose < 0 ? null : Array.from(this.poses.subarray(7 * pose, 7 * pose + 7), (v) => v * this.joint_unit),
      pair: state === BLOCKED ? this.blockers[this.causes[k]] : null,
      clearance_mm: clearance === kUnknown ? undefined : clearance / 10,
    };
  }
  meaning(k) {
    const state = this.state(k);
    if (state === LIMIT) return `limit of ${this.jointNames[this.causes[k]]}`;
    if (state === BLOCKED) return `blocked by ${this.blockers[this.causes[k]].join(' - ')}`;
    if (state === FREE) return this.states[k] & kCertified ? 'free, proved by a certificate' : 'free, found by FCL';
    const none = this.panels.some(({ rolls }) => rolls) ? 'no node: out of reach, beside the given start, or turned further than allowed' : 'no node: out of reach, or beside the given start';
    return { [NO_IK]: none, [SINGULAR]: 'singular', [UNSEEN]: 'not looked at' }[state];
  }
  colour(k, { nothing, unseen }) {
    const state = this.state(k);
    if (state === LIMIT) return LIMITS;
    if (state === BLOCKED) return this.object(k) === null ? SELF : OBJECTS[this.objects.indexOf(this.object(k)) % OBJECTS.length];
    if (state === FREE) return this.states[k] & kCertified ? '#7ed0b4' : '#00795a';
    return { [NO_IK]: nothing, [SINGULAR]: '#cc79a7', [UNSEEN]: unseen }[state];
  }
  /** The object that blocks a cell; null where the robot is in its own way. */
  object(k) { return this.blockers[this.causes[k]].find((name) => this.objects.includes(name)) ?? null; }
  /** What cells of one colour have in common. */
  group(k) {
    const state = this.state(k);
    if (state === LIMIT) return 'joint limit';
    if (state === BLOCKED) return `blocked by ${this.object(k) ?? 'the robot itself'}`;
    return this.meaning(k);
  }
  /** Cells of equal state and cause mean the same. */
  kind(k) { return (this.states[k] & ~kPosed) << 8 | this.causes[k]; }
  /** [meaning, colour] of what is there, the most telling first. */
  legend(colours) {
    const kinds = new Map();
    for (let k = 0; k < this.states.length; ++k) if (!kinds.has(this.kind(k))) kinds.set(this.kind(k), k);
    const entries = [...kinds.values()].sort((a, b) => this.state(b) - this.state(a)).map((k) => [this.group(k), this.colour(k, colours)]);
    return [...new Map(entries)];
  }
}
