// SPDX-License-Identifier: BSD-3-Clause
// What is plotted along a path and in time.
import { manipulability } from './kinematics.js';
import { degrees, shownOf, stepsOf } from './poses.js';

/**
 * All joints that have limits in one plot: 0 and 100 are the limits. The one that the answer names
 * (`named`) is bold, or where it names none the one that comes nearest.
 */
function ranges(chain, rows, named) {
  const lines = chain.joints
    .map((joint, k) => ({
      name: joint.name,
      of: ({ q }) => (100 * (q[k] - joint.lower)) / (joint.upper - joint.lower),
      joint,
    }))
    .filter(({ joint }) => joint.lower !== null && joint.upper !== null)
    .map((line) => ({ ...line, values: rows.map(line.of) }));
  const room = ({ values }) => Math.min(...values.map((v) => Math.min(v, 100 - v)));
  if (!lines.length || !rows.length) return [];
  const at = lines.findIndex(({ name }) => name === named),
    bold =
      at >= 0
        ? at
        : lines.reduce((best, line, k) => (room(line) < room(lines[best]) ? k : best), 0);
  return [
    {
      title: `joints; bold: ${lines[bold].name}`,
      unit: '% of range',
      lines,
      bold,
      of: lines[bold].of,
      low: 0,
      high: 100,
    },
  ];
}

/** Plots over the rows of a path, as Plots takes them. summary: of its result, or undefined. */
export function alongRows(chain, rows, settings, summary) {
  return [
    ...ranges(chain, rows, summary?.joint_limit?.joint),
    ...chain.joints.map((joint, k) => {
      const { scale } = shownOf(joint),
        shown = (value) => (value === null ? null : value * scale);
      return {
        title: joint.name,
        unit: joint.slides ? 'mm' : 'deg',
        values: rows.map((row) => row.q[k] * scale),
        of: ({ q }) => q[k] * scale,
        low: shown(joint.lower),
        high: shown(joint.upper),
      };
    }),
    {
      title: 'roll of the tool',
      unit: 'deg',
      values: rows.map((row) => degrees(row.roll)),
      of: ({ roll }) => degrees(roll),
      low: null,
      high: null,
    },
    {
      title: 'largest joint step',
      unit: 'deg',
      values: stepsOf(rows, chain),
      of: ({ step }) => step,
      low: null,
      high: degrees(settings.joint_step),
      from0: true,
    },
    {
      title: 'manipulability',
      unit: 'm³',
      values: rows.map((row) => manipulability(chain, row.q)),
      of: ({ q }) => manipulability(chain, q),
      low: null,
      high: null,
      from0: true,
    },
    {
      title: 'clearance',
      unit: 'mm',
      values: rows.map((row) => row.clearance_mm ?? null),
      of: ({ clearance_mm }) => clearance_mm ?? null,
      low: settings.clearance_mm,
      high: null,
      from0: true,
    },
    {
      title: 'tool-path error',
      unit: 'mm',
      values: rows.map((row) => row.error_mm),
      of: ({ error_mm }) => error_mm ?? null,
      low: null,
      high: summary?.tool_path_error?.allowed_mm ?? null,
      from0: true,
    },
  ].filter((series) => series.lines || series.values.some((v) => v !== null));
}

/** Plots over the times of a motion. speed: what the tool was asked to have, mm/s, or null. */
export function overTime(motion, speed) {
  const share = (title) => ({
    title: `largest joint ${title}`,
    unit: '% of limit',
    values: motion[title],
    low: null,
    high: 100,
    from0: true,
  });
  return [
    {
      title: 'tool speed',
      unit: 'mm/s',
      values: motion.tool_mm_s,
      low: null,
      high: speed,
      from0: true,
    },
    share('speed'),
    share('acceleration'),
    share('jerk'),
  ];
}
