// SPDX-License-Identifier: BSD-3-Clause
// Runs campaigns with --report and uses their overview in headless Chromium. Arguments as of
// page_test.mjs.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { assertFits, dataOf, elements, saved, withBrowser } from './browser.mjs';

const [swivel, problems, packages, shots] = process.argv.slice(2).map((path) => resolve(path));
const problem = join(problems, 'experiment_c.yaml'),
  kEpisodes = 60;

function firstRows(csv, to, count) {
  writeFileSync(
    to,
    readFileSync(csv, 'utf8')
      .split('\n')
      .slice(0, count + 1)
      .join('\n') + '\n',
  );
  return to;
}

function campaign(csv, html, ...options) {
  const said = execFileSync(swivel, [
    'campaign',
    problem,
    '--planner',
    'lazy',
    '--ds',
    '0.02',
    '--dphi',
    '0.2',
    '--episodes',
    String(kEpisodes),
    '--seed',
    '1',
    '--out',
    csv,
    '--report',
    html,
    ...options,
  ]);
  const rows = readFileSync(csv, 'utf8')
    .trim()
    .split('\n')
    .filter((line) => !line.startsWith('# '))
    .slice(1)
    .map((line) => line.split(','));
  return { html, csv, rows, said: String(said), bytes: statSync(html).size };
}
/** The page's data without the time of planning. */
const told = (html) => JSON.stringify(dataOf(html), (key, v) => (key === 'plan_ms' ? 0 : v));
const column = (page, k) =>
  page.$$eval(
    '#scroll tbody tr',
    (lines, at) => lines.map((line) => line.cells[at].textContent),
    k,
  );

await withBrowser({ packages, shots }, async ({ folder, open, shoot }) => {
  const [all, overview] = ['csv', 'html'].map((end) => join(folder, `all.${end}`)),
    { html, csv, rows, bytes, said } = campaign(all, overview);
  const failed = rows.filter(([, status]) => status === 'infeasible');
  assert.ok(failed.length >= 3 && rows.length === kEpisodes);
  const { page, close } = await open(html, {
    viewport: { width: 1280, height: 800 },
    colorScheme: 'light',
  });
  assert.match(
    await page.textContent('#verdict'),
    new RegExp(
      `^${rows.length - failed.length} of ${rows.length} episodes solved .*${failed.length} ` +
        'without a path',
    ),
  );
  // The terminal says the same, to the digit.
  const [, median, p95] = said.match(/plan ([\d.]+) ms in the median \(.*5 % above ([\d.]+)\)/);
  assert.ok(
    (await page.textContent('#verdict')).endsWith(
      `${median} ms in the median, 5 % above ${p95} ms.`,
    ),
  );
  await assertFits(page, 1280);
  assert.deepEqual(
    await column(page, 0),
    rows.map(([episode]) => episode),
  );
  assert.equal(await page.locator('#reasons svg').count(), 1);
  assert.equal(await page.locator('#times .pick circle').count(), rows.length);
  assert.equal(
    await page.locator('#places .pick circle').count(),
    failed.filter(([, , , , , , , , s]) => s !== '').length,
  );

  // Where the objects stood, coloured by what ended the paths: an object, a joint or the cause.
  assert.equal(await page.locator('#offsets .pick circle').count(), rows.length);
  const subjects = new Set(failed.map((row) => row[10] || row[9]));
  assert.ok(subjects.size >= 2);
  assert.equal(await page.locator('#legend span').count(), 1 + subjects.size);
  assert.equal(
    new Set(
      await page.$$eval('#offsets .pick circle', (dots) =>
        dots.map((dot) => dot.getAttribute('fill')),
      ),
    ).size,
    1 + subjects.size,
  );
  await page.selectOption('#up', { label: 'door.yaw' });
  assert.match(await page.textContent('#offsets svg'), /door\.yaw, deg/);
  await page.selectOption('#up', { label: 'door.y' });
  assert.match(await page.textContent('#facts'), /door\.x/);

  await shoot(page, 'overview_c.png');

  // Without JavaScript: how many have a path, and what ended the others.
  const still = await open(html, {
    viewport: { width: 390, height: 844 },
    javaScriptEnabled: false,
  });
  const words = await still.page.textContent('noscript pre');
  assert.ok(
    words.includes(`${rows.length - failed.length} of ${rows.length} episodes have a path`),
  );
  assert.equal(words.match(/without one: /g).length, subjects.size);
  assert.ok(!(await still.page.isVisible('main')));
  await still.close();

  // Sorted by cost, both ways; episodes without a cost stay at the end.
  const costs = async () =>
    (await column(page, 2)).slice(0, rows.length - failed.length).map(Number);
  const head = page.locator('#scroll th button').nth(2);
  await head.click();
  const rising = await costs();
  assert.deepEqual(
    rising,
    [...rising].sort((a, b) => a - b),
  );
  await head.click();
  assert.deepEqual(await costs(), [...rising].reverse());
  assert.deepEqual(
    (await column(page, 1)).slice(-failed.length),
    failed.map(() => 'infeasible'),
  );
  await page.check('#failed');
  assert.deepEqual(
    await column(page, 1),
    failed.map(() => 'infeasible'),
  );
  await page.uncheck('#failed');

  // A dot and a line of the table pick an episode; its command plans the same again.
  const dot = page.locator('#times .pick circle').last(),
    named = (await dot.textContent()).match(/\d+/)[0];
  await dot.dispatchEvent('click');
  assert.match(await page.textContent('#facts'), new RegExp(`^Episode ${named} of seed 1`));
  for (const wanted of [rows[0], failed[0]]) {
    await page
      .locator('#scroll tbody tr')
      .filter({ has: page.locator('td:first-child', { hasText: new RegExp(`^${wanted[0]}$`) }) })
      .click();
    const command = await page.textContent('#command');
    assert.match(command, /^swivel plan /);
    const again = spawnSync(
      'sh',
      ['-c', `exec '${swivel}' ${command.slice('swivel '.length)} --quiet --json -`],
      { cwd: folder },
    );
    const result = JSON.parse(String(again.stdout));
    assert.equal(result.status, wanted[1]);
    assert.equal(result.cost ?? '', wanted[2] === '' ? '' : Number(wanted[2]));
    assert.ok(statSync(join(folder, `episode_${wanted[0]}.html`)).size > 1e5);
  }
  for (const section of ['times', 'costs', 'work', 'reasons', 'offsets']) {
    const svg = await saved(page, page.locator(`#${section} h2 button`).filter({ hasText: 'SVG' }));
    assert.equal(svg.name, `experiment_c_${section}.svg`);
    assert.ok((await elements(page, svg.bytes.toString())).text > 4);
  }
  await page.click('#theme');
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), 'dark');
  await close();
  const narrow = await open(html, { viewport: { width: 390, height: 844 }, colorScheme: 'dark' });
  await assertFits(narrow.page, 390);
  await narrow.close();
  console.log(
    `${rows.length} episodes, ${failed.length} without a path: ${(bytes / 1e3).toFixed(0)} kB`,
  );

  // A campaign that was cut off and went on has the same page; a shard has its own rows, and shards
  // put together that of the whole.
  assert.equal(
    told(
      campaign(
        join(folder, 'resumed.csv'),
        join(folder, 'resumed.html'),
        '--rows',
        firstRows(csv, join(folder, 'first.csv'), 20),
      ).html,
    ),
    told(html),
  );
  const shards = [0, 1, 2].map((k) =>
    campaign(join(folder, `shard${k}.csv`), join(folder, `shard${k}.html`), '--shard', `${k}/3`),
  );
  shards.forEach((shard, k) =>
    assert.deepEqual(
      shard.rows.map(([episode]) => Number(episode)),
      Array.from({ length: 20 }, (_, n) => 3 * n + k),
    ),
  );
  const second = await open(shards[1].html, { viewport: { width: 1280, height: 800 } });
  assert.match(await second.page.textContent('#title'), /shard 1 of 3$/);
  assert.deepEqual(
    await column(second.page, 0),
    shards[1].rows.map(([episode]) => episode),
  );
  await second.close();
  execFileSync(swivel, [
    'merge',
    join(folder, 'joined.csv'),
    ...shards.map((shard) => shard.csv),
    '--report',
    join(folder, 'joined.html'),
  ]);
  assert.equal(told(join(folder, 'joined.html')), told(html));
});
