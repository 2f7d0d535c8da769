// SPDX-License-Identifier: BSD-3-Clause
// Placements of the part, the path or the robot: a map by verdict, by what ends the paths, by
// quality; each placement with its command.
import * as Plot from '@observablehq/plot';
import { enders, legend } from './ended.js';
import { savers } from './figure.js';
import { $, data, isDark, number, style, table, themes, whenResized } from './page.js';
import { FAILED, kDark, kLight, rampColour, SOLVED } from './palette.js';
import { Placed } from './placed.js';

const kBest = 20;
// Of each quality: the column, whether more is better, its scale to the unit shown, words.
const kQualities = {
  cost: ['cost', -1, 1, '', 'cost'],
  clearance: ['clearance_margin', 1, 1e3, ' mm', 'clearance beyond what must be kept'],
  margin: ['joint_margin', 1, 180 / Math.PI, '°', 'distance from a joint limit'],
  speed: ['tool_speed', 1, 1, ' m/s', 'top speed of the tool'],
};
const { axes, columns } = data;
const varied = axes.filter((axis) => axis.values.length > 1 || data.sample),
  stem = data.problem.replace(/\.[^.]*$/, '');

const rows = columns.cell.map((cell, k) => {
  const row = { cell, end: columns.end[k], solved: columns.end[k] < 0, offset: {} };
  for (const key of [
    'cost',
    'clearance',
    'clearance_margin',
    'joint_margin',
    'tool_speed',
    'failed_s',
  ])
    row[key] = columns[key][k];
  let rest = cell;
  for (let a = axes.length - 1; a >= 0; --a) {
    const { name, values } = axes[a];
    row.offset[name] = data.sample ? columns.offsets[k][a] : values[rest % values.length];
    row[name] = rest % values.length;
    rest = Math.floor(rest / values.length);
  }
  return row;
});
const solved = rows.filter((row) => row.solved);
const ended = enders(rows.filter((row) => !row.solved).map(({ end }) => data.ends[end])),
  colourOfEnd = data.ends.map(({ by }) => ended.get(by)?.colour);

document.title = `${data.problem}, ${rows.length} placements – Swivel`;
$('title').textContent = `${data.problem}: where should ${data.thing} stand?`;
$('verdict').textContent =
  `${solved.length} of ${rows.length} placements have a path ` +
  `(${number((100 * solved.length) / Math.max(1, rows.length), 3)} %)` +
  (rows.length < data.asked
    ? `; ${data.asked - rows.length} of ${data.asked} were not planned`
    : '') +
  `. Planner ${data.planner}.`;

const order_by = (name) => {
  const [key, sign] = kQualities[name],
    merit = (row) => (row[key] === null ? -Infinity : sign * row[key]);
  return (a, b) => b.solved - a.solved || (a.solved && merit(b) - merit(a)) || a.cell - b.cell;
};
const quality = () => (kQualities[$('colour').value] ? $('colour').value : data.criterion);
function option(select, value, text) {
  select.append(new Option(text, value));
}
option($('colour'), 'verdict', 'verdict');
option($('colour'), 'end', 'what ends the paths');
for (const [name, [key, , , , words]] of Object.entries(kQualities))
  if (solved.some((row) => row[key] !== null)) option($('colour'), name, words);
$('colour').value = [...$('colour').options].some(({ value }) => value === data.criterion)
  ? data.criterion
  : 'end';
for (const { name } of varied.length ? varied : axes) {
  option($('across'), name, name);
  option($('up'), name, name);
}
$('up').value = (varied[1] ?? varied[0] ?? axes[0]).name;
$('axes').hidden = varied.length < 3;

/** From 0 to 1 among all that have a path. */
function shade() {
  const [key, sign] = kQualities[quality()],
    values = solved.map((r) => r[key]).filter((v) => v !== null);
  const low = values.reduce((a, b) => Math.min(a, b), Infinity),
    high = values.reduce((a, b) => Math.max(a, b), -Infinity);
  const share = (value) => (high > low ? (value - low) / (high - low) : 1);
  return {
    low,
    high,
    of: (r) => (r[key] === null ? null : sign > 0 ? share(r[key]) : 1 - share(r[key])),
  };
}
function colours() {
  const by = $('colour').value,
    { unseen } = isDark() ? kDark : kLight;
  if (by === 'verdict')
    return {
      of: (row) => (row.solved ? SOLVED : FAILED),
      legend: [
        [SOLVED, `a path (${solved.length})`],
        [FAILED, `no path at this resolution (${rows.length - solved.length})`],
      ],
    };
  if (by === 'end')
    return {
      of: (row) => (row.solved ? SOLVED : colourOfEnd[row.end]),
      legend: [
        [SOLVED, `a path (${solved.length})`],
        ...[...ended.values()].map(({ colour, by, count }) => [colour, `${by} (${count})`]),
      ],
    };
  const { low, high, of } = shade(),
    [, sign, scale, unit, words] = kQualities[by],
    text = (v) => `${number(scale * v, 4)}${unit}`;
  return {
    of: (row) => (row.solved && of(row) !== null ? rampColour(of(row)) : unseen),
    legend: [
      [rampColour(0), `${words} ${text(sign > 0 ? low : high)}`],
      [rampColour(0.5), '…'],
      [rampColour(1), text(sign > 0 ? high : low)],
      [unseen, `no path (${rows.length - solved.length})`],
    ],
  };
}
/** The rows that are shown over two coordinates: where more vary, of each place the best. */
function shown(x, y) {
  if (data.sample) return rows;
  const before = order_by(quality()),
    places = new Map();
  for (const row of rows) {
    const place = `${row[x]},${row[y]}`,
      other = places.get(place);
    if (!other || before(row, other) < 0) places.set(place, row);
  }
  return [...places.values()];
}
const axisOf = (name) => axes.find((a) => a.name === name);
/** Half a step, so that cells touch. */
function half(name) {
  const { values } = axisOf(name);
  return values.length > 1 ? (values.at(-1) - values[0]) / (values.length - 1) / 2 : 0.5;
}
/** The map of x and y as the floor of the view. */
function layFloor() {
  if (!placed || !['x', 'y'].every((name) => varied.some((axis) => axis.name === name))) return;
  const { of } = colours(),
    halves = data.sample ? [0.004, 0.004] : [half('x'), half('y')];
  placed.lay(
    shown('x', 'y').map((row) => ({
      x: row.offset.x,
      y: row.offset.y,
      half: halves,
      colour: of(row),
    })),
  );
}
let drawn = [];
function draw(width, ink) {
  const x = $('across').value,
    flat = varied.length < 2,
    y = $('up').value,
    { of } = colours();
  drawn = shown(x, y);
  const unit = (name) => `${name}, ${/^[xyz]$/.test(name) ? 'm' : 'rad'}`;
  const hx = half(x),
    hy = flat ? 0.5 : half(y),
    at = (row) => (flat ? 0 : row.offset[y]);
  const range = (name) => {
    const { values } = axisOf(name);
    return [values[0] - half(name), values.at(-1) + half(name)];
  };
  const height = flat
    ? 120
    : Math.min(
        640,
        Math.max(
          240,
          Math.round(
            ((range(y)[1] - range(y)[0]) / (range(x)[1] - range(x)[0])) * (width - 70) + 60,
          ) || 240,
        ),
      );
  const marks = data.sample
    ? [
        Plot.dot(drawn, {
          x: (row) => row.offset[x],
          y: at,
          r: Math.max(2, Math.min(6, 200 / Math.sqrt(rows.length + 1))),
          fill: of,
          className: 'cells',
        }),
      ]
    : [
        Plot.rect(drawn, {
          x1: (row) => row.offset[x] - hx,
          x2: (row) => row.offset[x] + hx,
          y1: (row) => at(row) - hy,
          y2: (row) => at(row) + hy,
          fill: of,
          stroke: 'none',
          className: 'cells',
          shapeRendering: 'crispEdges',
        }),
      ];
  if (picked && drawn.includes(picked))
    marks.push(
      Plot.dot([picked], {
        x: (row) => row.offset[x],
        y: at,
        r: 6,
        stroke: '#fff',
        strokeWidth: 3,
        pointerEvents: 'none',
      }),
      Plot.dot([picked], {
        x: (row) => row.offset[x],
        y: at,
        r: 6,
        stroke: '#000',
        strokeWidth: 1.5,
        pointerEvents: 'none',
      }),
    );
  return Plot.plot({
    width,
    height,
    marginLeft: 54,
    marginRight: 16,
    marginTop: 22,
    marginBottom: 36,
    style: { color: ink, background: 'none', fontSize: '11px' },
    x: { label: unit(x), domain: range(x), ticks: 6 },
    y: flat ? { axis: null, domain: [-0.5, 0.5] } : { label: unit(y), domain: range(y), ticks: 6 },
    marks,
  });
}

let picked = null;
const placed = data.scene && new Placed(data.scene);
$('view').hidden = $('controls').hidden = !placed;
function pick(row) {
  picked = row;
  const offsets = axes.map(({ name }) => [name, row.offset[name]]),
    text = (v, scale, unit, digits = 4) =>
      v === null ? '–' : `${number(scale * v, digits)}${unit}`;
  $('facts').replaceChildren();
  table($('facts'), `Placement ${row.cell}`, [
    ...offsets.map(([name, value]) => [
      name,
      `${number(value, 8)} ${/^[xyz]$/.test(name) ? 'm' : 'rad'}`,
    ]),
    ['verdict', row.solved ? 'solved' : 'no path at this resolution'],
    ...(row.solved
      ? [
          ['cost', text(row.cost, 1, '', 6)],
          ['clearance', text(row.clearance, 1e3, ' mm')],
          ['more than must be kept by', text(row.clearance_margin, 1e3, ' mm')],
          ['from a joint limit', text(row.joint_margin, 180 / Math.PI, '°')],
          ['top speed of the tool', text(row.tool_speed, 1, ' m/s')],
        ]
      : [
          [
            'every path ends at s',
            row.failed_s === null
              ? 'the first layer has no valid node'
              : text(row.failed_s, 1, ' m'),
          ],
          ['ended by', data.ends[row.end].reason],
        ]),
  ]);
  $('command').textContent = `${data.plan_command}${offsets
    .filter(([, value]) => value !== 0)
    .map(([name, value]) => ` --${name} ${value}`)
    .join('')} --report placement_${row.cell}.html`;
  paintMap();
  for (const line of $('best').querySelectorAll('tbody tr'))
    line.classList.toggle('marked', Number(line.dataset.cell) === row.cell);
  if (placed?.has(row.cell) && window.swivel.cell !== row.cell) placed.open(row.cell, row.offset);
  $('readout').textContent = placed
    ? `the plan of placement ${window.swivel.cell}` +
      `${window.swivel.cell === row.cell ? '' : `; that of ${row.cell} is opened by its command`}`
    : '';
}
$('copy').addEventListener('click', () => navigator.clipboard?.writeText($('command').textContent));

const head = $('best').querySelector('thead tr');
for (const name of [
  ...axes.map((axis) => axis.name),
  'cost',
  'clearance, mm',
  'joint limit, °',
  'speed, m/s',
]) {
  const cell = document.createElement('th');
  cell.textContent = name;
  head.append(cell);
}
function listBest() {
  const best = [...solved].sort(order_by(quality())).slice(0, kBest);
  $('best').querySelector('h2').textContent = best.length
    ? `The best by ${kQualities[quality()][4]}`
    : 'No placement has a path';
  $('best')
    .querySelector('tbody')
    .replaceChildren(
      ...best.map((row) => {
        const line = document.createElement('tr');
        line.tabIndex = 0;
        line.dataset.cell = row.cell;
        line.title = placed?.has(row.cell) ? 'shows its plan' : '';
        for (const value of [
          ...axes.map(({ name }) => number(row.offset[name], 6)),
          number(row.cost, 6),
          number(row.clearance === null ? null : 1e3 * row.clearance),
          number(row.joint_margin === null ? null : (180 / Math.PI) * row.joint_margin, 3),
          number(row.tool_speed, 3),
        ])
          line.insertCell().textContent = value;
        line.addEventListener('click', () => pick(row));
        line.addEventListener('keydown', (event) => event.key === 'Enter' && pick(row));
        return line;
      }),
    );
}
function paintMap() {
  const host = $('map').querySelector('.chart'),
    drawing = draw(host.clientWidth, style('--soft'));
  // Plot keeps a mark's index into its data.
  drawing.addEventListener(
    'click',
    ({ target }) =>
      target.closest('.cells') && drawn[target.__data__] && pick(drawn[target.__data__]),
  );
  host.replaceChildren(drawing);
  legend($('legend'), colours().legend);
  $('map-note').textContent =
    varied.length > 2 && !data.sample
      ? 'Each place shows the best over the other coordinates.'
      : '';
}
function paint() {
  paintMap();
  listBest();
  layFloor();
  placed?.paint();
}
savers($('map').querySelector('h2'), `${stem}_placements`, () => draw(720, '#000'));
for (const id of ['colour', 'across', 'up'])
  $(id).addEventListener('change', () => {
    paint();
    if (picked) pick(picked);
  });
themes(paint);
whenResized(paintMap);
$('chosen').hidden = rows.length === 0;
if (rows.length) pick([...rows].sort(order_by(data.criterion))[0]);
