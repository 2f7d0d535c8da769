// SPDX-License-Identifier: BSD-3-Clause
// What plays a path and what turns its picture: the button, the keys, the options of the view.
import { $ } from './page.js';

/** Plays and pauses. begin: called before it plays, false where there is nothing to play. */
export class Player {
  constructor(begin) {
    Object.assign(this, { begin, playing: false, before: 0 });
    $('play').addEventListener('click', () => this.turn());
  }
  turn() {
    if (this.playing) this.pause();
    else this.play();
  }
  pause() {
    this.playing = false;
    $('play').textContent = '▶';
    $('play').setAttribute('aria-label', 'Play');
  }
  play() {
    if (!this.begin()) return;
    this.playing = true;
    $('play').textContent = '❚❚';
    $('play').setAttribute('aria-label', 'Pause');
    this.before = performance.now();
  }
  /** Seconds that have passed in the motion since the last call. */
  passed(now) {
    const seconds = (Math.max(0, now - this.before) / 1000) * Number($('speed')?.value ?? 1);
    this.before = now;
    return seconds;
  }
}

/**
 * actions: of each key, called with how many steps are meant: one, with shift ten. They are those
 * of what moves the arm (view, map and slider) while it has the focus; elsewhere keys scroll the
 * page.
 */
export function keys(actions) {
  addEventListener('keydown', (event) => {
    if (
      !event.target.closest?.('#view, #map, #controls') ||
      event.target.matches(event.key === ' ' ? 'select, button, [type=checkbox]' : 'select') ||
      event.ctrlKey ||
      event.altKey ||
      event.metaKey
    )
      return;
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action(event.shiftKey ? 10 : 1);
  });
}
/** The keys that turn the view, a function that returns it, or null before it has begun. */
export const viewKeys = (view) => ({
  f: () => view()?.look('fit'),
  0: () => view()?.look('best'),
  1: () => view()?.look('front'),
  2: () => view()?.look('side'),
  3: () => view()?.look('top'),
});
/**
 * view: as of viewKeys; joints: returns those that are shown; text: what is copied of them.
 */
export function viewOptions(view, joints, text = (q) => `[${q.join(', ')}]`) {
  $('visual').addEventListener('change', ({ target }) => view()?.showVisual(target.checked));
  $('trail').addEventListener('change', ({ target }) => view()?.showTrail(target.checked));
  $('copy-joints').addEventListener('click', ({ target }) => {
    navigator.clipboard?.writeText(text(joints()));
    target.textContent = 'Copied';
    setTimeout(() => (target.textContent = 'Copy joints'), 1200);
  });
  $('ghosts').addEventListener('change', ({ target }) => {
    if (!view()) return;
    view().ghosts.visible = target.checked;
    view().dirty = true;
  });
  $('views').addEventListener('change', ({ target }) => {
    view()?.look(target.value);
    target.value = '';
  });
  $('names').addEventListener('change', ({ target }) =>
    $('view').classList.toggle('nameless', !target.checked),
  );
}
