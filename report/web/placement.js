// SPDX-License-Identifier: BSD-3-Clause
// Placements of the part, the path or the robot: a map by verdict, by what ends the paths, by
// quality; each placement with its command.
import * as Plot from '@observablehq/plot';
import { enders, legend } from './ended.js';
import { savers } from './figure.js';
import { element, hatching } from './hatching.js';
import { $, data, number, show, style, table, themes, whenResized } from './page.js';
import { FAILED, lineBetween, rampColour, SOLVED } from './palette.js';
import { Placed } from './placed.js';

const kMapName = 'Map of placements: the arrows pick one',
  kBest = 20,
  kAround = 270, // pixels above and below the map
  kDegrees = 180 / Math.PI;
// Of each quality: the column, whether more is better, its scale to the unit shown, words.
const kQualities = {
  cost: ['cost', -1, 1, '', 'cost'],
  clearance: ['clearance_margin', 1, 1e3, ' mm', 'clearance beyond what must be kept'],
  margin: ['joint_margin', 1, kDegrees, '°', 'distance from a joint limit'],
  slide: ['slide_margin', 1, 1e3, ' mm', 'distance of the slide from a limit'],
  speed: ['tool_speed', 1, 1, ' m/s', 'top speed of the tool'],
};
const { columns } = data;
// The axes of the grid. `name` is the key of the axis in a row, `label` what people read, `joint`
// the held joint that the axis varies, or null; values in rows times `scale` are in `unit`.
const axes = data.axes.map(({ name, unit, values }) => {
  const turns = !unit && !/^[xyz]$/.test(name);
  return {
    name: unit ? `hold.${name}` : name,
    label: name,
    joint: unit ? name : null,
    unit: unit ?? (turns ? 'deg' : 'm'),
    scale: turns ? kDegrees : 1,
    values,
  };
});
const varied = axes.filter((axis) => axis.values.length > 1 || data.sample),
  stem = data.problem.replace(/\.[^.]*$/, '');

const rows = columns.cell.map((cell, k) => {
  const row = { cell, end: columns.end[k], solved: columns.end[k] < 0, offset: {} };
  for (const key of [
    'cost',
    'clearance',
    'clearance_margin',
    'joint_margin',
    'slide_margin',
    'tool_speed',
    'failed_s',
  ])
    row[key] = columns[key]?.[k] ?? null;
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
for (const { name, label } of varied.length ? varied : axes) {
  option($('across'), name, label);
  option($('up'), name, label);
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
    ends = [...ended.values()].map(({ colour, by: who, count }) => [
      colour,
      `no path: ${who} (${count})`,
      true,
    ]);
  if (by === 'verdict')
    return {
      of: (row) => (row.solved ? SOLVED : FAILED),
      legend: [
        [SOLVED, `a path (${solved.length})`],
        [FAILED, `no path at this resolution (${rows.length - solved.length})`, true],
      ],
    };
  if (by === 'end')
    return {
      of: (row) => (row.solved ? SOLVED : colourOfEnd[row.end]),
      legend: [[SOLVED, `a path (${solved.length})`], ...ends],
    };
  const { low, high, of } = shade(),
    [, sign, scale, unit, words] = kQualities[by],
    text = (v) => `${number(scale * v, 4)}${unit}`;
  return {
    of: (row) => (row.solved ? rampColour(of(row) ?? 0) : colourOfEnd[row.end]),
    legend: [
      [rampColour(0), `${words} ${text(sign > 0 ? low : high)}`],
      [rampColour(0.5), '…'],
      [rampColour(1), text(sign > 0 ? high : low)],
      ...ends,
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
/** Coordinates are shown in m and degrees, positions of joints that are held in m and rad. */
const shownAt = (row, name) => axisOf(name).scale * row.offset[name];
/** The values of an axis as they are shown. */
const valuesOf = (name) => axisOf(name).values.map((v) => axisOf(name).scale * v);
/** Half a step, so that cells touch. */
function half(name) {
  const values = valuesOf(name);
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
/**
 * Hatching over the cells without a path, and lines between those that different things ended,
 * where their contrast is low. x, y: names of the coordinates; of: the colour of a row.
 */
function unsolvedCells(x, y, flat, of, scales) {
  const group = element('g', { 'pointer-events': 'none' }),
    at = (row, name) => (name === y && flat ? 0 : shownAt(row, name)),
    places = new Map(drawn.map((row) => [`${row[x]},${flat ? 0 : row[y]}`, row])),
    paths = new Map();
  const add = (kind, colour, d) => {
    const key = `${kind} ${colour}`;
    paths.set(key, (paths.get(key) ?? '') + d);
  };
  for (const row of drawn.filter(({ solved: has }) => !has)) {
    const [hx, hy] = [half(x), flat ? 0.5 : half(y)],
      [left, right] = [-hx, hx].map((h) => scales.x(at(row, x) + h).toFixed(1)),
      [low, high] = [-hy, hy].map((h) => scales.y(at(row, y) + h).toFixed(1));
    add('hatch', lineBetween(of(row), of(row)), `M${left},${low}H${right}V${high}H${left}Z`);
    const line = (column, level) => {
      const other = places.get(`${column},${level}`);
      return other && !other.solved && of(other) !== of(row) && lineBetween(of(row), of(other));
    };
    const level = flat ? 0 : row[y],
      beside = line(row[x] + 1, level),
      above = line(row[x], level + 1);
    if (beside) add('line', beside, `M${right},${low}V${high}`);
    if (above) add('line', above, `M${left},${high}H${right}`);
  }
  for (const [key, d] of paths) {
    const [kind, colour] = key.split(' '),
      { pattern, fill } = hatching(colour);
    if (kind === 'hatch') group.append(pattern, element('path', { d, fill }));
    else group.append(element('path', { d, fill: 'none', stroke: colour, 'stroke-width': 1.2 }));
  }
  return group;
}
let drawn = [];
function draw(width, ink) {
  const x = $('across').value,
    flat = varied.length < 2,
    y = $('up').value,
    { of } = colours();
  drawn = shown(x, y);
  const unit = (name) => `${axisOf(name).label}, ${axisOf(name).unit}`;
  const hx = half(x),
    hy = flat ? 0.5 : half(y),
    at = (row) => (flat ? 0 : shownAt(row, y));
  const range = (name) => {
    const values = valuesOf(name);
    return [values[0] - half(name), values.at(-1) + half(name)];
  };
  const height = flat
    ? 120
    : Math.min(
        Math.max(280, innerHeight - kAround),
        Math.max(
          240,
          Math.round(
            ((range(y)[1] - range(y)[0]) / (range(x)[1] - range(x)[0])) * (width - 70) + 60,
          ) || 240,
        ),
      );
  const chosen = (row) => (row.solved ? of(row) : 'none');
  const marks = data.sample
    ? [
        Plot.dot(drawn, {
          x: (row) => shownAt(row, x),
          y: at,
          r: Math.max(2, Math.min(6, 200 / Math.sqrt(rows.length + 1))),
          fill: chosen,
          stroke: of,
          strokeWidth: 1.5,
          pointerEvents: 'all',
          className: 'cells',
        }),
      ]
    : [
        Plot.rect(drawn, {
          x1: (row) => shownAt(row, x) - hx,
          x2: (row) => shownAt(row, x) + hx,
          y1: (row) => at(row) - hy,
          y2: (row) => at(row) + hy,
          fill: of,
          stroke: 'none',
          className: 'cells',
          shapeRendering: 'crispEdges',
        }),
        (_, scales) => unsolvedCells(x, y, flat, of, scales),
      ];
  if (picked && drawn.includes(picked))
    marks.push(
      Plot.dot([picked], {
        x: (row) => shownAt(row, x),
        y: at,
        r: 6,
        stroke: '#fff',
        strokeWidth: 3,
        pointerEvents: 'none',
      }),
      Plot.dot([picked], {
        x: (row) => shownAt(row, x),
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
    marginBottom: 40,
    style: { color: ink, background: 'none', fontSize: '11px' },
    x: { label: unit(x), labelOffset: 34, domain: range(x), ticks: 6 },
    y: flat ? { axis: null, domain: [-0.5, 0.5] } : { label: unit(y), domain: range(y), ticks: 6 },
    marks,
  });
}

/** A word of a command line, in quotes where a shell would not take it as it is. */
const word = (text) =>
  /^[\w./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;

let picked = null;
const placed = data.scene && new Placed(data.scene);
$('view').hidden = $('controls').hidden = !placed;
function pick(row) {
  picked = row;
  const offsets = axes.map((axis) => [axis, row.offset[axis.name]]),
    text = (v, scale, unit, digits = 4) =>
      v === null ? '–' : `${number(scale * v, digits)}${unit}`;
  $('facts').replaceChildren();
  table($('facts'), `Placement ${row.cell}`, [
    ...offsets.map(([{ label, unit, scale }, value]) => [
      label,
      unit === 'deg' ? `${number(value * scale, 6)}°` : `${number(value, 8)} ${unit}`,
    ]),
    ['verdict', row.solved ? 'solved' : 'no path at this resolution'],
    ...(row.solved
      ? [
          ['cost', text(row.cost, 1, '', 6)],
          ['clearance', text(row.clearance, 1e3, ' mm')],
          ['more than must be kept by', text(row.clearance_margin, 1e3, ' mm')],
          ['from a joint limit', text(row.joint_margin, kDegrees, '°')],
          ...(row.slide_margin === null
            ? []
            : [["from the slide's limit", text(row.slide_margin, 1e3, ' mm')]]),
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
    .filter(([{ joint }, value]) => joint || value !== 0)
    .map(([{ joint, name }, value]) =>
      joint ? ` --hold ${word(joint)}=${value}` : ` --${name} ${value}`,
    )
    .join('')} --report placement_${row.cell}.html`;
  paintMap();
  for (const line of $('best').querySelectorAll('tbody tr'))
    line.classList.toggle('marked', Number(line.dataset.cell) === row.cell);
  if (placed) showPlan(row);
}
/** The plan of a placement, or what there is instead. */
function showPlan(row) {
  const open = placed.has(row.cell)
    ? row
    : window.swivel.cell === null
      ? rows.find(({ cell }) => placed.has(cell))
      : null;
  if (open && window.swivel.cell !== open.cell) placed.open(open.cell, open.offset);
  placed.pick(row.cell, row.offset);
  const isShown = window.swivel.cell === row.cell,
    what = placed.isPartial ? 'where paths end in' : 'the plan of';
  const words = row.solved
    ? [
        `${what} placement ${window.swivel.cell}`,
        isShown ? '' : `; that of ${row.cell} is opened by its command`,
      ]
    : [
        `placement ${row.cell} has no path: ${data.ends[row.end].reason}`,
        row.failed_s === null ? '' : `, at s ${number(row.failed_s)} m`,
        isShown ? `\n${placed.plan.past.what}` : `\nfaded: ${what} placement ${window.swivel.cell}`,
      ];
  $('readout').textContent = words.join('');
}
$('copy').addEventListener('click', () => navigator.clipboard?.writeText($('command').textContent));

const head = $('best').querySelector('thead tr'),
  slides = solved.some(({ slide_margin }) => slide_margin !== null);
for (const name of [
  ...axes.map(({ label, unit }) => `${label}, ${unit === 'deg' ? '°' : unit}`),
  'cost',
  'clearance, mm',
  'joint limit, °',
  ...(slides ? ["slide's limit, mm"] : []),
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
          ...axes.map(({ name }) => number(shownAt(row, name), 6)),
          number(row.cost, 6),
          number(row.clearance === null ? null : 1e3 * row.clearance),
          number(row.joint_margin === null ? null : kDegrees * row.joint_margin, 3),
          ...(slides ? [number(row.slide_margin === null ? null : 1e3 * row.slide_margin)] : []),
          number(row.tool_speed, 3),
        ])
          line.insertCell().textContent = value;
        line.addEventListener('click', () => pick(row));
        line.addEventListener('keydown', (event) => event.key === 'Enter' && pick(row));
        return line;
      }),
    );
}
/** The placement beside the picked one, by steps to the right and up. */
function pickBeside(right, up) {
  const x = $('across').value,
    y = $('up').value;
  if (!picked) return;
  const way = (row) => {
    const [dx, dy] = [row[x] - picked[x], row[y] - picked[y]],
      on = right * dx + up * dy;
    return on > 0 ? on + 4 * Math.abs(right * dy + up * dx) : Infinity;
  };
  const sampled = (row) => {
    const [dx, dy] = [shownAt(row, x) - shownAt(picked, x), shownAt(row, y) - shownAt(picked, y)],
      on = right * dx + up * dy;
    return on > 0 ? on + 4 * Math.abs(right * dy + up * dx) : Infinity;
  };
  const far = data.sample ? sampled : way,
    best = drawn.reduce((a, b) => (far(b) < far(a) ? b : a), picked);
  if (far(best) < Infinity) pick(best);
}
const kArrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
$('map')
  .querySelector('.chart')
  .addEventListener('keydown', (event) => {
    if (!kArrows[event.key] || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    pickBeside(...kArrows[event.key]);
  });
function paintMap() {
  const host = $('map').querySelector('.chart'),
    drawing = draw(host.clientWidth, style('--soft'));
  // Plot keeps a mark's index into its data.
  drawing.addEventListener(
    'click',
    ({ target }) =>
      target.closest('.cells') && drawn[target.__data__] && pick(drawn[target.__data__]),
  );
  show(host, drawing, kMapName, 'application');
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
