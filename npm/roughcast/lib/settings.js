// Settings: camelCase in JavaScript; the names of roughcast.toml, which are those of the flags, elsewhere.

/**
 * Returns settings under the names of roughcast.toml, without those that are undefined.
 *
 * @param {object} settings such as { maxError: 0.05 }
 * @returns {Record<string, unknown>} such as { 'max-error': 0.05 }
 */
export function tomlSettings(settings = {}) {
  const entries = Object.entries(settings).filter(([, value]) => value !== undefined && value !== null);
  return Object.fromEntries(entries.map(([name, value]) => [kebab(name), value]));
}

/**
 * Returns settings as flags of the command line.
 *
 * @param {object} settings
 * @returns {string[]} such as ['--max-error=0.05']
 */
export function flags(settings) {
  return Object.entries(tomlSettings(settings)).flatMap(([name, value]) => {
    if (name === 'provenance') return value ? [] : ['--no-provenance'];
    if (name === 'trim') return value ? ['--trim'] : [];
    return [`--${name}=${Array.isArray(value) ? value.join(',') : value}`];
  });
}

function kebab(name) {
  return name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);
}
