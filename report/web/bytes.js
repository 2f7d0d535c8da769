// SPDX-License-Identifier: BSD-3-Clause
/** The buffer that a base64 text stands for. */
export function decoded(text) {
  const raw = atob(text),
    result = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; ++k) result[k] = raw.charCodeAt(k);
  return result.buffer;
}

/** The buffer of a binary value of the page's data: [number of the first byte, how many]. */
export function bytes([first, count]) {
  return globalThis.swivelPage.bytes.slice(first, first + count).buffer;
}

/** The numbers of a binary value of varints (src/page/packed.hpp). */
export function varints(place) {
  const raw = new Uint8Array(bytes(place)),
    result = [];
  for (let k = 0; k < raw.length;) {
    let value = 0,
      scale = 1;
    for (; raw[k] & 128; ++k, scale *= 128) value += (raw[k] & 127) * scale;
    result.push(value + raw[k++] * scale);
  }
  return result;
}
/** The number that a varint stands for whose lowest bit is the sign. */
const signed = (value) => (value % 2 ? -(value + 1) / 2 : value / 2);

/**
 * Samples of `width` values each that varints stand for: one value of all samples after the other,
 * as what each adds to the line through the two samples before.
 */
export function samples(place, width) {
  const bends = varints(place),
    count = bends.length / Math.max(1, width),
    result = new Int32Array(bends.length);
  for (let k = 0, from = 0; k < width; ++k, from += count)
    for (let n = 0, value = 0, step = 0; n < count; ++n) {
      step += signed(bends[from + n]);
      value += step;
      result[n * width + k] = value;
    }
  return result;
}

/**
 * Values of poses, `width` of each, that varints stand for (encode_poses() of src/page/packed.hpp):
 * what each value adds to that which the cells below and to the left foretell. cells: { rows: of a
 * panel, column: how many cells all panels have in a column, pose: of each cell, or -1 }.
 */
export function poseValues(place, width, { rows, column, pose }) {
  const added = varints(place),
    count = added.length / width,
    result = new Int16Array(added.length);
  for (let k = 0, from = 0; k < width; ++k, from += count) {
    const value = (at) => result[at * width + k];
    for (let cell = 0, next = 0; cell < pose.length; ++cell) {
      if (pose[cell] !== next) continue;
      const row = cell % rows,
        below = row < 1 ? -1 : pose[cell - 1],
        further = row < 2 ? -1 : pose[cell - 2],
        left = cell < column ? -1 : pose[cell - column],
        leftBelow = row < 1 || cell < column ? -1 : pose[cell - column - 1],
        leftFurther = row < 2 || cell < column ? -1 : pose[cell - column - 2],
        hasSlope = below >= 0 && left >= 0 && leftBelow >= 0,
        goesOn = below >= 0 && further >= 0;
      let told = next > 0 ? value(next - 1) : 0;
      if (hasSlope && goesOn && leftFurther >= 0)
        told =
          2 * value(below) -
          value(further) +
          value(left) -
          2 * value(leftBelow) +
          value(leftFurther);
      else if (hasSlope) told = value(below) + value(left) - value(leftBelow);
      else if (goesOn) told = 2 * value(below) - value(further);
      else if (left >= 0 || below >= 0) told = value(left >= 0 ? left : below);
      result[next * width + k] = told + signed(added[from + next]);
      ++next;
    }
  }
  return result;
}

/** Triangles of a mesh: { points: x, y, z of each, m; corners: numbers of points }. */
export function triangles({ grain, points, corners }) {
  const steps = varints(points),
    at = [0, 0, 0];
  const places = Float32Array.from(steps, (step, k) => {
    at[k % 3] += signed(step);
    return grain * at[k % 3];
  });
  let next = 0;
  const numbers = Uint32Array.from(varints(corners), (below) => {
    if (below === 0) ++next;
    return below === 0 ? next - 1 : next - below;
  });
  return { points: places, corners: numbers };
}
