// SPDX-License-Identifier: BSD-3-Clause
/** The buffer that a base64 text stands for. */
export function bytes(text) {
  const raw = atob(text),
    result = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; ++k) result[k] = raw.charCodeAt(k);
  return result.buffer;
}
