// SPDX-License-Identifier: BSD-3-Clause
// The report of one plan: text, map and plots first, then the arm; one cursor moves in all of them.
import { savers } from './figure.js';
import { manipulability } from './kinematics.js';
import { BLOCKED, Cells, FREE, UNSEEN } from './map.js';
import { $, data, isDark, number, tell, themes, whenResized } from './page.js';
import { Panels } from './panels.js';
import { Plots } from './plots.js';
import { View } from './scene.js';
import { summary, verdict } from './summary.js';

const { rows, chain, cut, motion } = data, kDegrees = 180 / Math.PI;
const solved = data.result.status === 'solved', last = rows.length - 1;

$('title').textContent = data.problem + (data.which ? `, ${data.which}` : '');
document.title = `${$('title').textContent} – Swivel`;
verdict($('verdict'), data, (s) => { pause(); go(rowAt(s)); });
summary(data);

let view = null, shown = null, cursor = 0, time = 0, playing = false, picked = false, turned = null, before = 0, told = 0;
/** For those who test the page: joints and line shown now, pictures drawn. */
window.swivel = { joints: null, frames: 0, line: null };

const plots = new Plots($('plots'), rows.map((row) => row.s), [
  ...ranges(),
  ...chain.joints.map((joint, k) => ({ title: joint.name, unit: 'deg', values: rows.map((row) => row.q[k] * kDegrees), low: degrees(joint.lower), high: degrees(joint.upper) })),
  { title: 'roll of the tool', unit: 'deg', values: rows.map((row) => degrees(row.roll)), low: null, high: null },
  { title: 'largest joint step', unit: 'deg', values: rows.map((row, i) => (i ? kDegrees * Math.max(...row.q.map((v, k) => Math.abs(v - rows[i - 1].q[k]))) : null)), low: null, high: degrees(data.settings.joint_step), from0: true },
  { title: 'manipulability', unit: 'm³', values: rows.map((row) => manipulability(chain, row.q)), low: null, high: null, from0: true },
  { title: 'clearance', unit: 'mm', values: rows.map((row) => row.clearance_mm ?? null), low: data.settings.clearance_mm, high: null, from0: true },
  { title: 'tool-path error', unit: 'mm', values: rows.map((row) => row.error_mm), low: null, high: data.result.summary?.tool_path_error?.allowed_mm ?? null, from0: true },
].filter((series) => series.lines || series.values.some((v) => v !== null)), (k) => { pause(); go(k); });

function degrees(angle) { return angle === null || angle === undefined ? null : angle * kDegrees; }
/** All joints that have limits in one plot: 0 and 100 are the limits. The one that comes nearest to them is bold. */
function ranges() {
  const lines = chain.joints.map((joint, k) => ({ joint, k })).filter(({ joint }) => joint.lower !== null && joint.upper !== null)
    .map(({ joint, k }) => ({ name: joint.name, values: rows.map(({ q }) => (100 * (q[k] - joint.lower)) / (joint.upper - joint.lower)) }));
  const room = ({ values }) => Math.min(...values.map((v) => Math.min(v, 100 - v)));
  if (!lines.length || !rows.length) return [];
  const bold = lines.reduce((best, line, k) => (room(line) < room(lines[best]) ? k : best), 0);
  return [{ title: `joints; bold: ${lines[bold].name}`, unit: '% of range', lines, bold, low: 0, high: 100 }];
}
/** The row nearest to s. */
function rowAt(s) { return rows.reduce((best, row, k) => (Math.abs(row.s - s) < Math.abs(rows[best].s - s) ? k : best), 0); }

// In time: the motion's own, where there is one; a cursor along the path stands for a moment, and the other way round.
const share = (title) => ({ title: `largest joint ${title}`, unit: '% of limit', values: motion[title], low: null, high: 100, from0: true });
const timed = motion && new Plots($('motion'), motion.t, [{ title: 'tool speed', unit: 'mm/s', values: motion.tool_mm_s, low: null, high: 1e3 * data.result.motion.speed, from0: true },
  share('speed'), share('acceleration'), share('jerk')], (k) => { pause(); time = momentOf(k); go(layerAt(time)); }, 't, s');
/** Between the marks of an ascending list: the index, not always whole, at which it has a value. */
function indexAt(list, value) {
  const next = Math.min(list.length - 1, Math.max(1, list.findIndex((v) => v > value)));
  return list.at(-1) <= value ? list.length - 1 : next - 1 + Math.min(1, Math.max(0, (value - list[next - 1]) / (list[next] - list[next - 1])));
}
function valueAt(list, index) {
  const i = Math.min(list.length - 1, Math.max(0, Math.floor(index))), f = index - i;
  return f > 0 && i + 1 < list.length ? list[i] + f * (list[i + 1] - list[i]) : list[i];
}
const momentOf = (index) => valueAt(motion.t, index), layerAt = (t) => valueAt(motion.layers, indexAt(motion.t, t));

const cells = new Cells(data.map, chain.joints, [...new Set(data.bodies.filter(({ kind }) => kind === 'scene').map(({ name }) => name))]);
const panels = new Panels($('map'), cells, rows, data.beside, !solved && rows.length ? { layer: rows[last].layer } : null, hover, pick);

function hover(cell, event) {
  if (!cell) {
    tell(null);
    if (!picked) go(cursor);
    return;
  }
  const at = cell.roll === undefined ? `φ ${(cell.phi * kDegrees).toFixed(1)}°` : `roll ${(cell.roll * kDegrees).toFixed(1)}°`;
  const lines = [`s ${number(cell.s)} m, ${at}`, cell.branch, cell.what];
  if (cell.q) {
    lines.push(...chain.joints.map((joint, k) => `${joint.name}  ${(cell.q[k] * kDegrees).toFixed(1)}°`), `manipulability ${number(manipulability(chain, cell.q), 3)} m³`);
    if (cell.clearance_mm !== undefined) lines.push(`clearance ${number(cell.clearance_mm, 3)} mm`);
    pause();
    show(cell.q, cell.pair, null, cell.pair !== null);
    picked = false;
  }
  tell(lines.join('\n'), event);
}
function pick(cell) {
  pause();
  go(Math.min(last, cell.layer));
  if (cell.q) keep(cell);
}
/** Shows a pose away from the path until the cursor moves. */
function keep({ s, phi, roll, q, pair, what, line = null }) {
  show(q, pair, line, pair !== null);
  readout(s, phi, q, what, roll);
  picked = true;
}
/** Turns the arm about its tool where it stands: to the next cell of the same solution that has joints, up or down in the map. */
function turn(by) {
  if (!rows.length) return;
  const row = rows[Math.round(cursor)], panel = cells.panels.findIndex(({ sheet }) => sheet === row.sheet);
  if (panel < 0) return;
  const { rows: most, layers_each, angles_each } = cells, begin = turned ?? Math.floor((row.angle + 0.5) / angles_each);
  for (let k = 1; k <= most; ++k) {
    const at = (((begin + by * k) % most) + most) % most, cell = cells.at(panel, Math.floor(row.layer / layers_each), at);
    if (!cell.q) continue;
    pause();
    keep(cell);
    turned = at;
    panels.turn(cell);
    return;
  }
}
function show(q, pair, line = null, hit = false) {
  shown = [q, pair, line, hit];
  view?.pose(...shown);
  Object.assign(window.swivel, { joints: q, line });
}
/** What is not given of arm angle and roll is the path's there. */
function readout(s, at, q, note, turned) {
  const row = rows[rowAt(s)] ?? {}, phi = at ?? row.phi, roll = turned ?? row.roll;
  $('readout').textContent = `s ${s.toFixed(4)} m   φ ${(phi * kDegrees).toFixed(1)}°${roll === undefined ? '' : `   roll ${(roll * kDegrees).toFixed(1)}°`}\n${chain.joints.map((j, k) => `${j.name}  ${(q[k] * kDegrees).toFixed(2)}°`).join('\n')}\n${note}`;
}
const lineOf = ({ nearest, clearance_mm }) => (nearest ? { points: nearest, text: `${number(clearance_mm, 3)} mm` } : null);

/** To row k; between rows the joints are interpolated, as the motion is. */
function go(k) {
  if (!rows.length) return;
  cursor = Math.min(last, Math.max(0, k));
  if (timed && Math.abs(layerAt(time) - cursor) > 1e-9) time = momentOf(indexAt(motion.layers, cursor));
  picked = false;
  turned = null;
  const i = Math.min(Math.floor(cursor), Math.max(0, last - 1)), f = cursor - i, a = rows[i], b = rows[Math.min(i + 1, last)];
  const q = a.q.map((v, j) => (f === 0 ? v : f === 1 ? b.q[j] : v + f * (b.q[j] - v)));
  const near = f < 0.5 ? a : b;
  show(q, near.pair ?? null, lineOf(near));
  // What is told in numbers and beside the arm need not change with every frame.
  if (playing && performance.now() - told < 60) return;
  told = performance.now();
  readout(a.s + f * (b.s - a.s), near.phi, q, near.pair ? `clearance ${number(near.clearance_mm, 4)} mm: ${near.pair.join(' – ')}` : '');
  $('slider').value = cursor;
  $('where').textContent = `${Math.round(cursor)} / ${last}${timed ? `, ${time.toFixed(2)} / ${number(motion.t.at(-1))} s` : ''}`;
  timed?.draw(indexAt(motion.t, time));
  panels.draw(cursor);
  plots.draw(cursor);
}
function pause() {
  playing = false;
  $('play').textContent = '▶';
  $('play').setAttribute('aria-label', 'Play');
}
function play() {
  if (!rows.length) return;
  if (cursor >= last) go(time = 0);
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
$('slider').addEventListener('input', (event) => { pause(); go(Number(event.target.value)); });
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
$('names').addEventListener('change', (event) => $('view').classList.toggle('nameless', !event.target.checked));
addEventListener('keydown', (event) => {
  if (event.target.matches(event.key === ' ' ? 'select, button, [type=checkbox]' : 'select') || event.ctrlKey || event.altKey || event.metaKey) return;
  const step = event.shiftKey ? 10 : 1, to = (k) => () => { pause(); go(k); };
  const action = { ' ': () => (playing ? pause() : play()), ArrowLeft: to(Math.round(cursor) - step), ArrowRight: to(Math.round(cursor) + step), ArrowUp: () => turn(1), ArrowDown: () => turn(-1), Home: to(0), End: to(last), t: turnTheme,
    f: () => view?.look('fit'), 0: () => view?.look('best'), 1: () => view?.look('front'), 2: () => view?.look('side'), 3: () => view?.look('top') }[event.key];
  if (!action) return;
  event.preventDefault();
  action();
});

const kFarMm = 100;  // clearances from here on look alike
function colourPath() {
  const byPhi = $('colour').value === 'phi';
  const known = rows.map((row) => (byPhi ? (row.phi + Math.PI) / (2 * Math.PI) : row.clearance_mm === undefined ? NaN : row.clearance_mm / kFarMm));
  const [low, , high] = $('ramp').children;
  [low.textContent, high.textContent] = byPhi ? ['−180°', '180°'] : ['0', `${kFarMm} mm`];
  const values = data.tool_path.map(() => NaN);
  rows.forEach((row, k) => (values[row.layer] = known[k]));
  view?.colourPath(values);
}
function paint() {
  view?.background(isDark() ? '#1a2027' : '#ffffff');
  panels.paint();
  plots.paint();
  timed?.paint();
}

const unseen = cells.count((state) => state === UNSEEN), known = cells.count((state) => state === FREE || state === BLOCKED);
$('map-note').textContent = `s to the right, φ or ρ upwards. ${cells.layers_each * cells.angles_each > 1
  ? `A cell stands for up to ${cells.layers_each} × ${cells.angles_each} of the ${number(data.result.lattice.nodes)} nodes and shows a blocked one before a free one, and that before the others. ` : 'A cell is a node. '}`
  + (unseen + known ? `Of the cells that exist in closed form, ${number((100 * unseen) / (unseen + known), 3)} % were never looked at.` : '')
  + (data.result.lattice.rolls ? ' Branches are drawn at the rolls with which the path was found, rolls at its arm angles.' : '')
  + (data.beside.length ? ' The thin dashed line is the path that was found on the lattice, before it was refined.' : '')
  + (!solved && rows.length ? ' The dashed line is where every path has ended.' : '');
const stem = data.problem.replace(/\.[^.]*$/, '');
savers(document.querySelector('#plots-section h2'), `${stem}_plots`, () => plots.figure());
if (timed) savers(document.querySelector('#motion-section h2'), `${stem}_motion`, () => timed.figure());
if (cells.panels.some(({ rolls }) => rolls)) document.querySelector('#map-section h2').firstChild.textContent = '(s, φ) and (s, ρ) maps';
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
const asked = new URLSearchParams(location.hash.slice(1)).get('s'), told_at = data.result.summary?.clearance?.s ?? data.result.summary?.joint_limit?.s ?? 0;
if (asked !== null && Number.isFinite(Number(asked)) && rows.length) go(rowAt(Number(asked)));
else if (cut) showCut();
else go(solved ? rowAt(told_at) : last);
addEventListener('hashchange', () => {
  const s = Number(new URLSearchParams(location.hash.slice(1)).get('s') ?? NaN);
  if (!Number.isFinite(s) || !rows.length) return;
  pause();
  go(rowAt(s));
});

// The page can be read before WebGL has started, which takes longest.
requestAnimationFrame(() => setTimeout(() => {
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
  if (shown) view.pose(...shown);
  requestAnimationFrame(frame);
}));
