// `roughcast map` on WebAssembly.
import { readFile, realpath } from 'node:fs/promises';
import path from 'node:path';
import { bakeMap } from '../bake.js';
import { size, writeOutput } from './files.js';
import { UsageError, number, parse } from './options.js';

const OWN = {
  height: { type: 'boolean' },
  'height-scale': { type: 'string' },
  wrap: { type: 'string' },
  channels: { type: 'string' },
  'green-down': { type: 'boolean' },
  layer: { type: 'string' },
  roughness: { type: 'string' },
  'roughness-factor': { type: 'string' },
};

/** Bakes a standalone map. Returns the exit code. */
export async function mapCommand(args, stdout) {
  const { inputs, settings, values } = parse(args, OWN);
  if (inputs.length > 1) throw new UsageError(`expected one image, found ${inputs.length}`);
  if (!/\.ktx2$/i.test(values.output)) {
    throw new UsageError(`-o ${values.output}: expected the name of a .ktx2 file, found another extension`);
  }
  delete settings['height-scale'];
  const images = [inputs[0], values.roughness].filter(Boolean);
  const [image, roughness] = await Promise.all(images.map((file) => readFile(file)));
  const baked = await bakeMap(image, {
    name: path.basename(inputs[0]),
    output: path.basename(values.output),
    roughness: roughness && { image: roughness, name: path.basename(values.roughness) },
    ...mapOptions(values),
    settings,
    threads: values.threads,
    backend: 'wasm',
  });
  const sources = new Set(await Promise.all(images.map((file) => realpath(file))));
  for (const { path: name, bytes } of baked.files) {
    await writeOutput(path.join(path.dirname(values.output), name), bytes, sources);
  }
  if (values.json) stdout.write(`${JSON.stringify(baked.report, null, 2)}\n`);
  else if (!values.quiet) stdout.write(summary(baked.report, values.verbose));
  return 0;
}

/** Returns the options of `bakeMap` that the arguments set. */
function mapOptions(values) {
  const wrap = values.wrap?.split(',').map((mode) => mode.trim());
  const options = {
    height: values.height,
    heightScale: values['height-scale'] && number('height-scale', values['height-scale']),
    wrap: wrap && [wrap[0], wrap[1] ?? wrap[0]],
    channels: values.channels,
    greenDown: values['green-down'],
    layer: values.layer,
    roughnessFactor: values['roughness-factor'] && number('roughness-factor', values['roughness-factor']),
  };
  return Object.fromEntries(Object.entries(options).filter(([, value]) => value !== undefined));
}

function summary({ textures, notes }, verbose) {
  const lines = textures.map(
    (texture) =>
      `${texture.path}: ${texture.content}, ${texture.width} x ${texture.height}, ${texture.levels} levels, ` +
      size(texture.bytes),
  );
  lines.push(...notes.filter((note) => verbose || note.asksForAction).map((note) => `note: ${note.text}`));
  return `${lines.join('\n')}\n`;
}
