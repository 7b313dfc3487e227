// Packs the npm packages: `node make-packages.js --binary TOOL [--platform linux-x64] [--out out]`.
//
// Makes the package of one platform from the built tool, and the main package from roughcast/ with its WebAssembly
// modules and the viewer. Writes `roughcast-<version>.tgz` and `roughcast-<platform>-<version>.tgz`, and prints their
// paths.
import { execFileSync } from 'node:child_process';
import { chmodSync, cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import process from 'node:process';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { makeViewer } from './make-viewer.js';

const npm = path.dirname(fileURLToPath(import.meta.url));
const LICENCES = ['LICENSE-APACHE', 'LICENSE-MIT'];

/** Platforms with a package, as Node names them. Their tools are those that a release builds. */
const PLATFORMS = ['linux-x64', 'linux-arm64', 'darwin-x64', 'darwin-arm64', 'win32-x64', 'win32-arm64'];

const { values } = parseArgs({
  options: {
    binary: { type: 'string' },
    platform: { type: 'string', default: `${process.platform}-${process.arch}` },
    out: { type: 'string', default: path.join(npm, 'out') },
  },
});

const main = JSON.parse(readFileSync(path.join(npm, 'roughcast/package.json')));
const work = mkdtempSync(path.join(os.tmpdir(), 'roughcast-pack-'));
try {
  checkArguments();
  mkdirSync(values.out, { recursive: true });
  for (const folder of [platformFolder(), await mainFolder()]) {
    const packed = execFileSync('npm', ['pack', '--json', '--pack-destination', values.out], {
      cwd: folder,
      encoding: 'utf8',
      shell: process.platform === 'win32',
    });
    // Older versions of npm print the name of a scoped package with its slash.
    const name = JSON.parse(packed)[0].filename.replace(/^@/, '').replace('/', '-');
    process.stdout.write(`${path.join(values.out, name)}\n`);
  }
} catch (error) {
  process.stderr.write(`error: ${error.message}\n`);
  process.exitCode = 1;
} finally {
  rmSync(work, { recursive: true, force: true });
}

function checkArguments() {
  const { binary, platform } = values;
  if (!binary || !existsSync(binary)) {
    throw new Error(`expected the built tool at --binary, found ${binary ?? 'no such option'}; cargo build --release`);
  }
  if (!PLATFORMS.includes(platform)) {
    throw new Error(`--platform ${platform}: expected one of ${PLATFORMS.join(', ')}`);
  }
  for (const name of ['roughcast.wasm', 'roughcast.threads.wasm']) {
    if (existsSync(path.join(npm, 'roughcast', name))) continue;
    throw new Error(`expected roughcast/${name}, found none; bash wasm/build.sh`);
  }
}

/** Makes the folder of the platform's package: the tool alone. */
function platformFolder() {
  const [system, processor] = values.platform.split('-');
  const folder = path.join(work, values.platform);
  const tool = path.join(folder, 'bin', system === 'win32' ? 'roughcast.exe' : 'roughcast');
  mkdirSync(path.dirname(tool), { recursive: true });
  cpSync(values.binary, tool);
  chmodSync(tool, 0o755);
  writePackage(folder, {
    name: `@roughcast/${values.platform}`,
    version: main.version,
    description: `The native tool of the package roughcast for ${system} on ${processor}`,
    license: main.license,
    // npm's provenance needs the address that the main package has.
    ...(main.repository && { repository: main.repository }),
    files: ['bin', 'LICENSE-*'],
    os: [system],
    cpu: [processor],
    // The tool is built against the GNU C library.
    ...(system === 'linux' && { libc: ['glibc'] }),
    preferUnplugged: true,
  });
  writeFileSync(
    path.join(folder, 'README.md'),
    `The native tool of the npm package roughcast, for ${values.platform}.\n`,
  );
  return folder;
}

/** Makes the folder of the main package, which depends on the packages of all platforms as options. */
async function mainFolder() {
  const folder = path.join(work, 'roughcast');
  cpSync(path.join(npm, 'roughcast'), folder, { recursive: true });
  cpSync(path.join(npm, 'README.md'), path.join(folder, 'README.md'));
  await makeViewer(path.join(folder, 'viewer'));
  const platforms = PLATFORMS.map((platform) => [`@roughcast/${platform}`, main.version]);
  writePackage(folder, { ...main, optionalDependencies: Object.fromEntries(platforms) });
  return folder;
}

function writePackage(folder, contents) {
  writeFileSync(path.join(folder, 'package.json'), `${JSON.stringify(contents, null, 2)}\n`);
  for (const name of LICENCES) cpSync(path.join(npm, '..', name), path.join(folder, name));
}
