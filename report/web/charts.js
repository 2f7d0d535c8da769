// SPDX-License-Identifier: BSD-3-Clause
// The drawings of a campaign's overview. Each returns an SVG element; row: an episode. A click on
// one of its marks picks the episode.
import * as Plot from '@observablehq/plot';
import { FAILED, SOLVED } from './palette.js';

function frame(width, height, colours, more) {
  return {
    width,
    height,
    marginLeft: 46,
    marginRight: 14,
    marginTop: 24,
    marginBottom: 34,
    style: { color: colours.ink, background: 'none', fontSize: '11px' },
    ...more,
  };
}
export const colourOf = (row) => (row.status === 'solved' ? SOLVED : FAILED);

/** The share of the values that are at most x, one curve for each verdict. */
function shares(rows, key) {
  return ['solved', 'infeasible'].flatMap((status) => {
    const ordered = rows.filter((row) => row.status === status).sort((a, b) => a[key] - b[key]);
    return ordered.map((row, k) => ({ row, x: row[key], share: (100 * (k + 1)) / ordered.length }));
  });
}
/**
 * Empirical distribution, over a logarithmic axis. key: of positive numbers; zeros are shown as
 * `least`.
 */
export function distribution(rows, key, label, least, width, colours) {
  const points = shares(rows, key).map((point) => ({ ...point, x: Math.max(least, point.x) }));
  return Plot.plot(
    frame(width, 210, colours, {
      x: {
        type: 'log',
        label,
        grid: true,
        ticks: 5,
        tickFormat: (v) =>
          /^[125]/.test(v.toPrecision(1)) ? String(Number(v.toPrecision(2))) : '',
      },
      y: { label: '% of each', domain: [0, 100], grid: true },
      marks: [
        Plot.line(points, {
          x: 'x',
          y: 'share',
          z: (d) => d.row.status,
          stroke: (d) => colourOf(d.row),
          strokeWidth: 1.8,
          curve: 'step-after',
        }),
        Plot.dot(points, {
          x: 'x',
          y: 'share',
          r: 3,
          fill: (d) => colourOf(d.row),
          className: 'pick',
          title: (d) => `episode ${d.row.episode}`,
        }),
      ],
    }),
  );
}
export function histogram(rows, key, label, width, colours) {
  return Plot.plot(
    frame(width, 210, colours, {
      x: { label },
      y: { label: 'episodes', grid: true },
      marks: [
        Plot.rectY(
          rows,
          Plot.binX({ y: 'count' }, { x: key, thresholds: 24, fill: SOLVED, inset: 0.5 }),
        ),
        Plot.ruleY([0]),
      ],
    }),
  );
}
/** ended: as of enders(), which gives the colours. */
export function reasons(rows, ended, width, colours) {
  const count = new Map();
  for (const { reason, by } of rows)
    count.set(reason, { reason, by, n: (count.get(reason)?.n ?? 0) + 1 });
  const bars = [...count.values()].sort((a, b) => b.n - a.n).slice(0, 12);
  return Plot.plot(
    frame(width, 40 + 38 * bars.length, colours, {
      marginLeft: 14,
      marginRight: 40,
      marginTop: 6,
      x: { label: 'episodes', ticks: 4 },
      y: { domain: bars.map(({ reason }) => reason), axis: null },
      marks: [
        Plot.barX(bars, {
          x: 'n',
          y: 'reason',
          fill: ({ by }) => ended.get(by).colour,
          insetTop: 18,
          insetBottom: 4,
        }),
        Plot.text(bars, { x: 0, y: 'reason', text: 'reason', textAnchor: 'start', dy: -9 }),
        Plot.text(bars, { x: 'n', y: 'reason', text: 'n', textAnchor: 'start', dx: 5, dy: 7 }),
        Plot.ruleX([0]),
      ],
    }),
  );
}
/** One dot an episode, where every path had ended. */
export function places(rows, ended, width, colours) {
  return Plot.plot(
    frame(width, 210, colours, {
      x: {
        label: 's, m',
        domain: [0, Math.max(...rows.map((row) => row.failed_s)) || 1],
        nice: true,
        grid: true,
      },
      y: { axis: null },
      marks: [
        Plot.dot(
          rows,
          Plot.dodgeY({
            x: 'failed_s',
            r: 4,
            fill: ({ by }) => ended.get(by).colour,
            className: 'pick',
            title: (row) => `episode ${row.episode}: ${row.reason}`,
          }),
        ),
      ],
    }),
  );
}
/**
 * One dot an episode, where its objects stood. across, up: numbers of coordinates; those without a
 * path are drawn last.
 */
export function offsets(rows, coordinates, across, up, ended, width, colours) {
  const isShift = (k) => /\.[xyz]$/.test(coordinates[k]),
    label = (k) => `${coordinates[k]}, ${isShift(k) ? 'm' : 'deg'}`,
    shown = (row, k) => row.offsets[k] * (isShift(k) ? 1 : 180 / Math.PI),
    flat = up === across;
  return Plot.plot(
    frame(width, flat ? 120 : Math.min(420, width), colours, {
      x: { label: label(across), grid: true },
      y: flat ? { axis: null } : { label: label(up), grid: true },
      marks: [
        Plot.dot(
          [...rows].sort((a, b) => (a.by !== '') - (b.by !== '')),
          {
            x: (row) => shown(row, across),
            y: (row) => (flat ? 0 : shown(row, up)),
            r: Math.max(2, Math.min(4.5, 120 / Math.sqrt(rows.length))),
            fill: ({ by }) => ended.get(by)?.colour ?? SOLVED,
            className: 'pick',
            title: (row) => `episode ${row.episode}: ${row.reason || row.status}`,
          },
        ),
      ],
    }),
  );
}
