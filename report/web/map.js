// SPDX-License-Identifier: BSD-3-Clause
// The (s, phi) map: a panel for each branch, a pixel for each cell, the path above.
import { bytes } from './scene.js';

// States in the order of report/lattice_map.hpp. Okabe & Ito's palette, told apart by all kinds of colour vision.
const [NO_IK, SINGULAR, LIMIT, UNSEEN, FREE, BLOCKED] = [0, 1, 2, 3, 4, 5];
const JOINTS = ['#cfe8f7', '#b3daf2', '#97cced', '#7bbee8', '#5fb0e2', '#4a9bd0', '#3a83b5'];
const BLOCKERS = ['#d55e00', '#a34700', '#e69f00', '#8c2d04', '#f0902f', '#5e2400'];

export class LatticeMap {
  constructor(data, hover, pick) {
    const map = data.map;
    Object.assign(this, { data, map, hover, pick, cursor: 0 });
    this.states = new Uint8Array(bytes(map.states));
    this.causes = new Uint8Array(bytes(map.causes));
    this.joints = new Int16Array(bytes(map.joints));
    this.start = new Int32Array(this.states.length);  // where a cell's joints begin, -1: none
    let next = 0;
    this.states.forEach((state, k) => {
      this.start[k] = state & 128 ? next : -1;
      if (state & 128) next += 7;
    });
    const host = document.getElementById('map');
    this.panels = map.panels.map((panel, index) => {
      const box = document.createElement('div');
      box.className = 'panel';
      box.innerHTML = '<h3></h3><div class="stack"><canvas></canvas><div class="cursor"></div><div class="dot" hidden></div></div>';
      box.firstChild.textContent = panel.name;
      host.append(box);
      const canvas = box.querySelector('canvas');
      const at = (event) => {
        const r = canvas.getBoundingClientRect();
        const column = Math.min(map.columns - 1, Math.max(0, Math.floor(((event.clientX - r.left) / r.width) * map.columns)));
        const row = Math.min(map.rows - 1, Math.max(0, Math.floor((1 - (event.clientY - r.top) / r.height) * map.rows)));
        return this.cell(index, column, row);
      };
      let under = null;  // a click's coordinates are rounded, and could mean the neighbour of the cell that is shown
      for (const kind of ['pointerdown', 'pointermove']) canvas.addEventListener(kind, (event) => this.hover((under = at(event)), event));
      canvas.addEventListener('pointerleave', (event) => this.hover(null, event));
      canvas.addEventListener('click', () => this.pick(under));
      return { ...panel, canvas, box, line: box.querySelector('.cursor'), dot: box.querySelector('.dot') };
    });
    // The panels that hold the path come first.
    const used = new Set(data.rows.map((row) => row.label));
    [...this.panels].sort((a, b) => used.has(b.label) - used.has(a.label)).forEach((p) => host.append(p.box));
  }
  index(panel, column, row) { return (column * this.panels.length + panel) * this.map.rows + row; }
  cell(panel, column, row) {
    const { map } = this, k = this.index(panel, column, row), state = this.states[k] & 127, cause = this.causes[k];
    const layer = Math.min(map.layers - 1, column * map.layers_each);
    const q = this.start[k] < 0 ? null : Array.from(this.joints.subarray(this.start[k], this.start[k] + 7), (v) => v * map.joint_unit);
    const phi = -Math.PI + (2 * Math.PI * row * map.angles_each) / map.angles;
    return { layer, s: map.s[layer], phi, state, what: this.name(state, cause), q, branch: map.panels[panel].name, blocker: state === BLOCKED ? map.blockers[cause] : null };
  }
  /** A blocked cell that the furthest pose could move to, or any blocked one of that layer. */
  blockedAt(layer, label, angle) {
    const { map } = this, column = Math.min(map.columns - 1, Math.floor(layer / map.layers_each)), row = Math.floor(angle / map.angles_each);
    let best = null, least = Infinity;
    this.panels.forEach((panel, p) => {
      for (let r = 0; r < map.rows; ++r) {
        const k = this.index(p, column, r);
        if ((this.states[k] & 127) !== BLOCKED || this.start[k] < 0) continue;
        const away = Math.abs(r - row), far = Math.min(away, map.rows - away) + (panel.label === label ? 0 : 1000);
        if (far < least) [least, best] = [far, this.cell(p, column, r)];
      }
    });
    return best;
  }
  name(state, cause) {
    if (state === LIMIT) return 'limit of ' + this.data.chain.joints[cause].name;
    if (state === BLOCKED) return 'blocked by ' + this.map.blockers[cause];
    return { [NO_IK]: 'no node (out of reach, or beside the given start)', [SINGULAR]: 'singular', [UNSEEN]: 'not looked at', [FREE]: 'asked, free' }[state];
  }
  colour(state, cause, style) {
    if (state === LIMIT) return JOINTS[cause];
    if (state === BLOCKED) return BLOCKERS[cause % BLOCKERS.length];
    return { [NO_IK]: style.getPropertyValue('--void').trim(), [SINGULAR]: '#cc79a7', [UNSEEN]: style.getPropertyValue('--unseen').trim(), [FREE]: '#009e73' }[state];
  }
  /** Everything anew: at the start, and when the theme or the size changes. */
  paint() {
    const { map } = this, style = getComputedStyle(document.documentElement), seen = new Map();
    const ratio = Math.min(2, devicePixelRatio);
    this.panels.forEach((panel, p) => {
      const cells = document.createElement('canvas');
      cells.width = map.columns;
      cells.height = map.rows;
      const pen = cells.getContext('2d');
      for (let column = 0; column < map.columns; ++column)
        for (let row = 0; row < map.rows; ++row) {
          const k = this.index(p, column, row), state = this.states[k] & 127, colour = this.colour(state, this.causes[k], style);
          seen.set(this.name(state, this.causes[k]), [colour, state]);
          pen.fillStyle = colour;
          pen.fillRect(column, map.rows - 1 - row, 1, 1);
        }
      panel.canvas.width = panel.canvas.clientWidth * ratio;
      panel.canvas.height = panel.canvas.clientHeight * ratio;
      panel.cells = cells;
    });
    const legend = document.getElementById('legend');
    legend.replaceChildren(...[...seen].sort((a, b) => b[1][1] - a[1][1]).map(([name, [colour]]) => {
      const entry = document.createElement('span'), swatch = document.createElement('i');
      swatch.style.background = colour;
      entry.append(swatch, name);
      return entry;
    }));
    this.drawPath();
    this.draw(this.cursor);
  }
  /** The cursor alone, which moves with every frame. */
  draw(cursor) {
    this.cursor = cursor;
    const { map } = this, here = this.data.rows[Math.round(cursor)];
    for (const { line, dot, label } of this.panels) {
      line.hidden = !here;
      if (!here) continue;
      line.style.left = dot.style.left = `${(100 * (here.layer + 0.5)) / map.layers}%`;
      dot.style.top = `${100 * (1 - (here.angle + 0.5) / map.angles)}%`;
      dot.hidden = here.label !== label;
    }
  }
  drawPath() {
    const { map } = this, rows = this.data.rows;
    for (const panel of this.panels) {
      const { canvas, cells, label } = panel, pen = canvas.getContext('2d'), { width, height } = canvas;
      pen.imageSmoothingEnabled = false;
      pen.drawImage(cells, 0, 0, width, height);
      const x = (layer) => ((layer + 0.5) / map.layers) * width, y = (angle) => (1 - (angle + 0.5) / map.angles) * height;
      const stroke = (colour, thickness) => {
        pen.strokeStyle = colour;
        pen.lineWidth = thickness;
        pen.beginPath();
        rows.forEach((row, k) => {
          const last = rows[k - 1];
          if (row.label !== label) return;
          const joined = last && last.label === label && Math.abs(last.angle - row.angle) < map.angles / 2;
          pen[joined ? 'lineTo' : 'moveTo'](x(row.layer), y(row.angle));
        });
        pen.stroke();
      };
      stroke('#fff', 5);
      stroke('#000', 2.2);
      const dot = (row, colour, radius) => {
        pen.beginPath();
        pen.arc(x(row.layer), y(row.angle), radius, 0, 7);
        pen.fillStyle = colour;
        pen.fill();
        pen.strokeStyle = '#fff';
        pen.lineWidth = 1.5;
        pen.stroke();
      };
      rows.forEach((row, k) => {
        const changes = (other) => other && other.label !== row.label;
        if (row.label === label && (changes(rows[k - 1]) || changes(rows[k + 1]))) dot(row, '#cc79a7', 6);
      });
    }
  }
}
