// Pointers on the picture: one drags, two pinch, the wheel zooms, and a mouse hovers.

/**
 * Listens to the pointers on `element`. `dragged` gets a movement in CSS pixels and the kind of the pointer, `hovered`
 * a place, and `zoomed` a ratio of distances.
 */
export function listen(element, { dragged, hovered, zoomed }) {
  const pointers = new Map();
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  element.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      zoomed(1.0008 ** event.deltaY);
    },
    { passive: false },
  );
  element.addEventListener('pointerdown', (event) => {
    element.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  for (const end of ['pointerup', 'pointercancel'])
    element.addEventListener(end, (event) => pointers.delete(event.pointerId));
  element.addEventListener('pointermove', (event) => {
    const last = pointers.get(event.pointerId);
    const now = { x: event.clientX, y: event.clientY };
    if (!last) return hovered(event.offsetX, event.offsetY);
    const before = pointers.size === 2 ? spread() : 0;
    pointers.set(event.pointerId, now);
    if (pointers.size === 1) dragged(now.x - last.x, now.y - last.y, event.pointerType);
    else if (before > 0) zoomed(before / Math.max(spread(), 1));
  });
}
