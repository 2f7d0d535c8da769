// SPDX-License-Identifier: BSD-3-Clause
// The jumps of a page's answer: each part of it goes to the row of which the result speaks, and
// what is read there is what the result says, to the last digit that is shown.
import assert from 'node:assert/strict';

const kDegrees = 180 / Math.PI;
/** A number as the page tells it. */
const digits = (value, count) => String(Number(value.toPrecision(count)));

/** The value above a plot along the path, as text. */
export async function plotted(page, title) {
  const heading = page
    .locator('#plots .plot h3')
    .filter({ has: page.locator('span', { hasText: new RegExp(`^${title}, `) }) });
  return heading.locator('b').textContent();
}

/** How far a joint of a row is from the nearer of its limits, rad or m. */
function room(joint, value) {
  return joint.lower === null ? Infinity : Math.min(value - joint.lower, joint.upper - value);
}

/**
 * What a page's answer leads to, in its order: { key: of the result, row, says: what the part says,
 * holds: asserts what is read at that row }.
 */
function jumpsOf({ result, rows, chain }) {
  const { summary, trajectory } = result,
    jumps = [];
  /** Of the rows at s that of which `off` is least; the first or the last of several. */
  const rowAt = (s, off, last = false) => {
    const there = trajectory.map((_, k) => k).filter((k) => trajectory[k].s === s);
    assert.ok(there.length, `no row at s ${s}`);
    return (last ? there.reverse() : there).reduce((best, k) => (off(k) < off(best) ? k : best));
  };
  const add = (key, part, row, says, holds) =>
    part && row !== undefined && jumps.push({ key, row, says, holds });
  const {
      clearance,
      joint_limit: limit,
      slide_limit: slide,
      tool_path_error: error,
      top_tool_speed: speed,
    } = summary,
    contact = result.deepest_contact;
  add(
    'clearance',
    clearance,
    result.min_margin?.row,
    () => `least clearance ${digits(1e3 * clearance.value, 3)} mm`,
    async (page) => {
      const mm = 1e3 * clearance.value,
        bodies = clearance.bodies.join(' – ');
      assert.equal(
        await page.textContent('#readout .note'),
        `clearance ${digits(mm, 4)} mm: ${bodies}`,
      );
      if (rows[result.min_margin.row].nearest)
        assert.equal(await page.textContent('#gap'), `${digits(mm, 3)} mm`);
    },
  );
  add('contact', contact, contact?.row, () => `${digits(1e3 * contact.depth, 3)} mm deep`);
  for (const [key, near, margin, scale, unit] of [
    ['joint_limit', limit, limit?.margin_deg, kDegrees, '°'],
    ['slide_limit', slide, slide?.margin_mm, 1000, ' mm'],
  ]) {
    const named = chain.joints.findIndex(({ name }) => name === near?.joint),
      roomAt = (k) => room(chain.joints[named], trajectory[k].joints[named]);
    add(
      key,
      near,
      near && rowAt(near.s, roomAt),
      () => `${near.joint} ${digits(margin, 2)}${unit} from its limit`,
      async (page) => {
        assert.equal((scale * roomAt(rowAt(near.s, roomAt))).toFixed(2), margin.toFixed(2));
        const title = await page.locator('#readout .joint').nth(named).getAttribute('title'),
          told = margin.toFixed(margin < 10 ? 1 : 0);
        assert.ok(title.endsWith(`, ${told}${unit} from the nearer`), title);
      },
    );
  }
  add(
    'tool_path_error',
    (error?.s ?? null) !== null && error,
    (error?.s ?? null) !== null ? rowAt(error.s, (k) => -rows[k].error_mm) : undefined,
    () => `tool ${digits(error.max_mm, 2)} mm off`,
    async (page) =>
      assert.equal(await plotted(page, 'tool-path error'), error.max_mm.toPrecision(4)),
  );
  add(
    'top_tool_speed',
    speed,
    speed && rowAt(speed.s, () => 0, true),
    () => `tool up to ${digits(speed.speed, 3)} m/s (${speed.joint})`,
  );
  return jumps;
}

/**
 * Follows every jump of a page of one path, and returns how many there are; what is read at each is
 * what the result says. data: of the page; visit: called at each.
 */
export async function checkJumps(page, data, visit = async () => {}) {
  const { summary, trajectory } = data.result,
    jumps = summary?.solved ? jumpsOf(data) : [],
    parts = page.locator('#verdict button');
  assert.equal(await parts.count(), jumps.length);
  for (const [k, { key, row, says, holds }] of jumps.entries()) {
    const at = trajectory[row],
      what = `${data.problem}, ${key}`;
    const text = await parts.nth(k).textContent();
    assert.ok(text.includes(says()), `${what}: ${text} for ${says()}`);
    assert.ok(text.endsWith(` at s ${at.s.toFixed(3)}`), `${what}: ${text} for s ${at.s}`);
    await parts.nth(k).click();
    const [place, ...lines] = (await page.textContent('#readout')).split('\n');
    assert.equal(place.split('   ')[0], `s ${at.s.toFixed(4)} m`, what);
    for (const [j, { name, slides }] of data.chain.joints.filter(({ name }) => name).entries()) {
      const [scale, unit] = slides ? [1000, ' mm'] : [kDegrees, '°'];
      assert.equal(lines[j], `${name}  ${(at.joints[j] * scale).toFixed(2)}${unit}`, what);
    }
    await holds?.(page);
    await visit();
  }
  return jumps.length;
}
