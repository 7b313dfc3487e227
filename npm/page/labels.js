// The names and errors of the pictures, written on them.

/** Names of the pictures for a person. */
const TITLES = { before: 'Before', supersampled: 'Truth' };
/** Names of the picture `baked`, which shows the original as long as there is no bake. */
const [BAKED, UNBAKED] = [
  { busy: 'Earlier bake', other: 'Baked' },
  { busy: 'Baking …', other: 'Not baked' },
];
/** CSS pixels between a label and the edges of its picture. */
const GAP = 8;

/**
 * Returns the name of a picture for a person.
 *
 * @param {string} name
 * @param {boolean} isBaked whether there is a bake of the file
 * @param {boolean} isBusy whether a bake runs
 */
function titleOf(name, isBaked, isBusy) {
  return TITLES[name] ?? (isBaked ? BAKED : UNBAKED)[isBusy ? 'busy' : 'other'];
}

/**
 * Writes a label at the top of each picture: the name, and the error once it is measured.
 *
 * @param {HTMLElement} parent of the labels
 * @param {{places: import('./screen.js').Place[], errors: Record<string, number | null>, isBaked: boolean}} frame
 * @param {boolean} isBusy whether a bake runs
 */
export function label(parent, { places, errors, isBaked }, isBusy) {
  const height = parent.parentElement.clientHeight;
  const spans = places.map(({ name, window: [x, y, w, h] }) => {
    const error = errors[name] == null ? '' : `, error ${errors[name].toFixed(3)}`;
    const span = Object.assign(document.createElement('span'), { textContent: titleOf(name, isBaked, isBusy) + error });
    span.dataset.name = name;
    span.style.top = `${height - y - h + GAP}px`;
    span.style.left = `${x + GAP}px`;
    span.style.maxWidth = `${Math.max(w - 2 * GAP, 0)}px`;
    span.hidden = w < 4 * GAP;
    return span;
  });
  parent.replaceChildren(...spans);
}
