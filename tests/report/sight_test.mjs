// SPDX-License-Identifier: BSD-3-Clause
// The first picture of a page shows the work: of all problems of one arm, jobs included, four
// fifths of the path, and where the arm is nearest to something, by rays past all bodies, the arm's
// own among them; names do not stand over each other. Of those with one path, every jump of the
// answer leads to what it says. Arguments: the program, the problems' folder, the folder whose
// node_modules has playwright-core.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { assertLabelsApart, dataOf, some, until, withBrowser } from './browser.mjs';
import { checkJumps } from './jumps.mjs';

const [swivel, problems, packages] = process.argv.slice(2).map((path) => resolve(path)),
  screens = { desktop: { width: 1280, height: 800 }, phone: { width: 390, height: 844 } },
  kShare = 0.78, // of the path
  kShort = 0.08; // what may lack to the most that any direction shows, where that is less

/** In the page: defines window.test, which tells what the view's picture shows. */
function define() {
  const { view } = window.swivel,
    { camera, nearest, world, data } = view,
    inRoom = (point) => point.applyMatrix4(world.matrix),
    path = (data.paths ?? [data.tool_path])
      .flat()
      .map((point) => inRoom(camera.position.clone().set(...point))),
    // The two ends of the line between what is nearest: in a job, at home, they are of no interest.
    ends =
      nearest.visible && !data.paths
        ? nearest.children.slice(1).map(({ position }) => inRoom(position.clone()))
        : [],
    turned = camera.position.clone();
  /** Whether a point is in the picture, and nothing more than 15 mm before it. */
  const isSeen = (point) => {
    const { width, height } = view.size,
      away = point.distanceTo(camera.position),
      { x, y } = point.clone().project(camera);
    if (Math.max(Math.abs(x), Math.abs(y)) > 1) return false;
    const hit = view.pick(((x + 1) / 2) * width, ((1 - y) / 2) * height);
    return !hit || hit.point.distanceTo(camera.position) > away - 0.015;
  };
  const share = (points) => points.filter(isSeen).length / points.length;
  window.test = {
    now: () => ({ path: share(path), ends: ends.map(isSeen) }),
    /** The largest share of the path that is seen from any of 144 directions around. */
    most: () => {
      let most = 0;
      for (const up of [0.12, 0.3, 0.62, 1.0])
        for (let k = 0; k < 36; ++k) {
          const turn = (k * Math.PI) / 18,
            flat = Math.cos(up);
          turned.set(Math.cos(turn) * flat, Math.sin(turn) * flat, Math.sin(up));
          camera.position.copy(view.orbit.target).add(turned);
          view.look('fit');
          camera.updateMatrixWorld();
          most = Math.max(most, share(path));
        }
      return most;
    },
  };
}

const files = readdirSync(problems)
  .filter((name) => name.endsWith('.yaml'))
  .filter((name) => !/^arms:/m.test(readFileSync(join(problems, name), 'utf8')))
  .sort();
assert.ok(files.length >= 20, `${files.length} problems`);

await withBrowser({ packages }, async ({ folder, open }) => {
  let short = 0,
    nearest = 0,
    jumps = 0,
    solved = 0;
  for (const name of some(files)) {
    const html = join(folder, `${name}.html`),
      done = spawnSync(swivel, ['plan', join(problems, name), '--quiet', '--report', html]);
    assert.ok(existsSync(html), String(done.stderr));
    const data = dataOf(html);
    for (const [screen, viewport] of Object.entries(screens)) {
      const { page, close } = await open(html, { viewport });
      await until(page, () => window.swivel?.frames > 0);
      await assertLabelsApart(page);
      await page.evaluate(define);
      const { path, ends } = await page.evaluate(() => window.test.now()),
        isShort = path < kShare,
        most = isShort ? await page.evaluate(() => window.test.most()) : null,
        percent = (value) => `${(100 * value).toFixed(0)} %`;
      console.log(
        `${name}, ${screen}: ${percent(path)} of the path` +
          (isShort ? ` (${percent(most)} at most)` : '') +
          (ends.length ? `, nearest place ${ends.some(Boolean) ? 'seen' : 'hidden'}` : ''),
      );
      // A pipe hides nearly half of a path around it, wherever one stands.
      assert.ok(path >= Math.min(kShare, (most ?? 1) - kShort));
      assert.ok(!ends.length || ends.some(Boolean), 'the nearest place is hidden');
      short += isShort;
      nearest += ends.length > 0;
      if (screen === 'desktop' && data.result.trajectory) {
        jumps += await checkJumps(page, data);
        solved += data.result.status === 'solved';
      }
      await close();
    }
  }
  console.log(`${short} pictures show less of the path; ${nearest} have a nearest place`);
  console.log(`${jumps} jumps of ${solved} plans agree with their results`);
  assert.ok(jumps >= 3 * solved);
});
