"""The list of materials: real ones where they are present, generated ones, and those of folders that the user names."""

import shutil
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import generate
import gltf

IMAGES = {".png", ".jpg", ".jpeg"}
# Perceptual roughness of maps that have no material of their own; they become metals.
ROUGHNESS = {"aluminium": 0.32, "wool": 0.45, "sand": 0.45, "texture_bricks": 0.32, "water": 0.22}
OTHER_ROUGHNESS = 0.3


@dataclass
class Material:
    """A name, where the material comes from, and the path of its glTF plane."""

    name: str
    origin: str
    path: Path


def from_data(data, folder):
    """Returns the materials of the test data: maps as metals, and whole materials."""
    maps = [metal(path, folder) for path in sorted((data / "maps").glob("*_normal*")) if path.suffix in IMAGES]
    whole = sorted((data / "materials").glob("*/*.gltf"))
    return maps + [Material(path.stem, "test data", path) for path in whole]


def from_folder(source, folder):
    """Returns the materials of a user's folder: its glTF files, or else its normal maps as metals."""
    documents = sorted(source.rglob("*.gltf"))
    if documents:
        return [Material(path.stem, "user", path) for path in documents]
    maps = [path for path in sorted(source.rglob("*")) if "normal" in path.name.lower() and path.suffix in IMAGES]
    if not maps:
        raise ValueError(f"{source}: no .gltf file and no image with `normal` in its name")
    return [metal(path, folder, "user") for path in maps]


def metal(image, folder, origin="test data"):
    """Writes a metal that has only a normal map, and returns the material."""
    name = image.stem.replace("_normals", "").replace("_normal", "")
    target = folder / name
    target.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(image, target / image.name)
    roughness = ROUGHNESS.get(name, OTHER_ROUGHNESS)
    path = gltf.write_plane(target, name, {"normal": image.name}, roughness, base_colour=(0.91, 0.92, 0.92))
    return Material(name, origin, path)


def generated(name, folder, size):
    """Writes a generated material, and returns it."""
    build, roughness, metalness = generate.GENERATED[name]
    maps = build(size)
    target = folder / name
    target.mkdir(parents=True, exist_ok=True)
    images = {"normal": "normal.png"}
    gltf.save(target / "normal.png", generate.normals(maps["slopes"]))
    if "roughness" in maps:
        metal_map = maps.get("metalness", np.ones((size, size)))
        gltf.save(target / "orm.png", np.dstack([np.ones((size, size)), maps["roughness"], metal_map]))
        images["orm"] = "orm.png"
    colour = (0.91, 0.92, 0.92)
    if "colour" in maps:
        gltf.save(target / "colour.png", maps["colour"])
        images["colour"], colour = "colour.png", (1.0, 1.0, 1.0)
    path = gltf.write_plane(target, name, images, roughness, metalness, colour)
    return Material(name, "generated", path)
