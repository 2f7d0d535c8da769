// SPDX-License-Identifier: BSD-3-Clause
// Plans workcells with --report and uses their pages in headless Chromium. Arguments as of
// page_test.mjs.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import {
  assertFits,
  assertLabelsApart,
  assertPrints,
  assertReachable,
  clickBodies,
  dataOf,
  elements,
  press,
  saved,
  until,
  withBrowser,
} from './browser.mjs';

const [swivel, problems, packages, shots] = process.argv.slice(2).map((path) => resolve(path));
const wide = { width: 1280, height: 800 },
  phone = { width: 390, height: 844 },
  kNames = ['left', 'right'];

/** A workcell whose tools go along two lines, [from, to, turn about the vertical, rad] of each. */
function lines(folder, name, both, { scene = [], coarse = null } = {}) {
  const file = join(folder, `${name}.yaml`),
    robots = resolve(problems, '../robots');
  const arms = both.map(([from, to, yaw], k) => ({
    name: kNames[k],
    tip_link: `arm_${kNames[k]}_link_tool0`,
    tool: { xyz: [0, 0, 0.1] },
    attached: [
      {
        name: `${kNames[k]}_tool`,
        capsule: { radius: 0.025, length: 0.04 },
        xyz: [0, 0, 0.048],
      },
    ],
    path: { waypoints: [from, to].map((xyz) => ({ xyz, rpy: [0, 1.5707963, yaw] })) },
  }));
  const robot = {
    urdf: join(robots, 'sda10f.urdf'),
    srdf: join(robots, 'sda10f.srdf'),
    base_link: 'base_link',
    hold: { torso_joint_b1: 0 },
  };
  const resolution = { ds: 0.01, dphi: 0.1 };
  writeFileSync(file, JSON.stringify({ robot, arms, resolution, scene, ...coarse }));
  return file;
}
// The tools cross, one above the other: the forearms would meet on the cheapest paths.
const kCrossing = [
    [[0.6, 0.15, 0.91], [0.6, -0.04, 0.89], -0.38],
    [[0.64, -0.12, 1.09], [0.64, 0.08, 1.11], 0.1],
  ],
  // The forearms meet on all paths.
  kMeeting = [
    [[0.59, 0.22, 0.97], [0.59, -0.12, 0.99], -0.24],
    [[0.66, -0.2, 1.16], [0.66, 0.1, 1.07], 0],
  ],
  middle = ([from, to]) => from.map((x, k) => (x + to[k]) / 2);

/** Plans a workcell with a page; what the page and --json say. */
function planned(folder, file, ...options) {
  const [html, json] = ['html', 'json'].map((end) => join(folder, `workcell.${end}`));
  const done = spawnSync(swivel, [
    'plan',
    file,
    '--quiet',
    '--report',
    html,
    '--json',
    json,
    ...options,
  ]);
  assert.ok(done.status <= 1, String(done.stderr));
  return {
    html,
    status: done.status,
    bytes: statSync(html).size,
    data: dataOf(html),
    result: JSON.parse(readFileSync(json, 'utf8')),
  };
}
const shown = (page) => page.evaluate(() => ({ ...window.swivel }));
const slide = (page, value) =>
  page.evaluate((to) => {
    const slider = document.getElementById('slider');
    slider.value = to;
    slider.dispatchEvent(new Event('input'));
  }, value);
const drawn = (page) => until(page, () => window.swivel?.frames > 0);
function assertNear(found, expected, tolerance, what) {
  assert.equal(found.length, expected.length, what);
  found.forEach((value, k) =>
    assert.ok(
      Math.abs(value - expected[k]) <= tolerance,
      `${what}, ${k}: ${value} for ${expected[k]}`,
    ),
  );
}
const rounded = (value, count) => String(Number(value.toPrecision(count)));

/** Picture, legend and options are seen above the slider without scrolling, on a laptop, too. */
async function checkWhole(page) {
  for (const viewport of [{ width: 1100, height: 700 }, wide]) {
    await page.setViewportSize(viewport);
    const box = (id) => page.locator(id).boundingBox(),
      [view, legend, controls] = [await box('#view'), await box('#bodies'), await box('#controls')];
    assert.ok(view.y + view.height <= controls.y, JSON.stringify([viewport, view, controls]));
    assert.ok(legend.y + legend.height <= view.y + view.height && legend.height > 20);
  }
}
/** Each body is in the scene once, and the bodies that an arm moves are those of that arm. */
function checkBodies({ data }) {
  const all = data.bodies.map(({ arm, ...body }) => JSON.stringify(body));
  assert.equal(new Set(all).size, all.length, 'a body is drawn twice');
  const groups = { left: [1, 7], right: [8, 14] };
  let moved = 0;
  for (const { name, arm, group } of data.bodies) {
    if (arm === undefined) {
      assert.equal(group, 0, name);
      continue;
    }
    ++moved;
    const [first, last] = groups[arm];
    assert.ok(group >= first && group <= last, `${name} of ${arm}: group ${group}`);
    const side = name.match(/^arm_(left|right)_/)?.[1];
    if (side) assert.equal(side, arm, name);
  }
  assert.ok(moved > 10);
}

/** Rows of both arms are simultaneous; their tools are where their paths are. */
async function checkMotion(page, { data, result }) {
  const last = data.arms[0].rows.length - 1;
  assert.equal(data.arms[1].rows.length - 1, last);
  for (const k of [0, 1, Math.floor(last / 2), last]) {
    await slide(page, k);
    const joints = result.arms.flatMap(({ trajectory }) => trajectory[k].joints);
    assertNear((await shown(page)).joints, joints, 1e-12, `row ${k}`);
    const tools = await page.evaluate(() =>
      window.swivel.view.tools.map(({ matrix }) => matrix.elements.slice(12, 15)),
    );
    data.arms.forEach(({ tool_path }, arm) =>
      assertNear(tools[arm], tool_path[k], 2e-4, `tool of ${kNames[arm]} in row ${k}`),
    );
  }
  const between = (a, b) => a.map((v, j) => (v + b[j]) / 2),
    [a, b] = [0, 1].map((k) => result.arms.flatMap(({ trajectory }) => trajectory[k].joints));
  await slide(page, 0.5);
  assertNear((await shown(page)).joints, between(a, b), 1e-9, 'between two rows');
}
/** The rows of a table with a header: numbers by the names of their columns. */
function rowsOf(csv) {
  const [head, ...lines] = readFileSync(csv, 'utf8').trim().split('\n'),
    names = head.split(',');
  return lines.map((line) =>
    Object.fromEntries(line.split(',').map((value, k) => [names[k], Number(value)])),
  );
}

/** Slider, plots, table and play of a motion in time, whose rows are those of the file. */
async function checkTimes(page, { data, result, csv }) {
  const { t } = data.arms[0].motion,
    { rows } = data.arms[0],
    n = t.length,
    where = () => page.textContent('#where'),
    seconds = async () => Number((await where()).match(/([0-9.]+) \/ [0-9.]+ s/)[1]);
  assert.ok(Math.abs(t[n - 1] - result.motion.duration) < 0.01);
  assert.ok(await page.isVisible('#motion-section'));
  await assertReachable(page);
  const heads = await page.$$eval('#motion > h3', (all) => all.map((one) => one.textContent));
  assert.deepEqual(heads, kNames);
  assert.equal(await page.locator('#motion .chart').count(), 8);
  const names = await page.$$eval('.chart', (all) => all.map((one) => one.ariaLabel));
  assert.equal(new Set(names).size, names.length, 'charts of one name');
  assert.match(await page.textContent('#verdict'), /motion 3\.\d+ s at 50 mm\/s/);
  assert.match(await page.textContent('#verdict'), /: before refining that of both arms alone/);
  assert.match(
    await page.textContent('#map-note'),
    /the path of left and right before it was refined/,
  );
  // Both arms are where their samples are, each at its own place in its rows.
  for (const share of [0.2, 0.5, 0.9]) {
    const index = Math.round(share * (n - 1));
    await page.evaluate((to) => window.swivel.toTime(to), t[index]);
    assert.ok(Math.abs((await seconds()) - t[index]) < 0.006);
    const row = rowsOf(csv).find(({ t: time }) => Math.abs(time - t[index]) < 1e-6),
      joints = data.arms.flatMap(({ chain }) => chain.joints.map(({ name }) => row[name]));
    assertNear((await shown(page)).joints, joints, 1e-6, `at ${t[index]} s`);
  }
  await press(page, 'Home');
  assert.equal(await seconds(), 0);
  await page.click('#play');
  const begin = [await seconds(), Date.now()];
  await page.waitForTimeout(1500);
  const end = [await seconds(), Date.now()];
  await page.click('#play');
  const pace = (1000 * (end[0] - begin[0])) / (end[1] - begin[1]);
  assert.ok(pace > 0.6 && pace < 1.4, `${pace} s of the motion in a second`);
  const middle = Math.floor(rows.length / 2);
  await slide(page, middle);
  const at = data.arms[0].motion.layers.findIndex((layer) => layer >= middle);
  assert.ok(Math.abs((await seconds()) - t[at]) < 0.05);
  const svg = await saved(page, page.locator('#motion-section h2 button', { hasText: 'SVG' }));
  assert.equal(svg.name, 'sda10f_plate_workcell_motion.svg');
}

/** The follower's path, which the leader's tool carries, runs through the follower's tool. */
async function checkCarried(page, { data }) {
  const { on_leader, leader } = data.arms[1];
  assert.equal(leader, 0);
  for (const k of [0, 7, on_leader.length - 1]) {
    await slide(page, k);
    const off = await page.evaluate((point) => {
      const { carried, tools } = window.swivel.view,
        at = tools[1].position
          .clone()
          .set(...point)
          .applyMatrix4(carried[0].matrix);
      return at.toArray().map((x, axis) => x - tools[1].matrix.elements[12 + axis]);
    }, on_leader[k]);
    assertNear(off, [0, 0, 0], 2e-4, `the follower's path in row ${k}`);
  }
}
/** The line between the arms is as long as they are apart, in each row; least where it says. */
async function checkBetween(page, { data, result }) {
  let least = Infinity,
    lines = 0;
  data.between.forEach(({ mm, asked_mm, nearest, pair }, k) => {
    least = Math.min(least, mm - asked_mm);
    assert.equal(pair.length, 2);
    if (!nearest) return;
    const [ax, ay, az, bx, by, bz] = nearest;
    assert.ok(Math.abs(1e3 * Math.hypot(bx - ax, by - ay, bz - az) - mm) < 0.11, `row ${k}`);
    ++lines;
  });
  assert.ok(lines >= 0.9 * data.between.length);
  assert.ok(Math.abs(least - result.between_arms.margin_mm) < 1e-6);
  const { row, clearance_mm, bodies } = result.between_arms;
  await page.locator('#verdict button', { hasText: 'nearest to each other' }).click();
  assert.equal((await shown(page)).place, row);
  assert.deepEqual((await shown(page)).line.points, data.between[row].nearest);
  assert.equal(parseFloat(await page.textContent('#gap')), Number(rounded(clearance_mm, 3)));
  assert.match(await page.textContent('#readout .gap'), new RegExp(bodies.join(' – ')));
  // The line of one arm and its surroundings instead.
  await page.selectOption('#line-of', '1');
  assert.deepEqual((await shown(page)).line.points, data.arms[1].rows[row].nearest);
  await page.selectOption('#line-of', 'between');
}
/**
 * A click on a body says what is nearest to it at the row and along both paths, of either arm and
 * of the scene: nothing that the rows name is nearer. Returns of how many it is the other arm's.
 */
async function checkClicks(page, { data }) {
  const { arms, between, bodies } = data,
    last = arms[0].rows.length - 1,
    armOf = (name) => bodies.find((body) => body.name === name)?.arm;
  let across = 0,
    alike = 0;
  for (const at of [0, Math.floor(last / 2) + 0.3, last]) {
    await slide(page, at);
    const row = Math.round(at),
      pairs = [
        between[row],
        ...arms.map(({ rows }) => ({ pair: rows[row].pair, mm: rows[row].clearance_mm })),
      ];
    await clickBodies(page, (name, lines) => {
      if (lines.length === 2) return; // it has nothing to keep clear of
      const [, mm = '0', other] = lines[1].match(/^(?:([\d.]+) mm from|touches) ([^\s]+)/),
        [, least = '0', when] = lines[2].match(
          /^nearest along the paths: (?:([\d.]+) mm from|touches) [^\s]+ at row (\d+)$/,
        );
      assert.ok(Number(least) <= Number(mm) && Number(when) <= last, lines.join('\n'));
      if (at % 1) assert.ok(lines[1].endsWith(` at row ${row}`), lines[1]);
      for (const one of pairs) {
        if (!one.pair?.includes(name)) continue;
        const told = Number(rounded(one.mm, 3));
        assert.ok(Number(mm) <= told, `${lines.join('\n')}\n${one.pair}: ${one.mm}`);
        if (!one.pair.includes(other)) continue;
        assert.equal(Number(mm), told);
        ++alike;
      }
      across += [armOf(name), armOf(other)].sort().join() === 'left,right';
    });
  }
  assert.ok(alike >= 2, `${alike} of the pairs that rows name`);
  return across;
}
/** The table has the numbers of the answer. */
async function checkTable(page, { result }) {
  const heads = await page.$$eval('#list th', (all) => all.map((one) => one.textContent)),
    alone = result.arms.reduce((sum, { least_cost }) => sum + least_cost, 0);
  const both = { name: 'both', cost: result.cost, least_cost: alone };
  for (const [k, arm] of [...result.arms, both].entries()) {
    const cells = await page
      .locator('#list tbody tr')
      .nth(k)
      .locator('td')
      .evaluateAll((all) => all.map((one) => one.textContent));
    const told = (name) => cells[heads.indexOf(name)];
    assert.ok(told('arm').startsWith(arm.name));
    assert.equal(told('cost'), rounded(arm.cost, 5));
    assert.equal(told('least cost by itself'), rounded(arm.least_cost, 5));
    assert.equal(
      told('dearer for the other'),
      `${rounded(100 * (arm.cost / arm.least_cost - 1), 2)} %`,
    );
    if (arm.summary)
      assert.equal(told('clearance, mm'), rounded(1e3 * arm.summary.clearance.value, 4));
  }
}
/** Numbers beside both arms and in the plots are those of the row. */
async function checkNumbers(page, { data }) {
  const k = Math.floor(data.arms[0].rows.length / 3);
  await slide(page, k);
  for (const [arm, { name, rows, chain }] of data.arms.entries()) {
    const told = await page.locator('#readout .arm').nth(arm).textContent();
    assert.match(told, new RegExp(`${name}\\ns ${rows[k].s.toFixed(4)} m`));
    const box = page.locator('#plots > div').nth(arm);
    for (const [j, joint] of chain.joints.entries()) {
      const degrees = (rows[k].q[j] * 180) / Math.PI;
      assert.ok(told.includes(`${joint.name}  ${degrees.toFixed(2)}°`), `${joint.name}: ${told}`);
      const plot = box.locator('.plot h3').filter({ hasText: `${joint.name}, deg` });
      assert.equal(await plot.locator('b').textContent(), degrees.toPrecision(4));
    }
  }
  const gap = await page.locator('#plots > div').last().locator('b').textContent();
  assert.equal(gap, data.between[k].mm.toPrecision(4));
}
/**
 * A pose off the map of one arm: it stands there, the other one where it is meanwhile. The keys
 * choose an arm and turn it.
 */
async function checkMaps(page, { data }) {
  const chart = page.locator('#map .panel:not(.other)', { hasText: 'right: ' }).locator('.chart');
  const box = await chart.first().boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 3);
  const { joints, active } = await shown(page);
  assert.equal(active, 1);
  const layer = data.arms[0].rows.findIndex(({ q }) =>
    q.every((v, j) => Math.abs(v - joints[j]) < 1e-12),
  );
  assert.ok(layer > 0 && layer < data.arms[0].rows.length - 1);
  assert.match(await page.textContent('#readout'), /▸ right/);
  // The other arm turns about its tool, which stays.
  await slide(page, 3);
  await press(page, 'a');
  assert.equal((await shown(page)).active, 0);
  const tools = () =>
    page.evaluate(() => window.swivel.view.tools.map(({ matrix }) => [...matrix.elements]));
  const [before, from] = [await tools(), (await shown(page)).joints];
  await press(page, 'ArrowUp');
  const [after, to] = [await tools(), (await shown(page)).joints];
  assert.deepEqual(to.slice(7), from.slice(7));
  assert.ok(Math.max(...to.slice(0, 7).map((v, j) => Math.abs(v - from[j]))) > 1e-3);
  assertNear(after.flat(), before.flat(), 2e-3, 'tools');
  await press(page, 'ArrowRight');
  assert.equal((await shown(page)).place, 4);
  await press(page, 'End');
  assert.equal((await shown(page)).place, data.arms[0].rows.length - 1);
}
/** What the hatched cells of the maps say: which nodes of both arms bar each other. */
async function checkRegion(page, { data }) {
  for (const { name, region, map } of data.arms) {
    assert.ok(region.nodes > 0 && region.runs.length > 0);
    const sheets = new Set(map.panels.map(({ sheet }) => sheet));
    for (const { layer, sheet, from, to } of region.runs) {
      assert.ok(sheets.has(sheet) && from >= 0 && from <= to && to < map.angles);
      assert.ok(layer === region.layer || (region.of_motion && layer === region.layer + 1));
    }
    const panels = page.locator('#map .panel', { hasText: `${name}: ` }),
      marked = await panels.locator('rect[stroke="#a02d41"]').count();
    assert.equal(marked, region.runs.length, name);
  }
  assert.equal(data.arms[0].region.layer, data.arms[1].region.layer);
  assert.match(await page.textContent('#legend'), /first conflict/);
}

await withBrowser({ packages, shots }, async ({ folder, open, shoot }) => {
  // A leader and its follower, which do not meet.
  const plate = planned(folder, join(problems, 'sda10f_plate_workcell.yaml'));
  assert.equal(plate.status, 0);
  const { page, close } = await open(plate.html, { viewport: wide, colorScheme: 'light' });
  await drawn(page);
  assert.match(
    await page.textContent('#verdict'),
    /^Solved: two arms, 33 rows, cost 0.9728: that of both arms alone, which do not meet/,
  );
  await assertFits(page, wide.width);
  await assertLabelsApart(page);
  await checkWhole(page);
  checkBodies(plate);
  await checkMotion(page, plate);
  await checkCarried(page, plate);
  await checkBetween(page, plate);
  await checkTable(page, plate);
  await checkNumbers(page, plate);
  await checkClicks(page, plate);
  await checkMaps(page, plate);
  assert.ok(!(await page.isVisible('#blocked')));
  assert.match(await page.textContent('#verdict'), /held: torso_joint_b1 at 0 rad/);
  const names = await page.$$eval('.chart', (all) => all.map((one) => one.ariaLabel));
  assert.equal(new Set(names).size, names.length, 'charts of one name');
  assert.match(await page.textContent('#bodies'), /arm of left.*arm of right.*follower/s);
  const colours = await page
    .locator('#bodies button', { hasText: /^arm of/ })
    .locator('i')
    .evaluateAll((all) => all.map((one) => getComputedStyle(one).backgroundColor));
  assert.equal(new Set(colours).size, 2, `arms of colours ${colours}`);
  for (const [section, name] of [
    ['map', 'maps'],
    ['plots', 'plots'],
  ]) {
    const svg = await saved(
      page,
      page.locator(`#${section}-section h2 button`, { hasText: 'SVG' }),
    );
    assert.equal(svg.name, `sda10f_plate_workcell_${name}.svg`);
    assert.ok((await elements(page, svg.bytes.toString())).svg > 10);
  }
  await press(page, 'Home');
  await page.locator('#play').click();
  await until(page, () => Number(document.getElementById('slider').value) > 1);
  await page.locator('#play').click();
  await assertPrints(page);
  await slide(page, 16);
  await shoot(page, 'workcell_plate.png');
  await close();
  const still = await open(plate.html, { viewport: wide, javaScriptEnabled: false });
  assert.match(await still.page.textContent('noscript pre'), /two arms, 33 layers, cost /);
  assert.equal(await still.page.locator('noscript > svg:visible').count(), 2);
  assert.deepEqual(await still.page.locator('noscript h2').allTextContents(), kNames);
  await still.close();

  // Refined and timed: the page plays in the motion's own time.
  const timed = planned(
    folder,
    join(problems, 'sda10f_plate_workcell.yaml'),
    '--refine',
    '--speed',
    '0.05',
    '--out',
    join(folder, 'motion.csv'),
  );
  timed.csv = join(folder, 'motion.csv');
  const run = await open(timed.html, { viewport: wide });
  await drawn(run.page);
  await checkTimes(run.page, timed);
  await assertFits(run.page, wide.width);
  await run.close();

  // The cheapest paths would meet.
  const crossing = planned(folder, lines(folder, 'crossing', kCrossing));
  assert.equal(crossing.result.decided_by, 'regions');
  const small = await open(crossing.html, { viewport: phone, colorScheme: 'dark', hash: '#row=5' });
  await drawn(small.page);
  await assertFits(small.page, phone.width);
  assert.equal((await small.page.locator('#stage').boundingBox()).height, 320);
  assert.equal((await shown(small.page)).place, 5);
  const more = 100 * (crossing.result.cost / crossing.result.bound - 1);
  assert.ok(Math.abs(more) < 1e-6);
  assert.match(
    await small.page.textContent('#verdict'),
    /% more than both arms alone, which would/,
  );
  await checkTable(small.page, crossing);
  await checkRegion(small.page, crossing);
  await small.page.setViewportSize(wide);
  const across = await checkClicks(small.page, crossing);
  console.log(`${across} clicks name a body of the other arm`);
  assert.ok(across >= 2);
  await small.page.setViewportSize(phone);
  const given = crossing.data.arms.filter(({ beside }) => beside.length).map(({ name }) => name);
  assert.ok(given.length > 0);
  assert.match(
    await small.page.textContent('#map-note'),
    new RegExp(`the path that ${given.join(' and ')} would take alone`),
  );
  assert.match(await small.page.textContent('#tables'), /regions of conflict\s*[1-9]/);
  await shoot(small.page, 'workcell_phone.png', { fullPage: true });
  await small.close();

  // No two paths keep clear: those of both arms alone, where they meet.
  const meeting = planned(folder, lines(folder, 'meeting', kMeeting));
  assert.equal(meeting.status, 1);
  const failed = await open(meeting.html, { viewport: wide, colorScheme: 'dark' });
  await drawn(failed.page);
  const { conflict } = meeting.result;
  assert.match(
    await failed.page.textContent('#verdict'),
    new RegExp(
      `^No plan: each arm has a path by itself.*meet at s ${conflict.s[0].toFixed(3)} of left`,
    ),
  );
  const { row } = meeting.data.conflict;
  assert.equal(row, conflict.layer + (conflict.on_motion ? 0.5 : 0));
  assert.equal((await shown(failed.page)).place, row);
  const kinds = () =>
    failed.page.evaluate(() =>
      window.swivel.view.arm
        .filter(({ userData }) => userData.kind === 'hit')
        .map(({ userData }) => userData.body.name),
    );
  assert.deepEqual([...new Set(await kinds())].sort(), [...conflict.bodies].sort());
  assert.ok(meeting.data.between[Math.floor(row)].mm < meeting.data.between[0].asked_mm);
  assert.match(await failed.page.textContent('#readout .gap'), /^the arms meet: /);
  await checkRegion(failed.page, meeting);
  await press(failed.page, 'Home');
  await failed.page.locator('#blocked', { hasText: 'Where they meet' }).click();
  assert.equal((await shown(failed.page)).place, row);
  assert.match(await failed.page.textContent('#answer'), /the cheapest paths meet at s = /);
  await assertPrints(failed.page);
  await shoot(failed.page, 'workcell_meeting.png', { fullPage: true });
  await failed.close();

  // In two layers they meet on the way alone.
  const passing = [1, -1].map((side) => [
      [0.68, 0.03 * side, 1 - 0.12 * side],
      [0.68, 0.03 * side, 1 + 0.12 * side],
      -0.1 * side,
    ]),
    coarse = {
      resolution: { ds: 1, dphi: 1 },
      limits: { tool_path_error: 0.2, joint_step: 3 },
    };
  const moving = planned(folder, lines(folder, 'moving', passing, { coarse }));
  assert.equal(moving.status, 1);
  assert.ok(moving.result.conflict.on_motion);
  const way = await open(moving.html, { viewport: wide });
  await drawn(way.page);
  assert.equal((await shown(way.page)).place, 0.5);
  assert.equal((await shown(way.page)).line, null);
  assert.match(await way.page.textContent('#verdict'), /of right, on the way on: /);
  assert.match(await way.page.textContent('#readout .gap'), /meet on the way to the next row/);
  assert.match(await way.page.textContent('#legend'), /first conflict: the motion on from here/);
  await checkRegion(way.page, moving);
  await way.close();

  // One arm has no path by itself: a knob stands on it.
  const knob = { name: 'knob', sphere: { radius: 0.03 }, xyz: middle(kCrossing[1]) };
  const barred = planned(folder, lines(folder, 'barred', kCrossing, { scene: [knob] }));
  assert.equal(barred.status, 1);
  const stuck = await open(barred.html, { viewport: wide });
  await drawn(stuck.page);
  assert.match(
    await stuck.page.textContent('#verdict'),
    /^No plan: an arm has no path by itself.*right: no path at this resolution.*knob/,
  );
  const { cut } = barred.data.arms[1];
  assertNear((await shown(stuck.page)).joints.slice(7), cut.q, 1e-12, 'the blocked pose');
  const meanwhile = barred.data.arms[0].rows.find(({ layer }) => layer >= cut.layer);
  assertNear((await shown(stuck.page)).joints.slice(0, 7), meanwhile.q, 1e-12, 'the other arm');
  assert.deepEqual(barred.data.between, []);
  assert.match(await stuck.page.textContent('#map-note'), /right: .*where every path has ended/);
  await stuck.page.locator('#blocked', { hasText: 'Blocked pose' }).click();
  assert.match(await stuck.page.textContent('#readout'), /blocked by right_tool - knob/);
  await shoot(stuck.page, 'workcell_barred.png');
  await stuck.close();

  // One arm has no pose at all.
  const away = kCrossing[1].map((at) => (Array.isArray(at) ? [at[0], at[1] - 2.5, at[2]] : at)),
    far = planned(folder, lines(folder, 'far', [kCrossing[0], away]));
  assert.equal(far.status, 1);
  const none = await open(far.html, { viewport: wide });
  await drawn(none.page);
  assert.match(await none.page.textContent('#verdict'), /right: no path at any resolution/);
  assert.match(await none.page.textContent('#map-note'), /No pose of right exists/);
  assert.equal(await none.page.locator('#map .panel', { hasText: 'right: ' }).count(), 0);
  assertNear((await shown(none.page)).joints.slice(7), Array(7).fill(0), 0, 'no pose');
  await none.close();
  const sizes = [plate, crossing, meeting].map(({ bytes }) => (bytes / 1e6).toFixed(2));
  console.log(`pages of ${sizes.join(', ')} MB`);
});
