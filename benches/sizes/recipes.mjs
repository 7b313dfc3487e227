// The recipes that docs/sizes.md compares: each makes the textures of a document and returns their bytes.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { listTextureSlots, textureCompress } from '@gltf-transform/functions';
import { encodeToKTX2 } from 'ktx2-encoder';
import sharp from 'sharp';

export const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);

/** Slots whose images are sRGB colours. */
const COLOURS = new Set(['baseColorTexture', 'emissiveTexture', 'specularColorTexture', 'sheenColorTexture']);

/** Returns the RGBA8 texels of an image that sharp reads. */
export async function decode(image) {
  const { data, info } = await sharp(image).ensureAlpha().raw().toBuffer({ resolveWithObject: true });
  return { data: new Uint8Array(data), width: info.width, height: info.height };
}

/** Bakes with the tool and reads its .glb. */
const roughcast = (...options) => async (input, tool) => {
  const folder = mkdtempSync(join(tmpdir(), 'sizes-'));
  try {
    const output = join(folder, 'out.glb');
    execFileSync(tool, ['bake', input, '-o', output, '--quiet', ...options]);
    return await io.read(output);
  } finally {
    rmSync(folder, { recursive: true });
  }
};

/** Runs `work` without the messages of the encoder. */
async function silently(work) {
  const { log } = console;
  console.log = () => {};
  try {
    return await work();
  } finally {
    console.log = log;
  }
}

/**
 * Encodes every image with basis_universal, whose encoder the `ktx` commands of glTF-Transform and gltfpack call. The
 * encoder is WebAssembly on one thread here.
 */
const basis = (options) => async (input) => {
  const document = await io.read(input);
  for (const texture of document.getRoot().listTextures()) {
    if (texture.getMimeType() === 'image/ktx2') continue;
    const slots = listTextureSlots(texture);
    const isColour = slots.some((slot) => COLOURS.has(slot));
    const isNormal = slots.some((slot) => /normalTexture/i.test(slot));
    const settings = options({ isColour });
    const image = await silently(() => encodeToKTX2(texture.getImage(), {
      generateMipmap: true,
      isPerceptual: isColour,
      isSetKTX2SRGBTransferFunc: isColour,
      isNormalMap: isNormal && !settings.isUASTC,
      needSupercompression: settings.isUASTC,
      imageDecoder: decode,
      ...settings,
    }));
    texture.setImage(image).setMimeType('image/ktx2');
  }
  return document;
};

/** The image step of `gltf-transform optimize --texture-compress webp`. */
const webp = async (input) => {
  const document = await io.read(input);
  await document.transform(textureCompress({ encoder: sharp, targetFormat: 'webp', resize: [2048, 2048] }));
  return document;
};

const uastc = (level, rdo) => ({
  isUASTC: true,
  uastcLDRQualityLevel: level,
  enableRDO: rdo !== undefined,
  ...(rdo !== undefined && { rdoQualityLevel: rdo }),
});
const etc1s = (quality) => ({ isUASTC: false, qualityLevel: quality, compressionLevel: 1 });

const RDO_2 = ['--textures', 'all', '--rdo', '2'];

/** The rows of the table. */
export const RECIPES = [
  ['source', async (input) => io.read(input)],
  ['roughcast (`--textures bumps`; other images stay PNG and JPEG)', roughcast()],
  ['roughcast `--textures all`', roughcast('--textures', 'all')],
  ['roughcast `--textures all --rdo 0.5`', roughcast('--textures', 'all', '--rdo', '0.5')],
  ['roughcast `--textures all --rdo 2`', roughcast(...RDO_2)],
  ['roughcast `--textures all --rdo 2 --quality best`', roughcast(...RDO_2, '--quality', 'best')],
  ['roughcast `--textures all --rdo 2 --max-size 512`', roughcast(...RDO_2, '--max-size', '512')],
  ['uastc, level 2', basis(() => uastc(2))],
  ['uastc, level 2, RDO 1', basis(() => uastc(2, 1))],
  ['etc1s, quality 128', basis(() => etc1s(128))],
  ['colours etc1s 255, data uastc 2 with RDO 1', basis(({ isColour }) => (isColour ? etc1s(255) : uastc(2, 1)))],
  ['optimize (WebP, without mips)', webp],
];
