// SPDX-License-Identifier: BSD-3-Clause
// The plan in words and numbers.
import { $, number, table } from './page.js';
import { kNear } from './readout.js';

/**
 * The answer in one line; what it names along the path are buttons that go there. jump: called with
 * s, m, and with what is least at the row that is meant, of several at that s.
 */
export function verdict(host, { answer, result, chain, map }, jump) {
  const helps = result.advice?.filter(({ outcome }) => outcome === 'solved') ?? [];
  const {
      clearance,
      joint_limit: turn,
      slide_limit: slide,
      tool_path_error: error,
      top_tool_speed: speed,
    } = result.summary ?? {},
    d = result.diagnosis,
    held = result.held ?? [];
  const margin = (k, q) => Math.min(q[k] - chain.joints[k].lower, chain.joints[k].upper - q[k]);
  const say = (text, s, off, near = false) => {
    if (host.childNodes.length) host.append(separator());
    if (s === undefined || s === null)
      return host.append(
        Object.assign(document.createElement('span'), { className: 'part', textContent: text }),
      );
    const button = document.createElement('button');
    button.classList.toggle('near', near);
    Object.assign(button, { textContent: `${text} at s ${s.toFixed(3)}`, title: 'Go there' });
    button.addEventListener('click', () => jump(s, off));
    host.append(button);
  };
  host.classList.add(result.status === 'solved' ? 'solved' : 'failed');
  if (result.status !== 'solved') {
    // As the terminal has it: its first line is the verdict, the next may say what else stands in
    // the way.
    const [first, second] = answer.split('\n');
    say(`${first[0].toUpperCase()}${first.slice(1)}.`);
    if (/^ {2}(without|no single)/.test(second ?? '')) say(second.trim());
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
    if (result.min_clearance_status === 'not_measured') say('clearance not measured');
    const contact = result.deepest_contact;
    if (result.deepest_contact_status === 'not_measured') say('depth of contact not measured');
    if (contact)
      say(contactWords(contact), result.trajectory[contact.row]?.s, (_, k) => k !== contact.row);
    for (const [limit, room, unit] of [
      [turn, turn?.margin_deg, '°'],
      [slide, slide?.margin_mm, ' mm'],
    ])
      if (limit)
        say(
          `${limit.joint} ${number(room, 2)}${unit} from its limit`,
          limit.s,
          ({ q }) =>
            margin(
              chain.joints.findIndex(({ name }) => name === limit.joint),
              q,
            ),
          room < kNear,
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
    if (held.length) say(`held: ${heldWords(held)}`);
  }
  warn(host, result);
}

/** How deep two bodies may touch and do. */
export const contactWords = ({ depth, at_most, allowed, bodies }) =>
  `contact ${at_most === null ? 'at least ' : ''}${number(1e3 * depth, 3)} mm deep` +
  `${allowed === null ? '' : ` (allowed ${number(1e3 * allowed)})`}: ${bodies.join(' – ')}`;
/** The joints that are held, and where. */
export const heldWords = (held) =>
  held.map(({ joint, position, unit }) => `${joint} at ${number(position)} ${unit}`).join(', ');

/** What stands between the parts of an answer that is one line. */
export const separator = () =>
  Object.assign(document.createElement('span'), { className: 'separator', textContent: ' · ' });

const kOpen = 2; // warnings; more are folded
/** The warnings of the answer and of its motion, below a line of the page. */
export function warn(host, result) {
  const warnings = [...(result.warnings ?? []), ...(result.motion?.warnings ?? [])];
  // What is said of the job need not be said of each stroke.
  const again = (text) => warnings.some((other) => other !== text && text.endsWith(`: ${other}`));
  const lines = warnings
    .filter((warning) => !again(warning))
    .map((warning) =>
      Object.assign(document.createElement('p'), { className: 'warning', textContent: warning }),
    );
  if (lines.length <= kOpen) return host.after(...lines);
  const fold = Object.assign(document.createElement('details'), { className: 'warnings' }),
    title = document.createElement('summary');
  title.textContent = `${lines.length} warnings`;
  fold.append(title, ...lines);
  host.after(fold);
}

/** Units of keys whose numbers have one; angles are told in degrees. */
const kUnits = {
  ds: 'm',
  dphi: '°',
  dalpha: '°',
  droll: '°',
  knot: 'm',
  joint_step: '°',
  clearance_mm: 'mm',
  duration: 's',
  ideal: 's',
  at_s: 'm',
  speed: 'm/s',
  turn_speed: '°/s',
  rate: 'Hz',
  chord: 'm',
  bend: '°/m²',
  bend_before: '°/m²',
};
/** [name, value with its unit] of the numbers, texts and switches of an object that are there. */
export const words = (object) =>
  Object.entries(object ?? {})
    .filter(([, v]) => typeof v !== 'object')
    .map(([key, v]) => {
      const unit = kUnits[key] ?? '',
        name = key.replace(/_mm$/, '').replaceAll('_', ' ');
      if (typeof v === 'boolean') return [name, v ? 'yes' : 'no'];
      if (typeof v !== 'number') return [name, v];
      const value = number(unit.startsWith('°') ? (v * 180) / Math.PI : v);
      return [name, `${value}${unit.startsWith('°') || !unit ? '' : ' '}${unit}`];
    });

export function summary({ answer, result, settings }) {
  if (result.status !== 'solved') $('answer').textContent = answer.trimEnd();
  const add = (caption, entries) => entries.length && table($('tables'), caption, entries);
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
