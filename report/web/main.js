// SPDX-License-Identifier: BSD-3-Clause
// The report of one plan: text, map and plots first, then the arm; one cursor moves in all of them.
import { savers } from './figure.js';
import { manipulability } from './kinematics.js';
import { BLOCKED, Cells, FREE, UNSEEN, wrapped } from './map.js';
import { $, data, isDark, number, tell, themes, whenResized } from './page.js';
import { Panels } from './panels.js';
import { Plots } from './plots.js';
import { View } from './scene.js';
import { summary, verdict } from './summary.js';

const { rows, chain, cut, motion } = data,
  kDegrees = 180 / Math.PI;
const solved = data.result.status === 'solved',
  last = rows.length - 1;

$('title').textContent = data.problem + (data.which ? `, ${data.which}` : '');
document.title = `${$('title').textContent} – Swivel`;
verdict($('verdict'), data, (s, off) => {
  pause();
  go(rowAt(s, off));
});
summary(data);

// What is shown is a pose: of the path at the cursor, unless one off the path was kept, or a cell
// of the map is hovered.
let view = null,
  cursor = 0,
  kept = null,
  hovered = null,
  time = 0,
  playing = false,
  turned = null,
  before = 0,
  told = 0;
/** For those who test the page: joints and line shown now, pictures drawn. */
window.swivel = { joints: null, frames: 0, line: null };

const stepOf = (k) =>
  k < last ? kDegrees * Math.max(...rows[k].q.map((v, j) => Math.abs(rows[k + 1].q[j] - v))) : null;
const steps = rows.map((_, k) => stepOf(k));
const plots = new Plots(
  $('plots'),
  rows.map((row) => row.s),
  [
    ...ranges(),
    ...chain.joints.map((joint, k) => ({
      title: joint.name,
      unit: 'deg',
      values: rows.map((row) => row.q[k] * kDegrees),
      of: ({ q }) => q[k] * kDegrees,
      low: degrees(joint.lower),
      high: degrees(joint.upper),
    })),
    {
      title: 'roll of the tool',
      unit: 'deg',
      values: rows.map((row) => degrees(row.roll)),
      of: ({ roll }) => degrees(roll),
      low: null,
      high: null,
    },
    {
      title: 'largest joint step',
      unit: 'deg',
      values: steps,
      of: ({ step }) => step,
      low: null,
      high: degrees(data.settings.joint_step),
      from0: true,
    },
    {
      title: 'manipulability',
      unit: 'm³',
      values: rows.map((row) => manipulability(chain, row.q)),
      of: ({ q }) => manipulability(chain, q),
      low: null,
      high: null,
      from0: true,
    },
    {
      title: 'clearance',
      unit: 'mm',
      values: rows.map((row) => row.clearance_mm ?? null),
      of: ({ clearance_mm }) => clearance_mm ?? null,
      low: data.settings.clearance_mm,
      high: null,
      from0: true,
    },
    {
      title: 'tool-path error',
      unit: 'mm',
      values: rows.map((row) => row.error_mm),
      of: ({ error_mm }) => error_mm ?? null,
      low: null,
      high: data.result.summary?.tool_path_error?.allowed_mm ?? null,
      from0: true,
    },
  ].filter((series) => series.lines || series.values.some((v) => v !== null)),
  (k) => {
    pause();
    go(k);
  },
);

function degrees(angle) {
  return angle === null || angle === undefined ? null : angle * kDegrees;
}
/**
 * All joints that have limits in one plot: 0 and 100 are the limits. The one that the answer names
 * is bold, or where it names none the one that comes nearest.
 */
function ranges() {
  const lines = chain.joints
    .map((joint, k) => ({
      name: joint.name,
      of: ({ q }) => (100 * (q[k] - joint.lower)) / (joint.upper - joint.lower),
      joint,
    }))
    .filter(({ joint }) => joint.lower !== null && joint.upper !== null)
    .map((line) => ({ ...line, values: rows.map(line.of) }));
  const room = ({ values }) => Math.min(...values.map((v) => Math.min(v, 100 - v)));
  if (!lines.length || !rows.length) return [];
  const named = lines.findIndex(({ name }) => name === data.result.summary?.joint_limit?.joint),
    bold =
      named >= 0
        ? named
        : lines.reduce((best, line, k) => (room(line) < room(lines[best]) ? k : best), 0);
  return [
    {
      title: `joints; bold: ${lines[bold].name}`,
      unit: '% of range',
      lines,
      bold,
      of: lines[bold].of,
      low: 0,
      high: 100,
    },
  ];
}
/**
 * The row nearest to s; of several there, where the tool turns in place, the one of which `off` is
 * least. off: called with a row and its number.
 */
function rowAt(s, off = () => 0) {
  const away = (k) => [Math.abs(rows[k].s - s), off(rows[k], k)];
  return rows.reduce((best, _, k) => {
    const [a, b] = [away(k), away(best)];
    return a[0] < b[0] || (a[0] === b[0] && a[1] < b[1]) ? k : best;
  }, 0);
}
/**
 * The row at a layer of the lattice, which may have layers of the path between its own; null beyond
 * the last.
 */
function rowOf(layer) {
  const k = rows.findIndex((row) => row.layer >= layer);
  return k < 0 ? null : k;
}

// In time: the motion's own, where there is one; a cursor along the path stands for a moment, and
// the other way round.
const share = (title) => ({
  title: `largest joint ${title}`,
  unit: '% of limit',
  values: motion[title],
  low: null,
  high: 100,
  from0: true,
});
const timed =
  motion &&
  new Plots(
    $('motion'),
    motion.t,
    [
      {
        title: 'tool speed',
        unit: 'mm/s',
        values: motion.tool_mm_s,
        low: null,
        high: 1e3 * data.result.motion.speed,
        from0: true,
      },
      share('speed'),
      share('acceleration'),
      share('jerk'),
    ],
    (k) => {
      pause();
      time = momentOf(k);
      go(layerAt(time));
    },
    't, s',
  );
/** Between the marks of an ascending list: the index, not always whole, at which it has a value. */
function indexAt(list, value) {
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
function valueAt(list, index) {
  const i = Math.min(list.length - 1, Math.max(0, Math.floor(index))),
    f = index - i;
  return f > 0 && i + 1 < list.length ? list[i] + f * (list[i + 1] - list[i]) : list[i];
}
const momentOf = (index) => valueAt(motion.t, index),
  layerAt = (t) => valueAt(motion.layers, indexAt(motion.t, t));

const cells = new Cells(data.map, chain.joints, [
  ...new Set(data.bodies.filter(({ kind }) => kind === 'scene').map(({ name }) => name)),
]);
const panels = new Panels(
  $('map'),
  cells,
  rows,
  data.beside,
  !solved && rows.length ? { layer: rows[last].layer } : null,
  hover,
  pick,
);

/** s and what is chosen there, in words. */
function head({ s, phi, roll }, digits) {
  const angles = [
    [data.map.letter === 'ρ' ? 'roll' : 'φ', phi],
    ['roll', roll],
  ].filter(([, angle]) => angle !== undefined && angle !== null);
  return [
    `s ${s.toFixed(digits)} m`,
    ...angles.map(([name, angle]) => `${name} ${(angle * kDegrees).toFixed(1)}°`),
  ].join('   ');
}
function hover(cell, event) {
  hovered = cell?.q ? offPath(cell) : null;
  if (hovered) pause();
  present();
  if (!cell) return tell(null);
  const lines = [head(cell, 4), cell.branch, cell.what];
  if (cell.q)
    lines.push(
      ...chain.joints.map((joint, k) => `${joint.name}  ${(cell.q[k] * kDegrees).toFixed(1)}°`),
      `manipulability ${number(manipulability(chain, cell.q), 3)} m³`,
    );
  if (cell.clearance_mm !== undefined) lines.push(`clearance ${number(cell.clearance_mm, 3)} mm`);
  tell(lines.join('\n'), event);
}
function pick(cell) {
  pause();
  go(rowOf(cell.layer) ?? last);
  if (cell.q) keep(cell);
}
/** The pose of a cell of the map, or where every path has ended. */
function offPath(at) {
  return {
    ...at,
    off: true,
    row: rowOf(at.layer),
    hit: at.pair !== null,
    line: at.line ?? null,
    note: at.what,
  };
}
/** Shows a pose away from the path until the cursor moves. */
function keep(at) {
  hovered = null;
  kept = offPath(at);
  present();
}
/**
 * Turns the arm about its tool where it stands: to the next cell of the same solution that has
 * other joints, up or down in the map.
 */
function turn(by) {
  if (!rows.length) return;
  const row = rows[Math.round(cursor)],
    panel = cells.panels.findIndex(({ sheet }) => sheet === row.sheet);
  if (panel < 0) return;
  const { rows: most, layers_each, angles_each, closed } = cells,
    from = turned ?? { at: Math.floor((row.angle + 0.5) / angles_each), phi: row.phi };
  for (let k = 1; k <= most; ++k) {
    const up = from.at + by * k,
      at = closed ? ((up % most) + most) % most : up;
    if (at < 0 || at >= most) return;
    const cell = cells.at(panel, Math.floor(Math.round(row.layer) / layers_each), at);
    // Between two nodes cells show the same.
    if (!cell.q || Math.abs(wrapped(cell.phi - from.phi)) < 1e-5) continue;
    pause();
    keep(cell);
    turned = { at, phi: cell.phi };
    return;
  }
}
const lineOf = ({ nearest, clearance_mm }) =>
  nearest ? { points: nearest, text: `${number(clearance_mm, 3)} mm` } : null;
/**
 * Of the path: between rows the joints are interpolated, as the motion is; clearance is that of the
 * row nearest to it, which the note then names.
 */
function poseAt(k) {
  const i = Math.min(Math.floor(k), Math.max(0, last - 1)),
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
function shown() {
  return hovered ?? kept ?? (rows.length ? poseAt(cursor) : null);
}
/** The arm, its numbers, and the cursors of map and plots: all of one pose. */
function present() {
  const pose = shown();
  if (!pose) return;
  draw(pose);
  // What is told in numbers and beside the arm need not change with every frame.
  if (playing && performance.now() - told < 60) return;
  told = performance.now();
  const digits = pose.off ? 1 : 2;
  const angles = chain.joints.map(
    ({ name }, k) => `${name}  ${(pose.q[k] * kDegrees).toFixed(digits)}°`,
  );
  $('readout').textContent = `${head(pose, 4)}\n${angles.join('\n')}\n${pose.note}`;
  panels.draw(pose);
  plots.draw(pose.row, pose);
}
function draw({ q, pair, line, hit }) {
  view?.pose(q, pair, line, hit);
  Object.assign(window.swivel, { joints: q, line });
}
/** To row k, not always whole. */
function go(k) {
  if (!rows.length) return;
  cursor = Math.min(last, Math.max(0, k));
  if (timed && Math.abs(layerAt(time) - cursor) > 1e-9)
    time = momentOf(indexAt(motion.layers, cursor));
  kept = hovered = turned = null;
  const late = playing && performance.now() - told < 60;
  present();
  if (late) return;
  $('slider').value = cursor;
  $('where').textContent =
    `${Math.round(cursor)} / ${last}` +
    `${timed ? `, ${time.toFixed(2)} / ${number(motion.t.at(-1))} s` : ''}`;
  timed?.draw(indexAt(motion.t, time));
}
function pause() {
  playing = false;
  $('play').textContent = '▶';
  $('play').setAttribute('aria-label', 'Play');
}
function play() {
  if (!rows.length) return;
  if (cursor >= last) go((time = 0));
  playing = true;
  $('play').textContent = '❚❚';
  $('play').setAttribute('aria-label', 'Pause');
  before = performance.now();
}
function frame(now) {
  if (playing) {
    // A motion takes its own time at speed 1, a path without one eight seconds.
    const passed = (Math.max(0, now - before) / 1000) * Number($('speed').value);
    time += passed;
    go(timed ? layerAt(time) : cursor + (passed / 8) * last);
    before = now;
    if (timed ? time >= motion.t.at(-1) : cursor >= last) {
      pause();
      go(last);
    }
  }
  if (view.draw(now, playing) && ++window.swivel.frames === 1) performance.mark('first picture');
  requestAnimationFrame(frame);
}

$('controls').hidden = $('plots-section').hidden = !rows.length;
$('motion-section').hidden = !timed;
$('slider').max = Math.max(0, last);
$('slider').addEventListener('input', (event) => {
  pause();
  go(Number(event.target.value));
});
$('play').addEventListener('click', () => (playing ? pause() : play()));
$('colour').addEventListener('change', colourPath);
$('ghosts').addEventListener('change', (event) => {
  if (!view) return;
  view.ghosts.visible = event.target.checked;
  view.dirty = true;
});
$('views').addEventListener('change', (event) => {
  view?.look(event.target.value);
  event.target.value = '';
});
$('names').addEventListener('change', (event) =>
  $('view').classList.toggle('nameless', !event.target.checked),
);
addEventListener('keydown', (event) => {
  if (
    event.target.matches(event.key === ' ' ? 'select, button, [type=checkbox]' : 'select') ||
    event.ctrlKey ||
    event.altKey ||
    event.metaKey
  )
    return;
  const step = event.shiftKey ? 10 : 1,
    to = (k) => () => {
      pause();
      go(k);
    };
  const action = {
    ' ': () => (playing ? pause() : play()),
    ArrowLeft: to(Math.round(cursor) - step),
    ArrowRight: to(Math.round(cursor) + step),
    ArrowUp: () => turn(1),
    ArrowDown: () => turn(-1),
    Home: to(0),
    End: to(last),
    t: turnTheme,
    f: () => view?.look('fit'),
    0: () => view?.look('best'),
    1: () => view?.look('front'),
    2: () => view?.look('side'),
    3: () => view?.look('top'),
  }[event.key];
  if (!action) return;
  event.preventDefault();
  action();
});

const kFarMm = 100; // clearances from here on look alike
function colourPath() {
  const byPhi = $('colour').value === 'phi';
  const known = rows.map((row) =>
    byPhi
      ? (wrapped(row.phi) + Math.PI) / (2 * Math.PI)
      : row.clearance_mm === undefined
        ? NaN
        : row.clearance_mm / kFarMm,
  );
  const [low, , high] = $('ramp').children;
  [low.textContent, high.textContent] = byPhi ? ['−180°', '180°'] : ['0', `${kFarMm} mm`];
  const values = data.tool_path.map(() => NaN);
  known.forEach((value, k) => (values[k] = value));
  view?.colourPath(values);
}
function paint() {
  view?.background(isDark() ? '#1a2027' : '#ffffff');
  panels.paint();
  plots.paint();
  timed?.paint();
}

const unseen = cells.count((state) => state === UNSEEN),
  known = cells.count((state) => state === FREE || state === BLOCKED);
const several = cells.layers_each * cells.angles_each > 1;
const upwards = cells.panels.some(({ rolls }) => rolls)
  ? 'arm angle φ or roll ρ'
  : `${cells.coordinate} ${cells.letter}`;
$('map-note').textContent =
  `s to the right, ${upwards} upwards. ` +
  (cells.arcs
    ? 'Solutions lie on arcs: between two nodes of an arc a cell shows the nearer one' +
      (several ? ', of several a blocked one before a free one. ' : '. ')
    : several
      ? `A cell stands for up to ${cells.layers_each} × ${cells.angles_each} of the ` +
        `${number(data.result.lattice.nodes)} nodes and shows a blocked one before a free one, ` +
        'and that before the others. '
      : 'A cell is a node. ') +
  (unseen + known
    ? `Of the cells that exist in closed form, ${number((100 * unseen) / (unseen + known), 3)} % ` +
      'were never looked at.'
    : '') +
  (data.result.lattice.rolls
    ? ' Branches are drawn at the rolls with which the path was found, rolls at its arm angles.'
    : '') +
  (data.beside.length
    ? ' The thin dashed line is the path that was found on the lattice, before it was refined.'
    : '') +
  (!solved && rows.length ? ' The dashed line is where every path has ended.' : '');
const stem = data.problem.replace(/\.[^.]*$/, '');
savers(document.querySelector('#plots-section h2'), `${stem}_plots`, () => plots.figure());
if (timed)
  savers(document.querySelector('#motion-section h2'), `${stem}_motion`, () => timed.figure());
document.querySelector('#map-section h2').firstChild.textContent = cells.panels.some(
  ({ rolls }) => rolls,
)
  ? '(s, φ) and (s, ρ) maps'
  : `(s, ${cells.letter}) map`;
$('colour').querySelector('[value=phi]').textContent = cells.letter;
savers(document.querySelector('#map-section h2'), `${stem}_map`, () => panels.figure());

const turnTheme = themes(paint);
whenResized(paint);
function showCut() {
  pause();
  go(last);
  keep(cut);
}
$('blocked').hidden = !cut;
$('blocked').addEventListener('click', showCut);
// Where the address says so (#s=0.34), else at the pose that is nearest to something.
function openAtAddress() {
  const s = Number(new URLSearchParams(location.hash.slice(1)).get('s') ?? NaN);
  if (!Number.isFinite(s) || !rows.length) return false;
  pause();
  go(
    rows.length > 1 && s > rows[0].s
      ? indexAt(
          rows.map((row) => row.s),
          s,
        )
      : 0,
  );
  return true;
}
const begin = document.querySelector('#verdict button');
if (!openAtAddress()) {
  if (cut) showCut();
  else if (solved && begin) begin.click();
  else go(solved ? 0 : last);
}
addEventListener('hashchange', openAtAddress);

// The page can be read before WebGL has started, which takes longest.
requestAnimationFrame(() =>
  setTimeout(() => {
    try {
      view = new View($('scene'), $('gap'), data);
    } catch (error) {
      $('scene').hidden = $('view-options').hidden = true;
      $('no-view').hidden = false;
      window.swivel.frames = -1;
      return;
    }
    view.background(isDark() ? '#1a2027' : '#ffffff');
    colourPath();
    if (shown()) draw(shown());
    requestAnimationFrame(frame);
  }),
);
