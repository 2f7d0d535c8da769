#!/usr/bin/env node
// SPDX-License-Identifier: BSD-3-Clause
// Draws the arm of a report along its path, there and back, as a moving picture.
//   moving_picture.mjs REPORT.html PACKAGES OUT.webp
// PACKAGES is a folder whose node_modules has playwright-core (build/release/tests/report). Needs
// chromium and img2webp (Debian: webp).
import { execFileSync } from 'node:child_process';
import { join, resolve } from 'node:path';
import { withBrowser } from '../../tests/report/browser.mjs';

const [report, packages, out] = process.argv.slice(2);
const kFrames = 36,
  kMilliseconds = 110,
  kWidth = 640,
  kHeight = 400;

await withBrowser({ packages: resolve(packages) }, async ({ folder, open }) => {
  const { page, close } = await open(resolve(report), { viewport: { width: 1280, height: 900 } });
  await page.waitForSelector('canvas');
  const most = Number(await page.getAttribute('#slider', 'max'));
  // The picture alone, without the numbers and switches over it.
  await page.evaluate(
    ([width, height]) => {
      document.getElementById('readout').style.display = 'none';
      document.getElementById('views').parentElement.style.display = 'none';
      Object.assign(document.querySelector('canvas').parentElement.style, {
        position: 'fixed',
        left: '0',
        top: '0',
        width: `${width}px`,
        height: `${height}px`,
        zIndex: 1000,
      });
      window.dispatchEvent(new Event('resize'));
    },
    [kWidth, kHeight],
  );
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
