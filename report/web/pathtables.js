// SPDX-License-Identifier: BSD-3-Clause
// The plan of one path in words and numbers.
import { number } from './page.js';
import { rowAt } from './poses.js';
import { firstWords, heldParts, leastAlong, plannerOf, timesOf, words } from './summary.js';

export const kTexts = {
  kind: 'path',
  slider: 'Position along the path',
  along: () => 'Along the path',
  maps: 'the map',
  keys: '↑ ↓ turn the arm while the tool stands still (self-motion)',
  address: '#s=0.34 opens there',
};

/** The answer in one line, as tellVerdict() takes it. */
export function verdict({ answer, result, map, rows }, { paths: [path] }) {
  const parts = [],
    say = (text, s, off) =>
      parts.push(
        (s ?? null) === null
          ? { text }
          : { text: `${text} at s ${s.toFixed(3)}`, row: rowAt(rows, s, off) },
      );
  if (result.status !== 'solved') {
    const helps = result.advice?.filter(({ outcome }) => outcome === 'solved') ?? [],
      { unreachable } = result.diagnosis ?? {};
    if (unreachable)
      say(
        'no joints within their limits reach ' +
          (unreachable.waypoint === null
            ? `layer ${unreachable.layer}`
            : `waypoint ${unreachable.waypoint}`),
        unreachable.s,
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
    return [...firstWords(answer), ...parts];
  }
  const { tool_path_error: error, top_tool_speed: speed } = result.summary ?? {};
  if (error)
    say(
      `tool ${number(error.max_mm, 2)} mm off` +
        ((error.allowed_mm ?? null) === null ? '' : ` (allowed ${number(error.allowed_mm)})`),
      error.s,
      ({ error_mm }) => -error_mm,
    );
  if (speed)
    say(`tool up to ${number(speed.speed, 3)} m/s (${speed.joint})`, speed.s, (_, k) => -k);
  return [
    { text: `Solved: ${map.layers} layers, cost ${number(result.cost)}` },
    ...leastAlong(path),
    ...parts,
    ...heldParts(result.held ?? []),
  ];
}

/** The tables below the answer. */
export function tables({ result, settings }) {
  const empty = result.diagnosis?.empty_layers ?? [],
    kEmpty = 20;
  // Each was planned: what it says of itself is what came out.
  const cameTo = ({ outcome, cost, reached_s }) =>
    ({
      solved: `solved, cost ${number(cost)}`,
      further: `not enough: paths to s = ${number(reached_s)} m`,
      no_help: 'no help',
      unknown: 'not tried in the time',
    })[outcome];
  const layers = ({ layers: [first, last], s }) =>
    first === last
      ? `layer ${first}, s = ${number(s[0])} m`
      : `layers ${first} to ${last}, s = ${number(s[0])} to ${number(s[1])} m`;
  return [
    ['What would help', (result.advice ?? []).map((one) => [one.words, cameTo(one)])],
    ['Removed past the furthest layer', words(result.diagnosis?.removed)],
    [
      'Empty layers',
      [
        ...empty.slice(0, kEmpty).map((one) => [layers(one), one.reason]),
        ...(empty.length > kEmpty ? [['more', `${empty.length - kEmpty}`]] : []),
      ],
    ],
    ['Refinement', words(result.refinement)],
    ['Motion', words(result.motion)],
    timesOf(result.time_ms),
    ['Counters', words(result.counters)],
    ['Lattice', words(result.lattice)],
    ['Settings', [...words(settings), ...plannerOf(result)]],
  ];
}
