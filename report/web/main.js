// SPDX-License-Identifier: BSD-3-Clause
// The report of one plan: text, map and plots first, then the arm; one cursor moves in all of them.
import { savers } from './figure.js';
import { Cells, mapNote, mapTitle } from './map.js';
import { Nearness, placesOf } from './nearness.js';
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
  jointsOf,
  offPath,
  placeWords,
  poseAt,
  rowOf,
  shading,
  stepsOf,
  valueAt,
} from './poses.js';
import { tellPose } from './readout.js';
import { startView } from './scene.js';
import { alongRows, overTime } from './series.js';
import { summary, verdict } from './summary.js';

const { rows, chain, cut, motion } = data;
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
  turned = null,
  told = 0,
  begun = false,
  noting = 0;
/** For those who test the page: joints, line and time shown now, pictures drawn. */
window.swivel = { joints: null, frames: 0, line: null, time: null };

const player = new Player(() => {
  if (rows.length && cursor >= last) go((time = 0));
  return rows.length > 0;
});
const pause = () => player.pause();
const steps = stepsOf(rows, chain),
  nearness = new Nearness(data.near, placesOf(rows));
const plots = new Plots(
  $('plots'),
  rows.map((row) => row.s),
  alongRows(chain, rows, data.settings, data.result.summary),
  (k) => {
    pause();
    go(k);
  },
);

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
// In time: the motion's own, where there is one; a cursor along the path stands for a moment, and
// the other way round.
const timed =
  motion &&
  new Plots(
    $('motion'),
    motion.t,
    overTime(motion, 1e3 * data.result.motion.speed),
    (k) => {
      pause();
      time = momentOf(k);
      go(layerAt(time));
    },
    't, s',
  );
const joints = motion && jointsOf(motion, chain);
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

function hover(cell, event) {
  hovered = cell?.q ? offPath(cell, rowOf(rows, cell.layer)) : null;
  if (hovered) pause();
  present();
  if (!cell) return tell(null);
  tell(cellWords(cell, chain, data.map), event);
}
function pick(cell) {
  pause();
  go(rowOf(rows, cell.layer) ?? last);
  if (cell.q) keep(cell);
}
/** Shows a pose away from the path until the cursor moves. */
function keep(at) {
  hovered = null;
  kept = offPath(at, rowOf(rows, at.layer));
  present();
}
/**
 * Turns the arm about its tool where it stands: to the next cell of the same solution that has
 * other joints, up or down in the map.
 */
function turn(by) {
  if (!rows.length) return;
  const next = cellBeside(cells, rows[Math.round(cursor)], turned, by);
  if (!next) return;
  pause();
  keep(next.cell);
  turned = next.turned;
}
function shown() {
  if (hovered ?? kept) return hovered ?? kept;
  if (!rows.length) return null;
  const pose = poseAt(rows, steps, cursor);
  return timed ? { ...pose, q: joints(time) } : pose;
}
/** The arm, its numbers, and the cursors of map and plots: all of one pose. */
function present() {
  const pose = shown();
  if (!pose) return;
  draw(pose);
  panels.draw(pose);
  // What is told in numbers and beside the arm need not change with every frame.
  if (player.playing && performance.now() - told < 60) return;
  told = performance.now();
  const digits = pose.off ? 1 : 2;
  tellPose($('readout'), chain, placeWords(pose, data.map, 4), pose, digits);
  plots.draw(pose.row, pose);
}
function draw({ q, pair, line, hit, off, row }) {
  view?.pose(q, pair, line, hit, (name) => nearness.lines(name, off ? null : row));
  Object.assign(window.swivel, { joints: q, line, time });
}
/** To row k, not always whole. */
function go(k) {
  if (!rows.length) return;
  noteAddress();
  cursor = Math.min(last, Math.max(0, k));
  if (timed && Math.abs(layerAt(time) - cursor) > 1e-9)
    time = momentOf(indexAt(motion.layers, cursor));
  kept = hovered = turned = null;
  const late = player.playing && performance.now() - told < 60;
  present();
  if (late) return;
  const { s } = poseAt(rows, steps, cursor);
  slideTo(cursor, `s ${s.toFixed(3)} m${timed ? `, ${time.toFixed(2)} s` : ''}`);
  $('where').textContent =
    `${Math.round(cursor)} / ${last}` +
    `${timed ? `, ${time.toFixed(2)} / ${number(motion.t.at(-1))} s` : ''}`;
  timed?.draw(indexAt(motion.t, time));
}
/** Plays on; true while it plays. now: ms. */
function step(now) {
  if (!player.playing) return false;
  // A motion takes its own time at speed 1, a path without one eight seconds.
  const passed = player.passed(now);
  time += passed;
  go(timed ? layerAt(time) : cursor + (passed / 8) * last);
  if (timed ? time >= motion.t.at(-1) : cursor >= last) {
    pause();
    go(last);
  }
  return player.playing;
}

$('controls').hidden = $('plots-section').hidden = !rows.length;
$('motion-section').hidden = !timed;
$('slider').max = Math.max(0, last);
$('slider').addEventListener('input', (event) => {
  pause();
  go(Number(event.target.value));
});
$('path-colour').addEventListener('change', colourPath);
viewOptions(
  () => view,
  () => window.swivel.joints,
);
const to = (k) => {
  pause();
  go(k);
};
keys({
  ' ': () => player.turn(),
  ArrowLeft: (step) => to(Math.round(cursor) - step),
  ArrowRight: (step) => to(Math.round(cursor) + step),
  ArrowUp: () => turn(1),
  ArrowDown: () => turn(-1),
  Home: () => to(0),
  End: () => to(last),
  t: () => turnTheme(),
  ...viewKeys(() => view),
});

function colourPath() {
  const path = { rows, chain, map: data.map },
    { ends, of } = shading($('path-colour').value, [path]),
    [low, , high] = $('ramp').children;
  [low.textContent, high.textContent] = ends;
  view?.colourPath(data.tool_path.map((_, k) => (rows[k] ? of(path, rows[k], k) : NaN)));
}
function paint() {
  view?.paint();
  panels.paint();
  plots.paint();
  timed?.paint();
}

$('map-note').textContent = mapNote(cells, data.result.lattice, {
  beside: data.beside.length > 0,
  ended: !solved && rows.length > 0,
});
const stem = data.problem.replace(/\.[^.]*$/, '');
savers(document.querySelector('#plots-section h2'), `${stem}_plots`, () => plots.figure());
if (timed)
  savers(document.querySelector('#motion-section h2'), `${stem}_motion`, () => timed.figure());
document.querySelector('#map-section h2').firstChild.textContent = mapTitle(cells);
$('path-colour').querySelector('[value=phi]').textContent = cells.letter;
savers(document.querySelector('#map-section h2'), `${stem}_map`, () => panels.figure());

const turnTheme = themes(paint);
whenResized(paint);
function showCut() {
  pause();
  go(last);
  kept = endPose(cut, rows, steps);
  present();
}
$('blocked').textContent = endName(cut);
$('blocked').hidden = !cut;
$('blocked').addEventListener('click', showCut);
/** The address names the place once the cursor rests, so that it opens there again. */
function noteAddress() {
  clearTimeout(noting);
  if (begun)
    noting = setTimeout(() => {
      const s = valueAt(
        rows.map((row) => row.s),
        cursor,
      );
      history.replaceState(null, '', `#s=${s.toFixed(4)}`);
    }, 400);
}
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
begun = true; // what is shown from now on is the user's choice
addEventListener('hashchange', openAtAddress);

startView(
  () => data,
  (begun) => {
    view = begun;
    colourPath();
    if (shown()) draw(shown());
  },
  step,
);
