// SPDX-License-Identifier: BSD-3-Clause
// Bundles the page into one file, report.html, beside this script. "@@DATA@@" in it stands for the data of a plan.
import { build } from 'esbuild';
import { readFileSync, writeFileSync } from 'node:fs';

const bundle = await build({ entryPoints: ['main.js'], bundle: true, minify: true, format: 'iife', target: 'es2020', write: false, legalComments: 'none' });
const script = bundle.outputFiles[0].text.replaceAll('</script', '<\\/script');
const page = readFileSync('page.html', 'utf8')
  .replace('/* page.css */', () => readFileSync('page.css', 'utf8'))
  .replace('/* main.js */', () => script);
writeFileSync('report.html', page);
