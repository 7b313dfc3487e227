// The table of errors and bytes.
import { readable } from './bytes.js';
import { MISDRAWN, TITLES } from './variants.js';

/** Writes an error for people. */
export const percent = (error) => `${(100 * error).toFixed(error < 0.1 ? 1 : 0)} %`;

/** Makes a row that explains the row above it. */
function reason(text) {
  const row = Object.assign(document.createElement('tr'), { className: 'reason' });
  row.append(cell('td', text, { colSpan: 4 }));
  return row;
}

const cell = (tag, text, settings = {}) =>
  Object.assign(document.createElement(tag), { textContent: text, ...settings });

export class Figures {
  #errors = new Map();
  #isStale = true;

  /** `body` takes the rows, and `note` says how the errors were measured. */
  constructor({ body, note }) {
    Object.assign(this, { body, note });
  }

  /** Shows the assets by name, as a loader returns them. */
  show(assets) {
    this.assets = assets;
    this.#errors = new Map();
    this.#render();
  }

  /** Returns the error of a variant as text, or nothing. */
  errorOf(name) {
    const error = this.#isStale ? null : this.#errors.get(name);
    return error == null ? '' : percent(error);
  }

  /** Shows errors that were measured against `samples` samples per pixel. */
  measured(errors, samples) {
    [this.#errors, this.#isStale, this.samples] = [errors, false, samples];
    this.#render();
  }

  /** Marks the errors as those of an earlier picture. */
  expire() {
    if (this.#isStale) return;
    this.#isStale = true;
    this.#render();
  }

  #render() {
    const known = [...this.#errors.values()].filter((error) => error !== null);
    const best = known.length > 1 ? Math.min(...known) : null;
    // Errors that read alike are a tie.
    const isTie = known.filter((error) => percent(error) === percent(best)).length > 1;
    this.body.replaceChildren(
      ...[...this.assets].flatMap(([name, { files, textures, isMisdrawn }]) => {
        const row = document.createElement('tr');
        const error = this.#errors.get(name);
        const isBest = error != null && error === best && !isTie;
        row.append(
          cell('th', TITLES[name], { scope: 'row' }),
          cell('td', error == null ? '–' : percent(error), { className: isBest ? 'error best' : 'error' }),
          cell('td', readable(files)),
          cell('td', readable(textures)),
        );
        return isMisdrawn ? [row, reason(MISDRAWN)] : [row];
      }),
    );
    this.body.classList.toggle('stale', this.#isStale);
    this.note.textContent = this.#explain();
  }

  #explain() {
    if (!this.assets.has('original')) return 'Errors need the original asset: the supersampled picture is made of it.';
    if (this.#errors.size === 0) return 'Errors are measured when the picture rests.';
    return this.#isStale
      ? 'Errors of the last picture at rest. They are measured again when the picture rests.'
      : `Errors of this picture against ${this.samples} samples per pixel.`;
  }
}
