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

import gltf

NORMALS = re.compile(r"(.*?)_(norm|nm|normals|local|normal)\.(png|jpg|tga)", re.IGNORECASE)
DIELECTRIC = re.compile("stone|rock|brick|wall|wood|bark|ground|sand|dirt|plaster", re.IGNORECASE)
GLOSS = ("_gloss", "_s", "_spec", "_g")
COLOUR = ("", "_d", "_c", "_diffuse", "_df")
LEAST, MOST = 128, 1024
# More of these normals are no bumps of a surface: black parts of an atlas.
MOST_BELOW = 0.02
SERIES = 5
# Without a map of gloss.
ROUGHNESS = {"nx": 0.4, "c2": 0.35}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name in ("nexuiz", "cube2", "folder"):
        parser.add_argument(name, type=Path, metavar=name.upper())
    options = parser.parse_args()
    names, series = set(), Counter()
    for prefix, data in (("nx", options.nexuiz), ("c2", options.cube2)):
        paths = [path for path in sorted(data.rglob("*")) if NORMALS.fullmatch(path.name)]
        if not paths:
            parser.error(f"{data}: expected normal maps below this folder, found none")
        for path in paths:
            name = prefix + "_" + re.sub("[^A-Za-z0-9]", "_", NORMALS.fullmatch(path.name)[1])[:32]
            kind = re.sub("[0-9]+", "", name)
            if name not in names and series[kind] < SERIES and write_material(path, name, prefix, options.folder):
                names.add(name)
                series[kind] += 1


def write_material(path, name, prefix, folder):
    """Writes the material of a normal map. Returns whether the map can be used."""
    normals = Image.open(path).convert("RGB")
    below = normals.getchannel("B").histogram()[:128]
    if min(normals.size) < LEAST or sum(below) > MOST_BELOW * normals.width * normals.height:
        return False
    size = tuple(min(MOST, 1 << (side.bit_length() - 1)) for side in normals.size)
    target = folder / name
    target.mkdir(parents=True, exist_ok=True)
    files = {"normal": "normal.png"}
    normals.resize(size, Image.Resampling.BOX).save(target / files["normal"])
    if gloss := beside(path, GLOSS):
        files["orm"] = "orm.png"
        roughness = Image.open(gloss).convert("L").resize(size).point(lambda level: 255 - int(level * 0.8))
        white = Image.new("L", size, 255)
        Image.merge("RGB", (white, roughness, white)).save(target / files["orm"])
    if colour := beside(path, COLOUR):
        files["colour"] = "colour.png"
        Image.open(colour).convert("RGB").resize(size).save(target / files["colour"])
    metalness = 0.0 if prefix == "c2" and DIELECTRIC.search(str(path.relative_to(path.parents[2]))) else 1.0
    gltf.write_plane(target, name, files, roughness=1.0 if gloss else ROUGHNESS[prefix], metalness=metalness)
    return True


def beside(path, ends):
    """Returns the first file beside a normal map whose name has one of these ends instead."""
    stem = NORMALS.fullmatch(path.name)[1]
    names = (path.with_name(stem + end + kind) for end in ends for kind in (".png", ".jpg", ".tga"))
    return next((name for name in names if name.exists()), None)


if __name__ == "__main__":
    main()
