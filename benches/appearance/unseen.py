"""Writes materials on which nobody tuned Roughcast: FOLDER/<name>/<name>.gltf, with images beside it.

python3 benches/appearance/unseen.py PACKAGE FOLDER [--data DIR]

PACKAGE is the unpacked npm package @pmndrs/assets 1.7.0 (CC0 1.0). Its normal maps become metals and dielectrics by
turns. The helmet of the test data, where it is present, adds materials with maps of colour and roughness.
"""

import argparse
import base64
import io
import shutil
from pathlib import Path

from PIL import Image

import gltf

ROOT = Path(__file__).resolve().parents[2]
# Roughness goes by the number of the map, and so does metalness: no choice depends on a result.
ROUGHNESS = (0.15, 0.3, 0.5)
METAL, DIELECTRIC = (0.9, 0.8, 0.7), (0.35, 0.3, 0.25)
# The hoses have the maps of `RubberWood`, and the lenses are transparent.
HELMET = ("GlassPlastic", "LeatherParts", "MetalParts", "RubberWood")
MAPS = {"normal": "Normal", "orm": "OcclusionRoughMetal", "colour": "BaseColor"}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("package", type=Path, metavar="PACKAGE")
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("--data", type=Path, default=ROOT.parent / "shared" / "data", help="the test data")
    options = parser.parse_args()
    maps = sorted((options.package / "normals").glob("*.js"))
    if not maps:
        parser.error(f"{options.package}: expected normals/*.js of the npm package @pmndrs/assets, found none")
    for number, path in enumerate(maps):
        write_map(number, path, options.folder)
    if (options.data / "FlightHelmet").is_dir():
        for name in HELMET:
            write_part(name, options.data / "FlightHelmet", options.folder)


def write_map(number, path, folder):
    """Writes the material of a normal map. The package has images in scripts, as `data:` URLs."""
    data = path.read_text().split("base64,")[1].split("'")[0]
    image = Image.open(io.BytesIO(base64.b64decode(data)))
    is_metal = number % 2 == 0
    name = f"{'metal' if is_metal else 'dielectric'}_{number:02}"
    target = folder / name
    target.mkdir(parents=True, exist_ok=True)
    # One map is 501 texels wide.
    image.convert("RGB").resize((512, 512)).save(target / "normal.png")
    roughness = ROUGHNESS[number // 2 % len(ROUGHNESS)]
    images = {"normal": "normal.png"}
    gltf.write_plane(target, name, images, roughness, float(is_metal), METAL if is_metal else DIELECTRIC)


def write_part(name, source, folder):
    """Writes a material of the helmet on a plane."""
    target = folder / f"helmet_{name}"
    target.mkdir(parents=True, exist_ok=True)
    images = {}
    for key, kind in MAPS.items():
        images[key] = f"{key}.png"
        shutil.copyfile(source / f"FlightHelmet_Materials_{name}Mat_{kind}.png", target / images[key])
    gltf.write_plane(target, target.name, images)


if __name__ == "__main__":
    main()
