// The recipes that docs/sizes.md compares: each makes the textures of an asset and returns its document.
import { readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import process from 'node:process';
import { fileURLToPath } from 'node:url';

import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { listTextureSlots } from '@gltf-transform/functions';
import { encodeToKTX2 } from 'ktx2-encoder';
import { MeshoptDecoder } from 'meshoptimizer';
import sharp from 'sharp';

import { inFolder, run } from './programs.mjs';

export const io = new NodeIO()
  .registerExtensions(ALL_EXTENSIONS)
  .registerDependencies({ 'meshopt.decoder': MeshoptDecoder });

const GLTF_TRANSFORM = fileURLToPath(new URL('node_modules/@gltf-transform/cli/bin/cli.js', import.meta.url));

/** Slots whose images are sRGB colours. */
const COLOURS = new Set(['baseColorTexture', 'emissiveTexture', 'specularColorTexture', 'sheenColorTexture']);

/** Returns the RGBA8 texels of an image that sharp reads. */
export async function decode(image) {
  const { data, info } = await sharp(image).ensureAlpha().raw().toBuffer({ resolveWithObject: true });
  return { data: new Uint8Array(data), width: info.width, height: info.height };
}

/** Runs `command`, which takes the paths of an input and of a .glb, and reads that .glb. */
const converted = (command) => (input, tool) =>
  inFolder((folder) => {
    const output = join(folder, 'out.glb');
    command(input, output, tool);
    return io.read(output);
  });

const roughcast = (...options) =>
  converted((input, output, tool) => run(tool, 'bake', input, '-o', output, '--quiet', ...options));

/** Keeps meshes and materials as they are, so that only the textures are measured. */
const gltfpack = (...options) =>
  converted((input, output) => run('gltfpack', '-i', input, '-o', output, '-noq', '-km', ...options));

const gltfTransform = (command, ...options) =>
  converted((input, output) => run(process.execPath, GLTF_TRANSFORM, command, input, output, ...options));

/** Encodes the colours as ETC1S, which a bake leaves as they are, and bakes everything else. */
const colourEtc1sAndRoughcast = (...options) =>
  converted((input, output, tool) => {
    const colours = join(dirname(output), 'colours.glb');
    run(process.execPath, GLTF_TRANSFORM, 'etc1s', input, colours, '--slots', '{baseColor,emissive}*');
    run(tool, 'bake', colours, '-o', output, '--quiet', ...options);
  });

/** Encodes every image with `encode`, in the format that `format` returns for colours or data. */
const encoded = (encode, format) => async (input) => {
  const document = await io.read(input);
  for (const texture of document.getRoot().listTextures()) {
    if (texture.getMimeType() === 'image/ktx2') continue;
    const slots = listTextureSlots(texture);
    const isColour = slots.some((slot) => COLOURS.has(slot));
    const isNormal = slots.some((slot) => /normalTexture/i.test(slot));
    const image = await encode(texture.getImage(), { isColour, isNormal, ...format(isColour) });
    texture.setImage(image).setMimeType('image/ktx2');
  }
  return document;
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

/** Encodes with the WebAssembly of basis_universal, on one thread. */
const webAssembly = (image, { isColour, isNormal, isUastc, quality, rdo }) =>
  silently(() =>
    encodeToKTX2(image, {
      generateMipmap: true,
      isPerceptual: isColour,
      isSetKTX2SRGBTransferFunc: isColour,
      isNormalMap: isNormal && !isUastc,
      needSupercompression: isUastc,
      imageDecoder: decode,
      isUASTC: isUastc,
      ...(isUastc
        ? { uastcLDRQualityLevel: quality, enableRDO: rdo > 0, ...(rdo > 0 && { rdoQualityLevel: rdo }) }
        : { qualityLevel: quality, compressionLevel: 1 }),
    }),
  );

/** Encodes with the command of basis_universal, on all cores. */
const basisu = (image, { isColour, isNormal, isUastc, quality, rdo }) =>
  inFolder((folder) => {
    // The first byte of a PNG, which is none of a JPEG.
    const isPng = image[0] === 0x89;
    const [source, output] = [join(folder, isPng ? 'image.png' : 'image.jpg'), join(folder, 'image.ktx2')];
    writeFileSync(source, image);
    run(
      'basisu',
      ...['-ktx2', '-mipmap', '-file', source, '-output_file', output],
      ...(isColour ? [] : ['-linear']),
      ...(isNormal && !isUastc ? ['-normal_map'] : []),
      ...(isUastc ? ['-uastc', '-uastc_level', quality] : ['-q', quality, '-comp_level', 1]),
      ...(rdo > 0 ? ['-uastc_rdo_l', rdo] : []),
    );
    return new Uint8Array(readFileSync(output));
  });

const uastc = (quality, rdo = 0) => ({ isUastc: true, quality, rdo });
const etc1s = (quality) => ({ isUastc: false, quality, rdo: 0 });

const UASTC = ['uastc, level 2', () => uastc(2)];
const UASTC_RDO = ['uastc, level 2, RDO 1', () => uastc(2, 1)];
const ETC1S = ['etc1s, quality 128', () => etc1s(128)];
const MIXED = ['colours etc1s 255, data uastc 2 with RDO 1', (isColour) => (isColour ? etc1s(255) : uastc(2, 1))];

/** A row for each line of options of a command, named by both. */
const rows = (name, recipe, program, lines) =>
  lines.map((line) => ({ name: `${name} \`${line}\``, make: recipe(...line.split(' ')), program }));

/** A row for each format of an encoder. */
const encoders = (title, encode, program, formats) =>
  formats.map(([name, format]) => ({ name: `${title}: ${name}`, make: encoded(encode, format), program }));

/** Marks rows that take minutes for each asset. */
const slow = (recipes) => recipes.map((recipe) => ({ ...recipe, isSlow: true }));

/** The rows of the table, with the program of `install` that each needs. */
export const RECIPES = [
  { name: 'source', make: (input) => io.read(input) },
  { name: 'roughcast (`--textures bumps`; other images stay PNG and JPEG)', make: roughcast() },
  ...rows('roughcast', roughcast, undefined, [
    '--textures all',
    '--textures all --rdo 0.5',
    '--textures all --rdo 2',
    '--textures all --rdo 2 --quality best',
    '--textures all --rdo 2 --max-size 512',
  ]),
  ...rows('gltfpack', gltfpack, 'gltfpack', [
    '-tu',
    '-tu -tq 5',
    '-tc',
    '-tc color -tu normal,attrib',
    '-tc color -tu normal,attrib -tl 512',
  ]),
  ...encoders('basisu', basisu, 'basisu', [UASTC, UASTC_RDO, ETC1S, MIXED]),
  ...rows('gltf-transform', gltfTransform, 'ktx', ['uastc', 'etc1s']),
  ...rows('gltf-transform', gltfTransform, undefined, ['optimize --texture-compress webp']),
  ...rows('colours by gltf-transform `etc1s`, then roughcast', colourEtc1sAndRoughcast, 'ktx', [
    '--textures all',
    '--textures all --rdo 2',
  ]),
  ...encoders('basisu as WebAssembly', webAssembly, undefined, [UASTC, ETC1S]),
  ...slow(encoders('basisu as WebAssembly', webAssembly, undefined, [UASTC_RDO, MIXED])),
  ...slow(rows('gltf-transform', gltfTransform, 'ktx', ['optimize --texture-compress ktx2'])),
];
