// SPDX-License-Identifier: BSD-3-Clause
// The plans of the best placements in three dimensions, above the map of placements as a floor.
import { bytes } from './bytes.js';
import { toolPose } from './kinematics.js';
import { Nearness, placesOf } from './nearness.js';
import { $, data, slideTo } from './page.js';
import { Player, viewOptions } from './player.js';
import { startView } from './scene.js';

const kSeconds = 8; // that a path takes
/** For those who test the page: the placement and its joints shown now, pictures drawn. */
window.swivel = { cell: null, joints: null, frames: 0 };

export class Placed {
  constructor({ plans }) {
    this.plans = new Map(plans.map((plan) => [plan.cell, plan]));
    this.cursor = 0;
    this.player = new Player(() => {
      if (this.cursor >= this.shown.rows.length - 1) this.go(0);
      return true;
    });
    $('slider').addEventListener('input', ({ target }) => {
      this.player.pause();
      this.go(Number(target.value));
    });
    viewOptions(
      () => this.view,
      () => window.swivel.joints,
    );
    startView(
      () => this.shown,
      (view) => this.begin(view),
      (now) => this.step(now),
    );
  }
  has(cell) {
    return this.plans.has(cell);
  }
  begin(view) {
    this.view = view;
    view.colourPath([NaN]);
    if (this.squares) {
      this.lay(this.squares);
      view.look('best');
    }
    this.go(this.cursor);
    this.fade();
  }
  /** Shows the plan of one of its placements, from the beginning. */
  open(cell, offset) {
    const plan = this.plans.get(cell),
      // Where joints are held as in this placement, the robot stands otherwise.
      scene = { ...data.scene, ...plan.robot },
      { chain } = scene,
      joints = new Float32Array(bytes(plan.joints)),
      s = new Float32Array(bytes(plan.s));
    const rows = [...s].map((at, k) => ({
      s: at,
      q: [...joints.subarray(k * chain.joints.length, (k + 1) * chain.joints.length)],
    }));
    const tool_path = rows.map(({ q }) => toolPose(chain, q).elements.slice(12, 15));
    this.shown = { ...scene, rows, tool_path, poses: plan.poses, floor: true };
    this.nearness = new Nearness(plan.near, placesOf(rows));
    // One without a path is shown where paths end.
    Object.assign(this, { plan, offset, cursor: 0, isPartial: plan.past !== undefined });
    window.swivel.cell = cell;
    $('slider').max = rows.length - 1;
    this.view?.show(this.shown);
    this.view?.colourPath([NaN]);
    if (this.squares) this.lay(this.squares);
    this.player.pause();
    this.go(this.isPartial ? rows.length - 1 : 0);
  }
  /**
   * A placement is picked: its place is marked on the floor, and where the plan that is shown is
   * another's, the arm is faded.
   */
  pick(cell, offset) {
    Object.assign(this, { marked: offset });
    this.isOther = cell !== this.plan.cell;
    if (this.squares) this.lay(this.squares);
    this.fade();
  }
  fade() {
    for (const kind of ['robot', 'tool'])
      this.view?.legend.set(kind, this.isOther ? 'faded' : 'shown');
  }
  /** The floor: squares as of View.lay, by offsets. */
  lay(squares) {
    this.squares = squares;
    if (!this.view) return;
    const [x, y] = data.scene.origin,
      offset = this.marked ?? this.offset;
    this.view.lay(
      squares.map((square) => ({ ...square, x: x + square.x, y: y + square.y })),
      this.plan.still_frame,
      [x + (offset.x ?? 0), y + (offset.y ?? 0)],
    );
  }
  go(k) {
    const { rows } = this.shown,
      last = rows.length - 1;
    this.cursor = Math.min(last, Math.max(0, k));
    const i = Math.min(Math.floor(this.cursor), Math.max(0, last - 1)),
      f = this.cursor - i,
      a = rows[i],
      b = rows[Math.min(i + 1, last)];
    const q = a.q.map((v, j) => v + f * (b.q[j] - v));
    window.swivel.joints = q;
    const past = this.isPartial && this.cursor === last ? this.plan.past : null;
    this.view?.pose(q, past?.pair ?? null, past?.line ?? null, true, (name) =>
      this.nearness.lines(name, this.cursor),
    );
    const where = `s ${(a.s + f * (b.s - a.s)).toFixed(3)} of ${rows[last].s.toFixed(3)} m`;
    slideTo(this.cursor, where);
    $('where').textContent = where;
  }
  /** Plays on; true while it plays. now: ms. */
  step(now) {
    if (!this.player.playing) return false;
    const last = this.shown.rows.length - 1;
    this.go(this.cursor + (this.player.passed(now) / kSeconds) * last);
    if (this.cursor >= last) this.player.pause();
    return this.player.playing;
  }
  paint() {
    this.view?.paint();
  }
}
