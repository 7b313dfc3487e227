#!/usr/bin/env node
// The command line: the native tool if there is one, else WebAssembly. The viewer needs Node in both cases.
import { spawnSync } from 'node:child_process';
import process from 'node:process';
import { findBinary } from '../lib/binary.js';
import { run } from '../lib/cli/run.js';

const args = process.argv.slice(2);
const { path } = process.env.ROUGHCAST_BACKEND === 'wasm' || args[0] === 'view' ? {} : findBinary();
if (path) {
  const { status, signal, error } = spawnSync(path, args, { stdio: 'inherit' });
  if (error) process.stderr.write(`error: ${path}: ${error.message}\n`);
  if (signal) process.kill(process.pid, signal);
  process.exitCode = status ?? 1;
} else {
  process.exitCode = await run(args, process);
}
