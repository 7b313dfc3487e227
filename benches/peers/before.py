"""Times bakes of large materials by an earlier build and by this one, in turn, and prints the ratio of the medians.

python3 benches/peers/before.py EARLIER NOW MATERIAL.gltf ...

EARLIER and NOW are the paths of two builds of the tool. Both write PNG copies of level 0, which were the default of
earlier builds, so that their outputs are alike. NOW also writes KTX2 alone, as it does by default. The images of each
material are repeated to 4096 x 4096 texels, as PNGs in a temporary folder. Needs Pillow
(benches/appearance/requirements.txt).
"""

import json
import shutil
import sys
import tempfile
from pathlib import Path

from measure import Contender, alternate
from PIL import Image

SIDE = 4096
ROUNDS = 5


def repeated(source, folder):
    """Writes the material `source` to `folder`, with images of SIDE x SIDE texels, and returns its path."""
    document = json.loads(source.read_text())
    for image in document["images"]:
        tile = Image.open(source.parent / image["uri"])
        large = Image.new(tile.mode, (SIDE, SIDE))
        for y in range(0, SIDE, tile.height):
            for x in range(0, SIDE, tile.width):
                large.paste(tile, (x, y))
        image.pop("mimeType", None)
        image["uri"] = Path(image["uri"]).stem + ".png"
        large.save(folder / image["uri"], compress_level=4)
    for buffer in document["buffers"]:
        shutil.copyfile(source.parent / buffer["uri"], folder / buffer["uri"])
    (folder / source.name).write_text(json.dumps(document))
    return folder / source.name


def bake(tool, form, material, out):
    options = ["--gltf", form, "--quiet", "--threads", "2"]
    return Contender([tool, "bake", str(material), "-o", str(out), *options], out=str(out))


def main():
    earlier, now, *materials = sys.argv[1:]
    bakes = {"earlier": (earlier, "fallback"), "now": (now, "fallback"), "by default": (now, "strict")}
    for source in map(Path, materials):
        with tempfile.TemporaryDirectory() as folder:
            material = repeated(source, Path(folder))
            contenders = {name: bake(*run, material, Path(folder, name)) for name, run in bakes.items()}
            results = alternate(contenders, ROUNDS, note=lambda _: None)
        for name, result in results.items():
            if "failed" in result:
                sys.exit(f"{source}: {bakes[name][0]} {result['failed']}")
        before, *after = (results[name]["wall"] for name in bakes)
        now_text, default_text = (f"{wall:.2f} s: {wall / before:.2f} x" for wall in after)
        print(f"{source.stem}: {before:.2f} s, now {now_text}, without PNG copies {default_text}", flush=True)


if __name__ == "__main__":
    main()
