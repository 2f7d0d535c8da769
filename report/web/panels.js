// SPDX-License-Identifier: BSD-3-Clause
// The (s, phi) map drawn: a panel for each branch, where the tool may turn one more for its roll,
// the cells, the path above.
import * as Plot from '@observablehq/plot';
import { ticks } from 'd3';
import { alongPath } from './axis.js';
import { PAPER, sheet } from './figure.js';
import { element, hatching, hatchedBy } from './hatching.js';
import { LIMIT, unitOf, wrapped } from './map.js';
import { isDark, show, style } from './page.js';
import { kDark, kLight, kLines, lineBetween } from './palette.js';

const kMostDetails = 4; // named in the legend of one colour

/** An entry of the legend in words. */
const words = ({ meaning, details }) =>
  details.length < 2 && meaning !== 'joint limit'
    ? meaning
    : `${meaning}: ${details.slice(0, kMostDetails).join(', ')}` +
      (details.length > kMostDetails ? `, ${details.length - kMostDetails} more` : '');

/**
 * [place in cells, value] of an axis of the coordinate: quarters of a turn, or round values
 * between its ends.
 */
function marks(cells) {
  const name = (degrees) => String(degrees).replace('-', '−');
  if (cells.closed)
    return [-180, -90, 0, 90, 180].map((degrees) => [
      ((degrees + 180) / 360) * cells.angles - (degrees === 180 ? 0.5 : 0),
      name(degrees),
    ]);
  const { scale } = unitOf(cells),
    whole = (value) => (cells.slides ? value : wrapped(value)) * scale,
    low = cells.low * scale,
    high = low + (cells.angles - 1) * cells.step * scale;
  if (cells.angles === 1) return [[0, name(Number(whole(cells.low).toFixed(3)))]];
  return ticks(low, high, 4).map((value) => [
    (value - low) / (cells.step * scale),
    name(Number(whole(value / scale).toFixed(6))),
  ]);
}

/** Fills the legend of the maps of paths, whose colours mean the same. */
export function paintLegend(host, paths) {
  const colours = isDark() ? kDark : kLight,
    entries = new Map();
  for (const { cells } of paths)
    for (const one of cells?.legend(colours) ?? []) {
      const known = entries.get(one.meaning) ?? { ...one, details: [] };
      known.details = [...new Set([...known.details, ...one.details])].sort();
      entries.set(one.meaning, known);
    }
  if (paths[0].region)
    entries.set('region', {
      meaning: paths[0].region.of_motion
        ? 'first conflict: the motion on from here and that of the other arm do not keep clear'
        : 'first conflict: no pose here keeps clear of any such pose of the other arm',
      colour: '#fff',
      lines: kLines.nearest,
      hatched: true,
      details: [],
    });
  host.replaceChildren(
    ...[...entries.values()].map((one) => {
      const entry = document.createElement('span'),
        swatch = document.createElement('i');
      swatch.style.background = one.hatched
        ? hatchedBy(one.colour, one.lines ?? colours.hatch)
        : one.colour;
      entry.append(swatch, words(one));
      return entry;
    }),
  );
}

const kRegionLeast = 7; // pixels, of the width in which a region is drawn

export class Panels {
  /**
   * path: { cells: Cells; rows: of the path; beside: rows of the path that it was refined from, or
   * of another one, or none; ended: whether all paths end where the rows do; label: stands before
   * the names of panels, where there are several paths; region: { runs: [{ layer, sheet, from, to
   * }] } of cells where the arm bars the other, or none }; hover, pick: called with a cell or null.
   */
  constructor(host, { cells, rows, beside, ended, label, region }, hover, pick) {
    Object.assign(this, { cells, rows, beside, ended, label, region });
    Object.assign(this, { marks: marks(cells), pose: null });
    this.panels = cells.panels.map((panel, index) => {
      const box = document.createElement('div');
      box.className = 'panel';
      box.innerHTML =
        '<h3></h3><div class="stack"><div class="chart"></div><div class="cursor"></div>' +
        '<div class="dot" hidden></div></div>';
      box.firstChild.textContent = `${label && `${label}: `}${panel.name}`;
      const drawn = {
        ...panel,
        index,
        box,
        chart: box.querySelector('.chart'),
        line: box.querySelector('.cursor'),
        dot: box.querySelector('.dot'),
      };
      // A click's coordinates are rounded: they could mean the neighbour of the cell that is shown.
      let under = null;
      for (const kind of ['pointerdown', 'pointermove'])
        drawn.chart.addEventListener(kind, (event) =>
          hover((under = this.cellAt(drawn, event)), event),
        );
      drawn.chart.addEventListener('pointerleave', (event) => hover(null, event));
      drawn.chart.addEventListener('click', () => pick(under));
      return drawn;
    });
    // The panels that hold the path come first.
    const used = new Set(rows.map((row) => row.sheet));
    for (const panel of this.panels) if (panel.rolls && used.size) used.add(panel.sheet);
    this.panels.sort((a, b) => used.has(b.sheet) - used.has(a.sheet) || a.index - b.index);
    this.panels.forEach((panel) =>
      panel.box.classList.toggle('other', used.size > 0 && !used.has(panel.sheet)),
    );
    host.append(...this.panels.map(({ box }) => box));
  }
  cellAt({ index, chart, x, y }, event) {
    const { cells } = this,
      r = chart.getBoundingClientRect();
    const bounded = (v, most) => Math.min(most - 1, Math.max(0, v));
    const layer = x.invert(event.clientX - r.left) + 0.5,
      angle = y.invert(event.clientY - r.top) + 0.5;
    return cells.at(
      index,
      bounded(Math.floor(layer / cells.layers_each), cells.columns),
      bounded(Math.floor(angle / cells.angles_each), cells.rows),
    );
  }
  /** Where a row of a path or a pose is in a panel, in cells from below; NaN: in another panel. */
  height(panel, row) {
    if (panel.rolls) return this.cells.place(row.roll);
    return row.sheet === panel.sheet ? row.angle : NaN;
  }
  /**
   * Where the cursor is in a panel: between two rows in proportion, the short way round a closed
   * map; beside one that is not in the panel at the other.
   */
  cursorHeight(panel, pose) {
    if (!pose.rows || panel.rolls) return this.height(panel, pose);
    const [a, b, f] = pose.rows,
      from = this.height(panel, a),
      to = this.height(panel, b),
      { closed, angles } = this.cells;
    if (Number.isNaN(from) || Number.isNaN(to)) return f < 0.5 ? from : to;
    const step = to - from,
      turns = closed ? Math.round(step / angles) : 0,
      at = from + f * (step - turns * angles);
    return turns === 0 ? at : (((at + 0.5) % angles) + angles) % angles - 0.5;
  }
  /** vector: cells as rectangles, not as a picture. */
  drawing(panel, width, height, colours, vector = false) {
    const { cells, rows, beside, ended, marks } = this,
      axis = panel.rolls ? 'ρ, deg' : `${cells.letter}, ${unitOf(cells).unit}`;
    const lineOf = (path) =>
      path.flatMap((row, k) => {
        const point = { x: row.layer, y: this.height(panel, row) },
          jump =
            k &&
            cells.closed &&
            Math.abs(this.height(panel, path[k - 1]) - point.y) > cells.angles / 2;
        return jump ? [{ x: row.layer, y: NaN }, point] : [point];
      });
    const path = lineOf(rows),
      before = lineOf(beside);
    const changes = rows.filter(
      (row, k) =>
        !panel.rolls &&
        row.sheet === panel.sheet &&
        [rows[k - 1], rows[k + 1]].some((other) => other && other.sheet !== row.sheet),
    );
    const large = !panel.box.classList.contains('other'),
      frame = {
        marginLeft: 38,
        marginRight: 12,
        marginTop: vector ? 26 : large ? 20 : 6,
        marginBottom: vector || large ? 34 : 20,
      };
    return Plot.plot({
      width,
      height,
      ...frame,
      style: { color: colours.soft, background: 'none', fontSize: '10px' },
      x: {
        domain: [-0.5, cells.layers - 0.5],
        ...alongPath(cells.s, 5),
        label: vector || large ? 's, m' : null,
        labelArrow: 'none',
      },
      y: {
        domain: [-0.5, cells.angles - 0.5],
        label: vector ? `${axis}: ${panel.name}` : large ? axis : null,
        labelArrow: 'none',
        labelAnchor: 'top',
        ticks: marks.map(([place]) => place),
        tickFormat: (_, k) => marks[k][1],
      },
      marks: [
        vector
          ? Plot.rect(this.runs(panel.index, colours), {
              x1: 'x1',
              x2: 'x2',
              y1: 'y1',
              y2: 'y2',
              fill: 'fill',
              shapeRendering: 'crispEdges',
            })
          : this.picture(
              panel.index,
              colours,
              width - frame.marginLeft - frame.marginRight,
              height - frame.marginTop - frame.marginBottom,
            ),
        (_, { x, y }) => this.hatched(panel.index, x, y, colours),
        (_, { x, y }) => this.walls(panel.index, x, y, colours),
        (_, { x, y }) => this.barred(panel, x, y),
        Plot.frame({ stroke: colours.soft, strokeOpacity: 0.5 }),
        ended
          ? Plot.ruleX([rows.at(-1).layer + 0.5], {
              stroke: kLines.nearest,
              strokeWidth: 2,
              strokeDasharray: '5 3',
            })
          : null,
        Plot.line(before, { x: 'x', y: 'y', stroke: '#fff', strokeWidth: 3 }),
        Plot.line(before, {
          x: 'x',
          y: 'y',
          stroke: '#000',
          strokeWidth: 1.2,
          strokeDasharray: '4 3',
        }),
        Plot.line(path, { x: 'x', y: 'y', stroke: '#fff', strokeWidth: 4.5 }),
        Plot.line(path, { x: 'x', y: 'y', stroke: '#000', strokeWidth: 1.8 }),
        Plot.dot(changes, { x: 'layer', y: 'angle', r: 5, fill: '#000', stroke: '#fff' }),
        rows.length === 1 && !Number.isNaN(this.height(panel, rows[0]))
          ? Plot.dot(rows, {
              x: 'layer',
              y: (row) => this.height(panel, row),
              r: 4,
              fill: '#000',
              stroke: '#fff',
            })
          : null,
      ],
    });
  }
  /** One pixel a cell. */
  picture(panel, colours, width, height) {
    const { cells } = this,
      canvas = document.createElement('canvas'),
      known = new Map();
    canvas.width = cells.columns;
    canvas.height = cells.rows;
    const pen = canvas.getContext('2d', { willReadFrequently: true }),
      image = pen.createImageData(cells.columns, cells.rows),
      pixels = new Uint32Array(image.data.buffer);
    const pixel = (k) => {
      const kind = cells.kind(k);
      if (!known.has(kind)) {
        const [r, g, b] = cells
          .colour(k, colours)
          .match(/[0-9a-f]{2}/g)
          .map((part) => parseInt(part, 16));
        known.set(kind, (255 << 24) | (b << 16) | (g << 8) | r);
      }
      return known.get(kind);
    };
    for (let column = 0; column < cells.columns; ++column)
      for (let row = 0; row < cells.rows; ++row)
        pixels[(cells.rows - 1 - row) * cells.columns + column] = pixel(
          cells.index(panel, column, row),
        );
    pen.putImageData(image, 0, 0);
    // The last column and row may stand for fewer layers and angles than the others.
    const layers = cells.columns * cells.layers_each,
      angles = cells.rows * cells.angles_each;
    return Plot.image([canvas.toDataURL()], {
      src: (url) => url,
      x: () => (layers - 1) / 2,
      y: () => (angles - 1) / 2,
      width: (width * layers) / cells.layers,
      height: (height * angles) / cells.angles,
      preserveAspectRatio: 'none',
      imageRendering: 'pixelated',
      clip: 'frame',
    });
  }
  /** Cells alike, side by side along s, as one rectangle. */
  runs(panel, colours) {
    const { cells, edge } = this,
      runs = [];
    for (let row = 0; row < cells.rows; ++row)
      for (let column = 0, end; column < cells.columns; column = end) {
        const k = cells.index(panel, column, row);
        for (
          end = column + 1;
          end < cells.columns && cells.kind(cells.index(panel, end, row)) === cells.kind(k);
        )
          ++end;
        const fill = cells.colour(k, colours);
        if (fill === colours.nothing) continue;
        runs.push({
          fill,
          x1: edge(column, cells.layers_each, cells.layers),
          x2: edge(end, cells.layers_each, cells.layers),
          y1: edge(row, cells.angles_each, cells.angles),
          y2: edge(row + 1, cells.angles_each, cells.angles),
        });
      }
    return runs;
  }
  /** Where a cell's edge is, in layers or angles. */
  edge(cell, each, most) {
    return Math.min(cell * each, most) - 0.5;
  }
  /** Hatching over the cells beyond a joint limit. */
  hatched(panel, x, y, colours) {
    const { cells, edge } = this,
      { pattern, fill } = hatching(colours.hatch),
      group = element('g', {});
    let d = '';
    for (let row = 0; row < cells.rows; ++row)
      for (let column = 0, end; column < cells.columns; column = end) {
        const is = (c) => cells.state(cells.index(panel, c, row)) === LIMIT;
        for (end = column + 1; end < cells.columns && is(end) === is(column);) ++end;
        if (!is(column)) continue;
        const at = (c) => x(edge(c, cells.layers_each, cells.layers)).toFixed(1),
          up = (r) => y(edge(r, cells.angles_each, cells.angles)).toFixed(1);
        d += `M${at(column)},${up(row)}H${at(end)}V${up(row + 1)}H${at(column)}Z`;
      }
    if (d) group.append(pattern, element('path', { d, fill }));
    return group;
  }
  /**
   * Lines between cells of little contrast, and between cells that have the same colour but another
   * cause: limits of two joints, two bodies before one object.
   */
  walls(panel, x, y, colours) {
    const { cells, edge } = this,
      lines = new Map(),
      known = new Map();
    /** The colour of the line between two cells, or null. */
    const line = (k, other) => {
      const [a, b] = [cells.kind(k), cells.kind(other)];
      if (a === b) return null;
      const key = a * 65536 + b;
      if (!known.has(key)) {
        const limits = [k, other].filter((cell) => cells.state(cell) === LIMIT).length,
          [one, two] = [k, other].map((cell) => cells.colour(cell, colours));
        // Hatching parts a limit from all else.
        known.set(key, limits === 1 ? null : lineBetween(one, two));
      }
      return known.get(key);
    };
    const add = (colour, d) => lines.set(colour, (lines.get(colour) ?? '') + d);
    const at = (c) => x(edge(c, cells.layers_each, cells.layers)).toFixed(1),
      up = (r) => y(edge(r, cells.angles_each, cells.angles)).toFixed(1);
    for (let column = 0; column < cells.columns; ++column)
      for (let row = 0; row < cells.rows; ++row) {
        const k = cells.index(panel, column, row),
          left = column && line(k, cells.index(panel, column - 1, row)),
          below = row && line(k, cells.index(panel, column, row - 1));
        if (left) add(left, `M${at(column)},${up(row)}V${up(row + 1)}`);
        if (below) add(below, `M${at(column)},${up(row)}H${at(column + 1)}`);
      }
    const group = element('g', { fill: 'none', 'stroke-width': 0.8 });
    for (const [stroke, d] of lines) group.append(element('path', { d, stroke }));
    return group;
  }
  /** The cells of the region in which the arm bars the other one. */
  barred(panel, x, y) {
    const group = element('g', {}),
      { pattern, fill } = hatching(kLines.nearest),
      runs = panel.rolls ? [] : (this.region?.runs ?? []);
    if (runs.some(({ sheet }) => sheet === panel.sheet)) group.append(pattern);
    for (const { layer, sheet, from, to } of runs) {
      if (sheet !== panel.sheet) continue;
      const middle = x(layer),
        width = Math.max(kRegionLeast, x(layer + 0.5) - x(layer - 0.5)),
        box = {
          x: (middle - width / 2).toFixed(1),
          y: y(to + 0.5).toFixed(1),
          width: width.toFixed(1),
          height: (y(from - 0.5) - y(to + 0.5)).toFixed(1),
        };
      group.append(
        element('rect', { ...box, fill: '#fff', stroke: '#fff', 'stroke-width': 3.5 }),
        element('rect', { ...box, fill, stroke: kLines.nearest, 'stroke-width': 1.4 }),
      );
    }
    return group;
  }
  /** How much of a panel is what, in words. */
  share({ index }) {
    const { cells } = this,
      count = new Map();
    for (let column = 0; column < cells.columns; ++column)
      for (let row = 0; row < cells.rows; ++row) {
        const group = cells.group(cells.index(index, column, row));
        count.set(group, (count.get(group) ?? 0) + 1);
      }
    return [...count]
      .sort((a, b) => b[1] - a[1])
      .map(([group, n]) => `${((100 * n) / (cells.columns * cells.rows)).toFixed(0)} % ${group}`)
      .join(', ');
  }
  /** Everything anew: at the start, and when the theme or the width changes. */
  paint() {
    const colours = { soft: style('--soft'), ...(isDark() ? kDark : kLight) };
    for (const panel of this.panels) {
      const drawing = this.drawing(
        panel,
        panel.chart.clientWidth,
        panel.box.classList.contains('other') ? 92 : 236,
        colours,
      );
      Object.assign(panel, { x: drawing.scale('x'), y: drawing.scale('y') });
      const name = `${this.label && `${this.label}, `}${panel.name}`;
      show(panel.chart, drawing, `Map of ${name}: ${this.share(panel)}`);
    }
    this.draw(this.pose);
  }
  /** The cursor alone, which moves with every frame: to a pose, or none. */
  draw(here) {
    this.pose = here;
    for (const panel of this.panels) {
      const { line, dot, x, y } = panel;
      line.hidden = !here;
      const height = here ? this.cursorHeight(panel, here) : NaN;
      dot.hidden = Number.isNaN(height);
      if (!here) continue;
      const left = x.apply(here.layer).toFixed(1);
      line.style.transform = `translateX(${left}px)`;
      if (!dot.hidden) {
        const top = y.apply(height).toFixed(1);
        dot.style.transform = `translate(${left}px, ${top}px)`;
      }
    }
  }
  /** The map as one drawing for papers. */
  figure() {
    const drawings = this.panels.map((panel) => this.drawing(panel, 640, 240, PAPER, true));
    return sheet([...drawings, this.legendDrawing()]);
  }
  legendDrawing() {
    const entries = this.cells.legend(PAPER),
      { pattern, fill } = hatching(PAPER.hatch),
      box = { x1: 0.045, x2: 0.065, y1: (_, k) => k + 0.15, y2: (_, k) => k + 0.75 };
    return Plot.plot({
      width: 640,
      height: 18 * entries.length + 12,
      margin: 6,
      axis: null,
      style: { color: PAPER.ink, background: 'none', fontSize: '11px' },
      x: { domain: [0, 1] },
      y: { domain: [entries.length, 0] },
      marks: [
        () => pattern,
        Plot.rect(entries, { ...box, fill: 'colour', stroke: '#999', strokeWidth: 0.5 }),
        Plot.rect(entries, { ...box, fill: ({ hatched }) => (hatched ? fill : 'none') }),
        Plot.text(entries, { x: 0.08, y: (_, k) => k + 0.45, text: words, textAnchor: 'start' }),
      ],
    });
  }
}
