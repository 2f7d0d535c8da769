// SPDX-License-Identifier: BSD-3-Clause
// The report of an answer: of one path, of a job's strokes or of two arms. Text, map and plots
// first, then the arms; one cursor moves in all of them.
import { Arms } from './arms.js';
import { savers, sheet } from './figure.js';
import * as ofJob from './jobtables.js';
import { Cells, mapNotes, mapTitle } from './map.js';
import { $, data, slideTo, tell, themes, whenResized } from './page.js';
import { Panels, paintLegend } from './panels.js';
import * as ofPath from './pathtables.js';
import { keys, Player, viewKeys, viewOptions } from './player.js';
import { Plots } from './plots.js';
import {
  cellBeside,
  cellWords,
  endName,
  indexAt,
  offPath,
  rowOf,
  shading,
  valueAt,
} from './poses.js';
import { tellPose } from './readout.js';
import { startView } from './scene.js';
import { alongRows, overTime } from './series.js';
import { Strip } from './strip.js';
import { strokeName, Strokes } from './strokes.js';
import { addTables, fillList, tellVerdict, warn } from './summary.js';
import * as ofWorkcell from './workcelltables.js';

// An answer has paths, each of which has rows, a map and plots: the one that was planned, the
// strokes of a job, of which one is shown at a time (`showsOne`), or those of two arms.
const answer = data.strokes ? new Strokes(data) : new Arms(data),
  words = data.strokes ? ofJob : data.arms ? ofWorkcell : ofPath,
  { paths, showsOne, conflict } = answer,
  arms = showsOne ? paths.slice(0, 1) : paths,
  { kTexts } = words,
  solved = data.result.cost !== null,
  isTimed = answer.duration !== null,
  objects = [
    ...new Set(data.bodies.filter(({ kind }) => kind === 'scene').map(({ name }) => name)),
  ],
  heading = (section) => document.querySelector(`#${section}-section h2`);
/** A new element at the end of another one. */
function element(host, name, properties) {
  const one = Object.assign(document.createElement(name), properties);
  host.append(one);
  return one;
}

$('title').textContent = data.problem + (data.which ? `, ${data.which}` : '');
document.title = `${$('title').textContent} – Swivel`;

// What is shown are the poses of the arms: of their rows at the cursor, a place on the slider,
// unless an arm is kept off its path, or shown at the hovered cell of its map.
let view = null,
  cursor = 0,
  time = 0,
  active = 0, // the path whose arm the arrows turn
  kept = null,
  hovered = null,
  turned = null,
  told = 0,
  begun = false,
  noting = 0;
/**
 * For those who test the page: joints and line shown now, where the cursor stands, where a job's
 * parts lie on the slider, pictures drawn, and what goes to a time of the motion.
 */
window.swivel = {
  joints: null,
  frames: 0,
  line: null,
  active,
  place: null,
  time: null,
  sections: answer.parts?.map(({ from, to }) => [from, to]),
  toTime,
};

const player = new Player(() => {
  if (answer.moves && cursor >= answer.end) go((time = 0));
  return answer.moves;
});
/** To a place of the user's choice. */
function to(x) {
  player.pause();
  go(x);
}
function toTime(t) {
  player.pause();
  time = t;
  go(answer.placeAt(t));
}
/** To a row of a path. */
function toRow(k, row) {
  if (paths[k].rows.length) to(answer.markOf(k, row));
  if (active !== k) show(k);
}
/** To where the rows of a path end, and to the pose that bars the way on there. */
function toEnd(k) {
  const { cut, rows } = paths[k];
  toRow(k, rows.length - 1);
  if (!cut) return;
  const pose = cut.is_row
    ? { ...shown().poses.find(({ path }) => path === k), pair: null, line: null, note: cut.what }
    : offPath(cut, rowOf(rows, cut.layer));
  keep(k, pose);
}
/** To where the arms meet, or to what bars the way of one of these paths. */
function toBar(among) {
  if (conflict) to(conflict.row);
  else toEnd(paths.indexOf(among.find(({ cut }) => cut)));
}
/** Makes a path the one whose arm the arrows turn; where one is shown at a time, goes to it. */
function choose(k) {
  if (showsOne && paths[k].cut) return toEnd(k);
  kept = hovered = turned = null;
  if (showsOne) toRow(k, 0);
  else show(k);
  present();
}

const parts = words.verdict(data, answer);
tellVerdict(parts, solved, ({ path = active, row, ends }) =>
  ends === undefined ? toRow(path, row) : toEnd(ends),
);
warn(data.result);
const list = words.list?.(data, answer),
  lines = list ? fillList(list, choose) : [];
if (!solved || showsOne) $('answer').textContent = data.answer.trimEnd();
addTables(words.tables(data, answer));

const strip =
  answer.parts &&
  new Strip(answer.parts, answer.process, answer.end, (part) => to(answer.parts[part].opens));

/** Plots below a heading, where `label` is not empty. how: as Plots takes it. */
function plotsIn(host, label, ...how) {
  if (label) element(host, 'h3', { textContent: label });
  return new Plots(element(host, 'div', { className: 'plots' }), ...how);
}
const timed = answer.motions.map(({ motion, label, speed }) =>
  plotsIn(
    $('motion'),
    label,
    motion.t,
    overTime(motion, speed),
    (index) => toTime(valueAt(motion.t, index)),
    label ? `t of ${label}, s` : 't, s',
  ),
);
/** Plots over s of the rows of a path. */
const plotsAlong = (k, label, series) =>
  plotsIn(
    $('plots'),
    label,
    paths[k].rows.map((row) => row.s),
    series,
    (row) => to(answer.markOf(k, row)),
    paths[k].label ? `s of ${paths[k].label}, m` : 's, m',
  );
let gap = null,
  maps = null; // the element that holds them

/** The paths of which map and plots are shown. */
const seen = () => (showsOne ? [paths[active]] : paths);
/** Makes the map and plots of a path when they are first shown. */
function make(path, k) {
  const { map, rows, chain, settings, result, label } = path;
  if (path.panels || !map) return;
  if (showsOne || !maps) maps = element($('map'), 'div', { className: 'panels' });
  path.maps = maps;
  path.cells = new Cells(map, chain.joints, objects);
  path.ended = rows.length > 0 && Boolean(result.diagnosis);
  path.panels = new Panels(
    maps,
    path,
    (cell, event) => hover(k, cell, event),
    (cell) => pick(k, cell),
  );
  if (rows.length)
    path.plots = plotsAlong(k, label, alongRows(chain, rows, settings, result.summary));
}
/** Makes a path the active one, and shows its map and plots. */
function show(k) {
  active = window.swivel.active = k;
  if (paths[k].panels && !showsOne) return;
  paths.forEach((path, at) => {
    if (seen().includes(path)) make(path, at);
    if (showsOne && path.maps) path.maps.hidden = at !== k;
    if (showsOne && path.plots) path.plots.host.hidden = at !== k;
  });
  if (answer.gap) gap = plotsAlong(0, 'Between the arms', [answer.gap]);
  const all = seen(),
    mapped = all.filter(({ cells }) => cells),
    barred = all.find(({ cut }) => cut);
  $('map-section').hidden = !mapped.length;
  $('plots-section').hidden = !all.some(({ rows }) => rows.length);
  $('stroke').value = k;
  $('blocked').hidden = !conflict && !barred;
  $('blocked').textContent = conflict ? 'Where they meet' : endName(barred?.cut);
  if (showsOne) lines.forEach((line, at) => line.classList.toggle('marked', at === k));
  heading('plots').firstChild.textContent = kTexts.along(all, k);
  heading('map').firstChild.textContent = mapTitle(mapped) + (showsOne ? ' of ' : '');
  $('map-note').textContent =
    mapNotes(mapped) +
    (conflict && !barred ? ' The paths are those that each arm would take alone.' : '');
  paintPlots();
}

function hover(k, cell, event) {
  if (cell && k !== active) choose(k);
  const { rows, chain, map, label } = paths[k];
  hovered = cell?.q ? { ...offPath(cell, rowOf(rows, cell.layer)), path: k } : null;
  if (hovered) player.pause();
  present();
  tell(cell ? `${label && `${label}\n`}${cellWords(cell, chain, map)}` : null, event);
}
function pick(k, cell) {
  const { rows } = paths[k];
  if (rows.length) to(answer.markOf(k, rowOf(rows, cell.layer) ?? rows.length - 1));
  if (cell.q) keep(k, offPath(cell, rowOf(rows, cell.layer)));
}
/** Shows a pose of a path away from the cursor until that moves. */
function keep(k, pose) {
  active = window.swivel.active = k;
  hovered = null;
  kept = { ...pose, path: k };
  present();
}
/** Turns an arm about its tool where it stands. */
function turn(by) {
  const { cells, rows } = paths[active],
    row = rows[Math.round(answer.rowAt(active, cursor))],
    next = row && cellBeside(cells, row, turned, by);
  if (!next) return;
  player.pause();
  keep(active, offPath(next.cell, rowOf(rows, next.cell.layer)));
  turned = next.turned;
}
/** The poses of all arms, null where there are none, and what is between them on their paths. */
function shown() {
  const off = hovered ?? kept;
  if (off) return { poses: answer.posesBeside(off), between: null };
  return {
    poses: answer.posesAt(cursor, isTimed ? time : null),
    between: answer.betweenAt(cursor),
  };
}
/** What the view marks: the pose off a path, where the arms meet, or the line of one's choice. */
function marked({ poses, between }) {
  const off = poses.find((pose) => pose.off && pose.hit);
  if (off) return off;
  const wanted = $('line-of').value;
  if (between && (between.hit || wanted === 'between')) return between;
  return wanted === 'between' ? { pair: null, line: null, hit: false } : poses[Number(wanted)];
}
/** The arms, their numbers, and the cursors of maps and plots: all of one moment. */
function present() {
  const now = shown(),
    { poses, between } = now;
  if (!poses) return;
  draw(now);
  for (const path of seen()) {
    const pose = poseOf(path, poses);
    path.panels?.draw(pose?.layer === undefined ? null : pose);
  }
  // What is told in numbers and beside the arms need not change with every frame.
  if (player.playing && performance.now() - told < 60) return;
  told = performance.now();
  poses.forEach((pose, k) => {
    const { chain, label } = paths[k],
      name = label && `${k === active ? '▸ ' : ''}${label}`,
      where = [name, answer.whereWords(pose, cursor)].filter((line) => line).join('\n');
    tellPose(readouts[k], chain, where, pose, pose.off ? 1 : 2);
  });
  for (const path of seen()) {
    const pose = poseOf(path, poses);
    path.plots?.draw(pose?.row ?? null, pose ?? poses[0]);
  }
  gapReadout.textContent = between?.note ?? '';
  gap?.draw(Math.min(cursor, paths[0].rows.length - 1), { mm: between?.mm ?? null });
}
const poseOf = (of, poses) => poses.find(({ path }) => paths[path] === of);
function draw(now) {
  const { poses } = now,
    q = poses.flatMap((pose) => pose.q),
    { pair, line, hit } = marked(now);
  view?.pose(q, pair ?? null, line ?? null, hit, (name) => answer.nearLines(name, poses, cursor));
  Object.assign(window.swivel, { joints: q, line, place: cursor, time });
}
// What is between arms stands before them.
const [gapReadout, ...readouts] = ['gap', ...arms.map(() => 'arm')].map((className) =>
  element($('readout'), 'div', { className }),
);

/** To a place on the slider, which need not be that of a row. */
function go(x) {
  kept = hovered = turned = null;
  if (!answer.moves) return present();
  noteAddress();
  cursor = Math.min(answer.end, Math.max(0, x));
  if (isTimed && Math.abs(answer.placeAt(time) - cursor) > 1e-9) time = answer.timeOf(cursor);
  const late = player.playing && performance.now() - told < 60,
    here = answer.pathAt(cursor) ?? active;
  if (!late && here !== active) show(here);
  present();
  if (late) return;
  const [where, short] = answer.told(cursor, time);
  slideTo(cursor, where);
  $('where').textContent = short;
  strip?.mark(answer.partAt(cursor));
  timed.forEach((plots, k) => plots.draw(indexAt(answer.motions[k].motion.t, time)));
}
/** Plays on; true while it plays. now: ms. */
function step(now) {
  if (!player.playing) return false;
  const passed = player.passed(now);
  if (isTimed) time = Math.min(answer.duration, time + passed);
  go(isTimed ? answer.placeAt(time) : cursor + (passed / answer.seconds) * answer.end);
  if (isTimed ? time >= answer.duration : cursor >= answer.end) to(answer.end);
  return player.playing;
}

function colourPaths() {
  const { ends, of } = shading(
      $('path-colour').value,
      paths,
      (_, row) => answer.between[row]?.mm ?? NaN,
    ),
    [low, , high] = $('ramp').children;
  [low.textContent, high.textContent] = ends;
  paths.forEach((path, k) =>
    view?.colourPath(
      path.tool_path.map((_, row) => (path.rows[row] ? of(path, path.rows[row], row) : NaN)),
      k,
    ),
  );
}
function paintPlots() {
  for (const { panels, plots } of seen()) {
    panels?.paint();
    plots?.paint();
  }
  gap?.paint();
  paintLegend($('legend'), seen());
}
function paint() {
  view?.paint();
  paintPlots();
  for (const plots of timed) plots.paint();
}

// What there is decides what the page has.
document.querySelector('main').className = kTexts.kind;
$('controls').hidden = !answer.moves;
$('motion-section').hidden = !isTimed;
$('list').hidden = !list;
Object.assign($('slider'), { max: answer.end, step: showsOne ? 'any' : 0.01 });
$('slider').ariaLabel = kTexts.slider;
$('slider').addEventListener('input', ({ target }) => to(Number(target.value)));
if (showsOne) paths.forEach((one, k) => $('stroke').append(new Option(strokeName(one, k), k)));
else $('stroke').hidden = true;
$('stroke').addEventListener('change', ({ target }) => choose(Number(target.value)));
$('keys').textContent =
  `Keys, while the view, ${kTexts.maps} or the slider has the focus: space plays, ← → step (with ` +
  `shift: ten), ${kTexts.keys}, Home and End, f fits the view, 0 to 3 turn it, t light or dark. ` +
  `An address that ends in ${kTexts.address}.`;
$('path-colour').addEventListener('change', colourPaths);
const letters = new Set(paths.flatMap(({ map }) => map?.letter ?? []));
$('path-colour').querySelector('[value=phi]').textContent = [...letters].join(', ');
$('blocked').addEventListener('click', () => toBar(seen()));
if (arms.length > 1) {
  if (answer.gap) {
    $('line-of').append(new Option('the arms', 'between'));
    $('path-colour').append(new Option('distance of the arms', 'between'));
  }
  arms.forEach(({ label }, k) =>
    $('line-of').append(new Option(`${label} and its surroundings`, k)),
  );
  $('line-of').addEventListener('change', () => present());
  $('line-option').hidden = false;
  // Their numbers leave no room for the legend beside them.
  $('view-options').before($('bodies'));
  $('plots-section').before($('motion-section'));
  $('map').ariaLabel = 'Maps: the arrows step and turn an arm';
  $('scene').ariaLabel = $('scene').ariaLabel.replace('The arm', 'Both arms');
  $('kept').alt = $('kept').alt.replace('The arm', 'Both arms');
}
viewOptions(
  () => view,
  () => window.swivel.joints,
  (q) =>
    arms
      .map(({ label }, k) => `${label && `${label}: `}[${q.slice(7 * k, 7 * k + 7).join(', ')}]`)
      .join('\n'),
);
const partBy = (by) => {
  const part = answer.parts?.[answer.partAt(cursor) + by];
  if (part) to(part.opens);
};
const stepBy = (by) => answer.moves && to(answer.stepFrom(cursor, by));
keys({
  ' ': () => player.turn(),
  ArrowLeft: (step) => stepBy(-step),
  ArrowRight: stepBy,
  ArrowUp: () => turn(1),
  ArrowDown: () => turn(-1),
  a: () => arms.length > 1 && choose(1 - active),
  n: () => partBy(1),
  p: () => partBy(-1),
  Home: () => to(0),
  End: () => to(answer.end),
  t: () => turnTheme(),
  ...viewKeys(() => view),
});

const stem = data.problem.replace(/\.[^.]*$/, ''),
  save = (section, name, all) =>
    savers(heading(section), `${stem}_${name}`, () =>
      sheet(
        all()
          .filter((one) => one)
          .map((one) => one.figure()),
      ),
    );
save('plots', 'plots', () => [...seen().map(({ plots }) => plots), gap]);
if (isTimed) save('motion', 'motion', () => timed);
save('map', arms.length > 1 ? 'maps' : 'map', () => seen().map(({ panels }) => panels));

const turnTheme = themes(paint);
whenResized(paint);

/** The address names the place once the cursor rests, so that the page opens there again. */
function noteAddress() {
  clearTimeout(noting);
  if (begun && answer.address(cursor))
    noting = setTimeout(() => history.replaceState(null, '', `#${answer.address(cursor)}`), 400);
}
/** At the place that the address names. */
function openAtAddress() {
  const place = answer.addressed(new URLSearchParams(location.hash.slice(1)));
  if (place !== null) to(place);
  return place !== null;
}
show(0);
if (!openAtAddress()) {
  const [first] = parts.filter(({ row }) => row !== undefined);
  if (conflict || paths.some(({ cut }) => cut)) toBar(paths);
  else if (solved && !showsOne) go(first?.row ?? 0);
  else go(solved || paths.length > 1 ? 0 : answer.end);
}
begun = true; // what is shown from now on is the user's choice
addEventListener('hashchange', openAtAddress);

startView(
  () => answer.scene(),
  (started) => {
    view = started;
    colourPaths();
    const now = shown();
    if (now.poses) draw(now);
  },
  step,
);
