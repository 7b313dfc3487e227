"""Roughcast's own variants: bakes of a glTF plane, read back from their files."""

import re
import subprocess
from pathlib import Path

import numpy as np

from encoding import in_8_bits, srgb_in_8_bits, to_linear
from filtering import Texture, chain
from gltf import Document, pixels
from source import colour_factor, orm_factors
from truth import mi
from variants import Lobes, Variant, channels, ellipse

PYRAMID = "ROUGHCAST_materials_roughness_pyramid"
# The least z of stored offsets that the plugins assume.
LEAST_Z = 1.0 / 32.0
# Name of each variant, and the arguments of its bake.
BAKES = {
    "plain mips, UASTC": ["--model", "none"],
    "portable, isotropic": ["--profile", "portable", "--model", "isotropic"],
    "portable, fast": ["--profile", "portable", "--quality", "fast"],
    "portable, best": ["--profile", "portable", "--quality", "best"],
    "pyramid, fast": ["--profile", "pyramid", "--quality", "fast"],
    "pyramid, best": ["--profile", "pyramid", "--quality", "best"],
}


def bake(roughcast, gltf, folder, name, arguments=None):
    """Bakes a material with the arguments of a variant, or with others, and returns the variant."""
    options = ["--scale-normals=false", *(arguments or BAKES[name])]
    command = [str(roughcast), "bake", str(gltf), "-o", str(folder), *options]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)} failed: {done.stderr.strip()}")
    return read(roughcast, folder / Path(gltf).name, name)


def read(roughcast, path, name):
    """Returns the variant that an engine loads from a baked document: with the extension, as the plugins shade it."""
    document = Document(path)
    texture = lambda info, after=in_8_bits, linear=lambda t: t: load(roughcast, document.file(info), after, linear)
    textures, scales = {}, {}
    base = document.extension(PYRAMID).get("baseLobe", document.pbr)
    for key, info in (("orm", base.get("metallicRoughnessTexture")), ("metal", metal_info(document))):
        if info:
            textures[key] = texture(info)
    if "baseColorTexture" in document.pbr:
        textures["colour"] = texture(document.pbr["baseColorTexture"], srgb_in_8_bits, to_linear)
    scales = {"orm": orm_factors(base), "metal": orm_factors(document.pbr), "colour": colour_factor(document.pbr)}
    shape = pyramid if document.extension(PYRAMID) else portable
    return Variant(name, *shape(document, texture, textures, scales))


def metal_info(document):
    """Returns the texture of metalness, which the roughness of the extension's base lobe does not have."""
    return document.pbr.get("metallicRoughnessTexture")


def factors(samples, scales, count):
    """Returns roughness, colour and metalness of `count` pixels, with the factors of absent textures."""
    one = np.ones((count, 3), np.float32)
    value = {key: samples.get(key, one) * scale for key, scale in scales.items()}
    return value["orm"][:, 1], channels(value["colour"]), value["metal"][:, 2]


def portable(document, texture, textures, scales):
    """Returns textures and decoder of the core properties and KHR_materials_anisotropy."""
    info = document.material["normalTexture"]
    bump = info.get("scale", 1.0)
    anisotropy = document.extension("KHR_materials_anisotropy")
    textures["normal"] = texture(info)
    if "anisotropyTexture" in anisotropy:
        textures["anisotropy"] = texture(anisotropy["anisotropyTexture"])

    def decode(s):
        x, y, z = channels(s["normal"] * 2.0 - 1.0)
        roughness, colour, metalness = factors(s, scales, len(x))
        alpha = np.clip(roughness, 0.0, 1.0) ** 2
        strength, cosine, sine = np.zeros_like(x), np.ones_like(x), np.zeros_like(x)
        if anisotropy:
            strength = strength + anisotropy.get("anisotropyStrength", 0.0)
        if "anisotropy" in s:
            cosine, sine = channels(s["anisotropy"] * 2.0 - 1.0, 2)
            strength = strength * s["anisotropy"][:, 2]
        turn = anisotropy.get("anisotropyRotation", 0.0)
        length = np.maximum(np.hypot(cosine, sine), 1e-6)
        axis = (
            (cosine * np.cos(turn) - sine * np.sin(turn)) / length,
            (cosine * np.sin(turn) + sine * np.cos(turn)) / length,
        )
        return Lobes(
            (x * bump, y * bump, z), (alpha + (1.0 - alpha) * strength**2, alpha), colour, metalness, axis
        )

    return textures, decode


def pyramid(document, texture, textures, scales):
    """Returns textures and decoder of the extension: A' = A + 2 c K, with K = D D^T or lambda_1^2."""
    extension = document.extension(PYRAMID)
    if extension["frame"] != "unit":
        raise ValueError(f"{document.path}: the frame {extension['frame']} is not shaded by this benchmark")
    model = extension.get("roughnessModel")
    textures["offset"] = texture(extension["offsetTexture"])
    if model:
        textures["spread"] = texture(extension["roughnessTexture"])
    scale = extension["offsetScale"]

    def offsets(texels):
        x, y, z = channels(texels * 2.0 - 1.0)
        if extension["offsetChannels"] == 2:
            z = np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))
        z = np.maximum(z, LEAST_Z)
        return -scale[0] * x / z, -scale[1] * y / z

    def spread(texels):
        low, high = (np.array(extension[f"roughness{end}"], np.float32) for end in ("Min", "Max"))
        return channels(low + texels[:, : len(low)] * (high - low), len(low))

    def decode(s):
        f_u, f_v = offsets(s["offset"])
        roughness, colour, metalness = factors(s, scales, len(f_u))
        base, double = np.clip(roughness, 0.0, 1.0) ** 4, 2.0 * extension["correctionFactor"]
        k = (np.zeros_like(base),) * 3
        if model == "covarianceFactor":
            d1, d2, d3 = spread(s["spread"])
            k = (d1 * d1 + d2 * d2, d2 * d3, d3 * d3)
        elif model:
            (deviation,) = spread(s["spread"])
            k = (deviation**2, np.zeros_like(base), deviation**2)
        alphas, axis = ellipse(base + double * k[0], double * k[1], base + double * k[2])
        return Lobes((-f_u, -f_v, np.ones_like(f_u)), alphas, colour, metalness, axis)

    return textures, decode


def load(roughcast, path, after, linear):
    """Returns a texture: the levels of a KTX2 file, or an image with mips that an engine makes."""
    if path.suffix != ".ktx2":
        return Texture(chain(linear(pixels(path)), after))
    folder = path.with_suffix(".levels")
    command = [str(roughcast), "inspect", str(path), "--extract", str(folder)]
    subprocess.run(command, check=True, capture_output=True)
    number = lambda file: int(re.search(r"\.level(\d+)\.", file.name)[1])
    return Texture([linear(extracted(file)) for file in sorted(folder.iterdir(), key=number)])


def extracted(path):
    """Returns a level that `roughcast inspect` wrote: a PNG, or an OpenEXR file of half floats."""
    if path.suffix == ".exr":
        return np.array(mi.Bitmap(str(path)), np.float32)[..., :3]
    return pixels(path)
