// SPDX-License-Identifier: BSD-3-Clause
// How many pixels are drawn for each of the page's: many at rest, for smooth edges, and while the
// picture moves as many as the machine manages at thirty frames a second. Measured, not guessed
// from the name of the graphics card.
const kRestMs = 400,
  kFrames = 8,
  kLongMs = 400, // that few slow frames take
  kSlow = 1000 / 32,
  kFast = 1000 / 55,
  kLeast = 0.5;

export class Quality {
  constructor() {
    this.best = Math.max(2, devicePixelRatio);
    this.ratio = this.moving = Math.min(1, devicePixelRatio);
    this.times = [];
    this.moved = this.before = performance.now();
  }
  /** Whether round bodies had better have few corners. */
  get coarse() {
    return this.ratio < Math.min(1, devicePixelRatio);
  }
  /** Called for every frame of the browser. True where `ratio` is another than before. */
  changed(now, moves) {
    const old = this.ratio,
      ms = now - this.before;
    this.before = now;
    if (moves) {
      this.ratio = this.moving;
      // The first frame after a change of size, and after a rest, says nothing.
      if (old !== this.ratio || !this.moves) this.times = [];
      else this.times.push(ms);
      this.moved = now;
      const passed = this.times.reduce((sum, time) => sum + time, 0);
      if (this.times.length > kFrames || (this.times.length > 2 && passed > kLongMs)) this.adapt();
    } else if (now - this.moved > kRestMs) {
      this.ratio = this.best;
    }
    this.moves = moves;
    return this.ratio !== old;
  }
  adapt() {
    const median = [...this.times].sort((a, b) => a - b)[this.times.length >> 1];
    this.times = [];
    if (median > kSlow) this.ratio = this.moving = Math.max(kLeast, this.moving / Math.SQRT2);
    else if (median < kFast && this.moving < this.best && !this.limit)
      this.ratio = this.moving = Math.min(this.best, this.moving * Math.SQRT2);
    if (median > kSlow) this.limit = true; // not up and down for ever
  }
}
