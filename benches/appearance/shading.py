"""Pictures of a variant: one shading point for each pixel, as a game draws it."""

import functools
import math

import numpy as np

import formula
import lights

# Half-vectors of the environment's integral for each pixel. The error of the integral is at most 2.5 % for lobes of any
# width (test `half_vectors_are_enough`); with 48 it was 4 to 9 % for wide lobes, and counted against them.
HALF_VECTORS = 128


def render(view_pixels, surface, suns, half_vectors=HALF_VECTORS):
    """Returns radiance (lights, pixels, 3): under the environment, then under each sun."""
    surface = tuple(as_floats(part) for part in surface)
    eye = as_floats(view_pixels["eye"])
    pictures = [environment(surface, eye, half_vectors)]
    pictures += [formula.under_sun(np, surface, eye, tuple(float(c) for c in sun)) for sun in suns]
    shape = np.shape(eye[0])
    return np.array([[np.broadcast_to(channel, shape) for channel in picture] for picture in pictures]).swapaxes(1, 2)


def as_floats(part):
    """Returns tuples of arrays, or tuples of tuples, in single precision."""
    if isinstance(part, tuple):
        return tuple(as_floats(item) for item in part)
    return np.asarray(part, np.float32)


def environment(surface, eye, half_vectors):
    """Returns three channels of light from all around, by an even sequence of half-vectors of the lobe."""
    axes, alphas, f0, albedo = surface
    seen = (formula.turned_to(np, axes, eye), alphas, f0, albedo)
    total, shares = [0.0, 0.0, 0.0], 0.0
    for points, weight in half_vector_points(half_vectors):
        ray, share, fresnel = formula.reflected(np, seen, eye, points)
        share = share * weight
        total = [t + share * f * l for t, f, l in zip(total, fresnel, lights.environment(np, ray))]
        shares = shares + share
    factor = formula.compensation(np, f0, shares)
    diffuse = lights.diffuse(np, axes[0])
    return [t * c + a * d for t, c, a, d in zip(total, factor, albedo, diffuse)]


@functools.cache
def half_vector_points(count):
    """Returns slopes of a GGX lobe with alpha 1, and their weights. Half-vectors of the tail are drawn more often than
    their share u in [0, 1]: u = 1 - (1 - x)^2 for even x."""
    points = []
    for i in range(count):
        x = (i + 0.5) / count
        u = 1.0 - (1.0 - x) ** 2
        slope, angle = math.sqrt(u / (1.0 - u)), 2.0 * math.pi * i * 0.6180339887498949
        points.append(((slope * math.cos(angle), slope * math.sin(angle)), 2.0 * (1.0 - x) / count))
    return points


def albedo_table(size=48):
    """Returns E, the mean share of the rays of isotropic lobes, for alphas (rows) and cosines to the eye (columns)."""
    alpha, cosine = np.meshgrid(*((np.arange(size) + 0.5) / size,) * 2, indexing="ij")
    zero, one = np.zeros_like(alpha), np.ones_like(alpha)
    axes = ((zero, zero, one), (one, zero, zero), (zero, one, zero))
    surface = (axes, (alpha, alpha), (one,), None)
    eye = (np.sqrt(1.0 - cosine**2), zero, cosine)
    return sum(formula.reflected(np, surface, eye, points)[1] * w for points, w in half_vector_points(2048))
