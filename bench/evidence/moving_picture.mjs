#!/usr/bin/env node
// SPDX-License-Identifier: BSD-3-Clause
// Draws the arm of a report along its path, there and back, as a moving picture.
//   moving_picture.mjs REPORT.html PACKAGES OUT.webp [AZIMUTH ELEVATION AWAY]
// PACKAGES is a folder whose node_modules has playwright-core (build/release/tests/report). The
// camera stands at the azimuth from x and the elevation above the ground, degrees, AWAY times as
// far as where arm and path fill the picture, or where the page puts it. Needs chromium and
// img2webp (Debian: webp).
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { join, resolve } from 'node:path';
import { until, withBrowser } from '../../tests/report/browser.mjs';

const [report, packages, out, ...place] = process.argv.slice(2);
const kFrames = 36,
  kMilliseconds = 110,
  kWidth = 640,
  kHeight = 400;

await withBrowser({ packages: resolve(packages) }, async ({ folder, open }) => {
  const { page, close } = await open(resolve(report), { viewport: { width: 1280, height: 900 } });
  await until(page, () => window.swivel.frames > 0);
  const most = Number(await page.getAttribute('#slider', 'max'));
  // The picture alone, over all else on the page, without the arm's faded ends of the path.
  await page.locator('#ghosts').uncheck();
  await page.evaluate(
    ([width, height, [azimuth, elevation, away]]) => {
      Object.assign(document.getElementById('stage').style, {
        position: 'fixed',
        left: '0',
        top: '0',
        width: `${width}px`,
        height: `${height}px`,
        zIndex: 1000,
      });
      const { view } = window.swivel,
        { camera, orbit } = view;
      view.resize();
      if (!away) return view.look('best');
      const [turn, up] = [azimuth, elevation].map((angle) => (angle * Math.PI) / 180),
        flat = Math.cos(up);
      camera.position.set(Math.cos(turn) * flat, Math.sin(turn) * flat, Math.sin(up));
      camera.position.add(orbit.target);
      view.look('fit');
      camera.position.sub(orbit.target).multiplyScalar(away).add(orbit.target);
      orbit.update();
    },
    [kWidth, kHeight, place.map(Number)],
  );
  const shown = await page.locator('#scene').boundingBox();
  assert.deepEqual([shown.width, shown.height], [kWidth, kHeight]);
  const files = [];
  for (let k = 0; k < kFrames; ++k) {
    await page.evaluate(
      (value) => {
        const slider = document.getElementById('slider');
        slider.value = value;
        slider.dispatchEvent(new Event('input'));
      },
      Math.round((most * k) / (kFrames - 1)),
    );
    await page.waitForTimeout(900); // at rest the arm is drawn with more pixels
    files.push(join(folder, `${String(k).padStart(3, '0')}.png`));
    await page.screenshot({ path: files[k], clip: { x: 0, y: 0, width: kWidth, height: kHeight } });
  }
  const back = files.slice(1, -1).reverse();
  execFileSync('img2webp', [
    ...['-loop', '0', '-lossy', '-q', '55', '-m', '6', '-d', String(kMilliseconds)],
    ...files,
    ...back,
    ...['-o', resolve(out)],
  ]);
  await close();
});
