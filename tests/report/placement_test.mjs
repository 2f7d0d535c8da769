// SPDX-License-Identifier: BSD-3-Clause
// Runs swivel place with --report and uses the page in headless Chromium. Arguments as of
// page_test.mjs.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { readFileSync, statSync } from 'node:fs';
import { join, resolve } from 'node:path';
import {
  assertFits,
  dataOf,
  elements,
  saved,
  scale,
  some,
  until,
  withBrowser,
} from './browser.mjs';

const [swivel, problems, packages, shots] = process.argv.slice(2).map((path) => resolve(path));
const problem = join(problems, 'experiment_c.yaml'),
  kQuick = ['--planner', 'lazy', '--ds', '0.05', '--dphi', '0.3', '--edges', 'nodes'];

await withBrowser({ packages, shots }, async ({ folder, open, shoot }) => {
  const place = (name, ...options) => {
    const html = join(folder, `${name}.html`),
      csv = join(folder, `${name}.csv`);
    execFileSync(swivel, [
      'place',
      problem,
      ...kQuick,
      '--object',
      'door',
      '--out',
      csv,
      '--report',
      html,
      ...options,
    ]);
    const rows = readFileSync(csv, 'utf8')
      .trim()
      .split('\n')
      .slice(1)
      .map((line) => line.split(','));
    return { html, rows, bytes: statSync(html).size };
  };
  const fills = (page) =>
    page.$$eval('.cells rect', (cells) => cells.map((cell) => cell.getAttribute('fill')));
  const [cell, x, y, , , , , status, cost] = Array.from({ length: 9 }, (_, k) => k);

  const { html, rows } = place('map', '--x', '-0.1:0.1:0.01', '--y', '-0.1:0.1:0.02');
  const solved = rows.filter((row) => row[status] === 'solved');
  assert.ok(solved.length > 50 && solved.length < rows.length && rows.length === 21 * 11);
  const { page, close } = await open(html, {
    viewport: { width: 1280, height: 800 },
    colorScheme: 'light',
  });
  assert.match(
    await page.textContent('#verdict'),
    new RegExp(`^${solved.length} of ${rows.length} placements have a path`),
  );
  await assertFits(page, 1280);
  await shoot(page, 'placements_c.png');
  assert.equal((await fills(page)).length, rows.length);
  await page.selectOption('#colour', 'verdict');
  assert.deepEqual(
    (await fills(page)).map((fill) => fill === '#0f8064'),
    rows.map((row) => row[status] === 'solved'),
  );
  await page.selectOption('#colour', 'end');
  assert.match(await page.textContent('#legend'), /post \(\d+\)/);
  assert.equal(new Set(await fills(page)).size, await page.locator('#legend span').count());
  await page.selectOption('#colour', 'cost');

  // A place of the map and a line of the table pick a placement; its command plans the same.
  const best = [...solved].sort((a, b) => Number(a[cost]) - Number(b[cost]))[0],
    failed = rows.find((row) => row[status] !== 'solved');
  assert.match(await page.textContent('#facts'), new RegExp(`^Placement ${best[cell]}\\D`));
  assert.equal(await page.locator('#best tbody tr').first().getAttribute('data-cell'), best[cell]);
  for (const wanted of [rows[0], failed, best]) {
    await page.locator('.cells rect').nth(rows.indexOf(wanted)).dispatchEvent('click');
    assert.match(await page.textContent('#facts'), new RegExp(`^Placement ${wanted[cell]}\\D`));
    const command = await page.textContent('#command');
    const again = spawnSync(
      'sh',
      ['-c', `exec '${swivel}' ${command.slice('swivel '.length)} --quiet --json -`],
      { cwd: folder },
    );
    const result = JSON.parse(String(again.stdout));
    assert.equal(result.status, wanted[status]);
    assert.equal(result.cost ?? '', wanted[cost] === '' ? '' : Number(wanted[cost]));
    assert.ok(statSync(join(folder, `placement_${wanted[cell]}.html`)).size > 1e5);
    if (wanted === failed)
      assert.ok((await page.textContent('#facts')).includes(wanted.at(-2).replaceAll('"', '')));
  }
  await page.locator('#best tbody tr').nth(3).click();
  assert.match(
    await page.textContent('#facts'),
    new RegExp(
      `^Placement ${await page.locator('#best tbody tr').nth(3).getAttribute('data-cell')}\\D`,
    ),
  );
  // The best twenty open their plan: the joints that the program writes, from the first row to the
  // last.
  await until(page, () => window.swivel.frames > 0);
  for (const k of [0, 3, 19]) {
    await page.locator('#best tbody tr').nth(k).click();
    const chosen = await page.locator('#best tbody tr').nth(k).getAttribute('data-cell'),
      command = await page.textContent('#command');
    execFileSync(
      'sh',
      [
        '-c',
        `exec '${swivel}' ${command.slice('swivel '.length).replace(/ --report .*/, '')} --quiet ` +
          '--out best.csv',
      ],
      { cwd: folder },
    );
    const path = readFileSync(join(folder, 'best.csv'), 'utf8')
      .trim()
      .split('\n')
      .slice(1)
      .map((line) => line.split(',').slice(-7).map(Number));
    for (const [at, joints] of [
      ['0', path[0]],
      [String(path.length - 1), path.at(-1)],
    ]) {
      await page.locator('#slider').fill(at);
      const shown = await page.evaluate(() => window.swivel);
      assert.equal(String(shown.cell), chosen);
      shown.joints.forEach((q, j) =>
        assert.ok(Math.abs(q - joints[j]) < 1e-6, `${chosen} at ${at}: ${q} ${joints[j]}`),
      );
    }
    assert.equal(await page.textContent('#readout'), `the plan of placement ${chosen}`);
  }
  // Of one without a path it is said what ends the paths; the arm stands in the pose past their
  // end, with the bodies that are in its way, or is faded where it is another's.
  const isFaded = () =>
    page.evaluate(() => {
      const { arm } = window.swivel.view;
      return arm.find(({ userData }) => userData.body.group > 0).material.transparent;
    });
  const unsolved = rows.filter((row) => row[status] !== 'solved'),
    partial = new Map();
  for (const row of unsolved) {
    await page.locator('.cells rect').nth(rows.indexOf(row)).dispatchEvent('click');
    const told = await page.textContent('#readout'),
      shown = await page.evaluate(() => window.swivel),
      own = String(shown.cell) === row[cell];
    assert.ok(told.startsWith(`placement ${row[cell]} has no path: `), told);
    assert.match(told, own ? /\n(the next|a|no valid|no) (pose|way)/ : /\nfaded: /);
    assert.equal(await isFaded(), !own);
    if (own) partial.set(row, shown.joints);
  }
  assert.ok(partial.size >= 10, `${partial.size} of ${unsolved.length} show how far paths go`);
  const [ended] = [...partial.keys()].filter((row) => row.at(-2).includes(' - post'));
  await page.locator('.cells rect').nth(rows.indexOf(ended)).dispatchEvent('click');
  assert.equal(
    await page.evaluate(() => {
      const { arm } = window.swivel.view;
      return arm.filter(({ userData }) => userData.kind.startsWith('hit')).length;
    }),
    2,
  );
  // That pose is the one of the placement's own report.
  execFileSync(
    'sh',
    [
      '-c',
      `'${swivel}' ${(await page.textContent('#command')).slice('swivel '.length)} --quiet || true`,
    ],
    { cwd: folder },
  );
  const { cut } = dataOf(join(folder, `placement_${ended[cell]}.html`));
  partial.get(ended).forEach((q, j) => assert.ok(Math.abs(q - cut.q[j]) < 1e-6, `joint ${j}`));
  assert.ok((await page.textContent('#readout')).endsWith(cut.what));
  // The arrows pick the placement beside it.
  await page.locator('#map .chart').focus();
  const number = async () =>
    Number((await page.textContent('#facts')).match(/^Placement (\d+)/)[1]);
  await page.locator('.cells rect').nth(rows.indexOf(best)).dispatchEvent('click');
  assert.equal(await isFaded(), false);
  await page.keyboard.press('ArrowLeft');
  const beside = await number(),
    moved = rows.find((row) => Number(row[cell]) === beside);
  assert.ok(Math.abs(Number(best[x]) - 0.01 - Number(moved[x])) < 1e-9 && moved[y] === best[y]);
  await page.keyboard.press('ArrowRight');
  assert.equal(await number(), Number(best[cell]));
  // In every colouring places without a path are hatched, and their causes named.
  for (const colour of ['verdict', 'end', 'cost']) {
    await page.selectOption('#colour', colour);
    assert.ok((await page.locator('#map path[fill^="url("]').count()) > 0, colour);
    assert.ok((await page.locator('#legend span').filter({ hasText: 'no path' }).count()) > 0);
  }
  const svg = await saved(page, page.locator('#map h2 button').filter({ hasText: 'SVG' }));
  assert.equal(svg.name, 'experiment_c_placements.svg');
  assert.ok((await elements(page, svg.bytes.toString())).rect >= rows.length);
  await page.click('#theme');
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), 'dark');
  await close();
  // Without JavaScript: how many have a path, the best with its command, and the map.
  const still = await open(html, {
    viewport: { width: 390, height: 844 },
    javaScriptEnabled: false,
  });
  const words = await still.page.textContent('noscript pre');
  assert.ok(words.includes(`${solved.length} with a path, ${rows.length - solved.length} without`));
  assert.ok(words.includes(`--x ${Number(best[x])}`));
  assert.ok(await still.page.isVisible('noscript svg'));
  assert.ok(!(await still.page.isVisible('main')));
  await assertFits(still.page, 390);
  await still.close();
  const narrow = await open(html, { viewport: { width: 390, height: 844 }, colorScheme: 'dark' });
  await assertFits(narrow.page, 390);
  await narrow.close();

  // A joint that is held, over another coordinate: its axis is in rad, its command holds it, and
  // the view shows the robot with the joint there, the tool at the begin of its path.
  {
    const torso = 'torso_joint_b1',
      grid = ['--hold', `${torso}=-0.2:0.2:0.1`, '--y', '0:0.05:0.05'],
      { html: held, rows: found } = place('held', ...grid);
    const { page: view, close: done } = await open(held, {
      viewport: { width: 1280, height: 800 },
    });
    assert.equal(await view.locator('.cells rect').count(), found.length);
    assert.equal(
      await view.textContent('#title'),
      `experiment_c.yaml: where should door and ${torso} stand?`,
    );
    assert.ok((await view.textContent('#map svg')).includes(`${torso}, rad`));
    await until(view, () => window.swivel.frames > 0);
    const lines = await view.locator('#best tbody tr').count(),
      stands = new Set();
    assert.ok(lines >= 4, `${lines} have a path`);
    for (let k = 0; k < lines; ++k) {
      await view.locator('#best tbody tr').nth(k).click();
      const chosen = await view.locator('#best tbody tr').nth(k).getAttribute('data-cell'),
        command = await view.textContent('#command'),
        at = found.find((row) => row[cell] === chosen)[7];
      assert.ok(command.includes(` --hold ${torso}=${at} `), command);
      execFileSync('sh', ['-c', `'${swivel}' ${command.slice('swivel '.length)} --quiet`], {
        cwd: folder,
      });
      const { tool_path } = dataOf(join(folder, `placement_${chosen}.html`));
      await view.locator('#slider').fill('0');
      const [tool, arm] = await view.evaluate(() => {
        const { view: shown } = window.swivel,
          link = shown.arm.find(({ userData }) => userData.body.name === 'torso_link_b1');
        return [shown.tools[0].matrix.elements.slice(12, 15), link?.matrix.elements ?? []];
      });
      tool.forEach((v, c) => assert.ok(Math.abs(v - tool_path[0][c]) < 1e-5, `${chosen}: ${tool}`));
      stands.add(`${at} ${arm.map((v) => v.toFixed(6))}`);
    }
    const positions = new Set([...stands].map((text) => text.split(' ')[0]));
    assert.equal(stands.size, positions.size);
    assert.ok(positions.size >= 2);
    await done();
  }

  // One, three and sampled coordinates; a grid with holes.
  for (const [name, options, marks] of some([
    ['one', ['--yaw', '-0.2:0.2:0.05'], 'rect'],
    ['three', ['--x', '0:0.1:0.05', '--y', '0:0.1:0.05', '--z', '0:0.02:0.02'], 'rect'],
    ['sample', ['--sample', '20', '--x', '-0.1:0.1', '--roll', '-0.1:0.1'], 'circle'],
    ['refined', ['--x', '-0.1:0.1:0.01', '--y', '-0.1:0.1:0.02', '--refine-grid'], 'rect'],
  ])) {
    const { html: other, rows: found } = place(name, ...options);
    const { page: view, close: done } = await open(other, {
      viewport: { width: 1280, height: 800 },
    });
    assert.equal(
      await view.locator(`.cells ${marks}`).count(),
      name === 'three' ? 9 : found.length,
      name,
    );
    await done();
  }
  const [step, count] = scale < 1 ? [0.004, 2550] : [0.002, 10100];
  const many = place('many', '--x', `-0.1:0.1:${step}`, '--y', `-0.1:0.098:${step}`);
  assert.equal(many.rows.length, count);
  assert.ok(many.bytes <= 1e6 + 198 * count, `${many.bytes} bytes`);
  const begun = Date.now(),
    { page: large, close: closed } = await open(many.html, {
      viewport: { width: 1280, height: 800 },
    });
  assert.equal(await large.locator('.cells rect').count(), many.rows.length);
  const seconds = (Date.now() - begun) / 1000;
  await until(large, () => window.swivel.frames > 0);
  const drawn = (Date.now() - begun) / 1000;
  await closed();
  console.log(
    `${many.rows.length} placements: ${(many.bytes / 1e6).toFixed(2)} MB, opened in ` +
      `${seconds.toFixed(1)} s, the arm drawn after ${drawn.toFixed(1)} s`,
  );
});
