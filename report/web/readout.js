// SPDX-License-Identifier: BSD-3-Clause
// The numbers of the pose that is shown, with a gauge for each joint's range.
import { shownOf } from './poses.js';

export const kNear = 1; // degrees, or mm of a slide, from a limit: a joint is told apart

function line(className, ...parts) {
  const element = Object.assign(document.createElement('div'), { className });
  element.append(...parts, '\n');
  return element;
}
const span = (text) => Object.assign(document.createElement('span'), { textContent: text });

/** How many characters all names begin with. */
function commonLength(names) {
  let k = 0;
  while (names.length > 1 && names[0][k] && names.every((name) => name[k] === names[0][k])) ++k;
  return k;
}
/**
 * A joint, its angle, rad, or its position, m, and where it is between its limits. common: how
 * many characters of its name all joints share, which are left out where there is no room.
 */
function jointLine({ name, lower, upper, slides }, angle, digits, common) {
  const bounded = lower !== null && upper !== null,
    { scale, unit } = shownOf({ slides }),
    room = bounded ? scale * Math.min(angle - lower, upper - angle) : Infinity;
  const element = line(
    room < kNear ? 'joint near' : 'joint',
    span(name.slice(0, common)),
    span(name.slice(common)),
    '  ',
    span(`${(angle * scale).toFixed(digits)}${unit}`),
  );
  if (bounded) {
    const share = Math.min(1, Math.max(0, (angle - lower) / (upper - lower)));
    element.style.setProperty('--at', `${(100 * share).toFixed(1)}%`);
    element.classList.add('bounded');
    element.title =
      `${(lower * scale).toFixed(0)}${unit} to ${(upper * scale).toFixed(0)}${unit}, ` +
      `${room.toFixed(room < 10 ? 1 : 0)}${unit} from the nearer`;
  }
  return element;
}

/** where: words for the place of the pose; digits: of the angles, after the point. */
export function tellPose(host, chain, where, { q, note }, digits) {
  const names = chain.joints.map(({ name }) => name).filter(Boolean),
    common = commonLength(names);
  host.replaceChildren(
    ...(where ? [line('where', where)] : []),
    ...names.map((_, k) => jointLine(chain.joints[k], q[k], digits, common)),
    ...(note
      ? [Object.assign(document.createElement('div'), { className: 'note', textContent: note })]
      : []),
  );
}
