// SPDX-License-Identifier: BSD-3-Clause
// The report of a job: its strokes and transitions one after the other, the map of one stroke; one
// cursor moves in all of them.
import { savers } from './figure.js';
import { JobList, strokeName } from './joblist.js';
import { jobSummary, strokeTable, verdict } from './jobtables.js';
import { Cells, mapNote, mapTitle } from './map.js';
import { Nearness, nearWords, nearWordsAt, placesOf } from './nearness.js';
import { $, data, number, slideTo, tell, themes, whenResized } from './page.js';
import { Panels } from './panels.js';
import { keys, Player, viewKeys, viewOptions } from './player.js';
import { Plots } from './plots.js';
import {
  cellBeside,
  cellWords,
  endName,
  endPose,
  indexAt,
  offPath,
  placeWords,
  rowOf,
  shading,
  valueAt,
} from './poses.js';
import { tellPose } from './readout.js';
import { startView } from './scene.js';
import { alongRows, overTime } from './series.js';
import { Strip } from './strip.js';

const { chain, motion, home } = data,
  list = new JobList(data),
  { strokes, parts } = list,
  nearness = strokes.map(({ near, rows }) => new Nearness(near, placesOf(rows))),
  solved = data.result.cost !== null,
  objects = [
    ...new Set(data.bodies.filter(({ kind }) => kind === 'scene').map(({ name }) => name)),
  ];

$('title').textContent = data.problem + (data.which ? `, ${data.which}` : '');
document.title = `${$('title').textContent} – Swivel`;

// What is shown is a pose: of the job at the cursor (a place on the slider), unless one off the
// path was kept, or a cell of the map is hovered.
let view = null,
  cursor = 0,
  stroke = 0,
  kept = null,
  hovered = null,
  turned = null,
  told = 0;
/**
 * For those who test the page: joints and line shown now, stroke of the map, where parts lie on the
 * slider, pictures drawn.
 */
window.swivel = {
  joints: null,
  frames: 0,
  line: null,
  stroke: null,
  sections: parts.map(({ from, to }) => [from, to]),
};

const player = new Player(() => {
  if (parts.length && cursor >= list.end) go(0);
  return parts.length > 0;
});
/** To a place on the slider, of the user's choice. */
function to(x) {
  player.pause();
  go(x);
}
/** To the begin of a stroke, or into the middle of a transition. */
function toPart(part) {
  const { from, to: end, stroke } = parts[part];
  to(stroke === null ? (from + end) / 2 : from);
}
const partOf = (k) => parts.findIndex((part) => part.stroke === k);
/** To a row of a stroke; without rows, its map alone. */
function toStroke(k, row = 0) {
  const part = partOf(k);
  if (part >= 0) to(row ? list.markOf(parts[part].first + row) : parts[part].from);
  if (stroke !== k || part < 0) open(k);
  if (!solved && strokes[k].cut) showCut();
}

verdict(data, (k, s) =>
  toStroke(
    k,
    indexAt(
      strokes[k].rows.map((row) => row.s),
      s,
    ),
  ),
);
const lines = strokeTable(list, !solved, (k) => toStroke(k));
jobSummary(data, list);
const strip = new Strip(
  parts.map(({ from, to, title, stroke }) => ({
    from,
    to,
    title,
    name: stroke === null ? '' : strokeName(strokes[stroke], stroke),
  })),
  list.process,
  list.end,
  toPart,
);
const timed =
  motion &&
  new Plots($('motion'), motion.t, overTime(motion, null), (k) => to(valueAt(motion.t, k)), 't, s');

/** Map and plots of a stroke, made when they are first shown. */
function made(k) {
  const one = strokes[k];
  if (one.maps || !one.map) return one;
  one.cells = new Cells(one.map, chain.joints, objects);
  one.mapBox = document.createElement('div');
  one.plotBox = document.createElement('div');
  $('map').append(one.mapBox);
  $('plots').append(one.plotBox);
  one.maps = new Panels(
    one.mapBox,
    one.cells,
    one.rows,
    one.beside,
    !solved && one.cut && one.rows.length ? { layer: one.rows.at(-1).layer } : null,
    hover,
    pick,
  );
  one.plots = new Plots(
    one.plotBox,
    one.rows.map((row) => row.s),
    one.rows.length ? alongRows(chain, one.rows, one.settings, one.run.summary) : [],
    (row) => to(list.markOf(parts[partOf(k)].first + row)),
  );
  return one;
}
/** Shows the map and the plots of a stroke. */
function open(k) {
  stroke = k;
  const one = made(k);
  $('map-section').hidden = !one.map;
  $('plots-section').hidden = !one.rows.length;
  for (const other of strokes) {
    if (!other.maps) continue;
    other.mapBox.hidden = other.plotBox.hidden = other !== one;
  }
  $('stroke').value = k;
  $('blocked').hidden = !one.cut;
  $('blocked').textContent = endName(one.cut);
  lines.forEach((line, at) => line.classList.toggle('marked', at === k));
  window.swivel.stroke = k;
  if (!one.maps) return;
  document.querySelector('#map-section h2').firstChild.textContent = `${mapTitle(one.cells)} of `;
  document.querySelector('#plots-section h2').firstChild.textContent =
    `Along ${strokeName(one, k)}`;
  $('map-note').textContent = mapNote(one.cells, one.run.lattice, {
    beside: one.beside.length > 0,
    ended: !solved && one.rows.length > 0,
  });
  one.maps.paint();
  one.plots.paint();
}

function hover(cell, event) {
  hovered = cell?.q ? offPath(cell, rowOf(strokes[stroke].rows, cell.layer)) : null;
  if (hovered) player.pause();
  present();
  tell(cell ? cellWords(cell, chain, strokes[stroke].map) : null, event);
}
function pick(cell) {
  const { rows } = strokes[stroke];
  if (rows.length) toStroke(stroke, rowOf(rows, cell.layer) ?? rows.length - 1);
  if (cell.q) keep(cell);
}
/** Shows a pose away from the path until the cursor moves. */
function keep(at) {
  hovered = null;
  kept = offPath(at, rowOf(strokes[stroke].rows, at.layer));
  present();
}
function showCut() {
  const { rows, cut, steps } = strokes[stroke];
  if (rows.length) to(parts[partOf(stroke)].to);
  kept = endPose(cut, rows, steps);
  if (!kept.off) Object.assign(kept, { part: partOf(stroke), stroke });
  present();
}
/** Turns the arm about its tool where it stands. */
function turn(by) {
  const pose = shown();
  if (!pose || pose.stroke === null) return;
  const { cells, rows } = strokes[stroke],
    row = rows[Math.round(pose.row ?? 0)],
    next = row && cellBeside(cells, row, turned, by);
  if (!next) return;
  player.pause();
  keep(next.cell);
  turned = next.turned;
}
function shown() {
  if (hovered ?? kept) return hovered ?? kept;
  if (parts.length) return list.poseAt(cursor);
  if (!home) return null;
  const note = home.pair ? `at home ${home.pair.join(' – ')} come too near` : 'home';
  return { q: home.q, pair: home.pair, hit: home.pair !== null, line: null, row: null, note };
}
/** Where a pose is: of which part, at which s. */
function whereWords(pose) {
  if (pose.off) return placeWords(pose, strokes[stroke].map, 4);
  if (pose.part === undefined) return '';
  const { title } = parts[pose.part];
  return pose.row === null
    ? title
    : `${title}   process ${list.processOn(cursor) ? 'on' : 'off'}\n` +
        placeWords(pose, strokes[pose.stroke].map, 4);
}
/** The arm, its numbers, and the cursors of map and plots: all of one pose. */
function present() {
  const pose = shown();
  if (!pose) return;
  draw(pose);
  const inMap = () => pose.off || pose.stroke === stroke;
  strokes[stroke].maps?.draw(inMap() ? pose : null);
  // What is told in numbers and beside the arm need not change with every frame.
  if (player.playing && performance.now() - told < 60) return;
  told = performance.now();
  if (pose.part !== undefined && list.strokeOf(pose.part) !== stroke)
    open(list.strokeOf(pose.part));
  tellPose($('readout'), chain, whereWords(pose), pose, pose.off ? 1 : 2);
  const { maps, plots } = strokes[stroke];
  maps?.draw(inMap() ? pose : null);
  plots?.draw(inMap() ? pose.row : null, pose);
}
/** What is nearest to a body, at a pose on a stroke and along all strokes. */
function nearLines(name, { off, row, stroke: on }) {
  const known = nearness
    .map((one, k) => ({ near: one.least(name), k }))
    .filter(({ near }) => near)
    .sort((a, b) => a.near.mm - b.near.mm);
  if (!known.length) return [];
  const [{ near, k }] = known,
    here = off || !Number.isFinite(row) ? null : nearness[on]?.at(name, Math.round(row));
  const lines = [`nearest on strokes: ${nearWordsAt(near, strokeName(strokes[k], k))}`];
  if (here) lines.unshift(Number.isInteger(row) ? nearWords(here) : nearWordsAt(here));
  return lines;
}
function draw(pose) {
  const { q, pair, line, hit } = pose;
  view?.pose(q, pair, line, hit, (name) => nearLines(name, pose));
  Object.assign(window.swivel, { joints: q, line });
}
/** To a place on the slider. */
function go(x) {
  if (!parts.length) return present();
  cursor = Math.min(list.end, Math.max(0, x));
  kept = hovered = turned = null;
  const late = player.playing && performance.now() - told < 60;
  present();
  if (late) return;
  const part = list.partAt(list.placeOf(cursor));
  slideTo(cursor, parts[part].title + (list.timed ? `, ${cursor.toFixed(2)} s` : ''));
  strip.mark(part);
  $('where').textContent = list.timed
    ? `${cursor.toFixed(2)} / ${number(list.end)} s`
    : `part ${part + 1} / ${parts.length}`;
  timed?.draw(indexAt(motion.t, cursor));
}
/** Plays on; true while it plays. now: ms. */
function step(now) {
  if (!player.playing) return false;
  // A motion takes its own time at speed 1, a job without one four seconds a part.
  const passed = player.passed(now);
  go(cursor + passed * (list.timed ? 1 : list.end / (4 * parts.length)));
  if (cursor >= list.end) to(list.end);
  return player.playing;
}

function colourPaths() {
  const paths = strokes.map(({ rows, map }) => ({ rows, map, chain })),
    { ends, of } = shading($('path-colour').value, paths),
    [low, , high] = $('ramp').children;
  [low.textContent, high.textContent] = ends;
  strokes.forEach(({ tool_path, rows }, k) =>
    view?.colourPath(
      tool_path.map((_, row) => (rows[row] ? of(paths[k], rows[row], row) : NaN)),
      k,
    ),
  );
}
function paint() {
  view?.paint();
  strokes[stroke].maps?.paint();
  strokes[stroke].plots?.paint();
  timed?.paint();
}
/** What the view shows of the job. */
function sceneOf() {
  const begin = ({ rows, tool_path }) =>
    tool_path[
      Math.max(
        0,
        rows.findIndex(({ process }) => process),
      )
    ];
  return {
    ...data,
    rows: list.rows,
    cut: strokes.find(({ cut }) => cut)?.cut ?? home,
    tool_path: strokes.flatMap(({ tool_path }) => tool_path),
    paths: strokes.map(({ tool_path }) => tool_path),
    moves: parts.filter(({ stroke }) => stroke === null).map(({ rows }) => rows.map(({ q }) => q)),
    numbers: strokes.map((one, k) => ({ text: String(k + 1), point: begin(one) })),
  };
}

$('controls').hidden = !parts.length;
$('motion-section').hidden = !timed;
$('slider').max = list.end;
$('slider').addEventListener('input', ({ target }) => to(Number(target.value)));
strokes.forEach((one, k) => $('stroke').append(new Option(strokeName(one, k), k)));
$('stroke').addEventListener('change', ({ target }) => toStroke(Number(target.value)));
$('path-colour').addEventListener('change', colourPaths);
$('blocked').addEventListener('click', showCut);
viewOptions(
  () => view,
  () => window.swivel.joints,
);
const stepBy = (by) => parts.length && to(list.markOf(Math.round(list.placeOf(cursor)) + by));
const partBy = (by) => {
  const part = list.partAt(list.placeOf(cursor)) + by;
  if (parts[part]) toPart(part);
};
keys({
  ' ': () => player.turn(),
  ArrowLeft: (step) => stepBy(-step),
  ArrowRight: stepBy,
  ArrowUp: () => turn(1),
  ArrowDown: () => turn(-1),
  n: () => partBy(1),
  p: () => partBy(-1),
  Home: () => to(0),
  End: () => to(list.end),
  t: () => turnTheme(),
  ...viewKeys(() => view),
});

const stem = data.problem.replace(/\.[^.]*$/, '');
savers(document.querySelector('#plots-section h2'), `${stem}_plots`, () =>
  strokes[stroke].plots.figure(),
);
if (timed)
  savers(document.querySelector('#motion-section h2'), `${stem}_motion`, () => timed.figure());
savers(document.querySelector('#map-section h2'), `${stem}_map`, () =>
  strokes[stroke].maps.figure(),
);
const turnTheme = themes(paint);
whenResized(paint);
const letter = strokes.find(({ map }) => map)?.map.letter;
if (letter) $('path-colour').querySelector('[value=phi]').textContent = letter;

/** At the part that the address names (#part=3). */
function openAtAddress() {
  const part = Number(new URLSearchParams(location.hash.slice(1)).get('part') ?? NaN) - 1;
  if (!parts[part]) return false;
  toPart(part);
  return true;
}
open(0);
if (!openAtAddress()) {
  const failed = strokes.findIndex(({ run, cut }) => cut && run.status === 'infeasible');
  if (failed >= 0) toStroke(failed);
  else go(0);
}
addEventListener('hashchange', openAtAddress);

startView(
  sceneOf,
  (begun) => {
    view = begun;
    colourPaths();
    if (shown()) draw(shown());
  },
  step,
);
