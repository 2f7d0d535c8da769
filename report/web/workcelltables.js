// SPDX-License-Identifier: BSD-3-Clause
// A workcell in words and numbers.
import { $, number, table } from './page.js';
import { kNear } from './readout.js';
import { contactWords, heldWords, separator, warn, words } from './summary.js';

/**
 * The answer in one line, whose parts lead to the rows that they are about, and warnings. go: shows
 * a row; showCut: where the paths of an arm end.
 */
export function verdict({ answer, result, arms }, pair, go, showCut) {
  const host = $('verdict'),
    found = result.cost !== null;
  const say = (text, action, near = false) => {
    if (host.childNodes.length) host.append(separator());
    const part = document.createElement(action ? 'button' : 'span');
    part.textContent = text;
    if (action) {
      part.title = 'Go there';
      part.addEventListener('click', action);
      part.classList.toggle('near', near);
    } else part.className = 'part';
    host.append(part);
  };
  host.classList.add(found ? 'solved' : 'failed');
  if (found) sayFound(result, arms, say, go);
  else {
    const [first] = answer.split('\n');
    say(`${first[0].toUpperCase()}${first.slice(1)}.`);
    const { conflict } = result;
    if (conflict && pair.conflict)
      say(
        `the cheapest paths meet at s ${conflict.s[0].toFixed(3)} of ${arms[0].name} and ` +
          `s ${conflict.s[1].toFixed(3)} of ${arms[1].name}` +
          `${conflict.on_motion ? ', on the way on' : ''}: ${conflict.bodies.join(' – ')}`,
        () => go(pair.conflict.row),
      );
    arms.forEach((arm, k) => {
      if (!arm.answer) return;
      // As the terminal has it: the next line may say what else stands in the way.
      const [line, second] = arm.answer.split('\n');
      say(`${arm.name}: ${line}.`, arm.cut ? () => showCut(k) : undefined);
      if (/^ {2}(without|no single)/.test(second ?? '')) say(second.trim());
    });
  }
  const { motion } = result;
  const warnings = new Set([
    ...result.warnings,
    ...result.arms.flatMap((arm) => arm.warnings),
    ...(motion?.warnings ?? []),
    ...(motion?.arms ?? []).flatMap((arm) => arm.warnings.map((one) => `${arm.name}: ${one}`)),
  ]);
  warn(host, { warnings: [...warnings] });
}

/** What a plan costs and keeps. */
function sayFound(result, arms, say, go) {
  const alone = result.arms.reduce((sum, { least_cost }) => sum + least_cost, 0),
    solved = result.status === 'solved',
    found = costOfNodes(result),
    before = result.refinement ? 'before refining ' : '';
  say(
    `${solved ? 'Solved' : 'Stopped'}: two arms, ${arms[0].rows.length} rows, cost ` +
      `${number(result.cost)}: ${before}` +
      (result.decided_by === 'arms alone'
        ? 'that of both arms alone, which do not meet'
        : `${number(100 * (found / alone - 1), 2)} % more than both arms alone, which ` +
          'would meet') +
      (solved || !(result.bound > 0)
        ? ''
        : `, at most ${number(100 * (result.cost / result.bound - 1), 2)} % from the best`),
  );
  const { motion, between_arms: near } = result;
  if (motion?.executable)
    say(
      `motion ${number(motion.duration)} s at ` +
        `${number(1e3 * Math.max(...motion.arms.map(({ speed }) => speed)))} mm/s`,
    );
  else if (motion)
    say(`not executable: ${motion.arm} at s ${number(motion.at_s)}: ${motion.reason}`);
  if (near)
    say(
      `arms nearest to each other ${number(near.clearance_mm, 3)} mm (asked ` +
        `${number(near.clearance_mm - near.margin_mm)}): ${near.bodies.join(' – ')} at row ` +
        near.row,
      () => go(near.row),
    );
  result.arms.forEach((arm, k) => {
    const { name, summary, deepest_contact: contact, deepest_contact_status: looked } = arm;
    const rowAt = (s) =>
      arms[k].rows.reduce(
        (best, row, i) => (Math.abs(row.s - s) < Math.abs(arms[k].rows[best].s - s) ? i : best),
        0,
      );
    const { clearance, joint_limit: limit } = summary ?? {};
    if (clearance)
      say(
        `${name}: least clearance ${number(1e3 * clearance.value, 3)} mm (asked ` +
          `${number(1e3 * clearance.asked)}): ${clearance.bodies.join(' – ')} at s ` +
          clearance.s.toFixed(3),
        () => go(rowAt(clearance.s)),
      );
    if (looked === 'not_measured') say(`${name}: depth of contact not measured`);
    if (contact) say(`${contactWords(contact)} at row ${contact.row}`, () => go(contact.row));
    if (limit)
      say(
        `${limit.joint} ${number(limit.margin_deg, 2)}° from its limit at s ` + limit.s.toFixed(3),
        () => go(rowAt(limit.s)),
        limit.margin_deg < kNear,
      );
  });
  const held = new Map(result.arms.flatMap((arm) => arm.held).map((one) => [one.joint, one]));
  if (held.size) say(`held: ${heldWords([...held.values()])}`);
}

/** What both paths of the lattices cost, before they were refined. */
const costOfNodes = ({ arms }) => arms.reduce((sum, { lattice }) => sum + lattice.cost, 0);

const millimetres = (value) => (value === undefined ? null : number(1e3 * value));
const kColumns = [
  ['arm', ({ name }) => name],
  ['path', ({ path, least_cost }) => path ?? (least_cost === null ? 'none' : 'by itself')],
  ['cost', ({ cost }) => number(cost, 5)],
  ['before refining', ({ before }) => number(before, 5)],
  ['least cost by itself', ({ least_cost }) => number(least_cost, 5)],
  [
    'dearer for the other',
    ({ found, least_cost }) =>
      found === null || !least_cost ? null : `${number(100 * (found / least_cost - 1), 2)} %`,
  ],
  ['clearance, mm', ({ summary }) => millimetres(summary?.clearance?.value)],
  ['from a limit', ({ summary }) => limitWords(summary?.joint_limit)],
  ['tool off its path, mm', ({ summary }) => number(summary?.tool_path_error?.max_mm, 3)],
  ['tool speed at most, m/s', ({ summary }) => number(summary?.top_tool_speed?.speed, 3)],
];
const limitWords = (limit) => (limit ? `${number(limit.margin_deg, 3)}° (${limit.joint})` : null);

/** The table of arms; choose: called with the number of one. */
export function armTable({ result, arms }, choose) {
  const { refinement } = result,
    own = result.arms.map((arm, k) => ({
      ...arm,
      found: arm.cost === null ? null : arm.lattice.cost,
      before: refinement?.arms[k].cost_before ?? null,
    }));
  const both = {
    name: 'both',
    path: 'none',
    cost: result.cost,
    found: result.cost === null ? null : costOfNodes(result),
    before: refinement?.cost_before ?? null,
    least_cost: result.arms.some(({ least_cost }) => least_cost === null)
      ? null
      : result.arms.reduce((sum, { least_cost }) => sum + least_cost, 0),
  };
  const told = (value) => [...own, both].some((arm) => ![null, '–'].includes(value(arm))),
    columns = kColumns.filter(([name, value]) =>
      name === 'path' ? result.cost === null : told(value),
    ),
    host = $('arms');
  for (const [name] of columns) {
    const cell = document.createElement('th');
    cell.textContent = name;
    host.querySelector('thead tr').append(cell);
  }
  [...own, both].forEach((arm, k) => {
    const line = host.querySelector('tbody').insertRow();
    for (const [, value] of columns) line.insertCell().textContent = value(arm) ?? '–';
    if (!arms[k]) return;
    const { leader } = arms[k];
    line.cells[0].textContent +=
      leader !== null
        ? `, on the tool of ${arms[leader].name}`
        : arms.some((other) => other.leader === k)
          ? ', leads'
          : '';
    line.tabIndex = 0;
    line.title = 'makes it the arm that the arrows turn';
    line.addEventListener('click', () => choose(k));
    line.addEventListener('keydown', (event) => event.key === 'Enter' && choose(k));
  });
}

/** The answer where there is no plan, how it was found, work and times. */
export function workcellSummary({ answer, result, arms }) {
  if (result.cost === null) $('answer').textContent = answer.trimEnd();
  const add = (caption, entries) => entries.length && table($('tables'), caption, entries),
    { rounds, pops, node_pairs, move_pairs } = result.counters;
  add('Search', [
    ['decided by', result.decided_by],
    ...(result.bound === null ? [] : [['no pair costs less than', number(result.bound, 6)]]),
    ['regions of conflict', number(rounds, 9)],
    ['pairs of nodes taken', number(pops, 9)],
    ['pairs of nodes asked about', number(node_pairs, 9)],
    ['pairs of motions asked about', number(move_pairs, 9)],
    ['planner', result.planner],
    ['threads', String(result.threads)],
  ]);
  // Workcells have stages of their own in place of these two.
  const { prepare, plan, stages, ...rest } = result.time_ms;
  add('Times, ms', [...words(rest), ...words(stages)]);
  const { refinement, motion } = result;
  if (motion) {
    const { arms, ...both } = motion;
    add('Motion', words(both));
    arms?.forEach(({ name, ...arm }) => add(`Motion of ${name}`, words(arm)));
  }
  refinement?.arms.forEach(({ name, ...arm }) => add(`Refinement of ${name}`, words(arm)));
  result.arms.forEach(({ name, counters, lattice }, k) => {
    add(`Counters of ${name}`, words(counters));
    add(`Lattice of ${name}`, words(lattice));
    add(`Settings of ${name}`, words(arms[k].settings));
  });
}
