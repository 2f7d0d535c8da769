// SPDX-License-Identifier: BSD-3-Clause
// Plans jobs with --report and uses their pages in headless Chromium. Arguments as of
// page_test.mjs.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { assertFits, assertReachable, dataOf, press, until, withBrowser } from './browser.mjs';

const [swivel, problems, packages, shots] = process.argv.slice(2).map((path) => resolve(path));
const wide = { width: 1280, height: 800 },
  phone = { width: 390, height: 844 },
  kQuick = ['--ds', '0.01', '--dphi', '0.1'];

/** door_job.yaml with the strokes that `keep` accepts, and lines below its scene. */
function doorJob(folder, name, keep = () => true, scene = '') {
  const file = join(folder, `${name}.yaml`);
  const lines = readFileSync(join(problems, 'door_job.yaml'), 'utf8')
    .replaceAll('../', `${resolve(problems, '..')}/`)
    .split('\n')
    .filter((line) => !line.includes('door_stroke_') || keep(line));
  writeFileSync(file, lines.join('\n').replace('\nscene:\n', `\nscene:\n${scene}`));
  return file;
}
/** Plans a job with a page; what the page, --json and --out say. */
function planned(folder, file, ...options) {
  const [html, json, csv] = ['html', 'json', 'csv'].map((end) => join(folder, `job.${end}`));
  const done = spawnSync(swivel, [
    'plan',
    file,
    ...kQuick,
    '--quiet',
    '--report',
    html,
    '--json',
    json,
    '--out',
    csv,
    ...options,
  ]);
  assert.ok(done.status <= 1, String(done.stderr));
  const lines = done.status === 0 ? readFileSync(csv, 'utf8').trim().split('\n') : [];
  return {
    html,
    status: done.status,
    bytes: statSync(html).size,
    data: dataOf(html),
    result: JSON.parse(readFileSync(json, 'utf8')),
    columns: lines[0]?.split(','),
    rows: lines.slice(1).map((line) => line.split(',')),
  };
}
const shown = (page) => page.evaluate(() => window.swivel);
const slide = (page, value) =>
  page.evaluate((to) => {
    const slider = document.getElementById('slider');
    slider.value = to;
    slider.dispatchEvent(new Event('input'));
  }, value);
function assertNear(found, expected, tolerance, what) {
  found.forEach((value, k) =>
    assert.ok(
      Math.abs(value - expected[k]) <= tolerance,
      `${what}, ${k}: ${value} for ${expected[k]}`,
    ),
  );
}
/** [from, to] of the sections of the strip, and of the bands of the process. */
const spans = (page, kind) =>
  page.evaluate((selector) => {
    const end = Number(document.getElementById('slider').max);
    return [...document.querySelectorAll(`#strip ${selector}`)].map(({ style }) => {
      const from = (parseFloat(style.left) / 100) * end;
      return [from, from + (parseFloat(style.width) / 100) * end];
    });
  }, kind);

/** Sections are the parts in their order, with ends in common. */
async function checkSections(page, { data, result }) {
  const { sections } = await shown(page);
  assert.equal(sections.length, result.parts.length);
  assertNear((await spans(page, 'button')).flat(), sections.flat(), 1e-3, 'the strip');
  const names = await page.$$eval('#strip button', (all) => all.map((one) => one.textContent));
  let strokes = 0;
  assert.deepEqual(
    names,
    result.parts.map(({ stroke }) => (stroke === null ? '' : `${++strokes} ${stroke}`)),
  );
  assert.equal(strokes, data.strokes.length);
  sections.forEach(([from, to], k) => {
    assert.ok(to > from);
    assert.ok(Math.abs(from - (k ? sections[k - 1][1] : 0)) < 1e-6, `section ${k}`);
  });
  return sections;
}
/** The map is that of the stroke at the cursor; section, list and table go to a stroke. */
async function checkMaps(page, sections, { data }) {
  const isShown = async (k) => {
    assert.equal((await shown(page)).active, k);
    assert.equal(await page.inputValue('#stroke'), String(k));
    assert.equal(await page.locator('#map > div:visible').count(), 1);
    assert.ok((await page.textContent('#plots-section h2')).startsWith(`Along ${k + 1} `));
    assert.equal(await page.locator('#list tr.marked td').first().textContent(), String(k + 1));
    const marked = await page.locator('#strip [aria-current=true]').allTextContents();
    assert.match(marked.join(), new RegExp(`^${k + 1} row_\\d$`));
  };
  const at = (k) => data.parts.findIndex(({ stroke }) => stroke === k);
  const pictures = new Set();
  for (let k = 0; k < data.strokes.length; ++k) {
    await slide(page, (sections[at(k)][0] + sections[at(k)][1]) / 2);
    await isShown(k);
    assert.ok((await page.textContent('#readout')).startsWith(`${k + 1} `));
    assert.equal(await page.locator('#map .dot:visible').count(), 1);
    pictures.add(await page.locator('#map > div:visible image').first().getAttribute('href'));
  }
  assert.equal(pictures.size, data.strokes.length);
  const slider = async () => Number(await page.inputValue('#slider'));
  const begins = async (k) => {
    await isShown(k);
    assert.ok(Math.abs((await slider()) - sections[at(k)][0]) < 1e-3);
    assert.deepEqual((await shown(page)).joints, data.strokes[k].rows[0].q);
  };
  await page.locator('#strip button').nth(at(1)).click();
  await begins(1);
  await page.selectOption('#stroke', '3');
  await begins(3);
  await page.locator('#list tbody tr').nth(2).click();
  await begins(2);
  await press(page, 'n');
  await press(page, 'n');
  await begins(3);
}
/** In the middle of each transition joints are halfway, on the slider without times. */
async function checkTransitions(page, sections, { result }) {
  for (const [k, { stroke, rows }] of result.parts.entries()) {
    if (stroke !== null) continue;
    const most = (a, b) => Math.max(...a.joints.map((v, j) => Math.abs(b.joints[j] - v))),
      moves = rows.slice(1).map((row, i) => most(rows[i], row));
    let left = moves.reduce((sum, move) => sum + move, 0) / 2,
      i = 0;
    for (; left > moves[i]; ++i) left -= moves[i];
    const halfway = rows[i].joints.map(
      (v, j) => v + (left / moves[i]) * (rows[i + 1].joints[j] - v),
    );
    await slide(page, (sections[k][0] + sections[k][1]) / 2);
    assertNear((await shown(page)).joints, halfway, 1e-6, `transition ${k}`);
    assert.match(await page.textContent('#readout'), /^(transition to |way home)/);
    assert.equal(await page.locator('#map .dot:visible').count(), 0);
  }
}
/** The table has the numbers of the answer. */
async function checkTable(page, { result }, durations) {
  const heads = await page.$$eval('#list th', (all) => all.map((one) => one.textContent));
  for (const [k, run] of result.runs.entries()) {
    const cells = await page
      .locator('#list tbody tr')
      .nth(k)
      .locator('td')
      .evaluateAll((all) => all.map((one) => one.textContent));
    const told = (name) => cells[heads.indexOf(name)],
      digits = (value, count) => String(Number(value.toPrecision(count)));
    assert.equal(told('#'), String(k + 1));
    assert.equal(told('stroke'), run.stroke);
    assert.equal(told('backwards'), run.reversed ? 'yes' : 'no');
    if (run.cost === null) {
      assert.equal(told('path'), run.status === 'solved' ? 'yes' : 'none');
      continue;
    }
    assert.equal(told('cost'), digits(run.cost, 5));
    assert.equal(told('least cost by itself'), digits(run.least_cost, 5));
    assert.equal(told('clearance, mm'), digits(1e3 * run.summary.clearance.value, 4));
    assert.equal(told('tool off its path, mm'), digits(run.summary.tool_path_error.max_mm, 3));
    if (durations)
      assert.ok(Math.abs(Number(told('time, s')) - durations[k]) < 0.011 * durations[k]);
  }
}

await withBrowser({ packages, shots }, async ({ folder, open, shoot }) => {
  // Without times.
  const door = planned(folder, doorJob(folder, 'door'));
  assert.equal(door.status, 0);
  const { page, close } = await open(door.html, { viewport: wide, colorScheme: 'light' });
  await until(page, () => window.swivel?.frames > 0);
  assert.match(await page.textContent('#verdict'), /^Solved: 6 strokes, cost .*least clearance/);
  await assertFits(page, wide.width);
  const sections = await checkSections(page, door);
  await checkTransitions(page, sections, door);
  await checkMaps(page, sections, door);
  await checkTable(page, door);
  assert.equal((await spans(page, 'i')).length, 6);
  assert.deepEqual(await page.$$eval('.number', (all) => all.map((one) => one.textContent)), [
    ...'123456',
  ]);
  assert.ok(!(await page.isVisible('#motion-section')));
  await slide(page, (sections[5][0] + sections[5][1]) / 2);
  await page.evaluate(() => scrollTo(0, 0));
  await shoot(page, 'job_door.png');
  await close();
  const still = await open(door.html, { viewport: wide, javaScriptEnabled: false });
  assert.match(await still.page.textContent('noscript pre'), /solved: 6 strokes, cost /);
  assert.equal(await still.page.locator('noscript > svg:visible').count(), 6);
  assert.match((await still.page.locator('noscript h2').allTextContents())[4], /^5 row_4$/);
  await shoot(still.page, 'job_still.png');
  await still.close();

  // In time: each part takes as long as in the motion, and the process is on when it says so.
  const timed = planned(folder, doorJob(folder, 'timed'), '--rate', '25');
  assert.equal(timed.status, 0);
  const small = await open(timed.html, {
    viewport: phone,
    colorScheme: 'dark',
    hash: '#part=4',
  });
  await until(small.page, () => window.swivel?.frames > 0);
  await assertFits(small.page, phone.width);
  assertNear((await shown(small.page)).joints, timed.data.strokes[1].rows[0].q, 1e-3, 'its begin');
  const parts = await checkSections(small.page, timed),
    durations = timed.data.parts.map((_, k) => parts[k][1] - parts[k][0]);
  const column = (name) => timed.columns.indexOf(name),
    time = (row) => Number(row[column('t')]),
    ends = [];
  timed.rows.forEach((row, k) => {
    if (k && row[column('stroke')] !== timed.rows[k - 1][column('stroke')])
      ends.push(time(timed.rows[k - 1]));
  });
  assert.equal(ends.length, parts.length - 1);
  ends.forEach((t, k) => assert.ok(Math.abs(parts[k][1] - t) < 0.041, `part ${k}: ${t} s`));
  await checkTable(
    small.page,
    timed,
    durations.filter((_, k) => timed.data.parts[k].stroke !== null),
  );
  const { events } = timed.result.motion;
  assertNear(
    (await spans(small.page, 'i')).flat(),
    events.map(({ t }) => t),
    1e-3,
    'process',
  );
  for (const [k, part] of parts.entries()) {
    const at = timed.rows[Math.round((25 * (part[0] + part[1])) / 2)],
      joints = timed.result.joint_names.map((name) => Number(at[column(name)]));
    await slide(small.page, time(at));
    assertNear((await shown(small.page)).joints, joints, 1e-6, `motion in part ${k}`);
    const on = events.filter(({ t }) => t <= time(at)).at(-1)?.process === 'on';
    if (timed.data.parts[k].stroke !== null)
      assert.match(await small.page.textContent('#readout'), on ? /process on/ : /process off/);
  }
  assert.ok(await small.page.isVisible('#motion-section'));
  await assertReachable(small.page);
  await press(small.page, 'Home');
  await small.page.locator('#play').click();
  await until(small.page, () => Number(document.getElementById('slider').value) > 0.1);
  await small.page.locator('#play').click();
  await shoot(small.page, 'job_phone.png', { fullPage: true });
  await small.close();

  // Runs between lift-offs count s along their whole stroke: rows, maps and answers.
  const ring = planned(folder, join(problems, 'iiwa14_ring_job.yaml')),
    runs = ring.result.parts.filter(({ stroke }) => stroke !== null);
  assert.equal(ring.status, 0);
  assert.deepEqual([runs.length, ring.result.lift_offs.length], [2, 1]);
  // The rows of a run begin with its approach of 50 mm, before the place at which it resumes.
  assertNear([runs[1].rows[0].s + 0.05], [ring.result.lift_offs[0].resumed_s], 1e-9, 'resumed');
  ring.data.strokes.forEach(({ rows, map, run: { summary } }, k) => {
    const s = runs[k].rows.map((row) => row.s);
    assert.deepEqual(
      rows.map((row) => row.s),
      s,
    );
    assertNear([map.s[0], map.s.at(-1)], [s[0], s.at(-1)], 1e-9, `map of run ${k}`);
    for (const key of ['clearance', 'joint_limit', 'tool_path_error', 'top_tool_speed'])
      assert.ok(s.includes(summary[key].s), `${key} of run ${k} at s ${summary[key].s}`);
  });
  const lifted = await open(ring.html, { viewport: wide });
  await until(lifted.page, () => window.swivel?.frames > 0);
  const nearest = lifted.page.locator('#verdict button'),
    [, at] = (await nearest.textContent()).match(/ at s ([\d.]+)$/);
  await nearest.click();
  const [, there] = (await lifted.page.textContent('#readout')).match(/\ns ([\d.]+) m/);
  assert.equal(Number(there).toFixed(3), at);
  await lifted.page.selectOption('#stroke', '1');
  const ticks = await lifted.page
    .locator('#map > div:visible .panel')
    .first()
    .locator('[aria-label="x-axis tick label"] text')
    .allTextContents();
  assert.ok(ticks.length > 2 && ticks.every((tick) => Number(tick) >= runs[1].rows[0].s - 1e-9));
  await lifted.close();

  // A stroke without a path: a knob stands on it.
  const waypoint = readFileSync(join(problems, '../paths/door_stroke_0.csv'), 'utf8')
    .split('\n')[10]
    .split(',')
    .map(Number);
  const knob = [0.76 + waypoint[1], 0.27 - waypoint[0], 0.9 + waypoint[2]];
  const barred = planned(
    folder,
    doorJob(
      folder,
      'barred',
      (line) => /stroke_[05]/.test(line),
      `  - {name: knob, sphere: {radius: 0.004}, xyz: [${knob}]}\n`,
    ),
  );
  assert.equal(barred.status, 1);
  const failed = await open(barred.html, { viewport: wide, colorScheme: 'dark' });
  await until(failed.page, () => window.swivel?.frames > 0);
  assert.match(await failed.page.textContent('#verdict'), /^No job: 1 of 2 strokes has no path/);
  // Its first line names the cause, and leads there.
  const [cause] = await failed.page.locator('#verdict button').allTextContents();
  assert.match(cause, /^1 row_0.*: .*knob.* at s \d\.\d{3}$/);
  assert.match(await failed.page.textContent('#answer'), /stroke 'row_0': .*knob/);
  assert.equal((await shown(failed.page)).active, 0);
  assert.deepEqual((await shown(failed.page)).joints, barred.data.strokes[0].cut.q);
  assert.match(await failed.page.textContent('#readout'), /knob/);
  assert.match(await failed.page.textContent('#map-note'), /where every path has ended/);
  await checkTable(failed.page, barred);
  await shoot(failed.page, 'job_barred.png', { fullPage: true });
  await failed.page.selectOption('#stroke', '1');
  assert.equal((await shown(failed.page)).active, 1);
  assert.ok((await failed.page.locator('#map .panel:visible').count()) > 0);
  await failed.close();

  // Home is barred: strokes and the arm at home, no maps.
  const ball = '  - {name: ball, sphere: {radius: 0.1}, xyz: [0.55, 0.45, 1.0]}\n',
    home = planned(
      folder,
      doorJob(folder, 'home', (line) => /stroke_0/.test(line), ball),
    );
  assert.equal(home.status, 1);
  const stuck = await open(home.html, { viewport: wide });
  assert.match(await stuck.page.textContent('#verdict'), /^No job: at home .* - ball come nearer/);
  assert.deepEqual((await shown(stuck.page)).joints, home.data.home.q);
  for (const id of ['map-section', 'controls', 'plots-section', 'motion-section'])
    assert.ok(!(await stuck.page.isVisible(`#${id}`)), id);
  assert.equal(await stuck.page.locator('#list tbody tr').count(), 1);
  await stuck.close();
  console.log(
    `pages of ${[door, timed, barred].map(({ bytes }) => (bytes / 1e6).toFixed(2)).join(', ')} MB`,
  );
});
