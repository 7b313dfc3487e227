"""Exact light from the footprint that a texture filter averages, by supersampling with Mitsuba's textures.

A filter reads texels of two levels, and each of these texels is the mean of a box of level 0. A filtered value is
therefore a weighted mean of level 0. Here points of level 0 are drawn by that weight, and each of them is shaded with
its own normal, roughness and colour. Geometry is that of the pixel's centre, as it is for the one shading point of a
baked texture. The result has no error but those of the filter and of sampling.
"""

from dataclasses import dataclass

import drjit as dr
import numpy as np

import formula
import lights
from filtering import samples_of
from formula import add
from truth import mi, opaque

# Steps of an evenly spread sequence in eight dimensions: powers of 1 / g, where g^9 = g + 1 (M. Roberts, "The
# unreasonable effectiveness of quasirandom sequences", 2018).
STEPS = [(1.0 / 1.0850702) ** (k + 1) % 1.0 for k in range(8)]


@dataclass
class Means:
    """Means over the footprint of each pixel. Pictures are (lights, pixels, 3), the environment first."""

    # Light of the lobes, and of the same lobes with one F0 for the whole footprint.
    specular: np.ndarray
    specular_of_one_f0: np.ndarray
    diffuse: np.ndarray
    # Reflecting colours (pixels, 3).
    f0: np.ndarray
    albedo: np.ndarray
    # Light of the lobes (pixels, 3) under an environment whose radiance is 1 everywhere.
    white: np.ndarray

    @property
    def picture(self):
        """Returns all light."""
        return self.specular + self.diffuse


def means(view_pixels, maps, suns, anisotropic, f0, samples):
    """Returns the means over the footprints of a view's pixels. `f0` has three channels of each pixel: the one F0."""
    levels = max(maps.size).bit_length()
    scaled = lambda texels: tuple(t / s for t, s in zip(texels, maps.size))
    across, down = scaled(view_pixels["across"]), scaled(view_pixels["down"])
    count, lod, along = samples_of(across, down, maps.size, levels, anisotropic)
    number = lambda values: mi.Float(np.ascontiguousarray(values, np.float32))
    vector = lambda values: tuple(number(v) for v in values)
    pixel = {name: vector(view_pixels[name]) for name in ("normal", "tangent", "eye")}
    filtered = Filter(vector(scaled(view_pixels["texel"])), vector(along), number(count), number(lod), maps.size)
    suns = [tuple(opaque(c) for c in sun) for sun in suns]
    one_f0 = vector(f0)
    random = mi.PCG32(size=len(lod), initstate=1)
    shifts = [random.next_float32() for _ in STEPS]
    dr.eval(shifts)

    def sample(i, sums):
        point = [fraction(shift + mi.Float(i) * step) for shift, step in zip(shifts, STEPS)]
        surface = maps.surface(filtered.texel(point), pixel["normal"], pixel["tangent"])
        parts = shade(maps, surface, pixel["eye"], suns, one_f0, point)
        return i + 1, [add(total, part) for total, part in zip(sums, parts)]

    pictures = 1 + len(suns)
    zeros = [tuple(dr.zeros(mi.Float, len(lod)) for _ in range(3)) for _ in range(3 * pictures + 3)]
    count = mi.UInt32(opaque(samples))
    _, sums = dr.while_loop((dr.zeros(mi.UInt32, len(lod)), zeros), lambda i, sums: i < count, sample)
    dr.eval(sums)
    sums = np.array([[np.array(channel) for channel in part] for part in sums]).transpose(0, 2, 1) / samples
    specular, of_one, diffuse = (sums[k * pictures : (k + 1) * pictures] for k in range(3))
    return Means(specular, of_one, diffuse, *sums[3 * pictures :])


def fraction(x):
    """Returns what is left of the largest whole number below."""
    return x - dr.floor(x)


@dataclass
class Filter:
    """The filters of all pixels: place and step in repeats, number of samples, level of detail, size of level 0."""

    place: tuple
    along: tuple
    count: mi.Float
    lod: mi.Float
    size: tuple

    def texel(self, point):
        """Returns texel coordinates of level 0, drawn by their weight in the filter. `point` has eight numbers from 0
        to 1, of which the first six choose the sample, the level, the texel, and the place in the texel."""
        offset = (dr.floor(point[0] * self.count) + 0.5) / self.count - 0.5
        lower = dr.floor(self.lod)
        level = lower + dr.select(point[1] < self.lod - lower, 1.0, 0.0)
        return tuple(
            self.along_axis(place + step * offset, level, side, choice, within)
            for place, step, side, choice, within in zip(self.place, self.along, self.size, point[2:4], point[4:6])
        )

    @staticmethod
    def along_axis(place, level, side, choice, within):
        """Returns one coordinate: that of the bilinear sample at level 0, or a point of one of its two texels."""
        texels = dr.maximum(dr.floor(side * dr.exp2(-level) + 1e-3), 1.0)
        texel = dr.floor(place * texels - 0.5 + choice)
        return dr.select(level < 0.5, place * side, (texel + within) * (side / texels))


def shade(maps, surface, eye, suns, one_f0, point):
    """Returns the parts of `Means` for one sample, as triples in their order."""
    axes, alphas, f0, albedo = surface
    seen = formula.turned_to(dr, axes, eye)
    distance, angle = dr.sqrt(point[6] / dr.maximum(1.0 - point[6], 1e-6)), 2.0 * dr.pi * point[7]
    points = (distance * dr.cos(angle), distance * dr.sin(angle))
    ray, share, (rest,) = formula.reflected(dr, (seen, alphas, (0.0,), albedo), eye, points)
    light = lights.environment(dr, ray)

    def reflected(colour):
        factors = maps.compensation((axes, alphas, colour, albedo), eye)
        # Schlick's term of F0 is F0 + (1 - F0) of the term of 0.
        return tuple(share * (f + (1.0 - f) * rest) * k for f, k in zip(colour, factors))

    white = reflected(f0)
    specular = [tuple(w * l for w, l in zip(white, light))]
    specular_of_one = [tuple(w * l for w, l in zip(reflected(one_f0), light))]
    for sun in suns:
        # A white lobe without diffuse light: its Fresnel term is 1.
        (lobe,) = formula.under_sun(dr, (axes, alphas, (1.0,), (0.0,)), eye, sun)
        cosine = dr.clip(formula.dot(eye, formula.normalised(dr, add(eye, sun))), 0.0, 1.0)
        specular.append(formula.scale(formula.fresnel(f0, cosine), lobe))
        specular_of_one.append(formula.scale(formula.fresnel(one_f0, cosine), lobe))
    return [*specular, *specular_of_one, *diffuse(dr, axes[0], albedo, suns), f0, albedo, white]


def diffuse(xp, normal, albedo, suns):
    """Returns diffuse light as triples: under the environment, then under each sun."""
    cosines = [(xp.maximum(formula.dot(normal, sun), 0.0),) * 3 for sun in suns]
    return [tuple(a * c for a, c in zip(albedo, light)) for light in [lights.diffuse(xp, normal), *cosines]]
