// Vectors as arrays of numbers.

export const dot = (a, b) => a.reduce((total, value, i) => total + value * b[i], 0);
export const normalised = (a) => a.map((value) => value / Math.hypot(...a));
export const cross = ([a, b, c], [x, y, z]) => [b * z - c * y, c * x - a * z, a * y - b * x];
/** Returns the sum of vectors, each with its factor. */
export const sum = (...terms) => terms[0][0].map((_, i) => terms.reduce((all, [a, factor]) => all + factor * a[i], 0));
export const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
