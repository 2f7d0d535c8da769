// SPDX-License-Identifier: BSD-3-Clause
// The strip under the slider of a job: a section for each stroke and transition, and where the
// process is on.
import { $ } from './page.js';

export class Strip {
  /**
   * sections: { from, to, title, name (shown, '' for a transition) } along the slider; process:
   * [from, to] of where the process is on; end: where the slider ends; pick: called with the number
   * of a section.
   */
  constructor(sections, process, end, pick) {
    this.end = end || 1;
    this.buttons = sections.map(({ from, to, title, name }, k) => {
      const button = this.lay(document.createElement('button'), from, to);
      Object.assign(button, { title, textContent: name, className: name ? 'stroke' : 'move' });
      button.setAttribute('aria-label', title);
      button.addEventListener('click', () => pick(k));
      return button;
    });
    const bands = process.map(([from, to]) => this.lay(document.createElement('i'), from, to));
    $('strip').replaceChildren(...this.buttons, ...bands);
  }
  lay(element, from, to) {
    element.style.left = `${(100 * from) / this.end}%`;
    element.style.width = `${(100 * (to - from)) / this.end}%`;
    return element;
  }
  /** Marks the section in which the cursor stands; -1: none. */
  mark(k) {
    this.buttons.forEach((button, at) => button.setAttribute('aria-current', at === k));
  }
}
