// The native tool: the file `bin/roughcast` of the package for this platform.
import { existsSync } from 'node:fs';
import { createRequire } from 'node:module';
import process from 'node:process';

const require = createRequire(import.meta.url);

/** The name of the platform's package. */
const platformPackage = `@roughcast/${process.platform}-${process.arch}`;

/**
 * Finds the native tool: $ROUGHCAST_BINARY, else that of the platform's package.
 *
 * @returns {{path?: string, why?: string}} its path, or why there is none
 */
export function findBinary() {
  const named = process.env.ROUGHCAST_BINARY;
  if (named && existsSync(named)) return { path: named };
  if (named) return { why: `$ROUGHCAST_BINARY is ${named}, where no file is; correct or unset it` };
  const file = process.platform === 'win32' ? 'roughcast.exe' : 'roughcast';
  try {
    return { path: require.resolve(`${platformPackage}/bin/${file}`) };
  } catch {
    return { why: `the package ${platformPackage} is not installed; install it, or install without --omit=optional` };
  }
}
