// Pointer, wheel and keyboard on the picture: the divider, the layout, the camera.

const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
const NEAREST = 2;
const FARTHEST = 60;
/** Half of the width in CSS pixels of the strip in which a press takes the divider. */
const GRIP = 24;

/**
 * Lets a person move the divider and the camera, and change the layout.
 *
 * @param {HTMLCanvasElement} canvas
 * @param {import('./stage.js').Stage} stage
 * @param {(change: object) => void} set changes members of the view
 */
export function control(canvas, stage, set) {
  const zoom = (factor) => set({ radius: clamp(stage.view.radius * factor, NEAREST, FARTHEST) });
  const turn = (azimuth, elevation) =>
    set({
      azimuth: stage.view.azimuth + azimuth,
      elevation: clamp(stage.view.elevation + elevation, -89, 89),
    });
  const slide = (split) => set({ split: clamp(split, 0, 1) });

  /** The pointers that are down, with their last places. */
  const pointers = new Map();
  let takesDivider = false;
  const shareOf = (event) => (event.clientX - canvas.getBoundingClientRect().left) / canvas.clientWidth;

  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event);
    takesDivider =
      stage.view.layout === 'divider' &&
      pointers.size === 1 &&
      Math.abs(shareOf(event) - stage.view.split) * canvas.clientWidth < GRIP;
  });
  canvas.addEventListener('pointermove', (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const spread = () => {
      const [a, b] = [...pointers.values()];
      return Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
    };
    const before = pointers.size === 2 ? spread() : 0;
    pointers.set(event.pointerId, event);
    if (pointers.size === 2) zoom(before / Math.max(spread(), 1));
    else if (takesDivider) slide(shareOf(event));
    else turn((last.clientX - event.clientX) * 0.4, (event.clientY - last.clientY) * 0.4);
  });
  for (const name of ['pointerup', 'pointercancel']) {
    canvas.addEventListener(name, (event) => pointers.delete(event.pointerId));
  }
  canvas.addEventListener(
    'wheel',
    (event) => {
      // Otherwise the page scrolls. Browsers give pinches on touchpads as wheels with Ctrl.
      if (!event.ctrlKey && !event.metaKey && document.activeElement !== canvas) return;
      event.preventDefault();
      zoom(Math.exp(event.deltaY * 0.001));
    },
    { passive: false },
  );
  const keys = {
    ArrowLeft: () => turn(-5, 0),
    ArrowRight: () => turn(5, 0),
    ArrowUp: () => turn(0, 5),
    ArrowDown: () => turn(0, -5),
    '+': () => zoom(0.9),
    '=': () => zoom(0.9),
    '-': () => zoom(1 / 0.9),
    l: () => set({ layout: stage.view.layout === 'all' ? 'divider' : 'all' }),
    '[': () => slide(stage.view.split - 0.05),
    ']': () => slide(stage.view.split + 0.05),
  };
  canvas.addEventListener('keydown', (event) => {
    if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
  });
}
