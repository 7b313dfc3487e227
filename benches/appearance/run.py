"""Compares pictures of baked materials with the truth, beside plain mips and peers, and writes docs/appearance.md.

python3 benches/appearance/run.py [FOLDER ...] [--quick] [-o DIR] [--roughcast PATH] [--data DIR] [--only NAME ...]
"""

import argparse
import hashlib
import json
import os
import sys
import time
from pathlib import Path

# FLIP's threads wait for each other 40 times longer than they work on pictures as small as these.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np  # noqa: E402

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE))

import baked  # noqa: E402
import generate  # noqa: E402
import gltf  # noqa: E402
import materials  # noqa: E402
import page  # noqa: E402
import score  # noqa: E402
import source  # noqa: E402
from views import View  # noqa: E402

QUICK = score.Settings(pixels=48, samples=256, levels=(1.5, 3.5), frames=4)
QUICK_MATERIALS = ("mirror_tiles", "brushed", "painted_rust")
# Changes of these files make new truths.
TRUTH_FILES = ("formula.py", "lights.py", "shading.py", "source.py", "truth.py", "views.py")
# Changes of these files change the page, but no result.
PAGE_FILES = ("charts.py", "intervals.py", "page.py", "run.py", "sources.py", "summary.py", "suns.py")
# Programs of the study of limits, which `run.py` does not use.
LIMITS_FILES = ("footprints.py", "limits.py", "limits_page.py", "parts.py")
# The view of the pictures on the page.
SHOWN = ("plane 20", 2.5)


def main():
    options = arguments()
    start = time.monotonic()
    settings = QUICK if options.quick else score.Settings(options.pixels, options.samples)
    results = []
    for material in listed(options):
        print(f"== {material.name} ({time.monotonic() - start:.0f} s)", flush=True)
        results.append(scored(material, settings, options))
    file = options.output / "results.json"
    file.write_text(json.dumps({"settings": vars(settings), "materials": results}, indent=1))
    # Figures of small pictures, or of some materials only, do not count, and stay out of the docs.
    whole = not (options.quick or options.only or options.folders)
    docs = ROOT / "docs" if whole else options.output
    page.write(json.loads(file.read_text()), options.output / "pictures", docs)
    print(f"== {docs / 'appearance.md'} ({time.monotonic() - start:.0f} s)")


def arguments():
    """Returns the options of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="*", type=Path, metavar="FOLDER", help="more materials: glTF or normal maps")
    parser.add_argument("--quick", action="store_true", help="three materials, small pictures: shows that it works")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="only these materials")
    parser.add_argument("--roughcast", type=Path, default=ROOT / "target" / "release" / "roughcast", metavar="PATH")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "target" / "appearance", metavar="DIR")
    parser.add_argument(
        "--data", type=Path, default=ROOT.parent / "shared" / "data", help="real materials, used where present"
    )
    defaults = score.Settings()
    parser.add_argument("--pixels", type=int, default=defaults.pixels, help="side of the pictures")
    parser.add_argument("--samples", type=int, default=defaults.samples, help="samples for each pixel of the truth")
    options = parser.parse_args()
    if not options.roughcast.is_file():
        parser.error(f"{options.roughcast} is missing: run `cargo build --release`, or name another with --roughcast")
    return options


def listed(options):
    """Returns all materials that the options ask for."""
    folder = options.output / "sources"
    folder.mkdir(parents=True, exist_ok=True)
    size = 256 if options.quick else 512
    real = [] if options.quick else materials.from_data(options.data, folder)
    names = QUICK_MATERIALS if options.quick else generate.GENERATED
    made = [materials.generated(n, folder, size) for n in names if not options.only or n in options.only]
    named = [material for user in options.folders for material in materials.from_folder(user, folder)]
    return [m for m in real + made + named if not options.only or m.name in options.only]


def scored(material, settings, options):
    """Returns the results of a material: stored ones, if neither inputs nor programs have changed.

    A new binary changes only the bakes, and the results of other variants are kept.
    """
    folder = options.output / "results"
    folder.mkdir(parents=True, exist_ok=True)
    stored = folder / f"{material.name}.json"
    level_0 = source.read(material.path)
    truth_key = key_of_truth(level_0, settings)
    programs = sorted(file for file in HERE.glob("*.py") if file.name not in PAGE_FILES + LIMITS_FILES)
    key, peers_key = digest(truth_key, options.roughcast, *programs), digest(truth_key, *programs)
    old = json.loads(stored.read_text()) if stored.exists() else {}
    if old.get("key") == key:
        return old
    kept = old["variants"] if old.get("peers_key") == peers_key else {}
    reference = truths(material, level_0, truth_key, settings, options)
    result = {"key": key, "peers_key": peers_key, "name": material.name, "origin": material.origin}
    result["variants"] = {}
    result["noise"] = {n.removeprefix("noise, "): list(map(float, reference[n])) for n in reference if "noise" in n}
    shown = View(*SHOWN, settings.pixels) if SHOWN[1] in settings.levels else settings.views()[0]
    result["shown"] = shown.name
    pictures = options.output / "pictures" / material.name
    pictures.mkdir(parents=True, exist_ok=True)
    gltf.save(pictures / "truth.png", score.picture(None, level_0.size, shown, reference))
    bakes = options.output / "bakes" / material.name
    for variant in score.variants(material, level_0, options.roughcast, bakes):
        if variant.name in kept and variant.name not in baked.BAKES:
            result["variants"][variant.name] = kept[variant.name]
            continue
        scores = score.still(variant, level_0.size, settings, reference)
        scores["flicker"] = score.moving(variant, level_0.size, settings, reference)
        result["variants"][variant.name] = scores
        gltf.save(pictures / f"{variant.name}.png", score.picture(variant, level_0.size, shown, reference))
    stored.write_text(json.dumps(result, indent=1))
    return result


def key_of_truth(level_0, settings):
    """Returns the digest of all that a truth is made from."""
    return digest(repr(settings), *(HERE / name for name in TRUTH_FILES), *vars(level_0).values())


def truths(material, level_0, key, settings, options):
    """Returns the truth of a material, which is kept in a file: new bakes do not change it."""
    file = options.output / "truth" / f"{material.name}.npz"
    file.parent.mkdir(parents=True, exist_ok=True)
    if file.exists():
        stored = np.load(file)
        if str(stored["key"]) == key:
            return {name: stored[name] for name in stored.files if name != "key"}
    arrays = score.truths(level_0, settings)
    np.savez_compressed(file, key=key, **arrays)
    return arrays


def digest(*parts):
    """Returns a digest of texts, arrays, and the contents of files."""
    state = hashlib.blake2b(digest_size=16)
    for part in parts:
        if isinstance(part, Path):
            part = part.read_bytes()
        elif isinstance(part, np.ndarray):
            part = np.ascontiguousarray(part).tobytes()
        state.update(part.encode() if isinstance(part, str) else part)
        state.update(b"\0")
    return state.hexdigest()


if __name__ == "__main__":
    sys.exit(main())
