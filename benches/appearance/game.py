"""Writes whole materials of a game: FOLDER/<name>/<name>.gltf, with images beside it.

python3 benches/appearance/game.py DATA FOLDER

DATA is the folder usr/share/games/supertuxkart/data of the unpacked Debian package supertuxkart-data 1.4. Materials are
all its normal maps with a map of gloss and metalness beside them, for karts, props and roads. They are mostly glossy
paint with few bumps, many parts in one texture, at 128 to 1024 texels. Of materials with one name, the last one counts.
"""

import argparse
import re
from pathlib import Path

from PIL import Image

import gltf

NORMALS = re.compile(r"(.*?)[_-](normal|nm)\.(png|jpg)", re.IGNORECASE)
GLOSS = ("_pbrdata", "_gloss", "-gloss", "_glossy")
COLOUR = ("", "_basecolor", "_albedo", "_diffuse")
LEAST, MOST = 128, 1024
# Unused parts of some textures are black, which is a normal below the surface.
MOST_BELOW = 0.01


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", type=Path, metavar="DATA")
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    options = parser.parse_args()
    images = {path.relative_to(options.data).as_posix().lower(): path for path in sorted(options.data.rglob("*.*"))}
    written = [write_material(path, images, options) for path in images.values()]
    if not any(written):
        parser.error(f"{options.data}: expected normal maps with maps of gloss beside them, found none")


def write_material(path, images, options):
    """Writes the material of a normal map. Returns whether it is one."""
    match = NORMALS.fullmatch(path.name)
    if not match:
        return False
    stem = (path.relative_to(options.data).parent / match[1]).as_posix().lower()
    found = {
        key: next(filter(None, (images.get(stem + end + kind) for end in ends for kind in (".png", ".jpg"))), None)
        for key, ends in {"gloss": GLOSS, "colour": COLOUR}.items()
    }
    if not found["gloss"]:
        return False
    normals = Image.open(path).convert("RGB")
    if min(normals.size) < LEAST or below(normals) > MOST_BELOW:
        return False
    size = tuple(min(MOST, 1 << (side.bit_length() - 1)) for side in normals.size)
    name = re.sub("[^A-Za-z0-9]", "_", match[1])[:32]
    target = options.folder / name
    target.mkdir(parents=True, exist_ok=True)
    files = {"normal": "normal.png", "orm": "orm.png"}
    normals.resize(size, Image.Resampling.BOX).save(target / files["normal"])
    gloss, metalness, _ = Image.open(found["gloss"]).convert("RGB").resize(size).split()
    roughness = gloss.point(lambda level: 255 - level)
    Image.merge("RGB", (Image.new("L", size, 255), roughness, metalness)).save(target / files["orm"])
    if found["colour"]:
        files["colour"] = "colour.png"
        Image.open(found["colour"]).convert("RGB").resize(size).save(target / files["colour"])
    gltf.write_plane(target, name, files)
    return True


def below(normals):
    """Returns the share of texels whose normals point below the surface."""
    histogram = normals.getchannel("B").histogram()
    return sum(histogram[:128]) / sum(histogram)


if __name__ == "__main__":
    main()
