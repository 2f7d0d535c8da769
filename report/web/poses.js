// SPDX-License-Identifier: BSD-3-Clause
// Poses along a path, between its rows, and in words.
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

/** s and what is chosen there, in words. letter: of the map's coordinate. */
export function placeWords({ s, phi, roll }, letter, digits) {
  const angles = [
    [letter === 'ρ' ? 'roll' : 'φ', phi],
    ['roll', roll],
  ].filter(([, angle]) => angle !== undefined && angle !== null);
  return [
    `s ${s.toFixed(digits)} m`,
    ...angles.map(([name, angle]) => `${name} ${(angle * kDegrees).toFixed(1)}°`),
  ].join('   ');
}
/** How a joint's position is told: { scale: from rad or m, unit }; one that slides in mm. */
export const shownOf = ({ slides }) =>
  slides ? { scale: 1000, unit: ' mm' } : { scale: kDegrees, unit: '°' };
/** The joints of a pose, a line each. */
export const jointWords = (chain, q, digits) =>
  chain.joints.map((joint, k) => {
    const { scale, unit } = shownOf(joint);
    return `${joint.name}  ${(q[k] * scale).toFixed(digits)}${unit}`;
  });
/** A cell of the map in words, a line each. */
export function cellWords(cell, chain, letter) {
  const lines = [placeWords(cell, letter, 4), cell.branch, cell.what];
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
/**
 * The row at a layer of the lattice, which may have layers of the path between its own; null beyond
 * the last.
 */
export function rowOf(rows, layer) {
  const k = rows.findIndex((row) => row.layer >= layer);
  return k < 0 ? null : k;
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

const kFarMm = 100, // clearances from here on look alike
  kFarDegrees = 45; // and distances from a joint limit
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
 * How a path is coloured by one of the kinds of the view's list. rows: of all paths. { ends: what
 * the ends of the ramp mean; of: the share of a row, NaN where nothing is known }.
 */
export function shading(kind, chain, rows) {
  if (kind === 'phi')
    return {
      ends: ['−180°', '180°'],
      of: ({ phi }) => (wrapped(phi) + Math.PI) / (2 * Math.PI),
    };
  if (kind === 'margin')
    return { ends: ['0', `${kFarDegrees}°`], of: ({ q }) => marginOf(chain, q) / kFarDegrees };
  if (kind === 'manipulability') {
    const most = Math.max(1e-12, ...rows.map(({ q }) => manipulability(chain, q)));
    return {
      ends: ['0', `${number(most, 2)} m³`],
      of: ({ q }) => manipulability(chain, q) / most,
    };
  }
  return {
    ends: ['0', `${kFarMm} mm`],
    of: ({ clearance_mm }) => (clearance_mm === undefined ? NaN : clearance_mm / kFarMm),
  };
}
