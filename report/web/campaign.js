// SPDX-License-Identifier: BSD-3-Clause
// The overview of a campaign: what its rows say together, and each row with the way to plan it
// again.
import { distribution, histogram, offsets, places, reasons } from './charts.js';
import { enders, legend } from './ended.js';
import { savers } from './figure.js';
import { $, data, number, show, style, table, themes, whenResized } from './page.js';
import { SOLVED } from './palette.js';
import { EpisodeTable } from './episodes.js';

const { rows, coordinates } = data;
const solved = rows.filter((row) => row.status === 'solved'),
  failed = rows.filter((row) => row.status !== 'solved');
const ended = enders(failed),
  stem = data.problem.replace(/\.[^.]*$/, '');

document.title = `${data.problem}, ${rows.length} episodes – Swivel`;
$('title').textContent =
  `${data.problem}, ${data.episodes} episodes of seed ${data.seed}` +
  `${data.shard[1] > 1 ? `, shard ${data.shard[0]} of ${data.shard[1]}` : ''}`;
// As the terminal has them.
const { median, p95 } = data.plan_ms;
$('verdict').textContent = !rows.length
  ? 'No episode was answered.'
  : `${solved.length} of ${rows.length} episodes solved ` +
    `(${number((100 * solved.length) / rows.length, 3)} %), ${failed.length} without a path at ` +
    'this resolution' +
    (rows.length < data.asked ? `; ${data.asked - rows.length} not answered` : '') +
    `. Planner ${data.planner}: ${median.toFixed(1)} ms in the median, 5 % above ` +
    `${p95.toFixed(1)} ms.`;

const episodes = new EpisodeTable($('episodes'), rows, choose);
/** Shows one episode; called for a row of the table and for a dot of a chart. */
function choose(row) {
  $('facts').replaceChildren();
  table($('facts'), `Episode ${row.episode} of seed ${data.seed}`, [
    ...coordinates.map((name, k) => [
      name,
      /\.[xyz]$/.test(name)
        ? `${number(row.offsets[k], 6)} m`
        : `${number((row.offsets[k] * 180) / Math.PI, 6)}°`,
    ]),
    ['verdict', row.status],
    ['cost', number(row.cost)],
    ['planning time', `${number(row.plan_ms)} ms`],
    ['nodes checked', String(row.nodes_checked)],
    ['FCL calls', String(row.fcl_calls)],
    ['tool-path error at most', row.error_mm === null ? '–' : `${number(row.error_mm, 3)} mm`],
    ...(row.status === 'solved'
      ? []
      : [
          [
            'every path ends at s',
            row.failed_s === null
              ? 'the first layer has no valid node'
              : `${number(row.failed_s)} m`,
          ],
          ['ended by', row.reason],
        ]),
  ]);
  $('command').textContent =
    `${data.plan_command} --episode ${row.episode} --report episode_${row.episode}.html`;
  episodes.mark(row);
}
$('copy').addEventListener('click', () => navigator.clipboard?.writeText($('command').textContent));

coordinates.forEach((name, k) =>
  ['across', 'up'].forEach((id) => $(id).append(new Option(name, k))),
);
$('up').value = String(Math.min(1, coordinates.length - 1));
$('choices').hidden = coordinates.length < 2;
for (const id of ['across', 'up']) $(id).addEventListener('change', paint);
legend($('legend'), [
  [SOLVED, `a path (${solved.length})`],
  ...[...ended.values()].map(({ colour, by, count }) => [colour, `${by} (${count})`]),
]);

const placed = failed.filter((row) => row.failed_s !== null),
  unplaced = failed.length - placed.length;
$('places').querySelector('p').textContent = unplaced
  ? `${unplaced} more: not even the first layer has a valid node.`
  : '';
const charts = [
  ['times', rows, (width, colours) => distribution(rows, 'plan_ms', 'ms', 0.01, width, colours)],
  [
    'costs',
    solved,
    (width, colours) => histogram(solved, 'cost', 'cost of the solved', width, colours),
  ],
  [
    'work',
    rows,
    (width, colours) =>
      distribution(
        rows,
        'nodes_checked',
        rows.some((row) => row.nodes_checked === 0) ? 'nodes, none at 1' : 'nodes',
        1,
        width,
        colours,
      ),
  ],
  ['reasons', failed, (width, colours) => reasons(failed, ended, width, colours)],
  ['places', placed, (width, colours) => places(placed, ended, width, colours)],
  [
    'offsets',
    coordinates.length ? rows : [],
    (width, colours) =>
      offsets(
        rows,
        coordinates,
        Number($('across').value),
        Number($('up').value),
        ended,
        width,
        colours,
      ),
  ],
];
for (const [id, of, draw] of charts) {
  $(id).hidden = of.length === 0;
  if (of.length)
    savers($(id).querySelector('h2'), `${stem}_${id}`, () => draw(560, { ink: '#000' }));
}
function paint() {
  for (const [id, of, draw] of charts) {
    if (!of.length) continue;
    const host = $(id).querySelector('.chart'),
      drawing = draw(host.clientWidth, { ink: style('--soft') });
    // Plot keeps a mark's index into its data; a dot's title names the episode.
    for (const dot of drawing.querySelectorAll('.pick circle'))
      dot.addEventListener('click', () =>
        choose(rows.find((row) => row.episode === Number(dot.textContent.match(/\d+/)[0]))),
      );
    show(
      host,
      drawing,
      `${$(id).querySelector('h2').firstChild.textContent}, ${of.length} episodes`,
    );
  }
}
themes(paint);
whenResized(paint);
$('chosen').hidden = rows.length === 0;
if (rows.length) choose(failed[0] ?? rows[0]);
