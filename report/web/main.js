// SPDX-License-Identifier: BSD-3-Clause
import { manipulability } from './kinematics.js';
import { LatticeMap } from './map.js';
import { Plots } from './plots.js';
import { View } from './scene.js';

const data = JSON.parse(document.getElementById('data').textContent);
const { rows, result, chain } = data;
const $ = (id) => document.getElementById(id);
const number = (v, digits = 4) => (v === null || v === undefined ? '–' : Number(v.toPrecision(digits)).toString());
const solved = result.status === 'solved';

function verdict() {
  const d = result.diagnosis;
  if (solved)
    return `Solved: ${rows.length} layers, cost ${number(result.cost)}, tool-path error at most ${number(Math.max(...rows.map((r) => r.error_mm ?? 0)), 3)} mm`
      + (clearest === undefined ? '.' : `, clearance at least ${number(clearest, 3)} mm.`);
  if (!d || d.reached_layer === null) return `No path at this resolution: the first layer has no valid node${d?.reason ? ` (${d.reason})` : ''}.`;
  return `No path at this resolution: every one ends by layer ${d.reached_layer} of ${data.map.layers - 1} (s = ${number(d.reached_s)} m), where ${d.reason} stops it.`;
}
const clearances = rows.map((r) => r.clearance_mm).filter((v) => v !== undefined);
const clearest = clearances.length ? Math.min(...clearances) : undefined;

document.title = `${data.problem} – Swivel`;
$('title').textContent = data.problem;
$('verdict').textContent = verdict();

const view = new View($('scene'), data);
const measures = rows.map((row) => manipulability(chain, row.q));
const plain = (row) => row.clearance_mm ?? null;
const plots = new Plots($('plots'), rows.length ? rows.map((r) => r.s) : [0], [
  ...chain.joints.map((joint, k) => ({ title: joint.name, unit: 'rad', values: rows.map((r) => r.q[k]), low: joint.lower, high: joint.upper })),
  { title: 'largest joint step', unit: 'rad', values: rows.map((r, i) => (i ? Math.max(...r.q.map((v, k) => Math.abs(v - rows[i - 1].q[k]))) : null)), low: null, high: data.settings.joint_step },
  { title: 'manipulability', unit: 'm³', values: measures, low: null, high: null },
  { title: 'clearance', unit: 'mm', values: rows.map(plain), low: data.settings.clearance_mm, high: null },
  { title: 'tool-path error', unit: 'mm', values: rows.map((r) => r.error_mm), low: null, high: null },
].filter((series) => series.values.some((v) => v !== null)), (k) => { pause(); go(k); });

const map = new LatticeMap(data, (cell, event) => {
  const tip = $('tip');
  tip.hidden = !cell;
  if (!cell) {
    if (!picked) go(cursor);
    return;
  }
  const lines = [`s ${number(cell.s)} m, φ ${cell.phi.toFixed(2)} rad`, cell.branch, cell.what];
  const row = rows.find((r) => r.layer === cell.layer);
  if (cell.q) {
    lines.push(...chain.joints.map((joint, k) => `${joint.name}  ${cell.q[k].toFixed(3)}`), `manipulability ${number(manipulability(chain, cell.q), 3)} m³`);
    pause();
    show(cell.q, cell.blocker?.split(' - ') ?? null);
    picked = false;
  }
  if (row && Math.abs(row.phi - cell.phi) < 0.03 && row.clearance_mm !== undefined) lines.push(`clearance ${number(row.clearance_mm, 3)} mm`);
  tip.textContent = lines.join('\n');
  tip.style.left = `${Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 8)}px`;
  tip.style.top = `${Math.max(4, Math.min(event.clientY + 14, innerHeight - tip.offsetHeight - 8))}px`;
}, (cell) => {
  pause();
  go(Math.min(rows.length - 1, cell.layer));
  if (cell.q) {
    show(cell.q, cell.blocker?.split(' - ') ?? null);
    readout(cell.s, cell.phi, cell.q, cell.what);
    picked = true;
  }
});

let cursor = 0, playing = false, picked = false, before = 0, last = performance.now();
/** Joints shown now, for those who test the page. */
window.swivel = { joints: rows[0]?.q ?? null, frames: 0 };

function show(q, pair) {
  view.pose(q, pair);
  window.swivel.joints = q;
}
function readout(s, phi, q, note) {
  $('readout').textContent = `s ${s.toFixed(4)} m   φ ${phi.toFixed(3)} rad\n${chain.joints.map((j, k) => `${j.name}  ${q[k].toFixed(4)}`).join('\n')}\n${note}`;
}
/** To row k; between rows the joints are interpolated, as the motion is. */
function go(k) {
  if (!rows.length) return;
  cursor = Math.min(rows.length - 1, Math.max(0, k));
  picked = false;
  const i = Math.min(Math.floor(cursor), Math.max(0, rows.length - 2)), f = cursor - i, a = rows[i], b = rows[Math.min(i + 1, rows.length - 1)];
  const q = a.q.map((v, j) => (f === 0 ? v : f === 1 ? b.q[j] : v + f * (b.q[j] - v)));
  const near = f < 0.5 ? a : b;
  show(q, near.pair ?? null);
  readout(a.s + f * (b.s - a.s), near.phi, q, near.pair ? `clearance ${number(near.clearance_mm, 4)} mm: ${near.pair.join(' – ')}` : '');
  $('slider').value = cursor;
  $('where').textContent = `${Math.round(cursor)} / ${rows.length - 1}`;
  map.draw(cursor);
  plots.draw(cursor);
}
function pause() { playing = false; $('play').textContent = '▶'; }
function play() {
  if (cursor >= rows.length - 1) go(0);
  playing = true;
  $('play').textContent = '❚❚';
  before = performance.now();
}
function frame(now) {
  view.keepUp(playing, now - last);
  last = now;
  if (playing) {
    // The whole path takes eight seconds at speed 1.
    go(cursor + ((now - before) / 8000) * (rows.length - 1) * Number($('speed').value));
    before = now;
    if (cursor >= rows.length - 1) pause();
  }
  if (view.draw()) ++window.swivel.frames;
  requestAnimationFrame(frame);
}

$('slider').max = Math.max(0, rows.length - 1);
$('slider').addEventListener('input', (event) => { pause(); go(Number(event.target.value)); });
$('play').addEventListener('click', () => (playing ? pause() : play()));
addEventListener('keydown', (event) => {
  if (event.target.matches('select, button')) return;
  const step = event.shiftKey ? 10 : 1;
  const action = { ' ': () => (playing ? pause() : play()), ArrowLeft: () => { pause(); go(Math.round(cursor) - step); }, ArrowRight: () => { pause(); go(Math.round(cursor) + step); },
    Home: () => { pause(); go(0); }, End: () => { pause(); go(rows.length - 1); }, t: () => theme(document.documentElement.dataset.theme !== 'dark') }[event.key];
  if (!action) return;
  event.preventDefault();
  action();
});

function colourPath() {
  const known = $('colour').value === 'phi' ? rows.map((r) => (r.phi + Math.PI) / (2 * Math.PI)) : rows.map((r) => (r.clearance_mm === undefined ? NaN : r.clearance_mm / 100));
  const values = data.tool_path.map(() => NaN);
  rows.forEach((r, k) => (values[r.layer] = known[k]));
  view.colourPath(values);
}
$('colour').addEventListener('change', colourPath);
$('ghosts').addEventListener('change', (event) => { view.ghosts.visible = event.target.checked; view.dirty = true; });

function theme(dark) {
  document.documentElement.dataset.theme = dark ? 'dark' : 'light';
  view.background(dark ? '#1a2027' : '#ffffff');
  map.paint();
  plots.paint();
}
$('theme').addEventListener('click', () => theme(document.documentElement.dataset.theme !== 'dark'));
addEventListener('resize', () => { map.paint(); plots.paint(); });

function table(caption, entries) {
  const table = document.createElement('table');
  table.createCaption().textContent = caption;
  for (const [name, value] of entries) {
    const row = table.insertRow();
    row.insertCell().textContent = name;
    row.insertCell().textContent = value;
  }
  $('tables').append(table);
}
const flat = (object) => Object.entries(object ?? {}).filter(([, v]) => typeof v !== 'object').map(([k, v]) => [k.replaceAll('_', ' '), typeof v === 'number' ? number(v) : String(v)]);
table('Times, ms', [...flat(result.time_ms), ...flat(result.time_ms.stages)]);
table('Counters', flat(result.counters));
table('Lattice', flat(result.lattice));
table('Settings', [...flat(data.settings), ['planner', result.planner], ['threads', String(result.threads)]]);
if (!solved && result.diagnosis) {
  table('What removed the nodes past the furthest layer', flat(result.diagnosis.removed));
  if (result.diagnosis.empty_layers.length)
    table('Empty layers', result.diagnosis.empty_layers.slice(0, 20).map((l) => [`layer ${l.layer}, s = ${number(l.s)} m`, l.reason]));
}

const unseen = map.states.reduce((n, s) => n + ((s & 127) === 3), 0), asked = map.states.reduce((n, s) => n + ((s & 127) > 3), 0);
$('map-note').textContent = `s to the right (0 to ${number(data.map.s.at(-1))} m), φ from −π up to π. `
  + (data.map.layers_each * data.map.angles_each > 1 ? `A cell stands for up to ${data.map.layers_each} × ${data.map.angles_each} nodes and shows a blocked one before a free one, and that before the others. ` : 'A cell is a node. ')
  + (unseen + asked ? `Of the cells that exist in closed form, ${number((100 * unseen) / (unseen + asked), 3)} % were never looked at.` : '');

function save(name, href) {
  const link = document.createElement('a');
  Object.assign(link, { download: name, href });
  link.click();
}
function saver(host, text, action) {
  const button = document.createElement('button');
  button.className = 'save';
  button.textContent = text;
  button.addEventListener('click', action);
  host.append(button);
}
const stem = data.problem.replace(/\.[^.]*$/, '');
saver(document.querySelector('#plots-section h2'), 'Save SVG', () => save(`${stem}_plots.svg`, URL.createObjectURL(new Blob([plots.svg()], { type: 'image/svg+xml' }))));
saver(document.querySelector('#map-section h2'), 'Save PNG', () => {
  const sheet = document.createElement('canvas'), first = map.panels[0].canvas;
  sheet.width = first.width;
  sheet.height = map.panels.reduce((sum, p) => sum + p.canvas.height + 24, 0);
  const pen = sheet.getContext('2d');
  pen.fillStyle = '#fff';
  pen.fillRect(0, 0, sheet.width, sheet.height);
  pen.fillStyle = '#000';
  pen.font = '14px sans-serif';
  let y = 0;
  for (const p of map.panels) {
    pen.fillText(p.name, 4, y + 17);
    pen.drawImage(p.canvas, 0, y + 24);
    y += p.canvas.height + 24;
  }
  save(`${stem}_map.png`, sheet.toDataURL());
});

colourPath();
theme(matchMedia('(prefers-color-scheme: dark)').matches);
go(solved ? 0 : rows.length - 1);
if (!solved && rows.length) {
  // The cut: the pose that would come next and is blocked.
  const last = rows.at(-1), blocked = map.blockedAt(last.layer + 1, last.label, last.angle);
  if (blocked) {
    $('blocked').hidden = false;
    $('blocked').addEventListener('click', () => {
      pause();
      show(blocked.q, blocked.blocker.split(' - '));
      readout(blocked.s, blocked.phi, blocked.q, blocked.what);
      picked = true;
    });
  }
}
requestAnimationFrame(frame);
