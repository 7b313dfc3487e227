// A plugin for Vite: `import url from './helmet.glb?roughcast'` is the address of the baked asset, a .glb that holds
// all of its textures. `vite` bakes when the page asks for the asset, and again when one of its files is saved.
import { createHash } from 'node:crypto';
import { mkdir, readFile, writeFile } from 'node:fs/promises';
import path from 'node:path';

import { bake } from './bake.js';

const QUERY = '?roughcast';

/** Makes the plugin; `settings` are those of a bake. vite.d.ts describes it. */
export function roughcast(settings = {}) {
  let folder;
  return {
    name: 'roughcast',
    enforce: 'pre',

    configResolved(config) {
      folder = path.join(config.cacheDir, 'roughcast');
    },

    async load(id) {
      if (!id.endsWith(QUERY)) return null;
      const file = id.slice(0, -QUERY.length);
      const read = (name) => {
        const beside = path.resolve(path.dirname(file), name);
        this.addWatchFile(beside);
        return readFile(beside);
      };
      const name = path.parse(file).name;
      const baked = await bake(await read(file), { name, files: read, settings: { ...settings, glb: true } });
      for (const note of baked.report.layers.flatMap((layer) => layer.notes)) {
        if (note.asksForAction) this.warn(`${file}: ${note.text}`);
      }
      // The folder keeps assets of the same name apart.
      const key = createHash('sha256').update(file).digest('hex').slice(0, 8);
      const output = path.join(folder, key, `${name}.glb`);
      await mkdir(path.dirname(output), { recursive: true });
      await writeFile(output, baked.document.bytes);
      return `export { default } from ${JSON.stringify(`${output.replaceAll('\\', '/')}?url`)};`;
    },
  };
}
