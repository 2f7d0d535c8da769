// SPDX-License-Identifier: BSD-3-Clause
// The plan in words and numbers.
import { $, number, table } from './page.js';

export function verdict({ result, rows, map }) {
  const d = result.diagnosis, clearances = rows.map((row) => row.clearance_mm).filter((v) => v !== undefined);
  if (result.status === 'solved')
    return `Solved: ${rows.length} layers, cost ${number(result.cost)}, tool-path error at most ${number(Math.max(...rows.map((row) => row.error_mm ?? 0)), 3)} mm`
      + (clearances.length ? `, clearance at least ${number(Math.min(...clearances), 3)} mm.` : '.');
  if (!d || d.reached_layer === null) return `No path at this resolution: the first layer has no valid node${d?.reason ? ` (${d.reason})` : ''}.`;
  return `No path at this resolution: every one ends by layer ${d.reached_layer} of ${map.layers - 1} (s = ${number(d.reached_s)} m), where ${d.reason} stops it.`;
}

const words = (object) => Object.entries(object ?? {}).filter(([, v]) => typeof v !== 'object')
  .map(([key, v]) => [key.replaceAll('_', ' '), typeof v === 'number' ? number(v) : String(v)]);

export function summary({ result, settings }) {
  const add = (caption, entries) => table($('tables'), caption, entries);
  const removed = result.diagnosis?.removed, empty = result.diagnosis?.empty_layers ?? [];
  if (removed) add('Removed past the furthest layer', words(removed));
  if (empty.length)
    add('Empty layers', [...empty.slice(0, 20).map(({ layers: [first, last], s, reason }) => [first === last ? `layer ${first}, s = ${number(s[0])} m` : `layers ${first} to ${last}, s = ${number(s[0])} to ${number(s[1])} m`, reason]), ...(empty.length > 20 ? [['more', `${empty.length - 20}`]] : [])]);
  if (result.refinement) add('Refinement', words(result.refinement));
  if (result.motion) add('Motion', words(result.motion));
  add('Times, ms', [...words(result.time_ms), ...words(result.time_ms.stages)]);
  add('Counters', words(result.counters));
  add('Lattice', words(result.lattice));
  add('Settings', [...words(settings), ['planner', result.planner], ['threads', String(result.threads)]]);
}
