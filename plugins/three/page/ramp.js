// The colours of the view “Difference”: black, purple, orange, yellow and white, of rising luminance.

/** Places in [0, 1] and their colours. Colours between two places are mixed linearly, as displayed. */
const STOPS = [
  [0, [0, 0, 0]],
  [0.341, [0.75, 0, 0.545]],
  [0.35, [0.77, 0.02, 0.56]],
  [0.4545, [1, 0.25, 0.393]],
  [0.7, [1, 0.79, 0]],
  [0.7955, [1, 1, 0.181]],
  [1, [1, 1, 0.57]],
];
/** Differences that the scale names. */
const TICKS = [0, 0.05, 0.25, 0.5, 1];

/** Returns the place of a difference in [0, 1]: small differences take most of the scale. */
const placeOf = (difference) => Math.sqrt(difference);

const percent = (share) => `${(100 * share).toFixed(2)}%`;

/** The function `vec3 ramp(float difference)` in GLSL. */
export const RAMP = /* glsl */ `
vec3 ramp( float difference ) {
  float x = sqrt( difference );
  vec3 c = vec3( 0.0 );
  ${STOPS.slice(1)
    .map(([place, colour], i) => {
      const [from] = STOPS[i];
      const share = `clamp( ( x - ${from.toFixed(4)} ) / ${(place - from).toFixed(4)}, 0.0, 1.0 )`;
      return `c = mix( c, vec3( ${colour.map((value) => value.toFixed(3)).join(', ')} ), ${share} );`;
    })
    .join('\n  ')}
  return c;
}
`;

/** Returns the scale as a CSS gradient. */
export function gradient() {
  const stops = STOPS.map(([place, colour]) => `rgb(${colour.map(percent).join(' ')}) ${percent(place)}`);
  return `linear-gradient(to right, ${stops.join(', ')})`;
}

/** Fills an element with the scale and its numbers. */
export function showScale(element) {
  const [bar, ticks] = [document.createElement('i'), document.createElement('div')];
  bar.style.background = gradient();
  ticks.append(
    ...TICKS.map((difference) => {
      const tick = Object.assign(document.createElement('span'), { textContent: difference });
      tick.style.left = percent(placeOf(difference));
      return tick;
    }),
  );
  element.append('Difference', bar, ticks);
}
