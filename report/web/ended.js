// SPDX-License-Identifier: BSD-3-Clause
// What ended the paths of placements or episodes, and its colour: objects and bodies in oranges,
// limits of joints in blues, the rest in greys.
export const SOLVED = '#00795a',
  FAILED = '#d55e00';
const kPalettes = [
  ['#d55e00', '#e69f00', '#a34700', '#f0c05a', '#7a2d00', '#f0902f'],
  ['#5fb0e2', '#3a83b5', '#97cced', '#1f5f8b', '#cfe8f7', '#0b3a5c', '#7bbee8'],
  ['#cc79a7', '#8f8f9c', '#b9a0d0', '#5b6673'],
];

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
    ender.colour = palette[used[group]++ % palette.length];
  }
  return new Map(ordered.map((ender) => [ender.by, ender]));
}

/** items: [colour, text]. */
export function legend(host, items) {
  host.replaceChildren(
    ...items.map(([colour, text]) => {
      const item = document.createElement('span'),
        swatch = document.createElement('i');
      swatch.style.background = colour;
      item.append(swatch, text);
      return item;
    }),
  );
}
