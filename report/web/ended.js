// SPDX-License-Identifier: BSD-3-Clause
// What ended the paths of placements or episodes, and its colour: objects and bodies in oranges,
// limits of joints in blues, the rest in greys.
import { hatchedBy } from './hatching.js';
import { kLimits, kObjects, kOthers, lineBetween } from './palette.js';

const kPalettes = [kObjects, kLimits, kOthers];

/**
 * rows: { by, cause } of those without a path. A map from `by` to { by, cause, count, colour }, the
 * most frequent first.
 */
export function enders(rows) {
  const found = new Map();
  for (const { by, cause } of rows) {
    const ender = found.get(by) ?? { by, cause, count: 0 };
    ++ender.count;
    found.set(by, ender);
  }
  const ordered = [...found.values()].sort((a, b) => b.count - a.count),
    used = [0, 0, 0];
  for (const ender of ordered) {
    const bodies = /^(pair|contact|transition)$/.test(ender.cause),
      group = bodies ? 0 : ender.cause === 'limit' ? 1 : 2,
      palette = kPalettes[group];
    // Those beyond the palette, the least frequent, share its last colour.
    ender.colour = palette[Math.min(used[group]++, palette.length - 1)];
  }
  return new Map(ordered.map((ender) => [ender.by, ender]));
}

/** items: [colour, text, whether it is hatched: no path]. */
export function legend(host, items) {
  host.replaceChildren(
    ...items.map(([colour, text, hatched]) => {
      const item = document.createElement('span'),
        swatch = document.createElement('i');
      swatch.style.background = hatched ? hatchedBy(colour, lineBetween(colour, colour)) : colour;
      item.append(swatch, text);
      return item;
    }),
  );
}
