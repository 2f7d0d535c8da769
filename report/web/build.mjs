// SPDX-License-Identifier: BSD-3-Clause
// Bundles each page into one file beside this script, report.html and overview.html. "@@DATA@@" in them stands for the data.
import { build } from 'esbuild';
import { readFileSync, writeFileSync } from 'node:fs';

for (const [frame, entry, result] of [['page.html', 'main.js', 'report.html'], ['campaign.html', 'campaign.js', 'overview.html']]) {
  const bundle = await build({ entryPoints: [entry], bundle: true, minify: true, format: 'iife', target: 'es2020', write: false, legalComments: 'none' });
  const script = bundle.outputFiles[0].text.replaceAll('</script', '<\\/script');
  writeFileSync(result, readFileSync(frame, 'utf8')
    .replace('/* page.css */', () => readFileSync('page.css', 'utf8'))
    .replace('/* script */', () => script));
}
