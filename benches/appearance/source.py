"""Level 0 of a material, as its glTF document has it."""

from dataclasses import dataclass

import numpy as np

from encoding import to_linear
from gltf import Document, pixels


@dataclass
class Source:
    """Level 0: `normal` as filtered by engines (x, y, z, not renormalised), `orm` (occlusion, roughness, metalness)
    and linear `colour`. Images may differ in size; factors are applied, and absent images have one texel."""

    normal: np.ndarray
    orm: np.ndarray
    colour: np.ndarray

    @property
    def size(self):
        """Returns (columns, rows) of the normal map, whose texels set the distances."""
        return self.normal.shape[1], self.normal.shape[0]


def read(path):
    """Returns the level 0 of a material."""
    document = Document(path)
    if document.extension("KHR_materials_anisotropy"):
        raise ValueError(f"{path}: materials with an anisotropic base lobe are not supported by this benchmark")
    info = document.material["normalTexture"]
    scale = info.get("scale", 1.0)
    normal = (pixels(document.file(info)) * 2.0 - 1.0) * [scale, scale, 1.0]
    return Source(normal, orm(document), colour(document))


def orm(document):
    """Returns the texels of roughness and metalness, times their factors, in channels 1 and 2."""
    info = document.pbr.get("metallicRoughnessTexture")
    texels = pixels(document.file(info)) if info else np.ones((1, 1, 3), np.float32)
    return texels * orm_factors(document.pbr)


def orm_factors(pbr):
    """Returns the factors of occlusion, roughness and metalness."""
    return np.array([1.0, pbr.get("roughnessFactor", 1.0), pbr.get("metallicFactor", 1.0)], np.float32)


def colour(document):
    """Returns the texels of the base colour in linear light, times its factor."""
    info = document.pbr.get("baseColorTexture")
    texels = to_linear(pixels(document.file(info))) if info else np.ones((1, 1, 3), np.float32)
    return texels * colour_factor(document.pbr)


def colour_factor(pbr):
    """Returns the linear factor of the base colour."""
    return np.array(pbr.get("baseColorFactor", [1.0] * 4)[:3], np.float32)
