"""What all variants share: textures, the lobes that a shader decodes from filtered texels, and shaded pixels."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import formula
import lights
from encoding import in_8_bits, normals_in_8_bits, srgb_in_8_bits
from filtering import Texture, chain


@dataclass
class Lobes:
    """Lobes of pixels: a normal (x, y, z) and the axis of the longer alpha (cosine, sine) in glTF's tangent frame, two
    alphas, and the reflecting colours."""

    normal: tuple
    alphas: tuple
    colour: tuple
    metalness: np.ndarray
    axis: tuple = (1.0, 0.0)


@dataclass
class Variant:
    """Textures, and how a shader makes lobes of what their filters return."""

    name: str
    textures: dict[str, Texture]
    decode: Callable[[dict[str, np.ndarray]], Lobes]

    def surface(self, view_pixels, size, anisotropic, shift=(0.0, 0.0)):
        """Returns what `formula` shades: axes, alphas, F0 and albedo of each pixel.

        `size` is (columns, rows) of level 0 in texels, and `shift` moves the texture by so many texels.
        """
        scaled = lambda texels: tuple(t / s for t, s in zip(texels, size))
        uv = scaled(tuple(t + s for t, s in zip(view_pixels["texel"], shift)))
        across, down = scaled(view_pixels["across"]), scaled(view_pixels["down"])
        lobes = self.decode({n: t.sample(uv, across, down, anisotropic) for n, t in self.textures.items()})
        return surface(lobes, view_pixels)


def surface(lobes, view_pixels):
    """Returns lobes in the frame of the scene."""
    n, t = view_pixels["normal"], view_pixels["tangent"]
    b = formula.cross(n, t)
    combine = lambda x, y, z: tuple(x * tc + y * bc + z * nc for tc, bc, nc in zip(t, b, n))
    normal = combine(*lobes.normal)
    axes = formula.frame(np, normal, combine(*lobes.axis, 0.0))
    alphas = tuple(np.clip(a, formula.MIN_ALPHA, 1.0) for a in lobes.alphas)
    return (axes, alphas, *formula.reflectances(lobes.colour, lobes.metalness))


def gltf_textures(source):
    """Returns the mips of roughness, metalness and base colour as an engine makes them: boxes, in 8 bits."""
    return {
        "orm": Texture(chain(source.orm, in_8_bits)),
        "colour": Texture(chain(source.colour, srgb_in_8_bits)),
    }


def normal_texture(source):
    """Returns the ordinary mips of a normal map: box-filtered, renormalised, in 8 bits."""
    return Texture(chain(source.normal, normals_in_8_bits))


def channels(texels, count=3):
    """Returns the first channels of filtered texels as a tuple."""
    return tuple(texels[:, i] for i in range(count))


def isotropic(normal, roughness, orm, colour):
    """Returns isotropic lobes of filtered texels. `roughness` is perceptual: alpha = roughness^2."""
    alpha = np.clip(roughness, formula.MIN_ROUGHNESS, 1.0) ** 2
    return Lobes(channels(normal), (alpha, alpha), channels(colour), orm[:, 2])


def ellipse(a_uu, a_uv, a_vv):
    """Returns (alphas, axis) of squared alphas A in the tangent frame: square roots of the eigenvalues, and the
    eigenvector (cosine, sine) of the larger one."""
    middle, half = (a_uu + a_vv) / 2.0, (a_uu - a_vv) / 2.0
    radius = np.hypot(half, a_uv)
    alphas = np.sqrt(np.maximum(middle + radius, 0.0)), np.sqrt(np.maximum(middle - radius, 0.0))
    angle = np.arctan2(a_uv, half) / 2.0
    return alphas, (np.cos(angle), np.sin(angle))
