// SPDX-License-Identifier: BSD-3-Clause
// The legend of the view in three dimensions: each colour, and bodies to fade or hide.
import { tell } from './page.js';
import { kBodies, kLines } from './palette.js';

/** What stands on the ground of the robot is told apart from what moves. */
export const kindOf = (body) =>
  body.stands ? 'fixed' : body.kind === 'robot' && body.isSecond ? 'robot 2' : body.kind;
/** The entry of the legend that a body belongs to: an object of the scene has its own. */
export const entryOf = (body) =>
  body.kind === 'scene'
    ? `scene ${body.name}`
    : body.stands
      ? 'fixed'
      : `${body.kind}${body.arm ? ` ${body.arm}` : ''}`;

const kNames = { robot: 'arm', 'robot 2': 'arm', tool: 'tool', fixed: 'base of the robot' },
  kLooks = ['shown', 'faded', 'hidden'],
  kMarks = { shown: '●', faded: '◐', hidden: '○' },
  kClick = 4; // pixels that a click may move

/** What a body of the robot or its tool is part of, in words; of two arms, of which. */
const partOf = (body) =>
  kNames[kindOf(body)] && body.arm && !body.stands
    ? `${kNames[kindOf(body)]} of ${body.arm}`
    : kNames[kindOf(body)];

export class BodyList {
  /** view: a View, whose looks the entries change. */
  constructor(host, view) {
    Object.assign(this, { host, view, setters: new Map() });
    const entries = new Map();
    for (const { body } of view.parts) entries.set(entryOf(body), body);
    const order = ['robot', 'robot 2', 'tool', 'fixed'];
    const rank = (body) => (order.indexOf(kindOf(body)) + order.length + 1) % (order.length + 1);
    this.buttons = [...entries]
      .sort(([, a], [, b]) => rank(a) - rank(b))
      .map(([entry, body]) => this.button(entry, body));
    host.replaceChildren(...this.buttons, ...this.colours());
    this.listen();
  }
  button(entry, body) {
    const button = document.createElement('button'),
      name = partOf(body) ?? body.name;
    let look = 0;
    const paint = () => {
      const swatch = this.swatch(kBodies[kindOf(body)]);
      button.replaceChildren(
        swatch,
        name,
        Object.assign(document.createElement('b'), {
          textContent: kMarks[kLooks[look]],
        }),
      );
      button.title = `${kLooks[look]}: press for ${kLooks[(look + 1) % kLooks.length]}`;
      button.setAttribute('aria-label', `${name}: ${button.title}`);
    };
    const set = (next) => {
      look = next;
      this.view.setLook(entry, kLooks[look]);
      paint();
    };
    button.addEventListener('click', () => set((look + 1) % kLooks.length));
    this.setters.set(entry, set);
    paint();
    return button;
  }
  /** look: 'shown', 'faded' or 'hidden'; entry: as of entryOf(), of bodies or of none. */
  set(entry, look) {
    this.setters.get(entry)?.(kLooks.indexOf(look));
  }
  swatch(colour, className = '') {
    const swatch = Object.assign(document.createElement('i'), { className });
    swatch.style.setProperty('--colour', colour);
    return swatch;
  }
  /** What colours mean that no body has for itself. */
  colours() {
    const { rows, cut, moves, paths, plans, numbers, ways } = this.view.data;
    return [
      [rows.some(({ pair }) => pair), kBodies.near, '', 'nearest to each other'],
      [cut?.pair || plans?.some(({ past }) => past?.pair), kBodies.hit, '', 'too near each other'],
      [rows.length > 1, kBodies.start, 'outline', numbers ? 'at the begin' : 'at the start'],
      [rows.length > 1, kBodies.end, 'outline', 'at the end'],
      [moves?.length, kLines.moves, 'dashes', 'transitions'],
      [ways?.length, kLines.moves, 'dashes', 'way of the follower’s tool'],
    ]
      .filter(([is]) => is)
      .map(([, colour, className, text]) => {
        const entry = document.createElement('span');
        entry.append(this.swatch(colour, className), text);
        return entry;
      });
  }
  /** A click on a body says what it is, and how near others are. */
  listen() {
    const { canvas } = this.view;
    let from = null;
    canvas.addEventListener('pointerdown', ({ clientX, clientY }) => {
      from = [clientX, clientY];
      tell(null);
    });
    canvas.addEventListener('pointerup', (event) => {
      if (!from || Math.hypot(event.clientX - from[0], event.clientY - from[1]) > kClick) return;
      const { left, top } = canvas.getBoundingClientRect(),
        hit = this.view.pick(event.clientX - left, event.clientY - top);
      tell(hit && this.words(hit), event);
    });
    canvas.addEventListener('pointerleave', () => tell(null));
  }
  words({ body, point }) {
    const { pair, text, hit, near } = this.view.told ?? {},
      kind = partOf(body),
      known = near?.(body.name) ?? [],
      lines = [kind && kind !== body.name ? `${body.name} (${kind})` : body.name];
    if (pair?.includes(body.name) && (hit || !known.length)) {
      const other = pair.find((name) => name !== body.name) ?? body.name;
      lines.push(text ? `${text} from ${other}` : `nearest to ${other}`);
    }
    lines.push(...known);
    const inBase = point.clone().applyMatrix4(this.view.world.matrix.clone().invert());
    lines.push(
      `point ${inBase
        .toArray()
        .map((v) => v.toFixed(3))
        .join(', ')} m`,
    );
    return lines.join('\n');
  }
}
