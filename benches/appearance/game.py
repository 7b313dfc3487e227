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

import game_maps

NORMALS = re.compile("(.*?)[_-](normal|nm)", re.IGNORECASE)
GLOSS = ("_pbrdata", "_gloss", "-gloss", "_glossy")
COLOUR = ("", "_basecolor", "_albedo", "_diffuse")
# Unused parts of some textures are black, which is a normal below the surface.
MOST_BELOW = 0.01


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", type=Path, metavar="DATA")
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    options = parser.parse_args()
    images = game_maps.images_of(options.data, (".png", ".jpg"))
    written = [write_material(path, images, options) for path in sorted(images.values())]
    if not any(written):
        parser.error(f"{options.data}: expected normal maps with maps of gloss beside them, found none")


def write_material(path, images, options):
    """Writes the material of a normal map. Returns whether it is one."""
    match = NORMALS.fullmatch(path.stem)
    if not match:
        return False
    stem = (path.relative_to(options.data).parent / match[1]).as_posix().lower()
    gloss, colour = (game_maps.beside(images, stem, ends) for ends in (GLOSS, COLOUR))
    if not gloss:
        return False
    name = re.sub("[^A-Za-z0-9]", "_", match[1])[:32]
    return game_maps.write_material(options.folder / name, path, MOST_BELOW, gloss, orm_of, colour)


def orm_of(image):
    """Returns the roughness texture of a map with gloss in red and metalness in green."""
    gloss, metalness, _ = image.split()
    return Image.merge("RGB", (Image.new("L", image.size, 255), gloss.point(lambda level: 255 - level), metalness))


if __name__ == "__main__":
    main()
