// SPDX-License-Identifier: BSD-3-Clause
// The report of a workcell: two arms that work at one time, a map of each; one cursor moves both.
import { sheet, savers } from './figure.js';
import { Cells, mapNote, mapTitle } from './map.js';
import { Nearness } from './nearness.js';
import { $, data, isDark, number, slideTo, tell, themes, whenResized } from './page.js';
import { Pair } from './pair.js';
import { kDark, kLight, kLines } from './palette.js';
import { Panels, showLegend } from './panels.js';
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
import { armTable, verdict, workcellSummary } from './workcelltables.js';

const pair = new Pair(data),
  { arms, conflict } = pair,
  nearness = new Nearness(
    data.near,
    Array.from({ length: pair.last + 1 }, (_, row) => `row ${row}`),
  ),
  solved = data.result.cost !== null,
  barredArm = arms.findIndex(({ cut }) => cut);

$('title').textContent = data.problem;
document.title = `${data.problem} – Swivel`;

// What is shown are the poses of both arms: of their paths at the cursor, unless one arm is kept
// off its path, or shown at the hovered cell of its map.
let view = null,
  cursor = 0,
  time = 0,
  active = 0,
  kept = null,
  hovered = null,
  turned = null,
  told = 0,
  begun = false,
  noting = 0;
/**
 * For those who test the page: joints of both arms and line shown now, row, pictures drawn, and
 * what goes to a time of the motion.
 */
window.swivel = { joints: null, frames: 0, line: null, row: null, active, toTime };

const player = new Player(() => {
  if (pair.moves && cursor >= pair.last) go((time = 0));
  return pair.moves;
});
/** To a row of the user's choice. */
function to(k) {
  player.pause();
  go(k);
}

verdict(data, pair, to, (arm) => showCut(arm));
armTable(data, (arm) => choose(arm));
workcellSummary(data);

const maps = arms.map((arm, k) => {
  const objects = [
    ...new Set(data.bodies.filter(({ kind }) => kind === 'scene').map(({ name }) => name)),
  ];
  arm.cells = new Cells(arm.map, arm.chain.joints, objects);
  return new Panels(
    $('map'),
    arm.cells,
    arm.rows,
    arm.beside,
    arm.cut && arm.rows.length ? { layer: arm.rows.at(-1).layer } : null,
    (cell, event) => hover(k, cell, event),
    (cell) => pick(k, cell),
    { name: arm.name, region: arm.region },
  );
});
const plots = arms.map(({ name, chain, rows, settings }, k) =>
  plotsOf(
    name,
    rows,
    alongRows(chain, rows, settings, data.result.arms[k].summary),
    `s of ${name}, m`,
  ),
);
const gap =
  pair.between.length > 0
    ? plotsOf(
        'Between the arms',
        arms[0].rows,
        [
          {
            title: 'clearance between the arms',
            unit: 'mm',
            values: pair.gaps,
            of: ({ mm }) => mm,
            low: pair.asked,
            high: null,
            from0: true,
          },
        ],
        `s of ${arms[0].name}, m`,
      )
    : null;
// In time, where there is a motion: a cursor along the paths stands for a moment, and the other
// way round.
const timed = pair.timed
  ? arms.map(({ name, leader, motion }, k) => {
      const box = document.createElement('div'),
        title = document.createElement('h3'),
        { speed } = data.result.motion.arms[k];
      title.textContent = name;
      $('motion').append(title, box);
      // The speed of a follower's tool is bounded on its leader's; the plot is of the base frame.
      return new Plots(
        box,
        motion.t,
        overTime(motion, leader === null ? 1e3 * speed : null),
        (index) => toTime(valueAt(motion.t, index)),
        `t of ${name}, s`,
      );
    })
  : [];
function toTime(t) {
  player.pause();
  time = t;
  go(pair.placeAt(0, t));
}
/** Plots below a heading, over s of the rows, which `axis` names; null where there are none. */
function plotsOf(name, rows, series, axis) {
  if (!rows.length) return null;
  const box = document.createElement('div'),
    title = document.createElement('h3');
  title.textContent = name;
  $('plots').append(title, box);
  return new Plots(
    box,
    rows.map((row) => row.s),
    series,
    to,
    axis,
  );
}

/** Makes an arm the one that the arrows turn and whose line may be drawn. */
function choose(arm) {
  active = arm;
  kept = hovered = turned = null;
  window.swivel.active = arm;
  present();
}
function hover(arm, cell, event) {
  if (cell && arm !== active) choose(arm);
  hovered = cell?.q ? offPath(cell, rowOf(arms[arm].rows, cell.layer)) : null;
  if (hovered) player.pause();
  present();
  tell(
    cell ? `${arms[arm].name}\n${cellWords(cell, arms[arm].chain, arms[arm].map)}` : null,
    event,
  );
}
function pick(arm, cell) {
  const { rows } = arms[arm];
  if (rows.length) to(rowOf(rows, cell.layer) ?? rows.length - 1);
  if (cell.q) keep(arm, cell);
}
/** Shows an arm away from its path until the cursor moves. */
function keep(arm, at) {
  active = window.swivel.active = arm;
  hovered = null;
  kept = offPath(at, rowOf(arms[arm].rows, at.layer));
  present();
}
/** Turns an arm about its tool where it stands. */
function turn(by) {
  const { cells, rows } = arms[active],
    row = rows[Math.round(cursor)],
    next = row && cellBeside(cells, row, turned, by);
  if (!next) return;
  player.pause();
  keep(active, next.cell);
  turned = next.turned;
}
function showCut(arm) {
  const { cut, rows, steps } = arms[arm];
  if (rows.length) to(rows.length - 1);
  active = window.swivel.active = arm;
  kept = endPose(cut, rows, steps);
  present();
}
/** The poses of both arms, and what is between them where both are on their paths. */
function shown() {
  const off = hovered ?? kept;
  if (off) return { poses: pair.posesBeside(active, off), between: null };
  return {
    poses: pair.posesAt(cursor, pair.timed ? time : null),
    between: pair.betweenAt(cursor),
  };
}
/** What the view marks: the pose off a path, where the arms meet, or the line of one's choice. */
function marked({ poses, between }) {
  const off = poses.find((pose) => pose.off && pose.hit);
  if (off) return off;
  const wanted = $('line-of').value,
    own = poses[Number(wanted)];
  if (between && (between.hit || wanted === 'between')) return between;
  return wanted === 'between' ? { pair: null, line: null, hit: false } : own;
}
/** Both arms, their numbers, and the cursors of maps and plots: all of one row. */
function present() {
  const now = shown(),
    { poses, between } = now;
  draw(now);
  poses.forEach((pose, k) => maps[k].draw(pose.layer === undefined ? null : pose));
  // What is told in numbers and beside the arms need not change with every frame.
  if (player.playing && performance.now() - told < 60) return;
  told = performance.now();
  poses.forEach((pose, k) => {
    const { name, chain, map } = arms[k],
      place = pose.s === undefined ? '' : `\n${placeWords(pose, map, 4)}`;
    const title = `${k === active ? '▸ ' : ''}${name}${place}`;
    tellPose(readouts[k], chain, title, pose, pose.off ? 1 : 2);
    plots[k]?.draw(pose.row, pose);
  });
  gapReadout.textContent = between?.note ?? '';
  gap?.draw(Math.min(cursor, arms[0].rows.length - 1), { mm: between?.mm ?? null });
}
/** What is nearest to a body of either arm or of the scene, at a row and along both paths. */
function nearLines(name, { poses }) {
  const row = poses.some(({ off }) => off) ? null : cursor;
  return nearness.lines(name, row, 'along the paths', Number.isInteger(row) && !pair.timed);
}
function draw(now) {
  const q = pair.joints(now.poses),
    { pair: bodies, line, hit } = marked(now);
  view?.pose(q, bodies ?? null, line ?? null, hit, (name) => nearLines(name, now));
  Object.assign(window.swivel, { joints: q, line, row: cursor });
}
// What is between the arms stands before both.
const [gapReadout, ...readouts] = ['gap', 'arm', 'arm'].map((className) => {
  const box = Object.assign(document.createElement('div'), { className });
  $('readout').append(box);
  return box;
});

/** To row k, not always whole. */
function go(k) {
  if (pair.moves) {
    noteAddress();
    cursor = Math.min(pair.last, Math.max(0, k));
    if (pair.timed && Math.abs(pair.placeAt(0, time) - cursor) > 1e-9) time = pair.timeOf(cursor);
  }
  kept = hovered = turned = null;
  const late = player.playing && performance.now() - told < 60;
  present();
  if (late) return;
  slideTo(
    cursor,
    `row ${Math.round(cursor)} of ${pair.last}${pair.timed ? `, ${time.toFixed(2)} s` : ''}`,
  );
  $('where').textContent =
    `${Math.round(cursor)} / ${pair.last}` +
    (pair.timed ? `, ${time.toFixed(2)} / ${number(pair.end)} s` : '');
  timed.forEach((plot, arm) => plot.draw(indexAt(arms[arm].motion.t, time)));
}
/** Plays on; true while it plays. now: ms. */
function step(now) {
  if (!player.playing) return false;
  // A motion takes its own time at speed 1, paths without one eight seconds.
  const passed = player.passed(now);
  time += passed;
  go(pair.timed ? pair.placeAt(0, time) : cursor + (passed / 8) * pair.last);
  if (pair.timed ? time >= pair.end : cursor >= pair.last) to(pair.last);
  return player.playing;
}

function colourPaths() {
  const { ends, of } = shading(
      $('path-colour').value,
      arms,
      (_, row) => pair.between[row]?.mm ?? NaN,
    ),
    [low, , high] = $('ramp').children;
  [low.textContent, high.textContent] = ends;
  for (const [k, arm] of arms.entries())
    view?.colourPath(
      arm.tool_path.map((_, row) => (arm.rows[row] ? of(arm, arm.rows[row], row) : NaN)),
      k,
    );
}

function paint() {
  view?.paint();
  for (const one of [...maps, ...plots, gap, ...timed]) one?.paint();
  paintLegend();
}
/** One legend for both maps, whose colours mean the same. */
function paintLegend() {
  const colours = isDark() ? kDark : kLight,
    entries = new Map();
  for (const { cells } of arms)
    for (const one of cells.legend(colours)) {
      const known = entries.get(one.meaning) ?? { ...one, details: [] };
      known.details = [...new Set([...known.details, ...one.details])].sort();
      entries.set(one.meaning, known);
    }
  if (arms[0].region)
    entries.set('region', {
      meaning: arms[0].region.of_motion
        ? 'first conflict: the motion on from here and that of the other arm do not keep clear'
        : 'first conflict: no pose here keeps clear of any such pose of the other arm',
      colour: '#fff',
      lines: kLines.nearest,
      hatched: true,
      details: [],
    });
  showLegend($('legend'), [...entries.values()], colours);
}

/** The line that is drawn between nearest bodies. */
function addLineChoice() {
  const label = document.createElement('label'),
    select = Object.assign(document.createElement('select'), { id: 'line-of' });
  if (pair.between.length) select.append(new Option('the arms', 'between'));
  arms.forEach(({ name }, k) => select.append(new Option(`${name} and its surroundings`, k)));
  label.append('nearest of ', select);
  $('views').before(label);
  select.addEventListener('change', () => present());
  if (pair.between.length) $('path-colour').append(new Option('distance of the arms', 'between'));
  $('path-colour').addEventListener('change', colourPaths);
}
addLineChoice();
$('view-options').before($('bodies'));

$('controls').hidden = $('plots-section').hidden = !pair.moves;
$('motion-section').hidden = !pair.timed;
$('slider').max = Math.max(0, pair.last);
$('slider').addEventListener('input', ({ target }) => to(Number(target.value)));
$('scene').ariaLabel = $('scene').ariaLabel.replace('The arm', 'Both arms');
$('kept').alt = $('kept').alt.replace('The arm', 'Both arms');
viewOptions(
  () => view,
  () => window.swivel.joints,
  (q) => arms.map(({ name }, k) => `${name}: [${q.slice(7 * k, 7 * k + 7).join(', ')}]`).join('\n'),
);
keys({
  ' ': () => player.turn(),
  ArrowLeft: (step) => to(Math.round(cursor) - step),
  ArrowRight: (step) => to(Math.round(cursor) + step),
  ArrowUp: () => turn(1),
  ArrowDown: () => turn(-1),
  a: () => choose(1 - active),
  Home: () => to(0),
  End: () => to(pair.last),
  t: () => turnTheme(),
  ...viewKeys(() => view),
});

const titles = [...new Set(arms.map(({ cells }) => mapTitle(cells)))];
document.querySelector('#map-section h2').firstChild.textContent =
  `${titles.map((title) => title.replace(/map$/, 'maps')).join(', ')} of ` +
  arms.map(({ name }) => name).join(' and ');
$('map-note').textContent = mapNotes();
/** How the maps are to be read; what is the same of both is said once. */
function mapNotes() {
  const notes = arms.map(({ cells, cut, rows }, k) =>
    mapNote(cells, data.result.arms[k].lattice, {
      beside: false,
      ended: cut !== null && rows.length > 0,
    }),
  );
  const own = notes.map((note, k) => `${arms[k].name}: ${note.trim()}`).join(' ');
  const empty = arms.filter(({ cells }) => !cells.panels.length).map(({ name }) => name),
    dashed = (of) =>
      arms.filter(({ beside, refined }) => beside.length && refined === of).map(({ name }) => name),
    before = dashed(true),
    alone = dashed(false);
  return (
    (notes[0] === notes[1] ? notes[0].trim() : own) +
    (empty.length ? ` No pose of ${empty.join(' and ')} exists, so that it has no map.` : '') +
    (alone.length
      ? ` The thin dashed line is the path that ${alone.join(' and ')} would take alone.`
      : '') +
    (before.length
      ? ` The thin dashed line is the path of ${before.join(' and ')} before it was refined ` +
        'or timed.'
      : '') +
    (solved || barredArm >= 0 || !conflict
      ? ''
      : ' The paths are those that each arm would take alone.')
  );
}
const letters = [...new Set(arms.map(({ map }) => map.letter))];
$('path-colour').querySelector('[value=phi]').textContent = letters.join(', ');

const stem = data.problem.replace(/\.[^.]*$/, '');
savers(document.querySelector('#plots-section h2'), `${stem}_plots`, () =>
  sheet([...plots, gap].filter((one) => one).map((one) => one.figure())),
);
if (pair.timed)
  savers(document.querySelector('#motion-section h2'), `${stem}_motion`, () =>
    sheet(timed.map((one) => one.figure())),
  );
savers(document.querySelector('#map-section h2'), `${stem}_maps`, () =>
  sheet(maps.map((one) => one.figure())),
);
const turnTheme = themes(paint);
whenResized(paint);
function showBarred() {
  if (conflict) to(conflict.row);
  else showCut(barredArm);
}
$('blocked').hidden = !conflict && barredArm < 0;
$('blocked').textContent = conflict ? 'Where they meet' : endName(arms[barredArm]?.cut);
$('blocked').addEventListener('click', showBarred);

/** The address names the row once the cursor rests, so that the page opens there again. */
function noteAddress() {
  clearTimeout(noting);
  if (begun)
    noting = setTimeout(() => history.replaceState(null, '', `#row=${Math.round(cursor)}`), 400);
}
/** At the row that the address names (#row=12). */
function openAtAddress() {
  const row = Number(new URLSearchParams(location.hash.slice(1)).get('row') ?? NaN);
  if (!Number.isFinite(row) || !pair.moves) return false;
  to(row);
  return true;
}
if (!openAtAddress()) {
  if (conflict || barredArm >= 0) showBarred();
  else go(data.result.between_arms?.row ?? 0);
}
begun = true; // what is shown from now on is the user's choice
addEventListener('hashchange', openAtAddress);

startView(
  () => pair.scene(data),
  (started) => {
    view = started;
    colourPaths();
    draw(shown());
  },
  step,
);
