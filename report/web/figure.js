// SPDX-License-Identifier: BSD-3-Clause
// Figures for papers: several drawings in one SVG file, or in a PNG file made from it.
import { kLight } from './palette.js';

const kSvg = 'http://www.w3.org/2000/svg';

/** Colours of a drawing on white paper. */
export const PAPER = { ink: '#000', soft: '#444', accent: '#0072b2', ...kLight };

/** drawings: SVG elements with width and height, set below each other. A new element. */
export function sheet(drawings) {
  const all = document.createElementNS(kSvg, 'svg');
  let width = 0,
    height = 0;
  for (const drawing of drawings) {
    drawing.setAttribute('y', height);
    width = Math.max(width, Number(drawing.getAttribute('width')));
    height += Number(drawing.getAttribute('height'));
  }
  for (const [name, value] of Object.entries({
    xmlns: kSvg,
    width,
    height,
    viewBox: `0 0 ${width} ${height}`,
  }))
    all.setAttribute(name, value);
  const ground = document.createElementNS(kSvg, 'rect');
  for (const [name, value] of Object.entries({ width, height, fill: '#fff' }))
    ground.setAttribute(name, value);
  all.append(ground, ...drawings);
  return all;
}

function save(name, blob) {
  const link = document.createElement('a'),
    href = URL.createObjectURL(blob);
  Object.assign(link, { download: name, href });
  link.click();
  setTimeout(() => URL.revokeObjectURL(href), 1000);
}

/** Buttons that save what `draw` returns, an SVG element. */
export function savers(host, stem, draw) {
  const add = (kind, action) => {
    const button = document.createElement('button');
    Object.assign(button, {
      className: 'save',
      textContent: kind,
      title: `Save as ${stem}.${kind.toLowerCase()}`,
    });
    button.addEventListener('click', action);
    host.append(button);
  };
  const text = (svg) =>
    new Blob([new XMLSerializer().serializeToString(svg)], { type: 'image/svg+xml' });
  add('PNG', () => {
    const svg = draw(),
      image = new Image(),
      canvas = document.createElement('canvas'),
      scale = 3;
    image.onload = () => {
      canvas.width = scale * image.width;
      canvas.height = scale * image.height;
      canvas.getContext('2d').drawImage(image, 0, 0, canvas.width, canvas.height);
      URL.revokeObjectURL(image.src);
      canvas.toBlob((blob) => save(`${stem}.png`, blob));
    };
    image.src = URL.createObjectURL(text(svg));
  });
  add('SVG', () => save(`${stem}.svg`, text(draw())));
}
