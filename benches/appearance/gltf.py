"""Reading and writing glTF planes, with one material and images in files of their own."""

import json
import struct
from pathlib import Path

import numpy as np
from PIL import Image

BASISU = "KHR_texture_basisu"


class Document:
    """A .gltf file and its first material that has a normal texture."""

    def __init__(self, path):
        self.path = Path(path)
        self.json = json.loads(self.path.read_text())
        found = [m for m in self.json.get("materials", []) if "normalTexture" in m]
        if not found:
            raise ValueError(f"{path}: no material has a normalTexture")
        self.material = found[0]
        self.pbr = self.material.get("pbrMetallicRoughness", {})

    def extension(self, name):
        """Returns an extension of the material, or an empty object."""
        return self.material.get("extensions", {}).get(name, {})

    def file(self, info):
        """Returns the path of a texture's image: of its KTX2 file, where there is one."""
        texture = self.json["textures"][info["index"]]
        source = texture.get("extensions", {}).get(BASISU, texture).get("source")
        uri = self.json["images"][source].get("uri", "data:")
        if uri.startswith("data:"):
            raise ValueError(f"{self.path}: images in buffers or data URIs are not read; write them to files")
        return self.path.parent / uri


def pixels(path):
    """Returns an image as floats (rows, columns, 3) from 0 to 1."""
    with Image.open(path) as image:
        if image.mode in ("I;16", "I", "F"):
            grey = np.asarray(image, np.float32) / 65535.0
            return np.repeat(grey[..., None], 3, axis=-1)
        return np.asarray(image.convert("RGB"), np.float32) / 255.0


def save(path, array):
    """Writes values from 0 to 1 as a PNG of 8 bits."""
    Image.fromarray(np.round(np.clip(array, 0.0, 1.0) * 255.0).astype(np.uint8)).save(path)


def write_plane(folder, name, images, roughness=1.0, metalness=1.0, base_colour=(1.0, 1.0, 1.0)):
    """Writes a glTF plane and returns its path. `images` names files in `folder`: normal, orm and colour."""
    corners = [(x, 0.0, z) for z in (-1.0, 1.0) for x in (-1.0, 1.0)]
    data = b"".join(struct.pack("<3f", *corner) for corner in corners)
    data += struct.pack("<3f", 0.0, 1.0, 0.0) * 4 + struct.pack("<4f", 1.0, 0.0, 0.0, 1.0) * 4
    data += b"".join(struct.pack("<2f", (x + 1.0) / 2.0, (z + 1.0) / 2.0) for x, _, z in corners)
    data += struct.pack("<6H", 0, 2, 1, 1, 2, 3)
    (folder / "plane.bin").write_bytes(data)
    names = [key for key in ("normal", "orm", "colour") if key in images]
    info = {key: {"index": index} for index, key in enumerate(names)}
    pbr = {
        "roughnessFactor": roughness,
        "metallicFactor": metalness,
        "baseColorFactor": [*base_colour, 1.0],
    }
    if "orm" in info:
        pbr["metallicRoughnessTexture"] = info["orm"]
    if "colour" in info:
        pbr["baseColorTexture"] = info["colour"]
    spans = [(0, 48), (48, 48), (96, 64), (160, 32), (192, 12)]
    kinds = [(5126, "VEC3", 4), (5126, "VEC3", 4), (5126, "VEC4", 4), (5126, "VEC2", 4), (5123, "SCALAR", 6)]
    accessors = [
        {"bufferView": i, "componentType": component, "type": kind, "count": count}
        for i, (component, kind, count) in enumerate(kinds)
    ]
    accessors[0] |= {"min": [-1, 0, -1], "max": [1, 0, 1]}
    attributes = {"POSITION": 0, "NORMAL": 1, "TANGENT": 2, "TEXCOORD_0": 3}
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 4, "material": 0}]}],
        "buffers": [{"uri": "plane.bin", "byteLength": len(data)}],
        "bufferViews": [{"buffer": 0, "byteOffset": o, "byteLength": n} for o, n in spans],
        "accessors": accessors,
        "samplers": [{"wrapS": 10497, "wrapT": 10497, "minFilter": 9987, "magFilter": 9729}],
        "images": [{"uri": images[key]} for key in names],
        "textures": [{"source": i, "sampler": 0} for i in range(len(names))],
        "materials": [{"name": name, "normalTexture": info["normal"], "pbrMetallicRoughness": pbr}],
    }
    path = folder / f"{name}.gltf"
    path.write_text(json.dumps(document, indent=1))
    return path
