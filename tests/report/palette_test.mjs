// SPDX-License-Identifier: BSD-3-Clause
// Holds the colours of pages, drawings and terminal against each other: differences by CIEDE2000
// for normal sight and three kinds of dichromats, contrast by WCAG 2. Argument: the source tree.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { contrast, difference, kSights, lab, leastDifference } from './colour.mjs';

const root = resolve(process.argv[2]),
  web = join(root, 'report/web'),
  kApart = 10,
  kContrast = 3;
const palette = await import(pathToFileURL(join(web, 'palette.js')));
const { kBodies, kDark, kKnown, kLight, kLimits, kLines, kObjects, kOthers, lineBetween } = palette;

// Pairs of Sharma, Wu and Dalal, "The CIEDE2000 color-difference formula", table 1.
for (const [one, other, expected] of [
  [[50, 2.6772, -79.7751], [50, 0, -82.7485], 2.0425],
  [[50, -1.3802, -84.2814], [50, 0, -82.7485], 1.0],
  [[50, 0, 0], [50, -1, 2], 2.3669],
  [[50, 2.49, -0.001], [50, -2.49, 0.0009], 7.1792],
  [[50, 2.49, -0.001], [50, -2.49, 0.0011], 7.2195],
  [[50, 2.5, 0], [73, 25, -18], 27.1492],
  [[50, 2.5, 0], [61, -5, 29], 22.8977],
  [[50, 2.5, 0], [56, -27, -3], 31.903],
  [[50, 2.5, 0], [58, 24, 15], 19.4535],
  [[60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644],
  [[2.0776, 0.0795, -1.135], [0.9033, -0.0636, -0.5514], 0.9082],
])
  assert.ok(Math.abs(difference(one, other) - expected) < 6e-5, `${one} and ${other}`);
// What a dichromat confuses is nearly alike for him, and not for others.
assert.ok(difference(lab('#b4b9bf'), lab('#e58fc0')) > 20);
assert.ok(leastDifference('#b4b9bf', '#e58fc0') < 8);

let pairs = 0,
  least = Infinity;
function assertApart(what, colours) {
  const entries = Object.entries(colours);
  entries.forEach(([name, colour], k) =>
    entries.slice(k + 1).forEach(([other, second]) => {
      const apart = leastDifference(colour, second);
      ++pairs;
      least = Math.min(least, apart);
      assert.ok(apart >= kApart, `${what}: ${name} and ${other} differ by ${apart.toFixed(1)}`);
    }),
  );
}
const objects = Object.fromEntries(kObjects.map((colour, k) => [`object ${k + 1}`, colour])),
  limits = Object.fromEntries(kLimits.map((colour, k) => [`limit ${k + 1}`, colour])),
  others = Object.fromEntries(kOthers.map((colour, k) => [`other ${k + 1}`, colour]));
for (const [theme, { hatch, ...ground }] of Object.entries({ light: kLight, dark: kDark })) {
  const map = { ...kKnown, ...objects, ...ground };
  assertApart(`the ${theme} map`, map);
  assertApart(`ends in the ${theme} theme`, {
    solved: kKnown.found,
    ...objects,
    ...limits,
    ...others,
    nothing: ground.nothing,
    unseen: ground.unseen,
  });
  assertApart(`bodies in the ${theme} theme`, {
    ...kBodies,
    ...kLines,
    ground: ground.nothing,
  });
  // Between areas of little contrast is a line of enough contrast with both; limits are hatched.
  let lines = 0;
  for (const one of Object.values(map))
    for (const other of Object.values(map)) {
      const line = lineBetween(one, other);
      if (line === null) {
        assert.ok(contrast(one, other) >= kContrast, `${one} ${other}`);
        continue;
      }
      ++lines;
      assert.ok(contrast(line, one) >= kContrast && contrast(line, other) >= kContrast);
    }
  assert.ok(lines > 50, `${lines} pairs with lines`);
  assert.ok(contrast(hatch, ground.limit) >= kContrast, `hatching of the ${theme} map`);
}
// The ramp rises in lightness for every sight, and no step of it looks like "no path".
for (const sight of Object.keys(kSights)) {
  const steps = Array.from({ length: 21 }, (_, k) => lab(palette.rampColour(k / 20), sight));
  steps.slice(1).forEach(([l], k) => assert.ok(l > steps[k][0], `${sight}, step ${k + 1}`));
}
for (const ground of [kLight, kDark])
  for (let k = 0; k <= 20; ++k) {
    const step = palette.rampColour(k / 20),
      apart = leastDifference(step, ground.nothing);
    assert.ok(apart >= kApart, `ramp at ${k / 20}: ${step} is ${apart.toFixed(1)} from the ground`);
  }

// Style sheet, drawings and terminal have the same colours.
const css = readFileSync(join(web, 'page.css'), 'utf8');
for (const colour of [
  kKnown.found,
  kKnown.proved,
  kObjects[0],
  kLines.moves,
  kLines.nearest,
  ...palette.kRamp,
])
  assert.ok(css.includes(colour), `${colour} in page.css`);
const header = readFileSync(join(root, 'report/src/palette.hpp'), 'utf8');
/** The colours of a constant there. */
const drawn = (name) => header.match(new RegExp(`${name}[ {][^;]*;`))[0].match(/#[0-9a-f]{6}/g);
for (const [name, colours] of Object.entries({
  kNothing: [kLight.nothing],
  kUnseen: [kLight.unseen],
  kLimit: [kLight.limit],
  kHatch: [kLight.hatch],
  kProved: [kKnown.proved],
  kFound: [kKnown.found],
  kSingular: [kKnown.singular],
  kSelf: [kKnown.self],
  kObjects,
  kLimits,
  kOthers,
  kRamp: palette.kRamp,
}))
  assert.deepEqual(drawn(name), colours, `${name} of palette.hpp`);
console.log(`${pairs} pairs of colours, the nearest two ${least.toFixed(1)} apart`);
assert.ok(pairs > 300);
