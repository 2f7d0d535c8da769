// SPDX-License-Identifier: BSD-3-Clause
// Poses along a path, between its rows, and in words.
import { samples } from './bytes.js';
import { manipulability } from './kinematics.js';
import { wrapped } from './map.js';
import { number } from './page.js';

export const kDegrees = 180 / Math.PI;

/** In degrees; null where there is no angle. */
export function degrees(angle) {
  return angle === null || angle === undefined ? null : angle * kDegrees;
}

/** The index, not always whole, at which an ascending list has a value; the last of several. */
export function indexAt(list, value) {
  const next = Math.min(
    list.length - 1,
    Math.max(
      1,
      list.findIndex((v) => v > value),
    ),
  );
  return list.at(-1) <= value
    ? list.length - 1
    : next - 1 + Math.min(1, Math.max(0, (value - list[next - 1]) / (list[next] - list[next - 1])));
}
/** The value of a list at an index that need not be whole. */
export function valueAt(list, index) {
  const i = Math.min(list.length - 1, Math.max(0, Math.floor(index))),
    f = index - i;
  return f > 0 && i + 1 < list.length ? list[i] + f * (list[i + 1] - list[i]) : list[i];
}

/**
 * The largest step of a joint from one row to the next, degrees; of those that turn, where the
 * chain is given, which says so.
 */
export const stepBetween = (row, next, chain) =>
  kDegrees *
  Math.max(...row.q.map((v, j) => (chain?.joints[j].slides ? 0 : Math.abs(next.q[j] - v))));
/** Of each row stepBetween() it and the next; null at the last. */
export const stepsOf = (rows, chain) =>
  rows.map((row, k) => (k + 1 < rows.length ? stepBetween(row, rows[k + 1], chain) : null));

const lineOf = ({ nearest, clearance_mm }) =>
  nearest ? { points: nearest, text: `${number(clearance_mm, 3)} mm` } : null;
/**
 * Of a path: between rows the joints are interpolated, as the motion is; clearance is that of the
 * row nearest to it, which the note then names. steps: stepsOf(rows).
 */
export function poseAt(rows, steps, k) {
  const last = rows.length - 1,
    i = Math.min(Math.floor(k), Math.max(0, last - 1)),
    f = k - i,
    a = rows[i],
    b = rows[Math.min(i + 1, last)],
    near = f < 0.5 ? a : b;
  const mixed = (u, v) => (f === 0 ? u : f === 1 ? v : u + f * (v - u));
  const note = near.pair
    ? `clearance ${number(near.clearance_mm, 4)} mm` +
      `${f === 0 || f === 1 ? '' : ` at s ${near.s.toFixed(4)} m`}: ${near.pair.join(' – ')}`
    : '';
  return {
    ...near,
    row: k,
    layer: mixed(a.layer, b.layer),
    rows: [a, b, f], // it is at a + f (b - a)
    s: mixed(a.s, b.s),
    phi: a.phi + mixed(0, wrapped(b.phi - a.phi)),
    roll: a.roll === undefined ? undefined : mixed(a.roll, b.roll),
    q: a.q.map((v, j) => mixed(v, b.q[j])),
    step: f === 1 ? steps[i + 1] : steps[i],
    error_mm: f === 1 ? b.error_mm : a.error_mm,
    pair: near.pair ?? null,
    hit: false,
    line: lineOf(near),
    off: false,
    note,
  };
}

/** The joints of a motion at a time: returns a function of t, s. motion: of the page's data. */
export function jointsOf({ joints: { unit, dt, values } }, chain) {
  const width = chain.joints.length,
    steps = samples(values, width),
    last = steps.length / width - 1;
  return (t) => {
    const at = Math.min(last, Math.max(0, t / dt)),
      k = Math.min(Math.floor(at), Math.max(0, last - 1)),
      next = Math.min(last, k + 1);
    return chain.joints.map((_, j) => {
      const [a, b] = [steps[k * width + j], steps[next * width + j]];
      return unit * (a + (at - k) * (b - a));
    });
  };
}

/** s and what is chosen there, in words. map: Cells, or of the page's data. */
export function placeWords({ s, phi, roll }, { letter, slides }, digits) {
  const chosen = [
    [letter === 'ρ' ? 'roll' : letter, phi, slides],
    ['roll', roll, false],
  ].filter(([, value]) => value !== undefined && value !== null);
  return [
    `s ${s.toFixed(digits)} m`,
    ...chosen.map(([name, value, isLength]) => {
      const { scale, unit } = shownOf({ slides: isLength });
      return `${name} ${(value * scale).toFixed(1)}${unit}`;
    }),
  ].join('   ');
}
/** How a joint's position is told: { scale: from rad or m, unit }; one that slides in mm. */
export const shownOf = ({ slides }) =>
  slides ? { scale: 1000, unit: ' mm' } : { scale: kDegrees, unit: '°' };
/** The joints of a pose that have a name, a line each. */
export const jointWords = (chain, q, digits) =>
  chain.joints.filter(({ name }) => name).map((joint, k) => {
    const { scale, unit } = shownOf(joint);
    return `${joint.name}  ${(q[k] * scale).toFixed(digits)}${unit}`;
  });
/** A cell of the map in words, a line each. */
export function cellWords(cell, chain, map) {
  const lines = [placeWords(cell, map, 4), cell.branch, cell.what];
  if (cell.q)
    lines.push(
      ...jointWords(chain, cell.q, 1),
      `manipulability ${number(manipulability(chain, cell.q), 3)} m³`,
    );
  if (cell.clearance_mm !== undefined) lines.push(`clearance ${number(cell.clearance_mm, 3)} mm`);
  return lines.join('\n');
}
/** The pose of a cell of the map, or where every path has ended; row: of the path, or null. */
export const offPath = (at, row) => ({
  ...at,
  off: true,
  row,
  hit: at.pair !== null,
  line: at.line ?? null,
  note: at.what,
});
/** What the button that leads there is called. */
export const endName = (cut) => (cut?.is_row ? 'Where it ends' : 'Blocked pose');
/**
 * The row at a layer of the lattice, which may have layers of the path between its own; null beyond
 * the last.
 */
export function rowOf(rows, layer) {
  const k = rows.findIndex((row) => row.layer >= layer);
  return k < 0 ? null : k;
}
/**
 * The row nearest to s; of several there, where the tool turns in place, the one of which `off` is
 * least. off: called with a row and its number.
 */
export function rowAt(rows, s, off = () => 0) {
  const away = (k) => [Math.abs(rows[k].s - s), off(rows[k], k)];
  return rows.reduce((best, _, k) => {
    const [a, b] = [away(k), away(best)];
    return a[0] < b[0] || (a[0] === b[0] && a[1] < b[1]) ? k : best;
  }, 0);
}
/**
 * The next cell up (by: 1) or down (-1) in the map that is of the same solution and has other
 * joints: there the arm turns about its tool where it stands. turned: { at, phi } of the cell that
 * it was turned to before, or null; null where there is no such cell.
 */
export function cellBeside(cells, row, turned, by) {
  const panel = cells.panels.findIndex(({ sheet }) => sheet === row.sheet);
  if (panel < 0) return null;
  const { rows: most, layers_each, angles_each, closed } = cells,
    from = turned ?? { at: Math.floor((row.angle + 0.5) / angles_each), phi: row.phi };
  for (let k = 1; k <= most; ++k) {
    const up = from.at + by * k,
      at = closed ? ((up % most) + most) % most : up;
    if (at < 0 || at >= most) return null;
    const cell = cells.at(panel, Math.floor(Math.round(row.layer) / layers_each), at);
    // Between two nodes cells show the same.
    if (!cell.q || Math.abs(wrapped(cell.phi - from.phi)) < 1e-5) continue;
    return { cell, turned: { at, phi: cell.phi } };
  }
  return null;
}

/**
 * The least distance of a joint that turns from one of its limits, degrees; Infinity where there
 * are none.
 */
export const marginOf = (chain, q) =>
  kDegrees *
  Math.min(
    ...chain.joints.map(({ lower, upper, slides }, k) =>
      lower === null || upper === null || slides ? Infinity : Math.min(q[k] - lower, upper - q[k]),
    ),
  );
/**
 * How paths are coloured, from the least to the largest of their values: by one of the kinds of the
 * view's list, or by values of the caller's. paths: [{ rows, chain, map }]; own: called with a row
 * and its number. { ends: what the ends of the ramp mean; of: called with a path, one of its rows
 * and its number, returns the share, NaN where nothing is known }.
 */
export function shading(kind, paths, own = null) {
  const map = paths.find((path) => path.map)?.map ?? {},
    shown = shownOf(map);
  const { value, unit } = {
    phi: { value: (_, { phi }) => phi * shown.scale, unit: shown.unit },
    margin: { value: ({ chain }, { q }) => marginOf(chain, q), unit: '°' },
    manipulability: { value: ({ chain }, { q }) => manipulability(chain, q), unit: ' m³' },
    clearance: { value: (_, { clearance_mm }) => clearance_mm ?? NaN, unit: ' mm' },
    between: { value: (_, row, k) => own?.(row, k) ?? NaN, unit: ' mm' },
  }[kind];
  if (kind === 'phi' && map.closed)
    return {
      ends: ['−180°', '180°'],
      of: (_, { phi }) => (wrapped(phi) + Math.PI) / (2 * Math.PI),
    };
  const known = paths
    .flatMap((path) => path.rows.map((row, k) => value(path, row, k)))
    .filter(Number.isFinite);
  if (!known.length) return { ends: ['–', '–'], of: () => NaN };
  const low = known.reduce((a, b) => Math.min(a, b)),
    high = known.reduce((a, b) => Math.max(a, b)),
    told = (v) => `${number(v, 3)}${unit}`.replace('-', '−');
  // What a reader could not tell apart has one colour.
  if (told(low) === told(high))
    return { ends: ['', told(high)], of: (...at) => 0 * value(...at) + 1 };
  return {
    ends: [told(low), told(high)],
    of: (...at) => (value(...at) - low) / (high - low),
  };
}
