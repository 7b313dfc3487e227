"""Writes the materials of the benchmark for other programs: FOLDER/<name>/<name>.gltf, with images beside it.

python3 benches/appearance/sources.py FOLDER [--size N] [--data DIR]
"""

import argparse
import shutil
from pathlib import Path

import generate
import materials

ROOT = Path(__file__).resolve().parents[2]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("--size", type=int, default=512, help="side of generated maps in texels")
    parser.add_argument(
        "--data", type=Path, default=ROOT.parent / "shared" / "data", help="real materials, used where present"
    )
    options = parser.parse_args()
    write(options.folder, options.size, options.data)


def write(folder, size, data):
    """Writes the generated materials, and the real ones that are present."""
    folder.mkdir(parents=True, exist_ok=True)
    for material in materials.from_data(data, folder):
        if material.path.parent.parent != folder:
            shutil.copytree(material.path.parent, folder / material.name, dirs_exist_ok=True)
    for name in generate.GENERATED:
        materials.generated(name, folder, size)


if __name__ == "__main__":
    main()
