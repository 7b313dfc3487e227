// The tables of the reachable gain, as Markdown.

const STOCK_FLOATS = ['portable float', 'portable float best'];
/** Column, variant, and variants in half floats, the best of which is what the engine can reach with single lobes. */
const SHADINGS = [
  ['stock', 'portable', STOCK_FLOATS],
  ['plugin', 'pyramid', ['pyramid float', 'pyramid float best', ...STOCK_FLOATS]],
];
const mean = (numbers) => numbers.reduce((sum, value) => sum + value, 0) / numbers.length;
const geometricMean = (numbers) => Math.exp(mean(numbers.map(Math.log)));

/** Returns the share of the reachable gain, or null where the best lobes gain less than a hundredth of the error. */
export function share(plain, error, reachable) {
  return plain - reachable > 0.01 * plain ? (plain - error) / (plain - reachable) : null;
}

/** Returns the mean error of a variant over the views that `use` selects, in one kind of light. */
export function errorOf({ errors }, variant, light = 'both', use = () => true) {
  return mean(errors.filter((_, i) => use(i)).map((view) => view[variant][light]));
}

/** Returns the least of the mean errors of variants. */
const leastOf = (result, variants) => Math.min(...variants.map((variant) => errorOf(result, variant)));

const times = (plain, error) => `${(plain / error).toFixed(2)}x`;
const percent = (value) => (value === null ? '' : `${Math.round(100 * value)} %`);
const table = (rows) => rows.map((cells) => `| ${cells.join(' | ')} |`).join('\n');
const headed = (cells) => [cells, cells.map((_, i) => (i === 0 ? '---' : '---:'))];

/** Returns the errors of each material. */
function byMaterial(results) {
  const rows = headed([
    'material',
    'plain',
    ...SHADINGS.flatMap(([name]) => [name, 'closer', 'reachable', 'share of the gain']),
  ]);
  for (const result of results) {
    const plain = errorOf(result, 'original');
    const cells = SHADINGS.flatMap(([, ours, best]) => {
      const [error, reachable] = [errorOf(result, ours), leastOf(result, best)];
      return [error.toFixed(3), times(plain, error), times(plain, reachable), percent(share(plain, error, reachable))];
    });
    rows.push([result.name, plain.toFixed(3), ...cells]);
  }
  return table(rows);
}

/** Returns geometric means of `closer` and the share of the summed gain, over groups of materials. */
function means(results) {
  const rows = headed(['mean of', ...SHADINGS.flatMap(([name]) => [name, 'reachable', 'share of the gain'])]);
  for (const [title, group] of [
    ['metals', results.filter(({ kind }) => kind === 'metal')],
    ['dielectrics', results.filter(({ kind }) => kind === 'dielectric')],
    ['whole materials', results.filter(({ kind }) => kind === 'whole')],
  ]) {
    if (!group.length) continue;
    const cells = SHADINGS.flatMap(([, ours, best]) => {
      const [plain, error, reachable] = [
        group.map((result) => errorOf(result, 'original')),
        group.map((result) => errorOf(result, ours)),
        group.map((result) => leastOf(result, best)),
      ];
      const closer = (errors) => `${geometricMean(errors.map((e, i) => plain[i] / e)).toFixed(2)}x`;
      return [closer(error), closer(reachable), percent(share(mean(plain), mean(error), mean(reachable)))];
    });
    rows.push([`${group.length} ${title}`, ...cells]);
  }
  return table(rows);
}

/** Variants of the table of parts. */
export const PARTS = [
  'portable',
  'portable best',
  'portable float',
  'pyramid',
  'pyramid best',
  'pyramid float',
  'reflected',
];

/** Returns how many times closer than plain mips other variants are, and where: by light and by subject. */
function parts(results) {
  const rows = headed([
    'material',
    ...PARTS,
    'stock, suns',
    'stock, environment',
    'plugin, suns',
    'plugin, environment',
  ]);
  for (const result of results) {
    const plain = (light) => errorOf(result, 'original', light);
    const cells = PARTS.map((variant) => times(plain('both'), errorOf(result, variant)));
    for (const [, ours] of SHADINGS) {
      for (const light of ['suns', 'environment']) cells.push(times(plain(light), errorOf(result, ours, light)));
    }
    rows.push([result.name, ...cells]);
  }
  return table(rows);
}

/** Returns all tables. */
export function tables(results) {
  return [byMaterial(results), means(results), parts(results)].join('\n\n');
}
