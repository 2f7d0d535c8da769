// SPDX-License-Identifier: BSD-3-Clause
// What the pages share: their data, numbers, light and dark, tables.
export const { data } = window.swivelPage; // starter.js
export const $ = (id) => document.getElementById(id);
/** A number with so many digits that count; whole numbers have all of theirs. */
export const number = (v, digits = 4) =>
  v === null || v === undefined
    ? '–'
    : (Number.isInteger(v) ? v : Number(v.toPrecision(digits))).toString();
export const isDark = () => document.documentElement.dataset.theme === 'dark';
export const style = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/**
 * Follows the system at first; the button and the key t change it. On paper all is light, and as
 * wide as a sheet (class paper): `changed` draws it anew, before printing and after.
 */
export function themes(changed) {
  const page = document.documentElement;
  measureHeader();
  const set = (dark) => {
    page.dataset.theme = dark ? 'dark' : 'light';
    changed();
  };
  const turn = () => set(!isDark());
  $('theme').addEventListener('click', turn);
  let before = false;
  addEventListener('beforeprint', () => {
    before = isDark();
    page.classList.add('paper');
    for (const folded of document.querySelectorAll('details')) folded.open = true;
    set(false);
  });
  addEventListener('afterprint', () => {
    page.classList.remove('paper');
    set(before);
  });
  set(matchMedia('(prefers-color-scheme: dark)').matches);
  return turn;
}

/** Leaves to view and map the height that the header does not take (page.css). */
function measureHeader() {
  const { offsetHeight } = document.querySelector('header');
  document.documentElement.style.setProperty('--head', `${offsetHeight}px`);
}

/** A note beside the pointer, or none for a text of null. */
export function tell(text, event) {
  const tip = $('tip');
  tip.hidden = text === null;
  if (tip.hidden) return;
  tip.textContent = text;
  tip.style.left = `${Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 8)}px`;
  const lowest = innerHeight - tip.offsetHeight - 8;
  tip.style.top = `${Math.max(4, Math.min(event.clientY + 14, lowest))}px`;
}

/** Puts the slider to a value, which `words` tell those who do not see it. */
export function slideTo(value, words) {
  $('slider').value = value;
  $('slider').setAttribute('aria-valuetext', words);
}

/** Shows a drawing in its place, which is named as a whole. role: of the place. */
export function show(host, drawing, name, role = 'img') {
  drawing.setAttribute('aria-hidden', 'true');
  host.setAttribute('role', role);
  host.setAttribute('aria-label', name);
  host.replaceChildren(drawing);
}

/** Calls back when the window's width has changed and come to rest. */
export function whenResized(changed) {
  let width = innerWidth,
    timer;
  addEventListener('resize', () => {
    clearTimeout(timer);
    timer = setTimeout(() => {
      if (innerWidth !== width) {
        measureHeader();
        changed();
      }
      width = innerWidth;
    }, 100);
  });
}

export function table(host, caption, entries) {
  const table = document.createElement('table');
  table.createCaption().textContent = caption;
  for (const [name, value] of entries) {
    const row = table.insertRow();
    row.insertCell().textContent = name;
    row.insertCell().textContent = value;
  }
  host.append(table);
}
