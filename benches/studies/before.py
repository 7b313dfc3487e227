"""Times bakes of large materials by an earlier build beside this one, in turns, and prints ratios of medians.

python3 benches/studies/before.py EARLIER NOW MATERIAL.gltf ...

EARLIER and NOW are two builds of the tool. The images of each material are repeated to 4096 x 4096 texels, as PNGs in
a temporary folder. Needs Pillow (benches/appearance/requirements.txt).
"""

import json
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from PIL import Image

SIDE = 4096
RUNS = 5


def repeated(source, folder):
    """Writes the material `source` to `folder`, with images of SIDE x SIDE texels."""
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


def seconds(tool, material, output):
    start = time.monotonic()
    subprocess.run([tool, "bake", material, "-o", output, "--quiet", "--threads", "2"], check=True)
    return time.monotonic() - start


def main():
    earlier, now, *materials = sys.argv[1:]
    for source in map(Path, materials):
        with tempfile.TemporaryDirectory() as folder:
            material = repeated(source, Path(folder))
            # The first pair fills the caches of the system and does not count.
            pairs = [
                [seconds(tool, material, Path(folder, f"out{i}")) for i, tool in enumerate((earlier, now))]
                for _ in range(RUNS + 1)
            ][1:]
            before, after = (statistics.median(times) for times in zip(*pairs))
        print(f"{source.stem}: {before:.2f} s, now {after:.2f} s: {after / before:.2f} x", flush=True)


if __name__ == "__main__":
    main()
