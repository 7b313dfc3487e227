// Counts the SPIR-V operations that a fragment runs. A function counts at each call. A loop from 0 to a constant counts
// as often as it runs, and any other loop counts once. All branches count.

const OP = {
  entryPoint: 15,
  constant: 43,
  function: 54,
  functionEnd: 56,
  call: 57,
  less: 177,
  loopMerge: 246,
  label: 248,
};
/** Fetches: OpImageSampleImplicitLod to OpImageFetch. */
const isFetch = (op) => op >= 87 && op <= 95;
/**
 * Operations: arithmetic, bits, comparisons, dot products and OpExtInst (sqrt, pow, ...), without moves, loads and
 * control flow.
 */
const isOperation = (op) =>
  op === 12 || (op >= 109 && op <= 115) || (op >= 126 && op <= 148) || (op >= 154 && op <= 191);

/** @param {Uint32Array} words */
export function count(words) {
  const [functions, constants] = [new Map(), new Map()];
  let entry = null;
  // The current function and the loops in it that have not ended.
  let open = [];
  for (let at = 5; at < words.length; at += words[at] >>> 16) {
    const op = words[at] & 0xffff;
    if (op === OP.entryPoint) entry = words[at + 2];
    if (op === OP.constant) constants.set(words[at + 2], words[at + 3]);
    if (op === OP.function) {
      open = [{ operations: 0, fetches: 0, calls: [] }];
      functions.set(words[at + 2], open[0]);
    }
    if (op === OP.functionEnd) open = [];
    const current = open.at(-1);
    if (current === undefined) continue;
    if (op === OP.label && words[at + 1] === current.end) {
      const { operations, fetches, calls, runs = 1 } = open.pop();
      const around = open.at(-1);
      around.operations += runs * operations;
      around.fetches += runs * fetches;
      for (let i = 0; i < runs; i++) around.calls.push(...calls);
    }
    if (op === OP.loopMerge) open.push({ operations: 0, fetches: 0, calls: [], end: words[at + 1] });
    // The first comparison of a loop is that of for ( int i = 0; i < constant; i ++ ).
    if (op === OP.less && current.end !== undefined) current.runs ??= constants.get(words[at + 4]) ?? 1;
    if (op === OP.call) current.calls.push(words[at + 3]);
    if (isFetch(op)) current.fetches++;
    if (isOperation(op)) current.operations++;
  }
  const expand = (id) => {
    const { operations, fetches, calls } = functions.get(id);
    return calls
      .map(expand)
      .reduce((a, b) => ({ operations: a.operations + b.operations, fetches: a.fetches + b.fetches }), {
        operations,
        fetches,
      });
  };
  return expand(entry);
}

/** Rewrites GLSL of WebGL 2 for glslang's SPIR-V: each uniform in its own block, each varying with a location. */
export function forSpirv(source) {
  let [binding, location] = [0, 0];
  return source
    .replace(/#version 300 es/, '#version 450')
    .replace(
      /^\s*uniform\s+((?:(?:high|medium|low)p\s+)?(?:i|u)?sampler\w+\s+\w+)\s*;/gm,
      (_, rest) => `layout(binding = ${binding++}) uniform ${rest};`,
    )
    .replace(
      /^\s*uniform\s+(\w[^;]*);/gm,
      (_, rest) => `layout(binding = ${binding++}) uniform Block${binding} { ${rest}; };`,
    )
    .replace(
      /^\s*(?:flat\s+)?varying\s+(\w[^;]*);/gm,
      (_, rest) => `layout(location = ${(location += 4)}) in ${rest};`,
    );
}
