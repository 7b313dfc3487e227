"""Plain mips, and lobes that other tools and papers make of level 0 by their own formulas.

Normals are ordinary mips in 8 bits. Roughness has 8 bits as well, and LEAN's moments are half floats, as its authors
store them. No peer has blocks of a compressed format, which could only add to its error.
"""

import functools

import numpy as np

from encoding import in_8_bits, in_half_floats, unit
from filtering import Texture, chain
from variants import Lobes, Variant, channels, ellipse, gltf_textures, isotropic, normal_texture


def plain(source):
    """Returns ordinary mips: the normals lose their bumps, and roughness stays."""
    decode = lambda s: isotropic(s["normal"], s["orm"][:, 1], s["orm"], s["colour"])
    return Variant("plain mips", {"normal": normal_texture(source), **gltf_textures(source)}, decode)


def toksvig_roughness(r, length):
    """Returns roughness by M. Toksvig, "Mipmapping normal maps", 2005: s' = s |N| / (|N| + s (1 - |N|)), with the
    exponent s = 2 / alpha^2 - 2."""
    s = 2.0 / np.maximum(r**4, 1e-12) - 2.0
    shrunk = s * length / np.maximum(length + s * (1.0 - length), 1e-12)
    return (2.0 / (shrunk + 2.0)) ** 0.25


def vmf_spread(length):
    """Returns 1 / kappa of the von Mises-Fisher lobe whose mean has this length (A. Banerjee et al., "Clustering on
    the unit hypersphere using von Mises-Fisher distributions", 2005, eq. 4.4)."""
    return (1.0 - length**2) / np.maximum(length * (3.0 - length**2), 1e-12)


def filament_roughness(r, length):
    """Returns roughness by Filament's `roughness-prefilter`: r'^2 = r^2 + 2 / kappa."""
    return np.sqrt(r**2 + 2.0 * vmf_spread(length))


def godot_roughness(r, length):
    """Returns roughness by Godot's import with a normal map: r'^2 = r^2 + min(0.75 / kappa, 0.16)."""
    return np.sqrt(r**2 + np.minimum(0.75 * vmf_spread(length), 0.16))


def by_length(name, formula):
    """Returns a peer that computes the roughness of each mip from roughness and the length of the mean normal."""

    def build(source):
        textures = {"normal": normal_texture(source), **gltf_textures(source)}
        roughness = chain(source.orm[..., 1:2], in_8_bits)
        lengths = [np.minimum(np.linalg.norm(mean, axis=-1, keepdims=True), 1.0) for mean in chain(unit(source.normal))]
        levels = [formula(resized(r, n.shape), n) for r, n in zip(padded(roughness, len(lengths)), lengths)]
        textures["roughness"] = Texture([in_8_bits(level) for level in levels])
        decode = lambda s: isotropic(s["normal"], s["roughness"][:, 0], s["orm"], s["colour"])
        return Variant(name, textures, decode)

    return build


def chan(source):
    """Returns D. Chan's gloss from normal length ("Material advances in Call of Duty: WWII", SIGGRAPH 2018 course):
    each texel's normal is as long as the mean half-vector of its lobe, and the mean of those vectors over a footprint
    gives the roughness."""
    roughness = resized(source.orm[..., 1:2], source.normal.shape)
    means = chain(unit(source.normal) * length_of_alpha(roughness**2))
    levels = [np.sqrt(alpha_of_length(np.linalg.norm(mean, axis=-1, keepdims=True))) for mean in means]
    textures = {"normal": normal_texture(source), **gltf_textures(source)}
    textures["roughness"] = Texture([in_8_bits(level) for level in levels])
    decode = lambda s: isotropic(s["normal"], s["roughness"][:, 0], s["orm"], s["colour"])
    return Variant("Chan, WWII", textures, decode)


def length_of_alpha(alpha):
    """Returns the length of the mean of half-vectors h drawn from D(h) (n.h) of GGX: with a = sqrt(1 - alpha^2),
    (a - (1 - a^2) atanh(a)) / a^3."""
    # In double precision, since a of smooth surfaces differs from 1 by 5e-9.
    a = np.sqrt(1.0 - np.clip(np.asarray(alpha, np.float64), 1e-4, 0.9995) ** 2)
    return (a - (1.0 - a * a) * np.arctanh(a)) / a**3


@functools.cache
def length_table():
    """Returns alphas in descending order and their lengths in ascending order."""
    alphas = np.linspace(0.9995, 1e-4, 8192)
    return alphas, length_of_alpha(alphas)


def alpha_of_length(length):
    """Returns the inverse of `length_of_alpha`."""
    alphas, lengths = length_table()
    return np.interp(length, lengths, alphas)


def lean(source):
    """Returns M. Olano, D. Baker, "LEAN mapping", 2010: mean and second moments of slopes as half floats, which filter
    linearly; the lobe has A' = A + 2 K, with K by subtraction."""
    normal = unit(source.normal)
    slopes = -normal[..., :2] / np.maximum(normal[..., 2:], 0.05)
    u, v = slopes[..., 0], slopes[..., 1]
    moments = np.stack([u, v, u * u, u * v, v * v], axis=-1)
    textures = {"moments": Texture([in_half_floats(level) for level in chain(moments)]), **gltf_textures(source)}

    def decode(s):
        u, v, uu, uv, vv = channels(s["moments"], 5)
        k_uu, k_vv = np.maximum(uu - u * u, 0.0), np.maximum(vv - v * v, 0.0)
        bound = np.sqrt(k_uu * k_vv)
        base = s["orm"][:, 1] ** 4
        alphas, axis = ellipse(base + 2.0 * k_uu, 2.0 * np.clip(uv - u * v, -bound, bound), base + 2.0 * k_vv)
        return Lobes((-u, -v, np.ones_like(u)), alphas, channels(s["colour"]), s["orm"][:, 2], axis)

    return Variant("LEAN", textures, decode)


def resized(array, shape):
    """Returns an array with as many rows and columns as `shape`, by the nearest texel."""
    rows = np.arange(shape[0]) * array.shape[0] // shape[0]
    columns = np.arange(shape[1]) * array.shape[1] // shape[1]
    return array[rows][:, columns]


def padded(levels, count):
    """Returns `count` levels: the first ones are left out, or the last one is repeated."""
    levels = levels[max(len(levels) - count, 0) :]
    return levels + [levels[-1]] * (count - len(levels))


PEERS = [
    plain,
    by_length("Toksvig", toksvig_roughness),
    by_length("Filament vMF", filament_roughness),
    by_length("Godot", godot_roughness),
    chan,
    lean,
]
