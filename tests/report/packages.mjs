// SPDX-License-Identifier: BSD-3-Clause
// Fetches what drives the browser into a folder, once, and where there is a browser. Arguments:
// npm, the folder.
import { execFileSync } from 'node:child_process';
import { copyFileSync, existsSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { needBrowser, skip } from './browser.mjs';

const [npm, folder] = process.argv.slice(2),
  here = dirname(fileURLToPath(import.meta.url));
needBrowser();
const wanted = readFileSync(join(here, 'package-lock.json')),
  fetched = join(folder, 'packages.lock');
if (!existsSync(fetched) || !readFileSync(fetched).equals(wanted)) {
  rmSync(fetched, { force: true });
  for (const name of ['package.json', 'package-lock.json'])
    copyFileSync(join(here, name), join(folder, name));
  try {
    execFileSync(npm, ['ci', '--no-audit', '--no-fund'], { cwd: folder, stdio: 'inherit' });
  } catch (error) {
    skip(`npm failed: ${error.message}`);
  }
  writeFileSync(fetched, wanted);
}
