// SPDX-License-Identifier: BSD-3-Clause
// Small line plots over the layers of the path or over time, drawn once, with a cursor above.
import * as Plot from '@observablehq/plot';
import { alongPath } from './axis.js';
import { PAPER, sheet } from './figure.js';
import { number, show, style, tell } from './page.js';
import { FAILED } from './palette.js';

const kHeight = 112;

export class Plots {
  /**
   * s: of each row, along an axis named `axis`; series: { title, unit, values (one a row, null
   * where unknown), low, high (bounds, or null), from0: the axis begins at 0, of: its value at a
   * pose, null where unknown }, or with lines: [{ name, values }], of which one is `bold`, instead
   * of values; seek: called with the row, not always a whole number, that the user points at.
   */
  constructor(host, s, series, seek, axis = 's, m') {
    Object.assign(this, { host, s, axis });
    this.plots = series.map((one) => {
      const box = document.createElement('div');
      box.className = 'plot';
      box.innerHTML =
        '<h3><span></span><b></b></h3><div class="stack"><div class="chart"></div>' +
        '<div class="cursor"></div><div class="dot" hidden></div></div>';
      box.querySelector('span').textContent = `${one.title}, ${one.unit}`;
      host.append(box);
      const told = (k) =>
        one.lines
          ? one.lines.map(({ name, values }) => `${name}  ${text(values[k])}`).join('\n')
          : `${one.title}  ${text(one.values[k])} ${one.unit}`;
      const plot = {
        ...one,
        told,
        chart: box.querySelector('.chart'),
        value: box.querySelector('b'),
        line: box.querySelector('.cursor'),
        dot: box.querySelector('.dot'),
      };
      const move = (event) => {
        const at = plot.x.invert(event.clientX - plot.chart.getBoundingClientRect().left);
        if (event.type !== 'pointermove' || event.buttons) seek(at);
        const k = Math.min(s.length - 1, Math.max(0, Math.round(at)));
        tell(`${axis.replace(', ', ' ')}: ${number(s[k])}\n${plot.told(k)}`, event);
      };
      plot.chart.addEventListener('pointerleave', () => tell(null));
      plot.chart.addEventListener('pointerdown', move);
      plot.chart.addEventListener('pointermove', move);
      return plot;
    });
  }
  drawing(
    { title, unit, values, lines, bold, low, high, from0 },
    width,
    height,
    colours,
    label = null,
  ) {
    const bounds = [low, high].filter((v) => v !== null),
      last = Math.max(1, this.s.length - 1);
    const all = lines ?? [{ name: title, values }],
      known = all.flatMap((line) =>
        line.values.map((v, k) => ({ k, v })).filter(({ v }) => v !== null),
      ),
      dot = known.length === all.length;
    return Plot.plot({
      width,
      height,
      marginLeft: 46,
      marginRight: 12,
      marginTop: label === null ? 8 : 26,
      marginBottom: label === null ? 20 : 34,
      style: { color: colours.soft, background: 'none', fontSize: '10px' },
      x: { domain: [0, last], ...alongPath(this.s, 4), label },
      y: {
        nice: true,
        ticks: 4,
        label: label === null ? null : `${title}, ${unit}`,
        labelArrow: 'none',
        domain: extent([...known.map(({ v }) => v), ...bounds, ...(from0 ? [0] : [])]),
      },
      marks: [
        Plot.frame({ stroke: colours.soft, strokeOpacity: 0.35 }),
        Plot.ruleY(bounds, { stroke: FAILED, strokeDasharray: '6 4' }),
        dot
          ? Plot.dot(known, { x: 'k', y: 'v', fill: colours.accent })
          : all.map((line, i) =>
              Plot.lineY(line.values, {
                x: (_, k) => k,
                y: (v) => v ?? NaN,
                stroke: lines && i !== bold ? colours.soft : colours.accent,
                strokeWidth: lines && i !== bold ? 0.9 : 1.8,
                strokeOpacity: lines && i !== bold ? 0.7 : 1,
              }),
            ),
      ],
    });
  }
  /** A plot in words. */
  name({ title, unit, values, lines, bold }) {
    const known = (lines ? lines[bold].values : values).filter((v) => v !== null);
    return known.length
      ? `${title}, ${unit}, along ${this.axis}: ${text(Math.min(...known))} to ` +
          text(Math.max(...known))
      : `${title}, ${unit}`;
  }
  /** Everything anew: at the start, and when the theme or the width changes. */
  paint() {
    const colours = { soft: style('--soft'), accent: style('--accent') };
    const width = this.plots.length ? this.plots[0].chart.clientWidth : 0;
    for (const plot of this.plots) {
      const drawing = this.drawing(plot, width, kHeight, colours);
      Object.assign(plot, { x: drawing.scale('x'), y: drawing.scale('y') });
      show(plot.chart, drawing, this.name(plot));
    }
    this.draw(this.cursor === undefined ? 0 : this.cursor, this.pose);
  }
  /**
   * The cursor and the values at it, which move with every frame. cursor: a row, or null beyond the
   * last; pose: the one that is shown, whose values are told instead of the nearest row's; a pose
   * off the path (`off`) has a dot of its own.
   */
  draw(cursor, pose = null) {
    Object.assign(this, { cursor, pose });
    for (const { values, lines, bold, of, value, line, dot, x, y } of this.plots) {
      line.hidden = cursor === null;
      const left = cursor === null ? 0 : x.apply(cursor),
        v = pose && of ? of(pose) : (lines ? lines[bold].values : values)[Math.round(cursor)];
      line.style.transform = `translateX(${left.toFixed(1)}px)`;
      const here = text(v, pose?.off ? 3 : 4),
        up = pose?.off && cursor !== null && v !== null && v !== undefined ? y.apply(v) : NaN;
      if (value.textContent !== here) value.textContent = here;
      dot.hidden = !(up >= 0 && up <= kHeight);
      if (!dot.hidden) dot.style.transform = `translate(${left.toFixed(1)}px, ${up.toFixed(1)}px)`;
    }
  }
  /** All plots as one drawing for papers. */
  figure() {
    return sheet(this.plots.map((plot) => this.drawing(plot, 640, 170, PAPER, this.axis)));
  }
}

const text = (v, digits = 4) => (v === null || v === undefined ? '–' : v.toPrecision(digits));

/** A little wider than the values, and never empty. */
function extent(values) {
  const least = Math.min(...values),
    most = Math.max(...values);
  return most > least ? [least, most] : [least - 1, most + 1];
}
