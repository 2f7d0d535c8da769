// SPDX-License-Identifier: BSD-3-Clause
// A workcell in words and numbers.
import { number } from './page.js';
import { firstWords, heldParts, leastAlong, plannerOf, timesOf, words } from './summary.js';

export const kTexts = {
  kind: 'workcell',
  slider: 'Position along both paths',
  along: () => 'Along the paths',
  maps: 'a map',
  keys: '↑ ↓ turn one arm while its tool stands still (self-motion), a chooses which arm',
  address: '#row=12 opens there',
};

/** The answer in one line, as tellVerdict() takes it. */
export function verdict({ answer, result }, { paths, conflict }) {
  if (result.cost !== null) return found(result, paths);
  const [first] = firstWords(answer),
    [one, other] = paths,
    { s, bodies, on_motion } = result.conflict ?? {};
  return [
    first,
    ...(conflict
      ? [
          {
            text:
              `the cheapest paths meet at s ${s[0].toFixed(3)} of ${one.name} and ` +
              `s ${s[1].toFixed(3)} of ${other.name}${on_motion ? ', on the way on' : ''}: ` +
              bodies.join(' – '),
            row: conflict.row,
          },
        ]
      : []),
    ...paths.flatMap((arm, k) => {
      if (!arm.answer) return [];
      const [{ text }, ...second] = firstWords(arm.answer, arm.name);
      return [{ text, ...(arm.cut && { ends: k }) }, ...second];
    }),
  ];
}

/** What a plan costs and keeps. */
function found(result, paths) {
  const alone = result.arms.reduce((sum, { least_cost }) => sum + least_cost, 0),
    solved = result.status === 'solved',
    found = costOfNodes(result),
    before = result.refinement ? 'before refining ' : '';
  const parts = [],
    say = (text, row) => parts.push({ text, row });
  say(
    `${solved ? 'Solved' : 'Stopped'}: two arms, ${paths[0].rows.length} rows, cost ` +
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
      near.row,
    );
  return [
    ...parts,
    ...paths.flatMap(leastAlong),
    ...heldParts([
      ...new Map(result.arms.flatMap(({ held }) => held).map((one) => [one.joint, one])).values(),
    ]),
  ];
}

/** What both paths of the lattices cost, before they were refined. */
const costOfNodes = ({ arms }) => arms.reduce((sum, { lattice }) => sum + lattice.cost, 0);

const millimetres = (value) => (value === undefined ? null : number(1e3 * value));
const kColumns = [
  ['arm', ({ name, leads = '' }) => name + leads],
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

/** The list of arms, as fillList() takes it. */
export function list({ result }, { paths }) {
  const { refinement, arms } = result;
  const leads = (k) =>
    paths[k].leader !== null
      ? `, on the tool of ${paths[paths[k].leader].name}`
      : paths.some(({ leader }) => leader === k)
        ? ', leads'
        : '';
  const own = arms.map((arm, k) => ({
    ...arm,
    leads: leads(k),
    found: arm.cost === null ? null : arm.lattice.cost,
    before: refinement?.arms[k].cost_before ?? null,
  }));
  const both = {
    name: 'both',
    path: 'none',
    cost: result.cost,
    found: result.cost === null ? null : costOfNodes(result),
    before: refinement?.cost_before ?? null,
    least_cost: arms.some(({ least_cost }) => least_cost === null)
      ? null
      : arms.reduce((sum, { least_cost }) => sum + least_cost, 0),
  };
  const lines = [...own, both],
    told = (value) => lines.some((arm) => ![null, '–'].includes(value(arm)));
  return {
    title: 'Arms',
    tip: 'makes it the arm that the arrows turn',
    columns: kColumns.filter(([name, value]) =>
      name === 'path' ? result.cost === null : told(value),
    ),
    lines,
    count: own.length,
  };
}

/** The tables below the answer: how it was found, work and times. */
export function tables({ result }, { paths }) {
  const { rounds, pops, node_pairs, move_pairs } = result.counters,
    { arms: moved = [], ...motion } = result.motion ?? {},
    // Workcells have stages of their own in place of these two.
    { prepare, plan, ...times } = result.time_ms;
  return [
    [
      'Search',
      [
        ['decided by', result.decided_by],
        ...(result.bound === null ? [] : [['no pair costs less than', number(result.bound, 6)]]),
        ['regions of conflict', number(rounds, 9)],
        ['pairs of nodes taken', number(pops, 9)],
        ['pairs of nodes asked about', number(node_pairs, 9)],
        ['pairs of motions asked about', number(move_pairs, 9)],
        ...plannerOf(result),
      ],
    ],
    timesOf(times),
    ['Motion', words(motion)],
    ...moved.map(({ name, ...arm }) => [`Motion of ${name}`, words(arm)]),
    ...(result.refinement?.arms ?? []).map(({ name, ...arm }) => [
      `Refinement of ${name}`,
      words(arm),
    ]),
    ...result.arms.flatMap(({ name, counters, lattice }, k) => [
      [`Counters of ${name}`, words(counters)],
      [`Lattice of ${name}`, words(lattice)],
      [`Settings of ${name}`, words(paths[k].settings)],
    ]),
  ];
}
