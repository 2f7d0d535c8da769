// SPDX-License-Identifier: BSD-3-Clause
// An answer in words and numbers: its first line, warnings, the list of what it consists of, and
// what is told alike of all answers.
import { $, number, table } from './page.js';
import { rowAt } from './poses.js';
import { kNear } from './readout.js';

/**
 * The answer in one line. parts: { text, near, and where it leads: a row (of `path`, where several
 * are shown one by one), or ends: the number of what has no path }; go: called with a part.
 */
export function tellVerdict(parts, found, go) {
  const host = $('verdict');
  host.classList.add(found ? 'solved' : 'failed');
  parts.forEach((part, k) => {
    const leads = (part.row ?? part.ends) !== undefined,
      element = document.createElement(leads ? 'button' : 'span');
    element.textContent = part.text;
    element.className = leads ? (part.near ? 'near' : '') : 'part';
    if (leads) {
      element.title = 'Go there';
      element.addEventListener('click', () => go(part));
    }
    if (k) host.append(separator());
    host.append(element);
  });
}
/** What stands between the parts of an answer that is one line. */
const separator = () =>
  Object.assign(document.createElement('span'), { className: 'separator', textContent: ' · ' });

export const capital = (text) => text[0].toUpperCase() + text.slice(1);
/**
 * How an answer begins that found nothing, as the terminal has it: its first line is the verdict,
 * the next may say what else stands in the way. of: one of several arms, or ''.
 */
export function firstWords(answer, of = '') {
  const [first, second] = answer.split('\n');
  return [
    { text: `${of ? `${of}: ${first}` : capital(first)}.` },
    ...(/^ {2}(without|no single)/.test(second ?? '') ? [{ text: second.trim() }] : []),
  ];
}
export const clearanceWords = ({ value, asked, bodies }) =>
  `least clearance ${number(1e3 * value, 3)} mm (asked ${number(1e3 * asked)}): ` +
  bodies.join(' – ');
/** What comes nearest to a bound along the rows of a path, as parts of the answer. */
export function leastAlong({ rows, chain, result, label }) {
  const { clearance, joint_limit: turn, slide_limit: slide } = result.summary ?? {},
    contact = result.deepest_contact,
    parts = [],
    of = label && `${label}: `;
  const say = (text, s, off, near = false) =>
    parts.push({ text: `${text} at s ${s.toFixed(3)}`, row: rowAt(rows, s, off), near });
  if (clearance)
    say(of + clearanceWords(clearance), clearance.s, (_, k) => k !== result.min_margin?.row);
  if (result.min_clearance_status === 'not_measured')
    parts.push({ text: `${of}clearance not measured` });
  if (result.deepest_contact_status === 'not_measured')
    parts.push({ text: `${of}depth of contact not measured` });
  if (contact) say(of + contactWords(contact), rows[contact.row].s, (_, k) => k !== contact.row);
  for (const [limit, room, unit] of [
    [turn, turn?.margin_deg, '°'],
    [slide, slide?.margin_mm, ' mm'],
  ]) {
    if (!limit) continue;
    const at = chain.joints.findIndex(({ name }) => name === limit.joint),
      { lower, upper } = chain.joints[at];
    say(
      `${limit.joint} ${number(room, 2)}${unit} from its limit`,
      limit.s,
      ({ q }) => Math.min(q[at] - lower, upper - q[at]),
      room < kNear,
    );
  }
  return parts;
}
/** How deep two bodies may touch and do. */
const contactWords = ({ depth, at_most, allowed, bodies }) =>
  `contact ${at_most === null ? 'at least ' : ''}${number(1e3 * depth, 3)} mm deep` +
  `${allowed === null ? '' : ` (allowed ${number(1e3 * allowed)})`}: ${bodies.join(' – ')}`;
/** The joints that are held, and where, as parts of the answer: one, or none. */
export const heldParts = (held) =>
  held.length
    ? [
        {
          text: `held: ${held
            .map(({ joint, position, unit }) => `${joint} at ${number(position)} ${unit}`)
            .join(', ')}`,
        },
      ]
    : [];

const kOpen = 2; // warnings; more are folded
/** The warnings of the answer, of its arms and of its motion, below its first line. */
export function warn({ warnings = [], arms = [], motion }) {
  const all = new Set([
    ...warnings,
    ...arms.flatMap((arm) => arm.warnings),
    ...(motion?.warnings ?? []),
    ...(motion?.arms ?? []).flatMap((arm) => arm.warnings.map((one) => `${arm.name}: ${one}`)),
  ]);
  // What is said of the job need not be said of each stroke.
  const again = (text) => [...all].some((other) => other !== text && text.endsWith(`: ${other}`));
  const lines = [...all]
    .filter((warning) => !again(warning))
    .map((warning) =>
      Object.assign(document.createElement('p'), { className: 'warning', textContent: warning }),
    );
  if (lines.length <= kOpen) return $('verdict').after(...lines);
  const fold = Object.assign(document.createElement('details'), { className: 'warnings' }),
    title = document.createElement('summary');
  title.textContent = `${lines.length} warnings`;
  fold.append(title, ...lines);
  $('verdict').after(fold);
}

/**
 * The list of strokes or arms. columns: [name, value of a line]; lines: those of which a number is
 * less than `count` lead somewhere, as `tip` says; pick: called with the number. Returns the lines'
 * elements.
 */
export function fillList({ title, columns, lines, count, tip }, pick) {
  const [head, body] = ['thead tr', 'tbody'].map((part) => $('list').querySelector(part));
  $('list').querySelector('h2').textContent = title;
  for (const [name] of columns)
    head.append(Object.assign(document.createElement('th'), { textContent: name }));
  return lines.map((one, k) => {
    const line = body.insertRow();
    for (const [, value] of columns) line.insertCell().textContent = value(one) ?? '–';
    if (k < count) {
      Object.assign(line, { tabIndex: 0, title: tip });
      line.addEventListener('click', () => pick(k));
      line.addEventListener('keydown', (event) => event.key === 'Enter' && pick(k));
    }
    return line;
  });
}

/** Tables below the answer. tables: [caption, [name, value] of each line]; omitted if empty. */
export function addTables(tables) {
  for (const [caption, entries] of tables) if (entries.length) table($('tables'), caption, entries);
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
/** The table of times, and the lines of another that say what planned. */
export const timesOf = ({ stages, ...all }) => ['Times, ms', [...words(all), ...words(stages)]];
export const plannerOf = ({ planner, threads }) => [
  ['planner', planner],
  ['threads', String(threads)],
];
