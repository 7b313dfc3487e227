"""Pictures of a baked material in which one part at a time is exact, and their errors.

Light of a baked pixel is one lobe, times the reflectance of one F0, plus one albedo times the cosine of one normal. All
of them come out of texture filters. Light of a footprint is a mean over level 0. Each part of the baked light can be
replaced by the exact mean over the filter's footprint, and the truth has the footprint of the pixel instead.
"""

from dataclasses import dataclass, replace

import numpy as np

import footprints
import formula
import shading
from encoding import in_8_bits, unit
from filtering import Texture, chain
from peers import resized
from variants import Variant

# Powers of the length of the mean normal that darken diffuse light.
POWERS = (0.0, 0.5, 1.0)
# Rec. 709.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)


@dataclass
class Material:
    """What the study compares: the level 0, its maps for Mitsuba, and variants by name."""

    source: object
    maps: object
    plain: object
    bake: object
    best: object

    def __post_init__(self):
        means = chain(unit(self.source.normal))
        self.length = Texture([in_8_bits(np.linalg.norm(mean, axis=-1, keepdims=True)) for mean in means])
        self.weighted = with_metalness(self.bake, metalness_by_colour(self.source))


def metalness_by_colour(source):
    """Returns mips of metalness m that are weighted by the luminance c of the base colour: sum(c m) / sum(c).

    Filters keep the mean of c, so that c m of a mip is the mean of c m, and c (1 - m) is the mean of c (1 - m).
    """
    shape = np.maximum(source.orm.shape, source.colour.shape)
    metalness = resized(source.orm[..., 2:3], shape)
    weight = resized(source.colour, shape) @ LUMINANCE + 1e-6
    levels = zip(chain(weight[..., None] * metalness), chain(weight[..., None]))
    return Texture([in_8_bits(over / under) for over, under in levels])


def with_metalness(variant, texture):
    """Returns a variant with another texture of metalness."""
    decode = lambda s: replace(variant.decode(s), metalness=s["weighted"][:, 0])
    return Variant("metalness by colour", {**variant.textures, "weighted": texture}, decode)


def light(view_pixels, surface, suns):
    """Returns pictures (lights, pixels, 3) of the lobes and of diffuse light."""
    axes, alphas, f0, albedo = surface
    black = tuple(np.zeros_like(a) for a in albedo)
    specular = shading.render(view_pixels, (axes, alphas, f0, black), suns)
    return specular, lambert(axes[0], albedo, suns)


def lambert(normal, albedo, suns):
    """Returns pictures of diffuse light."""
    return np.array([np.stack(part, axis=-1) for part in footprints.diffuse(np, normal, albedo, suns)])


def white(view_pixels, surface):
    """Returns the light of lobes (pixels, 3) under an environment whose radiance is 1 everywhere."""
    axes, alphas, f0, _ = shading.as_floats(surface)
    eye = shading.as_floats(view_pixels["eye"])
    seen = (formula.turned_to(np, axes, eye), alphas, f0, None)
    total, shares = 0.0, 0.0
    for points, weight in shading.half_vector_points(shading.HALF_VECTORS):
        _, share, fresnel = formula.reflected(np, seen, eye, points)
        total, shares = total + weight * share * np.array(fresnel), shares + weight * share
    return (total * np.array(formula.compensation(np, f0, shares))).T


def errors(material, view, view_pixels, anisotropic, truth, samples):
    """Returns the errors of all rows of the page in one view: dictionaries of `suns` and `environment`."""
    size, suns = material.source.size, view.suns
    surface_of = lambda variant: variant.surface(view_pixels, size, anisotropic)
    picture_of = lambda surface: sum(light(view_pixels, surface, suns))
    baked = surface_of(material.bake)
    axes, alphas, f0, albedo = baked
    exact = footprints.means(view_pixels, material.maps, suns, anisotropic, f0, samples)
    # Colours as baked by exact mean colours.
    f0_share, albedo_share = ratio(np.array(f0).T, exact.f0), ratio(np.array(albedo).T, exact.albedo)
    specular, diffuse = light(view_pixels, baked, suns)
    picture = specular + diffuse
    energy = exact.white * f0_share / white(view_pixels, baked)
    pairs = {
        "plain mips": (picture_of(surface_of(material.plain)), truth),
        "bake": (picture, truth),
        "bake in floats": (picture_of(surface_of(material.best)), truth),
        "exact lobes": (exact.specular * f0_share + diffuse, truth),
        "exact lobes by area": (exact.specular_of_one_f0 + diffuse, truth),
        "exact energy of lobes": (specular * energy + diffuse, truth),
        "exact diffuse light": (specular + exact.diffuse * albedo_share, truth),
        "exact mean colours": (picture_of((axes, alphas, tuple(exact.f0.T), tuple(exact.albedo.T))), truth),
        "metalness by colour": (picture_of(surface_of(material.weighted)), truth),
        "exact filter": (picture, exact.picture),
        "only the filter": (exact.picture, truth),
        "only the lobes": (specular / f0_share, exact.specular),
        "only the diffuse light": (diffuse / np.maximum(albedo_share, 1e-6), exact.diffuse),
        "only the colours": (exact.specular * f0_share + exact.diffuse * albedo_share, exact.picture),
        "light of exact lobes": (exact.specular, truth),
    }
    length = material.length.sample(*in_repeats(view_pixels, size), anisotropic)
    for power in POWERS:
        pairs[power_name(power)] = (specular + diffuse * length**power, truth)
    return {name: compared(*pair, truth) for name, pair in pairs.items()}


def power_name(power):
    """Returns the row of a power of the length of the mean normal."""
    return f"power {power:g}"


def in_repeats(view_pixels, size):
    """Returns texture coordinates and their derivatives in repeats."""
    return (tuple(t / s for t, s in zip(view_pixels[name], size)) for name in ("texel", "across", "down"))


def ratio(over, under):
    """Returns the quotient of two pictures, or 1 where both are black."""
    return np.where(under > 1e-12, over / np.maximum(under, 1e-12), 1.0)


def compared(picture, right, truth):
    """Returns the relative L1 of a picture, and its light by that of the truth, under suns and the environment."""
    result = {}
    for name, lights in (("environment", slice(0, 1)), ("suns", slice(1, None))):
        whole = truth[lights].sum(dtype=np.float64)
        result[name] = float(np.abs(picture[lights] - right[lights]).sum(dtype=np.float64) / whole)
        result[f"light, {name}"] = float(picture[lights].sum(dtype=np.float64) / whole)
    return result
