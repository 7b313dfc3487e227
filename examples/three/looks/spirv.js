// What a fragment runs, counted in SPIR-V: functions are expanded where they are called, loops count once, and all
// branches are taken.

const OP = { function: 54, functionEnd: 56, call: 57, entryPoint: 15 };
/** OpImageSampleImplicitLod to OpImageFetch. */
const isFetch = (op) => op >= 87 && op <= 95;
/** Arithmetic, bits, comparisons, dot products and OpExtInst (sqrt, pow, ...); not moves, loads or control flow. */
const isOperation = (op) => op === 12 || (op >= 109 && op <= 115) || (op >= 126 && op <= 148) || (op >= 154 && op <= 191);

/** @param {Uint32Array} words */
export function count(words) {
  const functions = new Map();
  let [entry, current] = [null, null];
  for (let at = 5; at < words.length; at += words[at] >>> 16) {
    const op = words[at] & 0xffff;
    if (op === OP.entryPoint) entry = words[at + 2];
    if (op === OP.function) functions.set(words[at + 2], (current = { operations: 0, fetches: 0, calls: [] }));
    if (op === OP.functionEnd) current = null;
    if (current === null) continue;
    if (op === OP.call) current.calls.push(words[at + 3]);
    if (isFetch(op)) current.fetches++;
    if (isOperation(op)) current.operations++;
  }
  const expand = (id) => {
    const { operations, fetches, calls } = functions.get(id);
    return calls.map(expand).reduce((a, b) => ({ operations: a.operations + b.operations, fetches: a.fetches + b.fetches }), { operations, fetches });
  };
  return expand(entry);
}

/** WebGL 2's GLSL as glslang reads it for SPIR-V: every uniform in a block of its own, every varying with a location. */
export function forSpirv(source) {
  let [binding, location] = [0, 0];
  return source
    .replace(/#version 300 es/, '#version 450')
    .replace(/^\s*uniform\s+((?:(?:high|medium|low)p\s+)?(?:i|u)?sampler\w+\s+\w+)\s*;/gm, (_, rest) => `layout(binding = ${binding++}) uniform ${rest};`)
    .replace(/^\s*uniform\s+(\w[^;]*);/gm, (_, rest) => `layout(binding = ${binding++}) uniform Block${binding} { ${rest}; };`)
    .replace(/^\s*(?:flat\s+)?varying\s+(\w[^;]*);/gm, (_, rest) => `layout(location = ${(location += 4)}) in ${rest};`);
}
