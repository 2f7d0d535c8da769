#!/usr/bin/env node
// SPDX-License-Identifier: BSD-3-Clause
// Visual shapes of a robot on its page: what the URDF has, in place of the collision shapes while
// the switch is on. On pages of plans, of two arms and of placements; of problem files that can be
// read but once.
//   visual_test.mjs SWIVEL PROBLEMS PACKAGES
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { triangles } from '../../report/web/bytes.js';
import { clickBodies, heldBy, press, until, withBrowser } from './browser.mjs';

const [swivel, problems, packages] = process.argv.slice(2).map((path) => resolve(path)),
  data = resolve(problems, '..');

/** A problem file with a URDF of its own, to whose links some elements are added. */
function written(folder, name, added, { robot = 'iiwa14', problem = 'iiwa14_bench' } = {}) {
  const urdf = readFileSync(join(data, `robots/${robot}.urdf`), 'utf8').replace(
      /<link name="(\w+)">/g,
      (open, link) => open + (added[link] ?? ''),
    ),
    file = join(folder, `${name}.yaml`);
  writeFileSync(join(folder, `${name}.urdf`), urdf);
  writeFileSync(
    file,
    readFileSync(join(problems, `${problem}.yaml`), 'utf8')
      .replace(new RegExp(`urdf: \\S*${robot}.urdf`), `urdf: ${join(folder, name)}.urdf`)
      .replaceAll('../', `${data}/`),
  );
  return file;
}
const kQuick = ['--ds', '0.02', '--dphi', '0.1'];
/** A page that the program makes, and what it holds. from: a file to pipe into it, or null. */
function made(folder, name, words, from = null) {
  const html = join(folder, `${name}.html`),
    command = [...words, '--report', html],
    done = from
      ? spawnSync('sh', ['-c', 'cat "$0" | "$@"', from, swivel, ...command])
      : spawnSync(swivel, command);
  assert.equal(done.status, 0, String(done.stderr));
  return { html, ...heldBy(html), bytes: statSync(html).size };
}
/** A page of the arm at the bench, to whose links some elements are added. */
const planned = (folder, name, added) =>
  made(folder, name, ['plan', written(folder, name, added), ...kQuick]);
const visualOf = (geometry, origin = '') =>
  `<visual>${origin}<geometry>${geometry}</geometry><material name="m"/></visual>`;

/** A closed mesh of many triangles, as STL. */
function bumpyTube(count) {
  const n = Math.floor(Math.sqrt(count / 2)),
    bytes = Buffer.alloc(84 + 50 * 2 * n * n);
  bytes.writeUInt32LE(2 * n * n, 80);
  const corner = (i, j) => {
    const turn = (2 * Math.PI * i) / n,
      radius = 0.1 + 0.01 * Math.sin(8 * turn) * Math.sin((9 * Math.PI * j) / n);
    return [radius * Math.cos(turn), radius * Math.sin(turn), (0.3 * j) / n];
  };
  let at = 84;
  for (let i = 0; i < n; ++i)
    for (let j = 0; j < n; ++j)
      for (const [a, b] of [
        [1, 0],
        [1, 1],
      ]) {
        const last = a && b ? corner(i, j + 1) : corner(i + 1, j + 1),
          shape = [corner(i, j), a && b ? corner(i + 1, j + 1) : corner(i + 1, j), last];
        shape.flat().forEach((value, k) => bytes.writeFloatLE(value, at + 12 + 4 * k));
        at += 50;
      }
  return bytes;
}

/** What is drawn of the robot: [name, visual] of each mesh that is visible, and their poses. */
const drawn = (page) =>
  page.evaluate(() =>
    window.swivel.view.arm
      .filter(({ visible, userData: { body } }) => visible && body.kind === 'robot')
      .map(({ matrix, userData: { body } }) => ({
        name: body.name,
        visual: Boolean(body.visual),
        at: [...matrix.elements],
      })),
  );

/** The collision shapes of a link of a robot. */
const collisionsOf = (robot, link) =>
  readFileSync(join(data, `robots/${robot}.urdf`), 'utf8')
    .split(`<link name="${link}">`)[1]
    .split('</link>')[0]
    .match(/<collision>.*?<\/collision>/gs);
const asVisuals = (robot, link) =>
  collisionsOf(robot, link).join('').replaceAll('collision>', 'visual>');
/**
 * Where the visual shapes of a link are its collision shapes, they stand where these stand. Two
 * spheres about the ends of a cylinder are one capsule among the collision shapes.
 */
async function checkSamePlaces(page, link, where) {
  const poses = (await drawn(page)).filter(({ name }) => name === link).map(({ at }) => at),
    own = await page.evaluate(
      (name) =>
        window.swivel.view.arm
          .filter(({ userData: { body } }) => body.name === name && !body.visual)
          .map(({ matrix }) => [...matrix.elements]),
      link,
    );
  assert.ok(own.length > 0 && poses.length > 0, link);
  for (const at of own)
    assert.ok(
      poses.some((other) => other.every((value, k) => Math.abs(value - at[k]) < 1e-9)),
      `${link}, ${where}: ${at}`,
    );
}

/** Both arms of a workcell and what stands: a switch for all, an entry of the legend for each. */
async function checkWorkcell(folder, open) {
  const links = ['arm_left_link_2_l', 'arm_right_link_3_e', 'torso_link_b1'],
    added = Object.fromEntries(links.map((link) => [link, asVisuals('sda10f', link)])),
    of = { robot: 'sda10f', problem: 'sda10f_plate_workcell' },
    { html, data: held } = made(folder, 'cell', ['plan', written(folder, 'cell', added, of)]);
  const arms = Object.fromEntries(held.visual.map(({ name, arm }) => [name, arm]));
  assert.deepEqual(arms, { [links[0]]: 'left', [links[1]]: 'right', [links[2]]: undefined });
  const { page, close } = await open(html, { viewport: { width: 1000, height: 800 } });
  await until(page, () => window.swivel.frames > 0);
  await page.check('#visual');
  for (const key of ['Home', 'End']) {
    await press(page, key);
    for (const link of links) await checkSamePlaces(page, link, key);
  }
  const right = page.locator('#bodies button').filter({ hasText: 'arm of right' });
  await right.click();
  await right.click();
  const left = new Set((await drawn(page)).filter(({ visual }) => visual).map(({ name }) => name));
  assert.deepEqual([...left].sort(), [links[0], links[2]].sort());
  await right.click();
  let clicked = 0;
  await clickBodies(page, (name, lines) => {
    clicked += links.includes(name) && lines.length > 2;
  });
  assert.ok(clicked > 0, 'no visual shape tells what is nearest');
  await close();
}

/** The plans of placements. */
async function checkPlacements(folder, open) {
  const file = written(folder, 'placed', { link_2: asVisuals('iiwa14', 'link_2') }),
    words = ['place', file, ...kQuick, '--object', 'casting', '--x', '0:0.02:0.02'],
    { html, data: held } = made(folder, 'placed', words);
  assert.deepEqual([...new Set(held.scene.visual.map(({ name }) => name))], ['link_2']);
  const { page, close } = await open(html, { viewport: { width: 1000, height: 800 } });
  await until(page, () => window.swivel.frames > 0);
  await page.check('#visual');
  await page.locator('#best tbody tr').last().click();
  await page.locator('#slider').focus();
  for (const key of ['End', 'Home']) {
    await page.keyboard.press(key);
    await checkSamePlaces(page, 'link_2', key);
    assert.ok((await drawn(page)).every(({ name, visual }) => visual === (name === 'link_2')));
  }
  await page.uncheck('#visual');
  assert.ok((await drawn(page)).every(({ visual }) => !visual));
  // A click tells what is nearest in this placement.
  let told = 0;
  await clickBodies(page, (name, lines) => {
    if (lines.length === 2) return;
    const [, mm] = lines[1].match(/^([\d.]+) mm from \S+$/),
      [, least] = lines[2].match(/^nearest along the path: ([\d.]+) mm from \S+ at s [\d.]+ m$/);
    assert.ok(Number(least) <= Number(mm), lines.join('\n'));
    ++told;
  });
  assert.ok(told >= 3, `${told} bodies`);
  await close();
}

/** The plans of placements with the torso held elsewhere: what it carries stands elsewhere. */
async function checkHeld(folder, open) {
  const links = ['torso_link_b1', 'arm_left_link_2_l'],
    added = Object.fromEntries(links.map((link) => [link, asVisuals('sda5f', link)])),
    file = written(folder, 'held', added, { robot: 'sda5f', problem: 'experiment_c' }),
    words = ['place', file, ...kQuick, '--hold', 'torso_joint_b1=-0.2:0.2:0.2'],
    { html } = made(folder, 'held', words);
  const { page, close } = await open(html, { viewport: { width: 1000, height: 800 } });
  await until(page, () => window.swivel.frames > 0);
  const rows = page.locator('#best tbody tr'),
    count = await rows.count(),
    stand = new Set();
  assert.ok(count >= 2, `${count} with a path`);
  for (let k = 0; k < 2 * count; ++k) {
    await rows.nth(k % count).click();
    if (k === 1) await page.check('#visual');
    if (k < 1) continue;
    for (const link of links) await checkSamePlaces(page, link, `row ${k}`);
    const torso = (await drawn(page)).find(({ name }) => name === links[0]);
    assert.ok(torso.visual);
    stand.add(torso.at.map((value) => value.toFixed(9)).join());
  }
  assert.equal(stand.size, count);
  await close();
}

/** A problem file that can be read once, as one from a pipe; the URDF as well. */
function checkPipes(folder) {
  const added = { link_2: asVisuals('iiwa14', 'link_2') },
    file = written(folder, 'piped', added),
    urdf = join(folder, 'piped.urdf'),
    page = (problem, from) => made(folder, 'piped', ['plan', problem, ...kQuick], from).data;
  const { visual } = page(file);
  assert.ok(visual.length > 0);
  assert.deepEqual(page('/dev/stdin', file).visual, visual);
  writeFileSync(file, readFileSync(file, 'utf8').replace(urdf, '/dev/stdin'));
  const once = page(file, urdf);
  assert.deepEqual([once.visual, once.unread], [[], []]);
}

await withBrowser({ packages }, async ({ folder, open }) => {
  // Of link 2 the collision shapes once more; of link 4 a mesh, of link 3 one that is missing.
  const { html, data: held } = planned(folder, 'visual', {
    link_2: asVisuals('iiwa14', 'link_2'),
    link_3: visualOf('<mesh filename="missing.dae"/>'),
    link_4: visualOf(
      `<mesh filename="${data}/meshes/door_2k.stl" scale="0.2 0.2 0.2"/>`,
      '<origin xyz="0.01 0.02 0.03"/>',
    ),
    link_5: visualOf('<box size="0.1 -1 0.1"/>'), // wrong, and so left out
  });
  const names = [...new Set(held.visual.map(({ name }) => name))];
  assert.deepEqual(names, ['link_2', 'link_4']);
  assert.equal(held.unread.length, 2);
  assert.match(held.unread[0], /link 'link_3': mesh 'missing.dae' not found/);
  assert.match(held.unread[1], /link 'link_5'.*size/);
  const { page, close } = await open(html, { viewport: { width: 1000, height: 800 } });
  await until(page, () => window.swivel.frames > 0);
  const before = await drawn(page);
  assert.ok(before.length > 7 && before.every(({ visual }) => !visual));
  assert.match(await page.textContent('#visual-option'), /visual shapes \(2 not shown\)/);
  await page.check('#visual');
  for (const key of [null, 'End', 'Home']) {
    if (key) await press(page, key);
    const shown = await drawn(page);
    for (const { name, visual } of shown) assert.equal(visual, names.includes(name), name);
    assert.deepEqual(
      new Set(shown.map(({ name }) => name)),
      new Set(before.map(({ name }) => name)),
    );
    await checkSamePlaces(page, 'link_2', key);
  }
  // The legend hides what it is of, and a click names the link.
  await page.locator('#bodies button').filter({ hasText: 'arm' }).click();
  await page.locator('#bodies button').filter({ hasText: 'arm' }).click();
  const left = (await drawn(page)).map(({ name }) => name);
  assert.ok(left.every((name) => !names.includes(name)));
  await page.locator('#bodies button').filter({ hasText: 'arm' }).click();
  await page.uncheck('#visual');
  assert.deepEqual(
    (await drawn(page)).map(({ name, visual }) => [name, visual]),
    before.map(({ name, visual }) => [name, visual]),
  );
  await close();

  // A robot without any, which most are: no switch.
  const bare = planned(folder, 'bare', {});
  assert.deepEqual([bare.data.visual, bare.data.unread], [[], []]);
  const plain = await open(bare.html, { viewport: { width: 1000, height: 800 } });
  await until(plain.page, () => window.swivel.frames > 0);
  assert.ok(!(await plain.page.isVisible('#visual-option')));
  await plain.close();

  await checkWorkcell(folder, open);
  await checkPlacements(folder, open);
  await checkHeld(folder, open);
  checkPipes(folder);

  // Meshes of 300,000 triangles become lighter, as those of 200,000 are.
  writeFileSync(join(folder, 'tube.stl'), bumpyTube(150_000));
  writeFileSync(join(folder, 'tubes.stl'), bumpyTube(150_000));
  const heavy = planned(folder, 'heavy', {
    link_1: visualOf('<mesh filename="tube.stl"/>') + visualOf('<mesh filename="tube.stl"/>'),
    link_6: visualOf('<mesh filename="tubes.stl"/>'),
  });
  globalThis.swivelPage = { bytes: heavy.binary };
  const counts = heavy.data.meshes.map((mesh) => triangles(mesh).corners.length / 3),
    all = counts.reduce((sum, count) => sum + count, 0);
  assert.equal(heavy.data.visual.length, 3);
  console.log(`${counts} triangles of ${300_000}, a page of ${(heavy.bytes / 1e6).toFixed(2)} MB`);
  assert.ok(all > 50_000 && all <= 200_000, `${counts}`);
  assert.ok(heavy.bytes <= 5e6, `${heavy.bytes} bytes`);
});
