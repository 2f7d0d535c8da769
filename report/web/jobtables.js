// SPDX-License-Identifier: BSD-3-Clause
// A job in words and numbers.
import { strokeName } from './joblist.js';
import { $, number, table } from './page.js';
import { separator, warn, words } from './summary.js';

const kMostCauses = 3; // of strokes without a path that the first line names

/**
 * The answer in one line, with what stops strokes that have no path, and warnings. go: shows a
 * stroke, its number, at s, m.
 */
export function verdict({ answer, result, strokes }, go) {
  const host = $('verdict'),
    [first] = answer.split('\n'),
    found = result.cost !== null;
  host.classList.add(found ? 'solved' : 'failed');
  host.append(
    Object.assign(document.createElement('span'), {
      className: 'part',
      textContent: first[0].toUpperCase() + first.slice(1),
    }),
  );
  const without = strokes
    .map(({ run, cut }, k) => ({ k, diagnosis: run?.diagnosis, cut }))
    .filter(({ diagnosis }) => diagnosis);
  for (const { k, diagnosis, cut } of without.slice(0, kMostCauses)) {
    const button = document.createElement('button'),
      at = diagnosis.at_s ?? cut?.s;
    button.textContent =
      `${strokeName(strokes[k], k)}: ${diagnosis.reason}` +
      (at === null || at === undefined ? '' : ` at s ${at.toFixed(3)}`);
    button.title = 'Go there';
    button.addEventListener('click', () => go(k, at ?? 0));
    host.append(separator(), button);
  }
  if (without.length > kMostCauses)
    host.append(separator(), `${without.length - kMostCauses} strokes more`);
  const near = strokes
    .map(({ run }, k) => ({ k, clearance: run?.summary?.clearance }))
    .filter(({ clearance }) => found && clearance)
    .sort((a, b) => a.clearance.value - b.clearance.value)[0];
  if (near) {
    const button = document.createElement('button'),
      { value, asked, bodies, s } = near.clearance;
    button.textContent =
      `least clearance ${number(1e3 * value, 3)} mm (asked ${number(1e3 * asked)}): ` +
      `${bodies.join(' – ')} on ${strokeName(strokes[near.k], near.k)} at s ${s.toFixed(3)}`;
    button.title = 'Go there';
    button.addEventListener('click', () => go(near.k, s));
    host.append(separator(), button);
  }
  warn(host, result);
}

const kColumns = [
  ['#', (_, k) => String(k + 1)],
  ['stroke', ({ name }) => name],
  ['backwards', ({ reversed }) => (reversed ? 'yes' : 'no')],
  ['path', ({ run }) => run && (run.status === 'solved' ? 'yes' : 'none')],
  ['time, s', (_, __, part) => part && number(part.to - part.from)],
  ['cost', ({ run }) => number(run?.cost, 5)],
  ['least cost by itself', ({ run }) => number(run?.least_cost, 5)],
  ['clearance, mm', ({ run }) => number(clearanceOf(run))],
  ['tool off its path, mm', ({ run }) => number(run?.summary?.tool_path_error?.max_mm, 3)],
];
const clearanceOf = (run) => (run?.summary?.clearance ? 1e3 * run.summary.clearance.value : null);

/** The table of strokes; pick: called with the number of one. Returns its lines. */
export function strokeTable(list, failed, pick) {
  const columns = kColumns.filter(
    ([name]) => (name !== 'time, s' || list.timed) && (name !== 'path' || failed),
  );
  const host = $('strokes');
  for (const [name] of columns) {
    const cell = document.createElement('th');
    cell.textContent = name;
    host.querySelector('thead tr').append(cell);
  }
  const lines = list.strokes.map((stroke, k) => {
    const line = document.createElement('tr'),
      part = list.parts.find((one) => one.stroke === k);
    line.tabIndex = 0;
    line.title = 'shows it';
    for (const [, value] of columns) line.insertCell().textContent = value(stroke, k, part) ?? '–';
    line.addEventListener('click', () => pick(k));
    line.addEventListener('keydown', (event) => event.key === 'Enter' && pick(k));
    return line;
  });
  host.querySelector('tbody').append(...lines);
  return lines;
}

/** The rest of the answer, transitions, work and times. */
export function jobSummary({ answer, result }, list) {
  $('answer').textContent = answer.trimEnd();
  const add = (caption, entries) => entries.length && table($('tables'), caption, entries);
  add(
    'Transitions',
    list.parts
      .filter(({ stroke }) => stroke === null)
      .map(({ title, rows, cost, from, to }) => [
        title,
        `${rows.length > 2 ? `${rows.length - 2} corners` : 'straight'}, cost ${number(cost)}` +
          `${list.timed ? `, ${number(to - from, 3)} s` : ''}`,
      ]),
  );
  if (result.motion) add('Motion', words(result.motion));
  add('Times, ms', [...words(result.time_ms), ...words(result.time_ms.stages)]);
  add('Counters', [...words(result.counters), ...words(result.transition_counters)]);
  add('Settings', [
    ['planner', result.planner],
    ['threads', String(result.threads)],
  ]);
}
