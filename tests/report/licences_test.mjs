// SPDX-License-Identifier: BSD-3-Clause
// Every page carries the notices of all that is bundled into it. Arguments: the program, the
// problems' folder, the folder with node_modules.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { skip } from './browser.mjs';

const [swivel, problems, packages] = process.argv.slice(2).map((path) => resolve(path));
const tools = /^(esbuild|@esbuild\/.*)$/; // no part of a page
const plain = (text) => text.replace(/\s+/g, ' ').trim();

const folder = mkdtempSync(join(tmpdir(), 'swivel-licences-'));
try {
  const page = (name, ...command) => {
    const done = spawnSync(swivel, [...command, '--report', join(folder, name)], {
      encoding: 'utf8',
    });
    if (done.stderr.includes('built without reports')) {
      rmSync(folder, { recursive: true }); // skip ends the process
      skip(done.stderr);
    }
    return plain(readFileSync(join(folder, name), 'utf8'));
  };
  const pages = {
    report: page(
      'plan.html',
      'plan',
      join(problems, 'experiment_a.yaml'),
      '--out',
      join(folder, 'a.csv'),
    ),
    job: page(
      'job.html',
      'plan',
      join(problems, 'door_job.yaml'),
      '--out',
      join(folder, 'job.csv'),
    ),
    workcell: page('workcell.html', 'plan', join(problems, 'sda10f_plate_workcell.yaml')),
    overview: page(
      'campaign.html',
      'campaign',
      join(problems, 'experiment_c.yaml'),
      '--episodes',
      '2',
      '--out',
      join(folder, 'c.csv'),
    ),
  };
  const { packages: installed } = JSON.parse(
    readFileSync(join(packages, 'package-lock.json'), 'utf8'),
  );
  let checked = 0;
  for (const [place, { version }] of Object.entries(installed)) {
    const name = place.replace(/^.*node_modules\//, '');
    if (!place || tools.test(name)) continue;
    const licence = readdirSync(join(packages, place)).find((file) => /^licen[cs]e/i.test(file));
    const text = plain(readFileSync(join(packages, place, licence), 'utf8'));
    for (const [page, html] of Object.entries(pages)) {
      assert.ok(html.includes(`${name} ${version}`), `${page}: ${name} ${version} is not named`);
      assert.ok(html.includes(text), `${page}: the licence of ${name} is missing`);
      ++checked;
    }
  }
  for (const [page, html] of Object.entries(pages))
    assert.ok(
      html.includes('Copyright (c) 2026') && html.includes('BSD 3-Clause'),
      `${page}: Swivel's own licence`,
    );
  console.log(`${checked} notices found`);
  assert.ok(checked > 60);
} finally {
  rmSync(folder, { recursive: true });
}
