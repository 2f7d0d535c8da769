// SPDX-License-Identifier: BSD-3-Clause
// Headless Chromium for the tests of the pages. Without a graphics card it draws them by the
// processor: WebGL by SwiftShader, the rest by its own software compositor.
import assert from 'node:assert/strict';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { inflateSync } from 'node:zlib';

const browserFile = process.env.CHROMIUM ?? '/usr/bin/chromium';

/** The share of the variants to try: SWIVEL_TEST_SCALE, 1 where it is not given. */
export const scale = Number(process.env.SWIVEL_TEST_SCALE || 1);

/**
 * Those of the variants that are tried: at least one, as many as the scale asks for, from a place
 * in the list that follows SWIVEL_TEST_SEED.
 */
export function some(variants) {
  const seed = BigInt(process.env.SWIVEL_TEST_SEED || 20260701),
    count = Math.min(variants.length, Math.max(1, Math.ceil(scale * variants.length - 1e-9))),
    first = Number(seed % BigInt(variants.length));
  return Array.from({ length: count }, (_, k) => variants[(first + k) % variants.length]);
}

/**
 * What a page holds: { data, binary: its binary values, bytes: that of which the data has the place
 * }.
 */
export function heldBy(html) {
  const [, text] = readFileSync(html, 'utf8').match(/<script id="data"[^>]*>(.*?)<\/script>/s),
    all = inflateSync(Buffer.from(text, 'base64')),
    end = all.includes(0) ? all.indexOf(0) : all.length,
    binary = new Uint8Array(all.subarray(end + 1));
  return {
    data: JSON.parse(all.subarray(0, end)),
    binary,
    bytes: ([first, count]) => binary.subarray(first, first + count),
  };
}
/** The data of a page. */
export const dataOf = (html) => heldBy(html).data;

/** Ends with code 77 (skipped), but where CI is set with 1. */
export function skip(why) {
  console.log(why);
  process.exit(process.env.CI ? 1 : 77);
}

export function needBrowser() {
  if (!existsSync(browserFile)) skip(`no browser at ${browserFile}`);
}

/** An empty window, and what goes wrong in it from now on. */
async function newWindow(browser, before, javaScriptEnabled) {
  const page = await browser.newPage({ javaScriptEnabled }),
    troubles = [];
  if (before) await page.addInitScript(before);
  page.on('pageerror', (error) => troubles.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && troubles.push(message.text()));
  page.on(
    'request',
    (request) =>
      /^(file|data|blob|about):/.test(request.url()) || troubles.push(`network: ${request.url()}`),
  );
  return { page, troubles };
}

/**
 * Calls back with { browser, folder (for files), open, shoot }; skips where there is no browser or
 * nothing to drive it.
 */
export async function withBrowser({ packages, shots }, test) {
  needBrowser();
  if (!existsSync(join(packages, 'node_modules/playwright-core')))
    skip(`no playwright-core in ${packages}: report.packages fetches it`);
  const { chromium } = createRequire(join(packages, 'package.json'))('playwright-core');
  const folder = mkdtempSync(join(tmpdir(), 'swivel-page-'));
  const browser = await chromium.launch({
    executablePath: browserFile,
    args: [
      '--no-sandbox',
      '--enable-unsafe-swiftshader',
      '--disable-quic',
      '--no-first-run',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-sync',
    ],
  });
  // A window costs two seconds of the processor before it shows anything: pages are opened in the
  // same one where nothing but its size and colours is another. By `before` and javaScriptEnabled.
  const windows = new Map();
  /**
   * Opens a page that must stay without errors and without network: `close` asserts it, and leaves
   * the window to the next page. `before`: a script that runs first in the page.
   */
  const open = async (
    html,
    { before, hash = '', javaScriptEnabled = true, viewport, colorScheme = 'light' },
  ) => {
    const key = JSON.stringify([before, javaScriptEnabled]);
    if (!windows.has(key)) windows.set(key, await newWindow(browser, before, javaScriptEnabled));
    const { page, troubles } = windows.get(key);
    windows.delete(key); // until it is closed
    troubles.length = 0;
    await page.setViewportSize(viewport);
    await page.emulateMedia({ colorScheme });
    await page.goto(`file://${html}${hash}`);
    // The program starts when it is unpacked, perhaps after the page is loaded.
    if (javaScriptEnabled) await until(page, () => 'swivelPage' in window);
    return {
      page,
      close: async ({ withErrors = false } = {}) => {
        if (!withErrors) assert.deepEqual(troubles, []);
        await page.goto('about:blank');
        if (windows.has(key)) await page.close();
        else windows.set(key, { page, troubles });
      },
    };
  };
  const shoot = async (page, name, options) => {
    if (!shots) return;
    // No ring about what has the focus, no line below what is hovered.
    await page.evaluate(() => (document.activeElement?.blur(), scrollTo(0, 0)));
    await page.mouse.move(1, 1);
    await page.waitForTimeout(800); // at rest the arm is drawn with more pixels
    await page.screenshot({ path: join(shots, name), ...options });
  };
  try {
    await test({ browser, folder, open, shoot });
  } finally {
    await browser.close();
    rmSync(folder, { recursive: true });
  }
}

/**
 * Waits until `holds` (a function of the page, with one argument) is true. The driver's own waiting
 * evaluates text in the page, which its content security policy refuses.
 */
export async function until(page, holds, argument) {
  for (const end = Date.now() + 30_000; !(await page.evaluate(holds, argument));) {
    assert.ok(Date.now() < end, `not within 30 s: ${holds}`);
    await new Promise((resolve) => setTimeout(resolve, 10));
  }
}

/** Presses a key while what moves the arm has the focus. */
export async function press(page, key) {
  await page.locator('#scene:visible, #slider').first().focus();
  await page.keyboard.press(key);
}

/**
 * Clicks on every body that the view shows wide enough to be hit. told: called with the name of
 * each and the lines that the page then tells.
 */
export async function clickBodies(page, told) {
  // The height of the view follows that of the header, a few pictures later.
  await page.evaluate(async () => {
    for (let steady = 0, last = '', n = 0; steady < 10 && n < 1000; ++n) {
      await new Promise(requestAnimationFrame);
      const { width, height } = window.swivel.view.size,
        box = document.querySelector('#scene').getBoundingClientRect(),
        fits = Math.abs(width - box.width) < 1 && Math.abs(height - box.height) < 1,
        now = `${box.width} ${box.height} ${box.y}`;
      steady = fits && now === last ? steady + 1 : 0;
      last = now;
    }
  });
  const box = await page.locator('#scene').boundingBox(),
    places = await page.evaluate(() => {
      const { view } = window.swivel,
        found = {},
        at = (x, y) => view.pick(x, y)?.body.name ?? '';
      for (let y = 8; y < view.size.height - 8; y += 8)
        for (let x = 8; x < view.size.width - 8; x += 8) {
          const name = at(x, y);
          if (name in found) continue;
          // A click lands up to a pixel off, since pages are laid out in parts of pixels.
          if ([-2, 2].every((d) => at(x + d, y) === name && at(x, y + d) === name))
            found[name] = [x, y];
        }
      return found;
    });
  delete places[''];
  for (const [name, [x, y]] of Object.entries(places)) {
    await page.mouse.click(box.x + x, box.y + y);
    const lines = (await page.textContent('#tip')).split('\n');
    assert.ok(lines[0] === name || lines[0].startsWith(`${name} (`), `${name}: ${lines[0]}`);
    assert.match(lines.at(-1), /^point (-?\d+\.\d{3}, ){2}-?\d+\.\d{3} m$/);
    told(name, lines);
  }
}

/** What a click on the page's button saves. */
export async function saved(page, button) {
  const [download] = await Promise.all([page.waitForEvent('download'), button.click()]);
  return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
}

/** How many elements of each name an SVG document has; throws where it is not well formed. */
export const elements = (page, text) =>
  page.evaluate((source) => {
    const document = new DOMParser().parseFromString(source, 'image/svg+xml'),
      count = {};
    if (document.querySelector('parsererror'))
      throw new Error(document.querySelector('parsererror').textContent);
    for (const { localName } of document.querySelectorAll('*'))
      count[localName] = (count[localName] ?? 0) + 1;
    return count;
  }, text);

export async function assertFits(page, width) {
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= width, `${wide} pixels wide on a screen of ${width}`);
}

/**
 * What is pressed is 24 pixels high or more (WCAG 2.2, 2.5.8), but the words of a line, and the
 * slider says where it stands.
 */
export async function assertReachable(page) {
  const low = await page.evaluate(() =>
    [...document.querySelectorAll('button, select')]
      .filter((one) => one.checkVisibility() && !one.closest('#verdict'))
      .filter((one) => one.getBoundingClientRect().height < 24)
      .map((one) => one.id || one.textContent || one.className),
  );
  assert.deepEqual(low, []);
  if (await page.isVisible('#slider'))
    assert.ok(((await page.getAttribute('#slider', 'aria-valuetext')) ?? '').length > 3);
}

/** No name in the view stands over another one, over a stroke's number or a line's length. */
export async function assertLabelsApart(page) {
  const over = await page.evaluate(() => {
    const all = [...document.querySelectorAll('#stage .name, #stage .number, #gap')]
      .filter((one) => one.checkVisibility({ visibilityProperty: true }))
      .map((one) => ({ one, ...one.getBoundingClientRect().toJSON() }));
    // A pixel is rounding.
    const meet = (a, b) =>
      a.left < b.right - 1 &&
      b.left < a.right - 1 &&
      a.top < b.bottom - 1 &&
      b.top < a.bottom - 1;
    return all
      .filter(({ one }) => one.className === 'name')
      .flatMap((a) => all.filter((b) => b !== a && meet(a, b)).map((b) => [a, b]))
      .map((two) => two.map(({ one }) => one.textContent).join(' over '));
  });
  assert.deepEqual(over, []);
}

/** On paper all is light, the arm is a picture, and afterwards all is as before. */
export async function assertPrints(page) {
  const dark = () => page.evaluate(() => document.documentElement.dataset.theme === 'dark'),
    before = await dark();
  const printed = await page.evaluate(() => {
    dispatchEvent(new Event('beforeprint'));
    const kept = document.getElementById('kept');
    return kept.decode().then(() => {
      const canvas = document.createElement('canvas'),
        pen = canvas.getContext('2d'),
        chart = document.querySelector('#map .chart svg');
      [canvas.width, canvas.height] = [200, 150];
      pen.drawImage(kept, 0, 0, 200, 150);
      const { data } = pen.getImageData(0, 0, 200, 150);
      return {
        colours: new Set(new Uint32Array(data.buffer)).size,
        nights: new Uint32Array(data.buffer).filter((pixel) => pixel === 0xff27201a).length,
        theme: document.documentElement.dataset.theme,
        width: chart.getBoundingClientRect().width,
        all: document.body.scrollWidth,
      };
    });
  });
  assert.ok(printed.colours > 200, `${printed.colours} colours in the picture`);
  // Of 30,000 pixels; the edge of a body may have that colour by chance.
  assert.ok(printed.nights < 30, `${printed.nights} pixels of the ground of the dark theme`);
  assert.equal(printed.theme, 'light');
  assert.ok(printed.width <= 700);
  assert.ok(printed.all <= 700, `${printed.all} pixels wide on paper`);
  await page.evaluate(() => dispatchEvent(new Event('afterprint')));
  assert.equal(await dark(), before);
  assert.ok(await page.isVisible('#scene'));
  assert.equal((await page.pdf({ format: 'A4' })).subarray(0, 4).toString(), '%PDF');
}
