"""Storage of texels: 8 bits, sRGB, half floats, and normals as glTF stores them."""

import numpy as np


def in_8_bits(array):
    """Returns values from 0 to 1 as a texture of 8 bits has them."""
    return np.round(np.clip(array, 0.0, 1.0) * 255.0) / 255.0


def to_linear(array):
    """Returns sRGB values as linear light."""
    return np.where(array <= 0.04045, array / 12.92, ((array + 0.055) / 1.055) ** 2.4)


def to_srgb(array):
    """Returns linear light as sRGB values."""
    array = np.clip(array, 0.0, 1.0)
    return np.where(array <= 0.0031308, array * 12.92, 1.055 * array ** (1 / 2.4) - 0.055)


def srgb_in_8_bits(linear):
    """Returns linear light as a texture in sRGB of 8 bits has it."""
    return to_linear(in_8_bits(to_srgb(linear)))


def normals_in_8_bits(normals):
    """Returns unit vectors as a texture of 8 bits has them: renormalised, then rounded."""
    return in_8_bits(unit(normals) * 0.5 + 0.5) * 2.0 - 1.0


def in_half_floats(array):
    """Returns values as a texture of half floats has them."""
    return np.asarray(array).astype(np.float16).astype(np.float32)


def unit(vectors):
    """Returns vectors (..., 3) with length 1."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9)
