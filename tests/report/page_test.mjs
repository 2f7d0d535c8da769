// SPDX-License-Identifier: BSD-3-Clause
// Plans the experiments with --report and uses the pages in headless Chromium. Arguments: the program, the problems' folder, the
// folder whose node_modules has playwright-core, and optionally a folder for screenshots.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const [swivel, problems, packages, shots] = process.argv.slice(2);
const { chromium } = createRequire(join(packages, 'package.json'))('playwright-core');
const browserFile = process.env.CHROMIUM ?? '/usr/bin/chromium';
if (!existsSync(browserFile)) {
  console.log(`no browser at ${browserFile}`);
  process.exit(process.env.CI ? 1 : 77);  // 77: skipped
}
const folder = mkdtempSync(join(tmpdir(), 'swivel-page-'));
const browser = await chromium.launch({ executablePath: browserFile, args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic',
  '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'] });

function plan(name, ...options) {
  const html = join(folder, `${name}.html`), csv = join(folder, `${name}.csv`);
  const done = spawnSync(swivel, ['plan', join(problems, `experiment_${name}.yaml`), '--quiet', '--report', html, '--out', csv, ...options]);
  const rows = existsSync(csv) ? readFileSync(csv, 'utf8').trim().split('\n').slice(1).map((line) => line.split(',').slice(3).map(Number)) : null;
  return { html, rows, status: done.status, bytes: statSync(html).size };
}
async function open(html, options) {
  const page = await browser.newPage(options), troubles = [];
  page.on('pageerror', (error) => troubles.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && troubles.push(message.text()));
  page.on('request', (request) => /^(file|data|blob):/.test(request.url()) || troubles.push(`network: ${request.url()}`));
  const begin = performance.now();
  await page.goto(`file://${html}`);
  await page.waitForFunction(() => window.swivel?.frames > 0);
  return { page, troubles, ms: performance.now() - begin };
}
const joints = (page) => page.evaluate(() => window.swivel.joints);
const slide = (page, row) => page.evaluate((value) => {
  const slider = document.getElementById('slider');
  slider.value = value;
  slider.dispatchEvent(new Event('input'));
}, row);
const shoot = async (page, name) => shots && (await page.screenshot({ path: join(shots, name) }));

try {
  for (const name of ['a', 'b', 'c']) {
    const { html, rows, status, bytes } = plan(name);
    assert.equal(status, 0);
    assert.ok(bytes <= 5e6, `${bytes} bytes`);
    const { page, troubles, ms } = await open(html, { viewport: { width: 1280, height: 800 }, colorScheme: name === 'b' ? 'dark' : 'light' });
    console.log(`experiment ${name}: ${(bytes / 1e6).toFixed(2)} MB, first picture after ${ms.toFixed(0)} ms`);
    assert.match(await page.textContent('#verdict'), /^Solved/);
    assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), name === 'b' ? 'dark' : 'light');
    for (const k of [0, Math.floor(rows.length / 2), rows.length - 1]) {
      await slide(page, k);
      const shown = await joints(page);
      rows[k].forEach((value, j) => assert.ok(Math.abs(value - shown[j]) < 1e-12, `row ${k} joint ${j}: ${value} in the file, ${shown[j]} on the page`));
    }
    await page.keyboard.press('Home');
    await page.keyboard.press('ArrowRight');
    assert.deepEqual((await joints(page)).map((v) => v.toFixed(9)), rows[1].map((v) => v.toFixed(9)));
    await page.keyboard.press('Home');
    const before = await page.evaluate(() => window.swivel.frames), from = performance.now();
    await page.keyboard.press(' ');
    await page.waitForTimeout(2000);
    const frames = (await page.evaluate(() => window.swivel.frames)) - before;
    console.log(`experiment ${name}: ${((1000 * frames) / (performance.now() - from)).toFixed(0)} frames a second, software rendering`);
    await page.keyboard.press(' ');
    assert.ok(frames > 4 && Number(await page.inputValue('#slider')) > 0);
    await slide(page, Math.floor(rows.length / 2));
    await shoot(page, `report_${name}.png`);

    // Over every panel's middle row of cells: some cell has joints, and hovering shows them and moves the arm.
    const rest = await joints(page), box = await page.locator('.panel canvas').first().boundingBox();
    let moved = false;
    for (let k = 1; k < 20 && !moved; ++k) {
      await page.mouse.move(box.x + box.width * 0.5, box.y + (box.height * k) / 20);
      assert.ok(await page.isVisible('#tip'));
      moved = JSON.stringify(await joints(page)) !== JSON.stringify(rest);
    }
    assert.ok(moved, 'no cell of the path\'s branch moves the arm');
    const hovered = await joints(page);
    await page.mouse.down();
    await page.mouse.up();
    await page.mouse.move(5, 5);
    assert.deepEqual(await joints(page), hovered, 'a click keeps the pose');
    await page.keyboard.press('t');
    assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), name === 'b' ? 'light' : 'dark');
    assert.deepEqual(troubles, []);
    await page.close();
  }
  const stuck = plan('a_start');
  assert.equal(stuck.status, 1);
  assert.equal(stuck.rows, null);
  const { page, troubles } = await open(stuck.html, { viewport: { width: 390, height: 844 }, colorScheme: 'light' });
  assert.match(await page.textContent('#verdict'), /^No path at this resolution: every one ends by layer \d+ of \d+/);
  assert.equal(await page.inputValue('#slider'), await page.getAttribute('#slider', 'max'));  // shows where it got stuck
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390, 'wider than a phone');
  assert.match(await page.textContent('#tables'), /What removed the nodes/);
  await shoot(page, 'report_phone.png');
  assert.deepEqual(troubles, []);
} finally {
  await browser.close();
  rmSync(folder, { recursive: true });
}
