// SPDX-License-Identifier: BSD-3-Clause
// Starts a page: inflates its data and its program, which it holds as zlib streams in base 64.
import { decoded } from './bytes.js';

const kNeeds =
  'This browser cannot unpack the page (DecompressionStream is missing); Chrome or Edge 80, ' +
  'Firefox 113, Safari 16.4 and later ones can. Here is what the page shows without JavaScript.';

/** What an element holds, as a Response. */
const inflated = (id) =>
  new Response(
    new Blob([decoded(document.getElementById(id).textContent)])
      .stream()
      .pipeThrough(new DecompressionStream('deflate')),
  );

/** Shows `why` above the answer and the map as they are without JavaScript. */
function showStill(why) {
  const still = document.querySelector('noscript').textContent,
    told = document.createElement('p');
  document.body.innerHTML = still;
  document.querySelector('.still').remove();
  told.textContent = why;
  document.body.prepend(told);
  window.swivelPage = { data: null };
}

async function start() {
  const [held, program] = await Promise.all([
      inflated('data').arrayBuffer(),
      inflated('program').text(),
    ]),
    script = document.createElement('script'),
    all = new Uint8Array(held),
    // A text of JSON, a byte 0, and the binary values of which the text has the places.
    end = all.indexOf(0) < 0 ? all.length : all.indexOf(0);
  window.swivelPage = {
    data: JSON.parse(new TextDecoder().decode(all.subarray(0, end))),
    bytes: all.subarray(end + 1),
  };
  script.textContent = program;
  document.body.append(script); // runs it
  script.remove(); // so that a saved page starts as this one does
}

if (window.DecompressionStream)
  start().catch((error) => showStill(`This page is damaged: ${error.message}`));
else showStill(kNeeds);
