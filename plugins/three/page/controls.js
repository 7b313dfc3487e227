// The form and the keyboard, which change what is shown.

/** The farthest distance is so many times the nearest. */
const RANGE = 60;
/** Distance of the slider's left end, in units. */
const NEAREST = 2.2;
/** Maps 0 to 100 of the slider to units. */
const distanceOf = (value) => NEAREST * RANGE ** (value / 100);

const SHOWN = {
  distance: (v) => distanceOf(v).toFixed(1),
  environmentIntensity: (v) => `${v} %`,
  exposure: (v) => `${v > 0 ? '+' : ''}${(v / 10).toFixed(1)} EV`,
  intensity: (v) => (v / 100).toFixed(1),
  level: (v) => (v < 0 ? 'auto' : String(v)),
};
const degrees = (v) => `${Math.round(v)}°`;

export class Controls {
  /** Calls `changed` with the name of the control that changed. `keys` adds actions to keys on the picture. */
  constructor({ form, canvas, keys, changed }) {
    Object.assign(this, { form, keys, changed });
    form.addEventListener('input', ({ target }) => target.name && this.#notify(target.name));
    form.addEventListener('submit', (event) => event.preventDefault());
    canvas.addEventListener('keydown', (event) => this.#key(event));
    for (const element of form.elements) if (element.name) this.#label(element.name);
  }

  /** Returns a value, as a number where it is one. */
  value(name) {
    const element = this.form.elements[name];
    return element.type === 'range' ? Number(element.value) : element.value;
  }

  /** The distance of the camera in units. */
  get distance() {
    return distanceOf(this.value('distance'));
  }

  set distance(units) {
    this.form.elements.distance.value = (100 * Math.log(units / NEAREST)) / Math.log(RANGE);
    this.#label('distance');
  }

  /** Whether a control has another value than that of the document: browsers keep values when a page reloads. */
  isChanged(name) {
    const { value, defaultValue } = this.form.elements[name];
    return value !== defaultValue;
  }

  /** Multiplies the distance. */
  zoom(ratio) {
    this.step('distance', (100 * Math.log(ratio)) / Math.log(RANGE));
  }

  /** Fills a list of [value, title], and selects the wanted value if the list has it. */
  options(name, entries, wish) {
    const options = entries.map(([value, title]) => new Option(title, value, false, value === wish));
    this.form.elements[name].replaceChildren(...options);
  }

  step(name, by) {
    const element = this.form.elements[name];
    const around = name === 'azimuth' && Math.abs(Number(element.value) + by) > 180 ? -360 * Math.sign(by) : 0;
    element.value = Number(element.value) + by + around;
    this.#notify(name);
  }

  #next(name) {
    const element = this.form.elements[name];
    element.selectedIndex = (element.selectedIndex + 1) % element.length;
    this.#notify(name);
  }

  #notify(name) {
    this.#label(name);
    this.changed(name);
  }

  #label(name) {
    const output = this.form.elements[name]?.closest?.('label')?.querySelector('output');
    if (output) output.value = (SHOWN[name] ?? degrees)(this.value(name));
  }

  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const actions = {
      ArrowLeft: () => this.step('azimuth', -5),
      ArrowRight: () => this.step('azimuth', 5),
      ArrowUp: () => this.step('elevation', 5),
      ArrowDown: () => this.step('elevation', -5),
      '+': () => this.step('distance', -4),
      '=': () => this.step('distance', -4),
      '-': () => this.step('distance', 4),
      v: () => this.#next('view'),
      l: () => this.#next('layout'),
      ...this.keys,
    };
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const action = actions[event.shiftKey && key.startsWith('Arrow') ? `Shift+${key}` : key];
    if (!action) return;
    event.preventDefault();
    action();
  }
}
