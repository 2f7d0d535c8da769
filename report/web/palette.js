// SPDX-License-Identifier: BSD-3-Clause
// The colours of all that is drawn; src/palette.hpp has those of drawings and of the terminal.
// Colours that can stand side by side differ by CIEDE2000 of at least 10, for normal sight and for
// dichromats; where their contrast is below 3, hatching or a line parts them
// (tests/report/palette_test.mjs).

/** What the search knows of a node, in every theme. */
export const kKnown = {
  proved: '#62caa9', // free, by a distance proof alone
  found: '#0f8064', // free, by FCL
  singular: '#c779a6',
  self: '#6a4d94', // blocked by the robot itself
};
/** Objects of the scene that block, one hue each; more than these repeat them. */
export const kObjects = ['#e0691b', '#ebc121', '#762200', '#f39868', '#765c00', '#c3473f'];
/** What was not asked about. A limit is hatched. */
export const kLight = { nothing: '#ffffff', unseen: '#ced2d9', limit: '#a8d7f8', hatch: '#1d5e8a' },
  kDark = { nothing: '#1a2027', unseen: '#4c5760', limit: '#214663', hatch: '#7fc0ee' };
/** Limits of joints, where each has a colour, and what is neither a body nor a limit. */
export const kLimits = ['#4fb2ea', '#1d5e8a', '#a7d7f9', '#486fcf'],
  kOthers = ['#cb79b9', '#8b8991'];
export const SOLVED = kKnown.found,
  FAILED = kObjects[0];

/** Bodies in three dimensions, before they are lit. */
export const kBodies = {
  robot: '#f2a92e',
  'robot 2': '#5a189a', // the second of two arms
  tool: '#5a6470',
  scene: '#8db0d8',
  fixed: '#c1c7d2', // what stands still of the robot
  near: '#d47caf', // what comes nearest to something, of the robot
  'near scene': '#c49ea7',
  hit: '#d12120', // what is too near, of the robot
  'hit scene': '#d66855',
  start: '#0573b0', // ghosts
  end: '#1aa17a',
};

/** Lines among the bodies: the tool's way between strokes, and what is nearest, or ends a path. */
export const kLines = { moves: '#8c6eff', nearest: '#a02d41' };

/** From little to much: after cividis, told apart by all kinds of colour vision. */
export const kRamp = ['#002d6e', '#5a606e', '#8f8b78', '#cbba69', '#fde737'];
/** Red, green and blue of a share of the ramp, 0 to 1 each. */
export function ramp(share) {
  const at = Math.min(0.9999, Math.max(0, share)) * (kRamp.length - 1),
    k = Math.floor(at),
    [low, high] = [kRamp[k], kRamp[k + 1]].map(parts);
  return low.map((v, c) => v + (at - k) * (high[c] - v));
}
/** A share of the ramp as "#rrggbb". */
export const rampColour = (share) =>
  `#${ramp(share)
    .map((v) =>
      Math.round(255 * v)
        .toString(16)
        .padStart(2, '0'),
    )
    .join('')}`;
/** Red, green and blue of "#rrggbb", 0 to 1 each. */
export const parts = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);

function luminance(hex) {
  const [r, g, b] = parts(hex).map((v) =>
    v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4,
  );
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}
/** Contrast of two colours, of 1 to 21. */
export function contrast(one, other) {
  const [a, b] = [luminance(one), luminance(other)];
  return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
}
const kEnough = 3;
/**
 * The colour of the line between two areas: of enough contrast with both. Null where they need
 * none, since their own contrast is enough.
 */
export function lineBetween(one, other) {
  if (contrast(one, other) >= kEnough) return null;
  return ['#5b6673', '#000000', '#ffffff'].find(
    (line) => Math.min(contrast(line, one), contrast(line, other)) >= kEnough,
  );
}
