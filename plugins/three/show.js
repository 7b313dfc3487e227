// Serves the page with an asset on this machine until the process ends.
import { mkdirSync, mkdtempSync, rmSync, statSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import process from 'node:process';
import { createInterface } from 'node:readline';
import { serve } from './server.js';

/** Makes a folder that is deleted when the process ends, by Ctrl-C too. */
export function temporaryFolder() {
  const folder = mkdtempSync(path.join(os.tmpdir(), 'roughcast-view-'));
  process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
  for (const signal of ['SIGINT', 'SIGTERM']) process.on(signal, () => process.exit(0));
  return folder;
}

/**
 * Serves the page and the folders of an asset.
 *
 * @param {Record<string, string>} files the documents to show, by variant
 * @param {Record<string, string>} folders what the page consists of, as `serve` takes it
 * @param {object} [options]
 * @param {'asset' | 'plane' | 'sphere'} [options.subject] what is shown first
 * @param {import('node:stream').Readable} [options.events] output of `roughcast watch --json`: the page reloads when it
 * reports new outputs
 * @returns {Promise<string>} the address of the page
 */
export async function show(files, folders, { subject = 'asset', events } = {}) {
  for (const file of Object.values(files)) statSync(file);
  const view = path.join(temporaryFolder(), 'view');
  mkdirSync(view);
  const entries = Object.entries(files);
  // Each asset has a folder of its own, since two assets may have files of one name.
  const assets = Object.fromEntries(entries.map(([name, file]) => [`asset-${name}`, path.dirname(file)]));
  const urls = entries.map(([name, file]) => [name, `/asset-${name}/${encodeURIComponent(path.basename(file))}`]);
  writeFileSync(path.join(view, 'variants.json'), JSON.stringify({ variants: Object.fromEntries(urls), subject }));
  const server = await serve({ ...assets, view, ...folders });
  if (events) createInterface({ input: events }).on('line', (line) => reportsOutputs(line) && server.reportBake());
  return `${server.url}/page/index.html`;
}

/** Returns whether a line of `roughcast watch --json` reports new outputs. */
function reportsOutputs(line) {
  try {
    return ['baked', 'removed'].includes(JSON.parse(line).event);
  } catch {
    return false;
  }
}
