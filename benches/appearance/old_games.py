"""Writes materials of two old games: FOLDER/<name>/<name>.gltf, with images beside it.

python3 benches/appearance/old_games.py NEXUIZ CUBE2 FOLDER

NEXUIZ is the unpacked archive data.pk3 of the Debian package nexuiz-data 2.5.2, and CUBE2 the folder
usr/share/games/cube2/packages of the unpacked package cube2-data 1.3. The games are older than glTF, so that their maps
of gloss become roughness by a rule of this program, and metalness is a guess. Machines of Nexuiz are rough, dark metal
with steep bumps. Those of Cube 2 are metal, and walls and grounds are dielectrics; most have no map of gloss. Of a
numbered series, the first five count.
"""

import argparse
import re
from collections import Counter
from pathlib import Path

from PIL import Image

import game_maps

NORMALS = re.compile("(.*?)_(norm|nm|normals|local|normal)", re.IGNORECASE)
DIELECTRIC = re.compile("stone|rock|brick|wall|wood|bark|ground|sand|dirt|plaster", re.IGNORECASE)
GLOSS = ("_gloss", "_s", "_spec", "_g")
COLOUR = ("", "_d", "_c", "_diffuse", "_df")
# More of these normals are no bumps of a surface: black parts of an atlas.
MOST_BELOW = 0.02
SERIES = 5
# Of materials without a map of gloss, by the game.
ROUGHNESS = {"nx": 0.4, "c2": 0.35}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name in ("nexuiz", "cube2", "folder"):
        parser.add_argument(name, type=Path, metavar=name.upper())
    options = parser.parse_args()
    for game, data in (("nx", options.nexuiz), ("c2", options.cube2)):
        images = game_maps.images_of(data, (".png", ".jpg", ".tga"))
        stems = {stem: match[1] for stem in sorted(images) if (match := NORMALS.fullmatch(stem))}
        if not stems:
            parser.error(f"{data}: expected normal maps below this folder, found none")
        names, series = set(), Counter()
        for normals, stem in stems.items():
            name = game + "_" + re.sub("[^A-Za-z0-9]", "_", images[normals].stem[: len(Path(stem).name)])[:32]
            kind = re.sub("[0-9]+", "", name)
            if name in names or series[kind] == SERIES:
                continue
            if write_material(images, normals, stem, game, options.folder / name):
                names.add(name)
                series[kind] += 1


def write_material(images, normals, stem, game, target):
    """Writes the material of a normal map, whose other maps have names that begin with `stem`. Returns whether the map
    can be used."""
    gloss, colour = (game_maps.beside(images, stem, ends) for ends in (GLOSS, COLOUR))
    metalness = 0.0 if game == "c2" and DIELECTRIC.search(stem) else 1.0
    factors = {"roughness": 1.0 if gloss else ROUGHNESS[game], "metalness": metalness}
    return game_maps.write_material(target, images[normals], MOST_BELOW, gloss, orm_of, colour, **factors)


def orm_of(image):
    """Returns the roughness texture of a map of gloss."""
    white = Image.new("L", image.size, 255)
    return Image.merge("RGB", (white, image.convert("L").point(lambda level: 255 - int(level * 0.8)), white))


if __name__ == "__main__":
    main()
