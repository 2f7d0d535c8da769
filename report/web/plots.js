// SPDX-License-Identifier: BSD-3-Clause
// Small line plots over s, drawn once with a cursor above, and exported as SVG.
export class Plots {
  /** series: { title, unit, values (one a row, null where unknown), low, high (bounds drawn and labelled, or null) } */
  constructor(host, s, series, seek) {
    this.s = s;
    this.plots = series.map((one) => {
      const box = document.createElement('div');
      box.className = 'plot';
      box.innerHTML = '<h3><span></span><b></b></h3><div class="stack"><canvas></canvas><div class="cursor"></div></div>';
      box.querySelector('span').textContent = `${one.title}, ${one.unit}`;
      host.append(box);
      const canvas = box.querySelector('canvas');
      const move = (event) => {
        if (event.type === 'pointermove' && !event.buttons) return;
        const r = canvas.getBoundingClientRect();
        seek(((event.clientX - r.left) / r.width) * (this.s.length - 1));
      };
      canvas.addEventListener('pointerdown', move);
      canvas.addEventListener('pointermove', move);
      const known = one.values.filter((v) => v !== null);
      let least = Math.min(...known, one.low ?? Infinity), most = Math.max(...known, one.high ?? -Infinity);
      if (!(most > least)) [least, most] = [least - 1, most + 1];
      const room = 0.06 * (most - least);
      return { ...one, canvas, value: box.querySelector('b'), line: box.querySelector('.cursor'), least: least - room, most: most + room };
    });
  }
  paint() {
    for (const plot of this.plots) {
      plot.canvas.width = plot.canvas.clientWidth * Math.min(2, devicePixelRatio);
      plot.canvas.height = plot.canvas.clientHeight * Math.min(2, devicePixelRatio);
    }
    this.drawLines();
    this.draw(this.cursor ?? 0);
  }
  /** The cursor and the values at it, which move with every frame. */
  draw(cursor) {
    this.cursor = cursor;
    for (const { values, value, line } of this.plots) {
      line.style.left = `${(100 * cursor) / Math.max(1, values.length - 1)}%`;
      const here = values[Math.round(cursor)];
      value.textContent = here === null || here === undefined ? '–' : here.toPrecision(4);
    }
  }
  drawLines() {
    const style = getComputedStyle(document.documentElement), colour = (name) => style.getPropertyValue(name).trim();
    const accent = colour('--accent'), line = colour('--line');
    for (const plot of this.plots) {
      const { canvas, values, least, most } = plot, pen = canvas.getContext('2d'), { width, height } = canvas;
      const x = (k) => (k / Math.max(1, values.length - 1)) * width, y = (v) => height * (1 - (v - least) / (most - least));
      pen.clearRect(0, 0, width, height);
      pen.strokeStyle = line;
      pen.strokeRect(0.5, 0.5, width - 1, height - 1);
      pen.strokeStyle = '#d55e00';
      pen.setLineDash([6, 4]);
      for (const bound of [plot.low, plot.high])
        if (bound !== null) {
          pen.beginPath();
          pen.moveTo(0, y(bound));
          pen.lineTo(width, y(bound));
          pen.stroke();
        }
      pen.setLineDash([]);
      pen.strokeStyle = accent;
      pen.lineWidth = 2;
      pen.beginPath();
      values.forEach((v, k) => v !== null && pen[k === 0 || values[k - 1] === null ? 'moveTo' : 'lineTo'](x(k), y(v)));
      pen.stroke();
    }
  }
  /** One SVG drawing of all plots, for papers. */
  svg() {
    const width = 640, each = 110, top = 22;
    const body = this.plots.map((plot, n) => {
      const x = (k) => 40 + (k / Math.max(1, plot.values.length - 1)) * (width - 60), y = (v) => n * (each + 30) + top + each * (1 - (v - plot.least) / (plot.most - plot.least));
      const points = plot.values.map((v, k) => (v === null ? '' : `${x(k).toFixed(2)},${y(v).toFixed(2)}`)).join(' ');
      const bounds = [plot.low, plot.high].filter((v) => v !== null).map((v) => `<line x1="40" x2="${width - 20}" y1="${y(v).toFixed(2)}" y2="${y(v).toFixed(2)}" stroke="#d55e00" stroke-dasharray="6 4"/>`).join('');
      return `<text x="40" y="${n * (each + 30) + 16}">${plot.title}, ${plot.unit} (${plot.least.toPrecision(3)} to ${plot.most.toPrecision(3)})</text><rect x="40" y="${n * (each + 30) + top}" width="${width - 60}" height="${each}" fill="none" stroke="#999"/>${bounds}<polyline fill="none" stroke="#0072b2" stroke-width="1.5" points="${points}"/>`;
    });
    const height = this.plots.length * (each + 30) + 20;
    return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" font-family="sans-serif" font-size="11"><rect width="${width}" height="${height}" fill="#fff"/>${body.join('')}<text x="${width / 2}" y="${height - 6}" text-anchor="middle">s, 0 to ${this.s.at(-1).toFixed(3)} m, by layer</text></svg>`;
  }
}
