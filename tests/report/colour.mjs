// SPDX-License-Identifier: BSD-3-Clause
// How far colours are apart: CIEDE2000 for normal sight and for dichromats, and contrast. A colour
// is "#rrggbb".

/** Linear red, green and blue, 0 to 1 each. */
export const linear = (hex) =>
  [1, 3, 5].map((at) => {
    const v = parseInt(hex.slice(at, at + 2), 16) / 255;
    return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
  });

/**
 * What eyes without one kind of cones make of linear red, green and blue: Machado, Oliveira and
 * Fernandes 2009, severity 1.
 */
export const kSights = {
  normal: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  protanopia: [
    0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998,
  ],
  deuteranopia: [
    0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881,
  ],
  tritanopia: [
    1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.3039,
  ],
};

const times = (m, v) =>
  [0, 3, 6].map((row) => m[row] * v[0] + m[row + 1] * v[1] + m[row + 2] * v[2]);

/** CIELAB under D65. sight: one of kSights. */
export function lab(hex, sight = 'normal') {
  const rgb = times(kSights[sight], linear(hex)).map((v) => Math.min(1, Math.max(0, v)));
  const xyz = times(
    [
      0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.072175, 0.0193339, 0.119192,
      0.9503041,
    ],
    rgb,
  );
  const [x, y, z] = xyz
    .map((v, k) => v / [0.95047, 1, 1.08883][k])
    .map((v) => (v > 216 / 24389 ? Math.cbrt(v) : (841 / 108) * v + 4 / 29));
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

/** CIEDE2000 of two colours of CIELAB: Sharma, Wu and Dalal 2005. */
export function difference([l1, a1, b1], [l2, a2, b2]) {
  const degrees = Math.PI / 180,
    seventh = (c) => Math.sqrt(c ** 7 / (c ** 7 + 25 ** 7));
  const grey = 1.5 - 0.5 * seventh((Math.hypot(a1, b1) + Math.hypot(a2, b2)) / 2),
    [c1, c2] = [Math.hypot(grey * a1, b1), Math.hypot(grey * a2, b2)];
  const hue = (a, b) => (a || b ? (Math.atan2(b, a) / degrees + 360) % 360 : 0),
    [h1, h2] = [hue(grey * a1, b1), hue(grey * a2, b2)];
  let turn = c1 * c2 === 0 ? 0 : h2 - h1;
  if (Math.abs(turn) > 180) turn -= 360 * Math.sign(turn);
  let mean = h1 + h2;
  if (c1 * c2 !== 0) {
    if (Math.abs(h1 - h2) > 180) mean += mean < 360 ? 360 : -360;
    mean /= 2;
  }
  const l = (l1 + l2) / 2,
    c = (c1 + c2) / 2,
    cos = (angle) => Math.cos(angle * degrees);
  const t =
    1 -
    0.17 * cos(mean - 30) +
    0.24 * cos(2 * mean) +
    0.32 * cos(3 * mean + 6) -
    0.2 * cos(4 * mean - 63);
  const dl = (l2 - l1) / (1 + (0.015 * (l - 50) ** 2) / Math.sqrt(20 + (l - 50) ** 2)),
    dc = (c2 - c1) / (1 + 0.045 * c),
    dh = (2 * Math.sqrt(c1 * c2) * Math.sin((turn / 2) * degrees)) / (1 + 0.015 * c * t);
  const twist =
    -2 * seventh(c) * Math.sin(2 * 30 * Math.exp(-(((mean - 275) / 25) ** 2)) * degrees);
  return Math.sqrt(dl * dl + dc * dc + dh * dh + twist * dc * dh);
}

/** The least difference that any kind of sight sees. */
export const leastDifference = (one, other) =>
  Math.min(...Object.keys(kSights).map((sight) => difference(lab(one, sight), lab(other, sight))));

export function luminance(hex) {
  const [r, g, b] = linear(hex);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}
/** Contrast of WCAG 2, 1 to 21. */
export function contrast(one, other) {
  const [a, b] = [luminance(one), luminance(other)];
  return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
}
