// SPDX-License-Identifier: BSD-3-Clause
// Slanted lines over areas of drawings.
const kSvg = 'http://www.w3.org/2000/svg';

/** An element of SVG. */
export function element(name, attributes) {
  const made = document.createElementNS(kSvg, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}
let patterns = 0;
/** A pattern of slanted lines, and what fills an area with it. */
export function hatching(colour) {
  const id = `hatch-${++patterns}`,
    pattern = element('pattern', {
      id,
      width: 5,
      height: 5,
      patternUnits: 'userSpaceOnUse',
      patternTransform: 'rotate(45)',
    });
  pattern.append(element('rect', { width: 1.2, height: 5, fill: colour }));
  return { pattern, fill: `url(#${id})` };
}
/** The background of an element of HTML that is hatched like that. */
export const hatchedBy = (colour, lines) =>
  `repeating-linear-gradient(-45deg, ${colour} 0 3px, ${lines} 3px 4px)`;
