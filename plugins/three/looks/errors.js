// Errors of a picture against the supersampled truth. Pictures are RGBA floats of linear radiance, row by row.

/** Returns the sum of |picture - truth| over the sum of the truth. */
export function relativeL1(picture, truth) {
  let [off, total] = [0, 0];
  for (let i = 0; i < truth.length; i++) {
    if (i % 4 === 3) continue;
    off += Math.abs(picture[i] - truth[i]);
    total += truth[i];
  }
  return total > 0 ? off / total : 0;
}

/** Returns the luminance as displayed, in [0, 1]: x / (1 + x), then the sRGB curve. */
export function displayed(picture) {
  const grey = new Float64Array(picture.length / 4);
  for (let i = 0; i < grey.length; i++) {
    const y = 0.2126 * picture[4 * i] + 0.7152 * picture[4 * i + 1] + 0.0722 * picture[4 * i + 2];
    const tone = Math.max(y, 0) / (1 + Math.max(y, 0));
    grey[i] = tone <= 0.0031308 ? 12.92 * tone : 1.055 * tone ** (1 / 2.4) - 0.055;
  }
  return grey;
}

/** Side of the windows of SSIM. */
const WINDOW = 7;

/**
 * Returns the mean structural similarity of the displayed pictures (Z. Wang et al., "Image quality assessment", 2004,
 * eq. 13, with square windows), over windows in which the truth is not empty.
 */
export function ssim(picture, truth, width) {
  const [a, b] = [displayed(picture), displayed(truth)];
  const height = a.length / width;
  let [sum, count] = [0, 0];
  for (let top = 0; top + WINDOW <= height; top++) {
    for (let left = 0; left + WINDOW <= width; left++) {
      let [ma, mb, aa, bb, ab] = [0, 0, 0, 0, 0];
      for (let y = top; y < top + WINDOW; y++) {
        for (let i = y * width + left; i < y * width + left + WINDOW; i++) {
          ma += a[i];
          mb += b[i];
          aa += a[i] * a[i];
          bb += b[i] * b[i];
          ab += a[i] * b[i];
        }
      }
      if (mb === 0) continue;
      const n = WINDOW * WINDOW;
      [ma, mb] = [ma / n, mb / n];
      const [va, vb, cov] = [aa / n - ma * ma, bb / n - mb * mb, ab / n - ma * mb];
      const [c1, c2] = [0.01 ** 2, 0.03 ** 2];
      sum += ((2 * ma * mb + c1) * (2 * cov + c2)) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
      count++;
    }
  }
  return count > 0 ? sum / count : 1;
}

/**
 * Returns the mean over pixels of the variance over time of (picture - truth) as displayed: flicker that the truth
 * lacks.
 */
export function flicker(pictures, truths) {
  const frames = pictures.map((picture, t) => {
    const truth = displayed(truths[t]);
    return displayed(picture).map((value, i) => value - truth[i]);
  });
  let sum = 0;
  for (let i = 0; i < frames[0].length; i++) {
    const mean = frames.reduce((total, frame) => total + frame[i], 0) / frames.length;
    sum += frames.reduce((total, frame) => total + (frame[i] - mean) ** 2, 0) / frames.length;
  }
  return sum / frames[0].length;
}
