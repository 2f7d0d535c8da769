// SPDX-License-Identifier: BSD-3-Clause
import { ticks } from 'd3';
import { number } from './page.js';

/**
 * Marks of an axis whose unit is the layer, at about `count` round values of s; s may repeat, and
 * layers need not be even.
 */
export function alongPath(s, count) {
  const names = new Map();
  for (const value of ticks(s[0], s.at(-1), count)) {
    const next = s.findIndex((v) => v >= value - 1e-9);
    const share =
      next > 0 && s[next] > s[next - 1] ? (s[next] - value) / (s[next] - s[next - 1]) : 0;
    names.set(next - share, number(value, 4));
  }
  return { ticks: [...names.keys()], tickFormat: (layer) => names.get(layer) };
}
