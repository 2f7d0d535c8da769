// SPDX-License-Identifier: BSD-3-Clause
/** The buffer that a base64 text stands for. */
export function bytes(text) {
  const raw = atob(text),
    result = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; ++k) result[k] = raw.charCodeAt(k);
  return result.buffer;
}

/** The numbers that a base64 text of varints stands for (src/page/scene_json.cpp). */
export function varints(text) {
  const raw = new Uint8Array(bytes(text)),
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
 * Samples of `width` values each that a base64 text of varints stands for: one value of all samples
 * after the other, as what each adds to the line through the two samples before. Numbers: the kind
 * of array that is returned.
 */
export function samples(text, width, Numbers = Int16Array) {
  const bends = varints(text),
    count = bends.length / Math.max(1, width),
    result = new Numbers(bends.length);
  for (let k = 0, from = 0; k < width; ++k, from += count)
    for (let n = 0, value = 0, step = 0; n < count; ++n) {
      step += signed(bends[from + n]);
      value += step;
      result[n * width + k] = value;
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
