// SPDX-License-Identifier: BSD-3-Clause
// The plan in words and numbers.
import { $, number, table } from './page.js';
import { kNear } from './readout.js';

/**
 * The answer in one line; what it names along the path are buttons that go there. jump: called with
 * s, m, and with what is least at the row that is meant, of several at that s.
 */
export function verdict(host, { result, chain, map }, jump) {
  const helps = result.advice?.filter(({ outcome }) => outcome === 'solved') ?? [];
  const {
      clearance,
      joint_limit: limit,
      tool_path_error: error,
      top_tool_speed: speed,
    } = result.summary ?? {},
    d = result.diagnosis,
    held = result.held ?? [];
  /** The joints that are held, where: named(joint) is what stands before each `at`. */
  const heldAt = (named) =>
    held
      .map(({ joint, position, unit }) => `${named(joint)} at ${number(position)} ${unit}`)
      .join(', ');
  const margin = (k, q) => Math.min(q[k] - chain.joints[k].lower, chain.joints[k].upper - q[k]);
  const say = (text, s, off, near = false) => {
    if (host.childNodes.length) host.append(' · ');
    if (s === undefined || s === null) return host.append(text);
    const button = document.createElement('button');
    button.classList.toggle('near', near);
    Object.assign(button, { textContent: `${text} at s ${s.toFixed(3)}`, title: 'Go there' });
    button.addEventListener('click', () => jump(s, off));
    host.append(button);
  };
  host.classList.add(result.status === 'solved' ? 'solved' : 'failed');
  if (result.status !== 'solved') {
    const claim =
      {
        every_resolution: 'No path at any resolution',
        exact_tool: 'No path for a tool that follows exactly',
      }[d?.holds] ?? 'No path at this resolution';
    const none = claim + (held.length ? ` with ${heldAt((joint) => `${joint} held`)}` : '');
    say(
      !d || d.reached_layer === null
        ? `${none}: the first layer has no valid node${d?.reason ? ` (${d.reason})` : ''}.`
        : `${none}: every one ends by layer ${d.reached_layer} of ${map.layers - 1} (s = ` +
            `${number(d.reached_s)} m), ` +
            `${d.cause ? `where ${d.reason} stops it` : `why is ${d.reason}`}.`,
    );
    if (d?.unreachable)
      say(
        'no joints within their limits reach ' +
          (d.unreachable.waypoint === null
            ? `layer ${d.unreachable.layer}`
            : `waypoint ${d.unreachable.waypoint}`),
        d.unreachable.s,
      );
    if (helps.length)
      say(
        'What would help: ' +
          helps[0].words +
          `${helps.length > 1 ? `, or one of ${helps.length - 1} more` : ''}`,
      );
    else
      say(
        result.advice
          ? 'Nothing that was tried helps'
          : 'What would help is planned with --advise 1',
      );
  } else {
    say(`Solved: ${map.layers} layers, cost ${number(result.cost)}`);
    if (clearance)
      say(
        `least clearance ${number(1e3 * clearance.value, 3)} mm (asked ` +
          `${number(1e3 * clearance.asked)}): ${clearance.bodies.join(' – ')}`,
        clearance.s,
        (_, k) => k !== result.min_margin.row,
      );
    const contact = result.deepest_contact;
    if (contact)
      say(
        `contact ${contact.at_most === null ? 'at least ' : ''}` +
          `${number(1e3 * contact.depth, 3)} mm deep` +
          `${contact.allowed === null ? '' : ` (allowed ${number(1e3 * contact.allowed)})`}: ` +
          `${contact.bodies.join(' – ')}`,
        result.trajectory[contact.row]?.s,
        (_, k) => k !== contact.row,
      );
    if (limit)
      say(
        `${limit.joint} ${number(limit.margin_deg, 2)}° from its limit`,
        limit.s,
        ({ q }) =>
          margin(
            chain.joints.findIndex(({ name }) => name === limit.joint),
            q,
          ),
        limit.margin_deg < kNear,
      );
    if (error)
      say(
        `tool ${number(error.max_mm, 2)} mm off` +
          (error.allowed_mm === null || error.allowed_mm === undefined
            ? ''
            : ` (allowed ${number(error.allowed_mm)})`),
        error.s,
        ({ error_mm }) => -error_mm,
      );
    if (speed)
      say(`tool up to ${number(speed.speed, 3)} m/s (${speed.joint})`, speed.s, (_, k) => -k);
    if (held.length) say(`held: ${heldAt((joint) => joint)}`);
  }
  for (const warning of result.warnings ?? []) {
    const line = document.createElement('p');
    line.className = 'warning';
    line.textContent = warning;
    host.after(line);
  }
}

export const words = (object) =>
  Object.entries(object ?? {})
    .filter(([, v]) => typeof v !== 'object')
    .map(([key, v]) => [key.replaceAll('_', ' '), typeof v === 'number' ? number(v) : String(v)]);

export function summary({ result, settings }) {
  const add = (caption, entries) => table($('tables'), caption, entries);
  const removed = result.diagnosis?.removed,
    empty = result.diagnosis?.empty_layers ?? [];
  // Each was planned: what it says of itself is what came out.
  const cameTo = ({ outcome, cost, reached_s }) =>
    ({
      solved: `solved, cost ${number(cost)}`,
      further: `not enough: paths to s = ${number(reached_s)} m`,
      no_help: 'no help',
      unknown: 'not tried in the time',
    })[outcome];
  if (result.advice?.length)
    add(
      'What would help',
      result.advice.map((one) => [one.words, cameTo(one)]),
    );
  if (removed) add('Removed past the furthest layer', words(removed));
  if (empty.length)
    add('Empty layers', [
      ...empty
        .slice(0, 20)
        .map(({ layers: [first, last], s, reason }) => [
          first === last
            ? `layer ${first}, s = ${number(s[0])} m`
            : `layers ${first} to ${last}, s = ${number(s[0])} to ${number(s[1])} m`,
          reason,
        ]),
      ...(empty.length > 20 ? [['more', `${empty.length - 20}`]] : []),
    ]);
  if (result.refinement) add('Refinement', words(result.refinement));
  if (result.motion) add('Motion', words(result.motion));
  add('Times, ms', [...words(result.time_ms), ...words(result.time_ms.stages)]);
  add('Counters', words(result.counters));
  add('Lattice', words(result.lattice));
  add('Settings', [
    ...words(settings),
    ['planner', result.planner],
    ['threads', String(result.threads)],
  ]);
}
