// The options of the bake that a person can choose.

/** Returns the settings of the library for the values of the form. Empty values are those that the library chooses. */
export function settingsOf(form) {
  const { engine, textures, maxSize, quality, rdo } = Object.fromEntries(new FormData(form));
  return {
    quality,
    textures,
    ...(engine && { engine }),
    ...(maxSize && { maxSize: Number(maxSize) }),
    ...(rdo && { rdo: Number(rdo) }),
    gltf: 'strict',
  };
}

/** Returns the name of the baked file, which says what differs from the first settings of the page. */
export function nameOf(name, { engine = 'any', textures, maxSize, quality, rdo }) {
  const marks = [
    engine !== 'three' && engine,
    textures !== 'bumps' && textures,
    maxSize,
    quality !== 'fast' && quality,
    rdo && `rdo${rdo}`,
  ];
  return [name, 'baked', ...marks.filter(Boolean)].join('-') + '.glb';
}
