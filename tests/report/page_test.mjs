// SPDX-License-Identifier: BSD-3-Clause
// Plans the experiments with --report and uses the pages in headless Chromium. Arguments: the
// program, the problems' folder, the folder whose node_modules has playwright-core, and optionally
// a folder for screenshots.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { triangles } from '../../report/web/bytes.js';
import {
  assertFits,
  assertPrints,
  assertReachable,
  clickBodies,
  dataOf,
  heldBy,
  elements,
  press,
  saved,
  some,
  until,
  withBrowser,
} from './browser.mjs';
import { checkJumps, plotted } from './jumps.mjs';

const [swivel, problems, packages, shots] = process.argv.slice(2).map((path) => resolve(path));
const wide = { width: 1280, height: 800 },
  phone = { width: 390, height: 844 };

const plan = (folder, name, ...options) => planned(folder, `experiment_${name}`, ...options);
function planned(folder, name, ...options) {
  const html = join(folder, `${name}.html`),
    csv = join(folder, `${name}.csv`);
  const done = spawnSync(swivel, [
    'plan',
    join(problems, `${name}.yaml`),
    '--quiet',
    '--planner',
    'lazy',
    '--report',
    html,
    '--out',
    csv,
    ...options,
  ]);
  assert.ok(existsSync(html), String(done.stderr));
  const lines = existsSync(csv) ? readFileSync(csv, 'utf8').trim().split('\n') : null,
    // A motion has times before, speeds and accelerations behind the joints.
    columns = lines?.[0].startsWith('t,') ? [4, 11] : [-7],
    rows = lines?.slice(1).map((line) => line.split(',').slice(...columns).map(Number)) ?? null;
  return { html, rows, data: dataOf(html), status: done.status, bytes: statSync(html).size };
}
const drawn = (page) => until(page, () => window.swivel?.frames > 0);
const joints = (page) => page.evaluate(() => window.swivel.joints);
const slide = (page, row) =>
  page.evaluate((value) => {
    const slider = document.getElementById('slider');
    slider.value = value;
    slider.dispatchEvent(new Event('input'));
  }, row);
/** s of the pose that the numbers beside the arm speak of. */
const told = async (page) => Number((await page.textContent('#readout')).match(/^s ([\d.]+) m/)[1]);
/** A group of a regular expression: what the page says of the distance of two bodies that fail. */
const kDistances =
  '(at least [\\d.]+ mm inside each other|[\\d.]+ mm apart, asked 5 mm|they touch)';
const dark = (page) => page.evaluate(() => document.documentElement.dataset.theme === 'dark');

/** Milliseconds from the start of loading to the first picture of the arm. */
const firstPicture = (page) =>
  page.evaluate(() => performance.getEntriesByName('first picture')[0].startTime);

/**
 * Frames a second while the arm moves, once the page has found how many pixels this machine can
 * draw.
 */
async function playback(page) {
  await press(page, 'Home');
  await page.selectOption('#speed', '0.5');
  await page.keyboard.press('Tab');
  await page.click('#play');
  await page.waitForTimeout(1500);
  const begin = await page.evaluate(() => [window.swivel.frames, performance.now()]);
  await page.waitForTimeout(2000);
  const end = await page.evaluate(() => [window.swivel.frames, performance.now()]);
  assert.ok(Number(await page.inputValue('#slider')) > 0);
  await page.click('#play');
  return (1000 * (end[0] - begin[0])) / (end[1] - begin[1]);
}

/**
 * Every row's line is as long as its clearance and stands on the page; at most a few rows have
 * none.
 */
async function checkNearest(page, data) {
  let lines = 0;
  data.rows.forEach(({ nearest, clearance_mm }, k) => {
    if (clearance_mm === undefined) return;
    assert.notEqual(nearest, undefined);
    if (nearest === null) return;
    ++lines;
    const [ax, ay, az, bx, by, bz] = nearest;
    assert.ok(
      Math.abs(1e3 * Math.hypot(bx - ax, by - ay, bz - az) - clearance_mm) <= 0.1,
      `row ${k}`,
    );
  });
  assert.ok(
    lines >= 0.9 * data.rows.length,
    `${lines} of ${data.rows.length} rows have a line between their nearest bodies`,
  );
  const k = data.rows.findIndex(({ nearest }) => nearest);
  await slide(page, k);
  assert.deepEqual((await page.evaluate(() => window.swivel.line)).points, data.rows[k].nearest);
  assert.equal(
    parseFloat(await page.textContent('#gap')),
    Number(data.rows[k].clearance_mm.toPrecision(3)),
  );
}

/**
 * A click on any body that is seen says its name and what is nearest to it: of the two bodies of
 * the row what the row says, and between two rows what the nearer one says; along the path no more.
 */
async function checkClicks(page, data) {
  const last = data.rows.length - 1;
  let alike = 0,
    seen = 0;
  for (const at of [0, Math.floor(last / 3) + 0.3, last]) {
    await slide(page, at);
    const row = data.rows[Math.round(at)];
    await clickBodies(page, (name, lines) => {
      ++seen;
      if (lines.length === 2) return; // it has nothing to keep clear of
      const [, here, mm, other] = lines[1].match(/^(([\d.]+) mm from|touches) (\S+)/),
        [, least] = lines[2].match(
          /^nearest along the path: (?:([\d.]+) mm from|touches) \S+ at s/,
        );
      assert.ok(here && Number(least ?? 0) <= Number(mm ?? 0), lines.join('\n'));
      if (at % 1) assert.ok(lines[1].endsWith(` at s ${row.s.toFixed(4)} m`), lines[1]);
      if (!row.pair?.includes(name)) return;
      assert.deepEqual([name, other].sort(), [...row.pair].sort());
      assert.equal(Number(mm), Number(row.clearance_mm.toPrecision(3)));
      ++alike;
    });
  }
  assert.ok(alike >= 2 && seen >= 10, `${alike} of ${seen} bodies are of the row's pair`);
}

/**
 * Where the page cannot be unpacked it says why, above the answer and the map as they are without
 * JavaScript.
 */
async function checkStill(open, html, data) {
  const damaged = html.replace('.html', '_damaged.html'),
    text = readFileSync(html, 'utf8'),
    middle = text.indexOf('<script id="program"') + 100_000;
  writeFileSync(damaged, `${text.slice(0, middle)}AAAAAAAA${text.slice(middle + 8)}`);
  for (const [file, before, why] of [
    [html, 'delete window.DecompressionStream', /^This browser cannot unpack the page/],
    [damaged, undefined, /^This page is damaged: /],
  ]) {
    const still = await open(file, { viewport: wide, before });
    assert.match(await still.page.textContent('body > p'), why);
    assert.ok((await still.page.textContent('pre')).includes(data.answer.split('\n')[0]));
    assert.ok(await still.page.isVisible('svg rect'));
    assert.equal(await still.page.locator('.still').count(), 0);
    await assertFits(still.page, wide.width);
    await still.close();
  }
}

async function checkExports(page, name, panels) {
  for (const [section, least] of [
    ['map', panels],
    ['plots', 9],
  ]) {
    const buttons = page.locator(`#${section}-section h2 button`);
    const png = await saved(page, buttons.filter({ hasText: 'PNG' })),
      svg = await saved(page, buttons.filter({ hasText: 'SVG' }));
    assert.deepEqual(
      [png.name, svg.name],
      [`experiment_${name}_${section}.png`, `experiment_${name}_${section}.svg`],
    );
    assert.equal(png.bytes.subarray(1, 4).toString(), 'PNG');
    assert.equal(png.bytes.readUInt32BE(16), 3 * 640);
    const count = await elements(page, svg.bytes.toString());
    // Vectors, no pictures.
    assert.ok(count.svg > least && count.path >= least && !count.image, JSON.stringify(count));
    if (section === 'map') assert.ok(count.rect > 100);
  }
}

/** Where the tool is, in the base frame. */
function toolOf(chain, q) {
  let point = [3, 7, 11].map((k) => chain.home[k]);
  for (let j = 6; j >= 0; --j) {
    // Rodrigues' rotation about each joint's line, the last one first
    const { axis: u, point: p } = chain.joints[j],
      v = point.map((x, k) => x - p[k]),
      c = Math.cos(q[j]),
      s = Math.sin(q[j]),
      along = u.reduce((sum, x, k) => sum + x * v[k], 0);
    const cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    point = p.map((x, k) => x + v[k] * c + cross[k] * s + u[k] * along * (1 - c));
  }
  return point;
}

/**
 * The numbers beside the arm, those of the plots and the arm itself speak of one pose; its tool is
 * on the path where they say, within 1.5 mm.
 */
async function checkAgrees(page, data) {
  const readout = await page.textContent('#readout'),
    q = await joints(page),
    off = await page.isVisible('#plots .dot');
  for (const [k, { name }] of data.chain.joints.entries()) {
    const degrees = (q[k] * 180) / Math.PI,
      beside = Number(readout.match(new RegExp(`^${name}  (\\S+)°$`, 'm'))[1]),
      plot = Number(await plotted(page, name));
    assert.ok(
      Math.abs(beside - degrees) < 0.051,
      `${name}: ${beside}° beside an arm at ${degrees}°`,
    );
    assert.ok(
      Math.abs(plot - degrees) <= Math.max(0.051, 0.005 * Math.abs(degrees)),
      `${name}: ${plot}° above the plot of an arm at ${degrees}°`,
    );
  }
  const s = await told(page),
    k = data.rows.findIndex((row) => Math.abs(row.s - s) < 6e-5);
  if (k < 0) return off;
  const away = 1e3 * Math.hypot(...toolOf(data.chain, q).map((x, c) => x - data.tool_path[k][c]));
  assert.ok(away < 1.5, `the tool is ${away} mm from the path at s ${s}`);
  return off;
}

/**
 * The page opens at the pose that comes nearest to something; every part of the answer goes to
 * where it is true; views move the camera.
 */
async function checkAnswer(page, data) {
  const { summary } = data.result;
  const near = (a, b) => assert.ok(Math.abs(a - b) < 6e-5, `${a} for ${b}`);
  near(await told(page), summary.clearance?.s ?? summary.joint_limit.s);
  await checkJumps(page, data, () => checkAgrees(page, data));
  assert.match(
    await page.locator('#plots .plot h3').first().textContent(),
    new RegExp(`bold: ${summary.joint_limit.joint}, % of range`),
  );
  const frames = await page.evaluate(() => window.swivel.frames);
  for (const view of ['top', 'best']) await page.selectOption('#views', view);
  await until(page, (before) => window.swivel.frames > before, frames);
}

/** The arm is at joints q, or where its motion passes a row with these. */
async function assertStands(page, q) {
  const now = await joints(page);
  q.forEach((v, j) => assert.ok(Math.abs(now[j] - v) < 1e-3, `joint ${j + 1}: ${now[j]}, ${v}`));
}

/**
 * Arrows turn the arm while the tool stands still: up and down again is the same pose; the cursor's
 * next step ends it.
 */
async function checkSelfMotion(page, data) {
  const middle = data.rows.findIndex(({ layer }) => layer === Math.floor(data.map.layers / 2)),
    { q } = data.rows[middle];
  await slide(page, middle);
  await assertStands(page, q);
  await press(page, 'ArrowUp');
  const turned = await joints(page);
  assert.ok(turned.some((v, k) => Math.abs(v - q[k]) > 1e-3));
  assert.equal(await checkAgrees(page, data), true);
  await press(page, 'ArrowUp');
  await press(page, 'ArrowDown');
  assert.deepEqual(await joints(page), turned);
  await slide(page, middle);
  await assertStands(page, q);
}

/**
 * Some cell of the middle column has joints: hovering shows them and moves the arm, a click keeps
 * them. The path's tell clearance.
 */
async function checkHover(page, data) {
  const rest = await joints(page),
    dot = await page.locator('.panel .dot:visible').first().boundingBox();
  await page.mouse.move(dot.x + dot.width / 2, dot.y + dot.height / 2);
  if (!data.beside.length)
    assert.match(
      await page.textContent('#tip'),
      /free, (proved by a certificate|found by FCL)\n[^]*clearance [\d.]+ mm$/,
    );
  const box = await page.locator('.panel .chart').first().boundingBox();
  let moved = false;
  for (let k = 1; k < 20 && !moved; ++k) {
    await page.mouse.move(box.x + box.width * 0.4, box.y + (box.height * k) / 21);
    assert.ok(await page.isVisible('#tip'));
    await checkAgrees(page, data);
    moved = JSON.stringify(await joints(page)) !== JSON.stringify(rest);
  }
  assert.ok(moved, "no cell of the path's branch moves the arm");
  const hovered = await joints(page);
  await page.mouse.down();
  await page.mouse.up();
  await page.mouse.move(5, 5);
  assert.deepEqual(await joints(page), hovered, 'a click keeps the pose');
  await checkAgrees(page, data);
}

/** Numbers, options and legend stand beside the picture. */
async function checkNothingOver(page) {
  const scene = await page.locator('#scene').boundingBox();
  for (const id of ['readout', 'view-options', 'bodies']) {
    const box = await page.locator(`#${id}`).boundingBox();
    assert.ok(
      box.x >= scene.x + scene.width - 1 || box.y >= scene.y + scene.height - 1,
      `#${id} covers the arm: ${JSON.stringify([box, scene])}`,
    );
  }
}
/** Where nothing of the arm has the focus, keys scroll. */
async function checkKeysScroll(page) {
  const at = await page.inputValue('#slider');
  await page.evaluate(() => (document.activeElement?.blur(), scrollTo(0, 0)));
  await page.keyboard.press('End');
  await until(page, () => scrollY > 100);
  assert.equal(await page.inputValue('#slider'), at);
  await page.waitForTimeout(500); // the page scrolls on for a while
  await page.locator('#scene:visible, #slider').first().focus();
  const scrolled = await page.evaluate(() => scrollY);
  await page.keyboard.press('End');
  assert.equal(await page.inputValue('#slider'), await page.getAttribute('#slider', 'max'));
  await page.waitForTimeout(200);
  assert.equal(await page.evaluate(() => scrollY), scrolled);
  await page.evaluate(() => scrollTo(0, 0));
}
/** Played, the map's cursor goes from row to row without jumps, the short way round the map. */
async function checkCursorMoves(page, { rows }) {
  const place = () =>
    page.evaluate(() => {
      const panel = document.querySelector('.panel:not(.other)'),
        at = (part) => new DOMMatrix(getComputedStyle(panel.querySelector(part)).transform),
        { e, f } = at('.dot');
      return { line: at('.cursor').e, x: e, y: f };
    });
  const knots = [];
  for (let k = 0; k < rows.length; ++k) {
    await slide(page, k);
    knots.push(await place());
  }
  const height = await page.evaluate(() => document.querySelector('.panel .chart').clientHeight),
    pitch = (knots.at(-1).x - knots[0].x) / (rows.length - 1);
  await slide(page, 0);
  await page.evaluate(() => document.getElementById('play').click());
  const seen = [];
  while (!seen.length || seen.at(-1).x < knots[3].x) seen.push(await place());
  await page.evaluate(() => document.getElementById('play').click());
  let between = 0;
  for (const { line, x, y } of seen) {
    const k = Math.min(knots.length - 2, knots.findLastIndex((knot) => knot.x <= x + 0.05)),
      [a, b] = [knots[k], knots[k + 1]],
      [low, high] = [Math.min(a.y, b.y) - 0.2, Math.max(a.y, b.y) + 0.2],
      isRound = high - low > height / 2;
    assert.equal(line, x);
    assert.ok(isRound ? y <= low + 0.4 || y >= high - 0.4 : y >= low && y <= high);
    between += x > a.x + 0.1 * pitch && x < b.x - 0.1 * pitch;
  }
  console.log(`${between} of ${seen.length} places of the cursor are between rows`);
  assert.ok(between >= 6, `${between} of ${seen.length}`);
}
/** Charts have names; entries of the legend fade and hide bodies. */
async function checkLegend(page) {
  const names = await page.$$eval('.chart', (all) => all.map((one) => one.ariaLabel));
  assert.ok(names.length > 10 && names.every((name) => name?.length > 10), names.join('; '));
  const looks = () =>
    page.evaluate(() => {
      const [first] = window.swivel.view.arm.filter(({ userData }) => userData.body.group > 0);
      return [first.visible, first.material.transparent];
    });
  const colours = new Set(),
    ends = new Set();
  for (const kind of ['clearance', 'phi', 'margin', 'manipulability']) {
    await page.selectOption('#path-colour', kind);
    colours.add(
      await page.evaluate(() => window.swivel.view.lines[0].tube.attributes.color.array.join()),
    );
    ends.add(await page.textContent('#ramp'));
  }
  assert.equal(colours.size, 4);
  assert.equal(ends.size, 4);
  await page.selectOption('#path-colour', 'clearance');
  const arm = page.locator('#bodies button').filter({ hasText: /^arm/ });
  assert.deepEqual(await looks(), [true, false]);
  await arm.click();
  assert.deepEqual(await looks(), [true, true]);
  await arm.click();
  assert.equal((await looks())[0], false);
  await arm.click();
  assert.deepEqual(await looks(), [true, false]);
}

await withBrowser({ packages, shots }, async ({ folder, open, shoot }) => {
  // Nothing stands over the first picture; what it shows, sight_test.mjs holds.
  for (const viewport of [wide, phone]) {
    const { html } = planned(folder, 'kr6_weld_pipe', '--ds', '0.01'),
      { page, close } = await open(html, { viewport, colorScheme: 'light' });
    await drawn(page);
    await checkNothingOver(page);
    await close();
  }

  // A mesh of the page is that of its file, triangle by triangle.
  {
    const { html, data, bytes } = plan(folder, 'c', '--ds', '0.05', '--dphi', '0.3'),
      stl = readFileSync(join(problems, '../meshes/door_2k.stl'));
    globalThis.swivelPage = { bytes: heldBy(html).binary };
    const { points, corners } = triangles(data.meshes[0]);
    assert.equal(data.meshes.length, 1);
    const count = stl.readUInt32LE(80);
    assert.equal(corners.length, 3 * count);
    let furthest = 0;
    for (let k = 0; k < 3 * count; ++k)
      for (let axis = 0; axis < 3; ++axis) {
        const at = 84 + 50 * Math.floor(k / 3) + 12 + 12 * (k % 3) + 4 * axis;
        furthest = Math.max(
          furthest,
          Math.abs(stl.readFloatLE(at) - points[3 * corners[k] + axis]),
        );
      }
    assert.ok(count > 1000 && furthest < 6e-6, `${count} triangles, ${furthest} m off`);
    const size = data.meshes[0].points[1] + data.meshes[0].corners[1];
    console.log(`${count} triangles in ${size} of ${bytes} bytes`);
    assert.ok(size < 20 * count);
    const { page, close } = await open(html, { viewport: wide });
    await drawn(page);
    await checkCursorMoves(page, data);
    await close();
  }

  // With the part in the hand the robot's base stands, and the part moves.
  {
    const { html, data } = planned(folder, 'iiwa14_deburr_in_hand', '--ds', '0.02');
    const { page, close } = await open(html, { viewport: wide, colorScheme: 'light' });
    await drawn(page);
    const poses = () =>
      page.evaluate(() => {
        const { arm, scene } = window.swivel.view;
        scene.updateMatrixWorld();
        const of = (wanted) => [...arm.find(wanted).matrixWorld.elements];
        return {
          base: of(({ userData }) => userData.body.stands),
          spindle: of(({ userData }) => userData.body.name === 'spindle'),
          plate: of(({ userData }) => userData.body.name === 'plate'),
        };
      });
    await slide(page, 0);
    const first = await poses();
    await slide(page, data.rows.length - 1);
    const last = await poses(),
      most = (name) => Math.max(...first[name].map((v, k) => Math.abs(v - last[name][k])));
    assert.ok(most('base') < 1e-9 && most('spindle') < 1e-9 && most('plate') > 0.05);
    // The spindle points upwards from where the file has it in the base's frame.
    assert.ok(
      Math.hypot(last.spindle[12] - 0.5, last.spindle[13] - 0.1, last.spindle[14] - 0.22) < 1e-6,
    );
    assert.equal(await page.locator('#bodies').getByText('base of the robot').count(), 1);
    await close();
  }

  for (const name of [...some(['a', 'b']), 'c']) {
    const { html, rows, data, status, bytes } = plan(folder, name);
    assert.equal(status, 0);
    assert.ok(bytes <= 1e6, `${bytes} bytes`);
    const { page, close } = await open(html, {
      viewport: wide,
      colorScheme: name === 'b' ? 'dark' : 'light',
    });
    await drawn(page);
    assert.match(
      await page.textContent('#verdict'),
      /^Solved: \d+ layers, cost [\d.]+ · .* from its limit at s /,
    );
    await checkAnswer(page, data);
    assert.equal(await dark(page), name === 'b');
    await assertFits(page, wide.width);
    for (const k of [0, Math.floor(rows.length / 2), rows.length - 1]) {
      await slide(page, k);
      const shown = await joints(page);
      rows[k].forEach((value, j) =>
        assert.ok(
          Math.abs(value - shown[j]) < 1e-12,
          `row ${k} joint ${j}: ${value} in the file, ${shown[j]} on the page`,
        ),
      );
    }
    await press(page, 'Home');
    await press(page, 'ArrowRight');
    assert.deepEqual(
      (await joints(page)).map((v) => v.toFixed(9)),
      rows[1].map((v) => v.toFixed(9)),
    );
    await checkNearest(page, data);
    await checkClicks(page, data);
    await slide(page, Math.floor(rows.length / 2));
    await shoot(page, `report_${name}.png`);
    await checkSelfMotion(page, data);
    await slide(page, Math.floor(rows.length / 2));
    await checkHover(page, data);
    await checkExports(page, name, data.map.panels.length);
    await checkLegend(page);
    await checkKeysScroll(page);
    await assertPrints(page);
    await press(page, 't');
    assert.equal(await dark(page), name !== 'b');
    const opening = await firstPicture(page);
    const rate = name === 'c' ? await playback(page) : null;
    await page.setViewportSize(phone);
    await assertFits(page, phone.width);
    await close();
    if (name === 'c') {
      // Without WebGL all but the arm is there; an address may name the place to open at.
      const flat = await open(html, {
        viewport: wide,
        hash: '#s=0.2',
        before:
          'HTMLCanvasElement.prototype.getContext = ((own) => function (kind, ...rest) { return ' +
          '/webgl/.test(kind) ? null : own.call(this, kind, ...rest); ' +
          '})(HTMLCanvasElement.prototype.getContext);',
      });
      await flat.page.waitForSelector('#no-view:not([hidden])');
      assert.ok(
        Math.abs(Number((await flat.page.textContent('#readout')).match(/s ([\d.]+) m/)[1]) - 0.2) <
          0.01,
      );
      assert.ok(
        (await flat.page.locator('.panel .chart svg').count()) > 1 &&
          (await flat.page.locator('#plots .plot').count()) > 9,
      );
      await press(flat.page, 'End');
      assert.equal(
        await flat.page.inputValue('#slider'),
        await flat.page.getAttribute('#slider', 'max'),
      );
      await flat.close({ withErrors: true }); // three.js reports the missing context as one
      await checkStill(open, html, data);
    }
    console.log(
      `experiment ${name}: ${(bytes / 1e6).toFixed(2)} MB, first picture after ` +
        `${opening.toFixed(0)} ms` +
        `${rate === null ? '' : `, ${rate.toFixed(0)} frames a second`}`,
    );
    // Not the aim, 2 s and 30 frames: this must hold on any machine, however busy.
    assert.ok(opening < 10_000);
    assert.ok(rate === null || rate > 3);
  }

  // Rolls: every row of the trajectory is there, those between the layers of the lattice as well.
  // Arcs: joints of several turns stand as in the trajectory; cells between two nodes of an arc are
  // filled, and the coordinate has its name and range.
  for (const [name, letter, options] of [
    ...some([
      ['torch_door', 'φ', []],
      ['torch_door', 'φ', ['--refine', '--speed', '0.1']],
    ]),
    ...some([
      ['panda_weld_seam', 'joint_5', ['--ds', '0.01']],
      ['kr6_weld_pipe', 'ρ', []],
    ]),
  ]) {
    const { html, rows, data, status } = planned(folder, name, ...options);
    assert.equal(status, 0);
    const { map } = data,
      arcs = name !== 'torch_door';
    assert.deepEqual(
      data.rows.map(({ q }) => q),
      data.result.trajectory.map((row) => row.joints),
    );
    assert.equal(data.tool_path.length, data.rows.length);
    assert.deepEqual([data.rows[0].layer, data.rows.at(-1).layer], [0, map.layers - 1]);
    assert.ok(data.rows.every(({ layer }, k) => !k || layer > data.rows[k - 1].layer));
    if (!arcs) assert.ok(data.rows.length > 4 * map.layers);
    const { page, close } = await open(html, { viewport: wide, colorScheme: 'light' });
    await drawn(page);
    await checkAnswer(page, data);
    for (const k of [1, 2, Math.floor(data.rows.length / 2), data.rows.length - 2]) {
      await slide(page, k);
      if (!data.motion)
        rows[k].forEach((value, j) => assert.ok(Math.abs(value - data.rows[k].q[j]) < 1e-12));
      assert.ok(Math.abs((await told(page)) - data.rows[k].s) < 6e-5);
      assert.equal(await checkAgrees(page, data), false);
    }
    await slide(page, 0.5); // between two rows
    assert.ok(Math.abs((await told(page)) - (data.rows[0].s + data.rows[1].s) / 2) < 6e-5);
    await checkAgrees(page, data);
    const half = Math.floor(data.rows.length / 2);
    await slide(page, data.rows.findIndex(({ layer }, k) => k >= half && layer % 1 === 0));
    await checkHover(page, data);
    await checkSelfMotion(page, data);
    assert.equal(
      await page.textContent('#map-section h2 >> text=/map/').then((text) => text.includes(letter)),
      true,
    );
    if (arcs) {
      const states = heldBy(html).bytes(map.states),
        panels = map.panels.length;
      let holes = 0,
        between = 0;
      for (let column = 0; column < map.columns; ++column)
        for (let panel = 0; panel < panels; ++panel) {
          const run = [
            ...states.subarray(
              (column * panels + panel) * map.rows,
              (column * panels + panel + 1) * map.rows,
            ),
          ].map((state) => state & 7);
          const first = run.findIndex((state) => state),
            last = run.findLastIndex((state) => state);
          if (first >= 0)
            ((holes += run.slice(first, last + 1).filter((state) => !state).length),
              (between += last - first + 1));
        }
      console.log(
        `${name}: ${((100 * holes) / between).toFixed(1)} % of ${between} cells between the ` +
          'lowest and highest of a layer are empty',
      );
      // Arcs of one branch lie apart on the weld seam; MapOfArcs in C++ tests cells within an arc.
      const most = name === 'panda_weld_seam' ? 0.31 : 0.25;
      assert.ok(between > 1000 && holes < most * between);
      assert.ok(map.closed || map.step * (map.angles - 1) < 5.5);
    }
    await assertFits(page, wide.width);
    await shoot(page, `report_${name}.png`);
    await close();
  }

  // Refined, and in time: the page plays at the motion's own speed, and shows the rows that are
  // executed.
  {
    const { html, data, status, rows: executed } = plan(folder, 'b', '--refine', '--speed', '0.1');
    assert.equal(status, 0);
    const { motion, result, rows, beside } = data,
      n = motion.t.length;
    for (const key of ['layers', 'tool_mm_s', 'speed', 'acceleration', 'jerk'])
      assert.equal(motion[key].length, n);
    assert.ok(Math.abs(motion.t[n - 1] - result.motion.duration) < 0.01);
    assert.ok(
      motion.layers.every((layer, k) => k === 0 || layer >= motion.layers[k - 1]) &&
        motion.layers[0] === 0 &&
        Math.abs(motion.layers[n - 1] - (rows.length - 1)) < 1e-6,
    );
    assert.ok(Math.max(...motion.tool_mm_s) <= 100.1 && Math.max(...motion.tool_mm_s) > 99);
    for (const key of ['speed', 'acceleration', 'jerk']) {
      const told = Math.max(...result.motion.peaks[key].map(({ ratio }) => ratio));
      assert.ok(
        Math.abs(Math.max(...motion[key]) / 100 - told) < 1e-6,
        `${key}: ${Math.max(...motion[key])} % on the page, ${told} in the result`,
      );
    }
    rows.forEach((row, k) => assert.deepEqual(row.q, result.trajectory[k].joints));
    assert.equal(beside.length, rows.length);
    assert.ok(beside.some(({ angle }, k) => Math.abs(angle - rows[k].angle) > 1));
    const { page, close } = await open(html, { viewport: wide, colorScheme: 'dark' });
    await drawn(page);
    assert.equal(await dark(page), true);
    await press(page, 't');
    assert.equal(await dark(page), false);
    assert.ok(await page.isVisible('#motion-section'));
    assert.equal(await page.locator('#motion .plot').count(), 4);
    await assertReachable(page);
    assert.match(await page.textContent('#map-note'), /before it was refined/);
    assert.match(await page.textContent('#tables'), /Refinement[^]*Motion/);
    const seconds = async () =>
      Number((await page.textContent('#where')).match(/, ([\d.]+) \//)[1]);
    await press(page, 'Home');
    assert.equal(await seconds(), 0);
    await page.click('#play');
    const begin = [await seconds(), Date.now()];
    await page.waitForTimeout(2000);
    const end = [await seconds(), Date.now()];
    await page.click('#play');
    const pace = (1000 * (end[0] - begin[0])) / (end[1] - begin[1]);
    assert.ok(pace > 0.7 && pace < 1.3, `${pace} s of the motion in a second`);
    // Wherever it stands, the arm is where the file of the motion says.
    for (const share of [0.1, 0.37, 0.62, 0.9]) {
      await slide(page, share * (rows.length - 1));
      const at = (await page.evaluate(() => window.swivel.time)) * result.motion.rate,
        k = Math.floor(at),
        now = await joints(page);
      executed[k].forEach((q, j) => {
        const wanted = q + (at - k) * (executed[k + 1][j] - q);
        assert.ok(Math.abs(now[j] - wanted) < 1e-6, `joint ${j + 1}: ${now[j]}, ${wanted}`);
      });
    }
    // The slider and the plots stand for the same moment.
    const middle = Math.floor(rows.length / 2);
    await slide(page, middle);
    const at = motion.layers.findIndex((layer) => layer >= middle);
    assert.ok(Math.abs((await seconds()) - motion.t[at]) < 0.05);
    const chart = page.locator('#motion .chart').last(),
      { width } = await chart.boundingBox();
    await page.evaluate(() => document.getElementById('summary').scrollIntoView({ block: 'end' }));
    await chart.click({ position: { x: 0.3 * width, y: 40 } });
    const there = await seconds();
    assert.ok(there > 0.1 * motion.t[n - 1] && there < 0.5 * motion.t[n - 1]);
    const buttons = page.locator('#motion-section h2 button');
    const svg = await saved(page, buttons.filter({ hasText: 'SVG' }));
    assert.equal(svg.name, 'experiment_b_motion.svg');
    assert.ok((await elements(page, svg.bytes.toString())).path >= 4);
    await assertFits(page, wide.width);
    await shoot(page, 'report_motion.png', { fullPage: true });
    await close();
  }

  // Where there is no path: the furthest layer, why, and the pose past it. By the joints, by a
  // body, and in the first layer.
  for (const [name, reason, reached, ...options] of [
    [
      'a_start',
      /^no way on from here: joint arm_left_joint_5_r, [\d.]+° beyond 179\.34°$/,
      true,
    ],
    ...some([
      ['5_r', 'the next pose is', true, '258'],
      ['6_b', 'a pose of the first layer,', false, '33'],
    ]).map(([link, pose, reached, episode]) => [
      'c',
      new RegExp(`^${pose} blocked by arm_left_link_${link} - post: ${kDistances}$`),
      reached,
      ...['--ds', '0.02', '--dphi', '0.2', '--seed', '1', '--episode', episode],
    ]),
  ]) {
    const { html, rows, data, status } = plan(folder, name, '--advise', '1', ...options);
    assert.equal(status, 1);
    assert.equal(rows, null);
    const viewport = name === 'a_start' ? phone : wide;
    const { page, close } = await open(html, { viewport, colorScheme: 'light' });
    await drawn(page);
    assert.match(
      await page.textContent('#verdict'),
      new RegExp(
        '^No path at this resolution with torso_joint_b1 held at 0 rad: ' +
          (reached ? 'every one ends by layer \\d+ of \\d+' : 'the first layer has no valid node'),
      ),
    );
    assert.match(data.cut.what, reason);
    const episode = options.includes('--episode')
      ? `, episode ${options.at(options.indexOf('--episode') + 1)} of seed 1`
      : '';
    assert.equal(await page.textContent('#title'), `experiment_${name}.yaml${episode}`);
    // The line between bodies that are too near is as long as they are apart; those inside each
    // other have a point where they meet.
    assert.equal(await page.isVisible('#gap'), data.cut.line !== null);
    if (name === 'c') {
      const [ax, ay, az, bx, by, bz] = data.cut.line.points,
        apart = data.cut.what.match(/([\d.]+) mm apart/);
      assert.ok(
        Math.abs(1e3 * Math.hypot(bx - ax, by - ay, bz - az) - (apart ? Number(apart[1]) : 0)) <=
          0.11,
      );
    }
    // Without JavaScript: the same answer in words, and the map.
    const still = await open(html, { viewport, javaScriptEnabled: false });
    assert.ok(
      (await still.page.textContent('noscript pre')).includes(
        (await page.textContent('#verdict')).split(/[;.] /)[0].slice(1, 40),
      ),
    );
    assert.ok(
      (await still.page.isVisible('noscript svg polyline, noscript svg rect')) &&
        !(await still.page.isVisible('main')),
    );
    await shoot(still.page, `report_still_${name}.png`);
    await still.close();
    const helps = data.result.advice.filter(({ outcome }) => outcome === 'solved');
    assert.match(
      await page.textContent('#verdict'),
      helps.length ? /What would help: / : /Nothing that was tried helps/,
    );
    if (helps.length) assert.ok((await page.textContent('#verdict')).includes(helps[0].words));
    for (const { words } of data.result.advice)
      assert.ok((await page.textContent('#tables')).includes(words));
    assert.equal((await page.textContent('#readout')).split('\n').at(-1), data.cut.what);
    assert.deepEqual(await joints(page), data.cut.q);
    if (reached) await checkAgrees(page, data);
    assert.equal(data.cut.layer, data.rows.length - (data.cut.is_row ? 1 : 0));
    assert.equal(data.cut.is_row, name === 'a_start' ? true : undefined);
    if (data.cut.is_row) {
      // The posture is that of which the verdict speaks, in all places.
      assert.deepEqual(await joints(page), data.rows.at(-1).q);
      assert.ok(Math.abs((await told(page)) - data.result.diagnosis.reached_s) < 6e-5);
      assert.match(await page.textContent('#readout'), /5_r {2}179\.\d\d°/);
    }
    if (reached) {
      assert.equal(await page.inputValue('#slider'), await page.getAttribute('#slider', 'max'));
      assert.match(
        await page.textContent('#map-note'),
        /The dashed line is where every path has ended/,
      );
      assert.match(await page.textContent('#tables'), /Removed past the furthest layer/);
      await press(page, 'Home');
      assert.deepEqual(await joints(page), data.rows[0].q);
      await page.click('#blocked');
      assert.deepEqual(await joints(page), data.cut.q);
    }
    await assertFits(page, viewport.width);
    if (name === 'a_start') {
      await page.setViewportSize(wide);
      await assertFits(page, wide.width);
      await press(page, 'End'); // back onto the path
      await checkHover(page, data);
      await page.setViewportSize(phone);
    }
    if (reached) {
      await page.click('#blocked');
      await shoot(page, name === 'c' ? 'report_blocked.png' : 'report_phone.png');
    }
    // Nothing to play or plot.
    else
      assert.ok(!(await page.isVisible('#controls')) && !(await page.isVisible('#plots-section')));
    await close();
  }
});
