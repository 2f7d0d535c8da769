// SPDX-License-Identifier: BSD-3-Clause
// The table of a campaign's episodes: sorted by a click on a column's head; a click, or Enter, on a
// row picks it.
import { $, number } from './page.js';

const kColumns = [
  ['episode', 'episode'],
  ['status', 'verdict'],
  ['cost', 'cost'],
  ['plan_ms', 'plan, ms'],
  ['nodes_checked', 'nodes checked'],
  ['fcl_calls', 'FCL calls'],
  ['error_mm', 'error, mm'],
  ['failed_s', 'ends at s, m'],
  ['reason', 'ended by'],
];
const kMost = 2000; // rows that a browser lays out in a moment

export class EpisodeTable {
  constructor(host, rows, pick) {
    Object.assign(this, {
      rows,
      pick,
      key: 'episode',
      falling: false,
      body: host.querySelector('tbody'),
      lines: new Map(),
    });
    const head = host.querySelector('thead tr');
    this.heads = kColumns.map(([key, name]) => {
      const cell = document.createElement('th'),
        button = document.createElement('button');
      button.textContent = name;
      button.addEventListener('click', () => {
        this.falling = key === this.key && !this.falling;
        this.key = key;
        this.fill();
      });
      cell.append(button);
      head.append(cell);
      return { key, cell };
    });
    $('failed').addEventListener('change', () => this.fill());
    this.fill();
  }
  fill() {
    const before = (a, b) => {
      const x = a[this.key],
        y = b[this.key];
      // What is not known comes last.
      if (x === null || y === null) return (x === null) - (y === null);
      return (typeof x === 'string' ? x.localeCompare(y) : x - y) * (this.falling ? -1 : 1);
    };
    const wanted = this.rows
      .filter((row) => !$('failed').checked || row.status !== 'solved')
      .sort((a, b) => before(a, b) || a.episode - b.episode);
    this.lines.clear();
    this.body.replaceChildren(...wanted.slice(0, kMost).map((row) => this.line(row)));
    $('shown').textContent =
      wanted.length > kMost
        ? `the first ${kMost} of ${wanted.length} in this order`
        : `${wanted.length} rows`;
    for (const { key, cell } of this.heads) {
      if (key === this.key)
        cell.setAttribute('aria-sort', this.falling ? 'descending' : 'ascending');
      else cell.removeAttribute('aria-sort');
    }
    if (this.marked) this.mark(this.marked);
  }
  line(row) {
    const line = document.createElement('tr');
    line.tabIndex = 0;
    line.className = row.status;
    for (const [key] of kColumns)
      line.insertCell().textContent =
        typeof row[key] === 'number'
          ? number(row[key], key === 'episode' ? 12 : 5)
          : row[key] || '–';
    line.addEventListener('click', () => this.pick(row));
    line.addEventListener('keydown', (event) => event.key === 'Enter' && this.pick(row));
    this.lines.set(row.episode, line);
    return line;
  }
  mark(row) {
    this.lines.get(this.marked?.episode)?.classList.remove('marked');
    this.marked = row;
    this.lines.get(row.episode)?.classList.add('marked');
  }
}
