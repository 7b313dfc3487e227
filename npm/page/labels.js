// The names and errors of the pictures, written on them.

/** Names of the pictures for a person. */
const TITLES = { before: 'Before', baked: 'Baked', supersampled: 'Truth' };
/** CSS pixels between a label and the edges of its picture. */
const GAP = 8;

/**
 * Writes a label at the top of each picture: the name, and the error once it is measured.
 *
 * @param {HTMLElement} parent of the labels
 * @param {import('./screen.js').Place[]} places
 * @param {Record<string, number | null>} errors
 * @param {number} height of the screen in CSS pixels
 */
export function label(parent, places, errors, height) {
  const spans = places.map(({ name, window: [x, y, w, h] }) => {
    const error = errors[name] == null ? '' : `, error ${errors[name].toFixed(3)}`;
    const span = Object.assign(document.createElement('span'), { textContent: TITLES[name] + error });
    span.dataset.name = name;
    span.style.top = `${height - y - h + GAP}px`;
    span.style.left = `${x + GAP}px`;
    span.style.maxWidth = `${Math.max(w - 2 * GAP, 0)}px`;
    span.hidden = w < 4 * GAP;
    return span;
  });
  parent.replaceChildren(...spans);
}
