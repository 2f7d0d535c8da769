// SPDX-License-Identifier: BSD-3-Clause
// Bundles each page into one file, report.html, overview.html and placements.html; "@@DATA@@" in
// them stands for the data. Argument: the folder that holds node_modules and gets the pages,
// THIRD-PARTY.txt (the notices of all that was bundled, which the pages carry too) and bundle.d
// (what was read).
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { createHash } from 'node:crypto';
import { createRequire } from 'node:module';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { deflateSync } from 'node:zlib';

const sources = dirname(fileURLToPath(import.meta.url)),
  folder = resolve(process.argv[2]);
const { build, transform } = createRequire(join(folder, 'package.json'))('esbuild');
const source = (name) => join(sources, name);

// The sources lie elsewhere than the packages they import.
const packages = {
  name: 'packages',
  setup: (bundler) =>
    bundler.onResolve({ filter: /^[^./]/ }, ({ path, kind, pluginData, resolveDir }) =>
      pluginData === 'resolved' || resolveDir !== sources
        ? undefined
        : bundler.resolve(path, { kind, resolveDir: folder, pluginData: 'resolved' }),
    ),
};

const licences = new Map(); // text -> the packages under it
function note(name, text) {
  licences.set(text, (licences.get(text) ?? new Set()).add(name));
}
note('Swivel', readFileSync(source('../../LICENSE'), 'utf8').trim());
// All but the tools that bundle. What the bundler reads does not tell: packages hold copies of
// those that they need.
for (const [place, { version, dev }] of Object.entries(
  JSON.parse(readFileSync(join(folder, 'package-lock.json'), 'utf8')).packages,
)) {
  if (!place || dev) continue;
  const licence = readdirSync(join(folder, place)).find((file) =>
    /^(licen[cs]e|copying)/i.test(file),
  );
  if (!licence) throw new Error(`${place}: no licence file: its text must be in the pages`);
  note(
    `${place.replace(/^.*node_modules\//, '')} ${version}`,
    readFileSync(join(folder, place, licence), 'utf8').trim(),
  );
}

const read = new Set([
    source('../../LICENSE'),
    ...['page.css', 'head.html', 'view.html', 'packed.html'].map(source),
  ]),
  pages = [];

/** The program that begins with a source, as one script. */
async function bundled(entry) {
  const bundle = await build({
    entryPoints: [source(entry)],
    absWorkingDir: folder,
    bundle: true,
    minify: true,
    format: 'iife',
    target: 'es2020',
    legalComments: 'eof',
    metafile: true,
    write: false,
    plugins: [packages],
  });
  for (const input of Object.keys(bundle.metafile.inputs).map((path) => resolve(folder, path))) {
    if (dirname(input) === sources) read.add(input);
  }
  return bundle.outputFiles[0].text.replaceAll('</script', '<\\/script');
}
const css = readFileSync(source('page.css'), 'utf8'),
  { code: look } = await transform(css, { loader: 'css', minify: true });
const hash = (script) => `'sha256-${createHash('sha256').update(script).digest('base64')}'`,
  starter = await bundled('starter.js');
for (const [frame, entry, result, title] of [
  ['page.html', 'main.js', 'report.html', 'Swivel report'],
  ['campaign.html', 'campaign.js', 'overview.html', 'Swivel campaign'],
  ['placement.html', 'placement.js', 'placements.html', 'Swivel placements'],
]) {
  const program = await bundled(entry);
  read.add(source(frame));
  pages.push([
    result,
    (readFileSync(source('head.html'), 'utf8') + readFileSync(source(frame), 'utf8'))
      .replace('  <!-- view.html -->\n', () => readFileSync(source('view.html'), 'utf8'))
      .replace('@@TITLE@@', () => title)
      .replace('<!-- packed.html -->\n', () => readFileSync(source('packed.html'), 'utf8'))
      .replace('/* page.css */', () => look)
      // Nothing else runs in the page.
      .replace('@@SCRIPT-HASHES@@', () => `${hash(starter)} ${hash(program)}`)
      .replace('/* program */', () => deflateSync(program, { level: 9 }).toString('base64'))
      .replace('/* starter */', () => starter),
  ]);
}

const notices = [...licences]
  .map(([text, names]) => `${[...names].join(', ')}\n\n${text}\n`)
  .join(`\n${'='.repeat(80)}\n\n`);
writeFileSync(join(folder, 'THIRD-PARTY.txt'), notices);
for (const [result, page] of pages)
  writeFileSync(
    join(folder, result),
    `${page}<!-- The pages of Swivel hold these programs or parts of them, under these ` +
      `licences.\n\n${notices.replaceAll('--', '- -')}-->\n`,
  );
const escaped = (path) => path.replace(/[ #\\]/g, '\\$&').replaceAll('$', '$$$$');
writeFileSync(
  join(folder, 'bundle.d'),
  `${pages.map(([result]) => escaped(join(folder, result))).join(' ')}: ` +
    `${[...read].map(escaped).join(' ')}\n`,
);
