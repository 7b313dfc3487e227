// Every block decodes in three.js's transcoder to the bytes that Roughcast expects: exactly, on no GPU and in no target
// format.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import test from 'node:test';
import { example, levels, missing, repository, roughcast, temporary } from './roughcast.js';

const LIBRARY = path.join(example, 'node_modules/three/examples/jsm/libs/basis');
/** `transcoder_texture_format::cTFRGBA32`. */
const RGBA32 = 13;

async function transcoder() {
  const script = readFileSync(path.join(LIBRARY, 'basis_transcoder.js'), 'utf8');
  // The file is a script for pages and for CommonJS, in a package of modules.
  const basis = new Function('require', '__dirname', `${script}; return BASIS;`)(
    createRequire(import.meta.url),
    LIBRARY,
  );
  const module = await basis({ wasmBinary: readFileSync(path.join(LIBRARY, 'basis_transcoder.wasm')) });
  module.initializeBasis();
  return module;
}

/** Decodes every level to RGBA. */
function transcoded({ KTX2File }, bytes) {
  const file = new KTX2File(new Uint8Array(bytes));
  try {
    assert.ok(file.isValid() && file.isUASTC() && file.startTranscoding());
    return Array.from({ length: file.getLevels() }, (_, level) => {
      const { origWidth: width, origHeight: height } = file.getImageLevelInfo(level, 0, 0);
      const data = new Uint8Array(file.getImageTranscodedSizeInBytes(level, 0, 0, RGBA32));
      assert.ok(file.transcodeImage(data, level, 0, 0, RGBA32, 0, -1, -1), `level ${level}`);
      return { width, height, data };
    });
  } finally {
    file.close();
    file.delete();
  }
}

test("three.js's transcoder decodes every level to the same bytes", { skip: missing }, async (t) => {
  const [folder, module] = [temporary(t), await transcoder()];
  for (const [profile, quality] of [
    ['portable', 'fast'],
    ['portable', 'best'],
    ['pyramid', 'fast'],
  ]) {
    const out = path.join(folder, `${profile}-${quality}`);
    const settings = [
      '--profile',
      profile,
      '--quality',
      quality,
      '--model',
      'anisotropic',
      '--gltf',
      'strict',
      '--quiet',
    ];
    roughcast('bake', path.join(repository, 'fixtures/brushed'), '-o', out, ...settings);
    const files = levels(path.join(out, 'brushed.gltf'), path.join(folder, `${profile}-${quality}-levels`));
    assert.ok(files.size >= 2, `${files.size} textures`);
    for (const [name, expected] of files) {
      const found = transcoded(module, readFileSync(path.join(out, `brushed.roughcast/${name}.ktx2`)));
      assert.equal(found.length, expected.length, name);
      for (const [level, { width, height, channels, data }] of expected.entries()) {
        assert.deepEqual([found[level].width, found[level].height], [width, height], `${name}, level ${level}`);
        const kept = found[level].data.filter((_, i) => i % 4 < channels);
        assert.ok(Buffer.from(kept).equals(Buffer.from(data)), `${name}, level ${level}`);
      }
    }
  }
});
