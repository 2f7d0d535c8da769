// SPDX-License-Identifier: BSD-3-Clause
// A job in words and numbers.
import { number } from './page.js';
import { rowAt } from './poses.js';
import { strokeName } from './strokes.js';
import { capital, clearanceWords, plannerOf, timesOf, words } from './summary.js';

const kMostCauses = 3; // of strokes without a path that the first line names

export const kTexts = {
  kind: 'job',
  slider: 'Position in the job',
  along: ([stroke], k) => `Along ${strokeName(stroke, k)}`,
  maps: 'the map',
  keys:
    'n and p go to the next and the previous part, ' +
    '↑ ↓ turn the arm while the tool stands still (self-motion)',
  address: '#part=2 opens at the second part',
};

/** The answer in one line, as tellVerdict() takes it, with what stops strokes without a path. */
export function verdict({ answer, result }, { paths }) {
  const parts = [{ text: capital(answer.split('\n')[0]) }];
  const without = paths
    .map((path, k) => ({ path, k, diagnosis: path.result?.diagnosis }))
    .filter(({ diagnosis }) => diagnosis);
  for (const { path, k, diagnosis } of without.slice(0, kMostCauses)) {
    const s = diagnosis.at_s ?? path.cut?.s ?? null;
    parts.push({
      text:
        `${strokeName(path, k)}: ${diagnosis.reason}` + (s === null ? '' : ` at s ${s.toFixed(3)}`),
      ends: k,
    });
  }
  if (without.length > kMostCauses)
    parts.push({ text: `${without.length - kMostCauses} strokes more` });
  const [near] = paths
    .map((path, k) => ({ path, k, clearance: path.result?.summary?.clearance }))
    .filter(({ clearance }) => result.cost !== null && clearance)
    .sort((a, b) => a.clearance.value - b.clearance.value);
  if (near) {
    const { path, k, clearance } = near;
    parts.push({
      text:
        `${clearanceWords(clearance)} on ${strokeName(path, k)} ` +
        `at s ${clearance.s.toFixed(3)}`,
      path: k,
      row: rowAt(path.rows, clearance.s),
    });
  }
  return parts;
}

const clearanceOf = (run) => (run?.summary?.clearance ? 1e3 * run.summary.clearance.value : null);
const kColumns = [
  ['#', ({ k }) => String(k + 1)],
  ['stroke', ({ name }) => name],
  ['backwards', ({ reversed }) => (reversed ? 'yes' : 'no')],
  ['path', ({ run }) => run && (run.status === 'solved' ? 'yes' : 'none')],
  ['time, s', ({ part }) => part && number(part.to - part.from)],
  ['cost', ({ run }) => number(run?.cost, 5)],
  ['least cost by itself', ({ run }) => number(run?.least_cost, 5)],
  ['clearance, mm', ({ run }) => number(clearanceOf(run))],
  ['tool off its path, mm', ({ run }) => number(run?.summary?.tool_path_error?.max_mm, 3)],
];
/** The list of strokes, as fillList() takes it. */
export const list = ({ result }, { paths, parts, duration }) => ({
  title: 'Strokes',
  tip: 'shows it',
  columns: kColumns.filter(
    ([name]) =>
      (name !== 'time, s' || duration !== null) && (name !== 'path' || result.cost === null),
  ),
  lines: paths.map((path, k) => ({
    ...path,
    k,
    part: parts.find(({ stroke }) => stroke === k),
  })),
  count: paths.length,
});

/** The tables below the answer: transitions, what refining brought, work and times. */
export const tables = ({ result }, { parts, duration }) => [
  [
    'Transitions',
    parts
      .filter(({ stroke }) => stroke === null)
      .map(({ title, rows, cost, from, to }) => [
        title,
        `${rows.length > 2 ? `${rows.length - 2} corners` : 'straight'}, cost ${number(cost)}` +
          `${duration === null ? '' : `, ${number(to - from, 3)} s`}`,
      ]),
  ],
  [
    'Refinement',
    (result.refinement?.runs ?? []).map(
      ({ stroke, reversed, refined, reason, cost_before, cost }) => [
        stroke + (reversed ? ' (backwards)' : ''),
        refined
          ? `cost ${number(cost_before, 5)}, now ${number(cost, 5)}`
          : `not refined: ${reason}`,
      ],
    ),
  ],
  ['Motion', words(result.motion)],
  timesOf(result.time_ms),
  ['Counters', [...words(result.counters), ...words(result.transition_counters)]],
  ['Settings', plannerOf(result)],
];
