"""Textures with mip levels, filtered as a GPU does: trilinear, or anisotropic with several trilinear samples.

Vulkan 1.3, chapter "Image operations", sections on level of detail and on anisotropic filtering.
"""

import math

import numpy as np

MAX_ANISOTROPY = 8


class Texture:
    """Levels of float texels, (rows, columns, channels) each, that repeat in both directions."""

    def __init__(self, levels):
        self.levels = [np.ascontiguousarray(level, np.float32) for level in levels]

    def sample(self, uv, across, down, anisotropic):
        """Returns an array (pixels, channels): the texture at `uv` (repeats) with the derivatives `across`, `down`."""
        rows, columns = self.levels[0].shape[:2]
        count, lod, along = samples_of(across, down, (columns, rows), len(self.levels), anisotropic)
        result = np.zeros((len(lod), self.levels[0].shape[2]), np.float32)
        for taps in np.unique(count).astype(int):
            chosen = np.flatnonzero(count == taps)
            for tap in range(taps):
                offset = (tap + 0.5) / taps - 0.5
                place = tuple(c[chosen] + a[chosen] * offset for c, a in zip(uv, along))
                result[chosen] += self.trilinear(place, lod[chosen]) / taps
        return result

    def trilinear(self, uv, lod):
        """Returns the mean of the two nearest levels, weighted by distance."""
        result = np.zeros((len(lod), self.levels[0].shape[2]), np.float32)
        for level in range(math.floor(lod.min()), math.floor(lod.max()) + 2):
            weight = 1.0 - np.abs(lod - level)
            chosen = np.flatnonzero(weight > 0.0)
            if level < len(self.levels) and len(chosen):
                part = bilinear(self.levels[level], tuple(c[chosen] for c in uv))
                result[chosen] += part * weight[chosen, None].astype(np.float32)
        return result


def samples_of(across, down, size, levels, anisotropic):
    """Returns (count, level, step) of the trilinear samples that a filter takes of a texture.

    `across` and `down` are derivatives in repeats, `size` is (columns, rows), and `step` is the derivative along which
    the samples are spread evenly.
    """
    columns, rows = size
    x = np.hypot(across[0] * columns, across[1] * rows)
    y = np.hypot(down[0] * columns, down[1] * rows)
    longer, shorter = np.maximum(x, y), np.maximum(np.minimum(x, y), 1e-6)
    count = np.ones_like(x)
    if anisotropic:
        count = np.clip(np.ceil(longer / shorter), 1, MAX_ANISOTROPY)
    lod = np.clip(np.log2(np.maximum(longer / count, 1e-6)), 0.0, levels - 1)
    return count, lod, tuple(np.where(x >= y, a, d) for a, d in zip(across, down))


def bilinear(level, uv):
    """Returns the level at `uv`, interpolated between the four nearest texels."""
    rows, columns = level.shape[:2]
    x, y = uv[0] * columns - 0.5, uv[1] * rows - 0.5
    left, top = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    fx, fy = (x - left).astype(np.float32)[:, None], (y - top).astype(np.float32)[:, None]
    x0, x1, y0, y1 = left % columns, (left + 1) % columns, top % rows, (top + 1) % rows
    upper = level[y0, x0] * (1.0 - fx) + level[y0, x1] * fx
    lower = level[y1, x0] * (1.0 - fx) + level[y1, x1] * fx
    return upper * (1.0 - fy) + lower * fy


def halved(array):
    """Returns the next level of an array (rows, columns, channels): box-filtered, by area where a side is odd."""
    return halved_rows(halved_rows(array).swapaxes(0, 1)).swapaxes(0, 1)


def halved_rows(array):
    """Returns half as many rows. An odd number n = 2 m + 1 has three taps for each of m rows."""
    count = len(array)
    if count == 1:
        return array
    half = count // 2
    if count % 2 == 0:
        return (array[0::2] + array[1::2]) * 0.5
    row = np.arange(half).reshape(-1, 1, 1)
    first, last = array[0 : 2 * half : 2] * ((half - row) / count), array[2::2] * ((row + 1) / count)
    return first + array[1::2] * (half / count) + last


def chain(array, after=lambda level: level):
    """Returns all levels of an array. `after` changes each new level, before the next level is made of it."""
    levels = [after(array)]
    while max(levels[-1].shape[:2]) > 1:
        levels.append(after(halved(levels[-1])))
    return levels
