"""Measures which part of whole materials limits their pictures, and writes the tables of docs/limits.md.

python3 benches/appearance/limits.py [-o DIR] [--roughcast PATH] [--data DIR] [--only NAME ...] [--samples N]
"""

import argparse
import json
import shutil
import sys
import time
from pathlib import Path

import run  # First of all, since it sets the number of FLIP's threads.
import baked
import limits_page
import materials
import parts
import peers
import score
import source
import truth
from views import pixels

REAL = ("rusty_metal", "mossy_rock", "facade")
GENERATED = ("painted_rust", "bricks", "gravel", "leather", "mirror_tiles")
PORTABLE = ["--profile", "portable"]
BAKES = {
    "bake": [*PORTABLE, "--quality", "best"],
    "best": [*PORTABLE, "--quality", "best", "--target", "float"],
}


def main():
    options = arguments()
    start = time.monotonic()
    settings = score.Settings()
    results = []
    for material in listed(options):
        results.append(studied(material, settings, options))
        print(f"== {material.name} ({time.monotonic() - start:.0f} s)", flush=True)
    page = run.ROOT / "docs" / "limits.md"
    if options.only:
        page = Path(shutil.copy(page, options.output))
    limits_page.write(results, page)
    print(f"== {page} ({time.monotonic() - start:.0f} s)")


def arguments():
    """Returns the options of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", metavar="NAME", help="only these materials, with a page in DIR")
    parser.add_argument("--roughcast", type=Path, default=run.ROOT / "target" / "release" / "roughcast", metavar="PATH")
    parser.add_argument("-o", "--output", type=Path, default=run.ROOT / "target" / "appearance", metavar="DIR")
    parser.add_argument(
        "--data", type=Path, default=run.ROOT.parent / "shared" / "data", help="real materials, used where present"
    )
    parser.add_argument("--samples", type=int, default=1024, help="samples for each footprint")
    options = parser.parse_args()
    if not options.roughcast.is_file():
        parser.error(f"{options.roughcast} is missing: run `cargo build --release`, or name another with --roughcast")
    return options


def listed(options):
    """Returns the whole materials that the options ask for."""
    folder = options.output / "sources"
    folder.mkdir(parents=True, exist_ok=True)
    asked = lambda name: not options.only or name in options.only
    real = [m for m in materials.from_data(options.data, folder) if m.name in REAL and asked(m.name)]
    return real + [materials.generated(name, folder, 512) for name in GENERATED if asked(name)]


def studied(material, settings, options):
    """Returns the results of a material: stored ones, if neither inputs nor programs have changed."""
    folder = options.output / "limits"
    folder.mkdir(parents=True, exist_ok=True)
    stored = folder / f"{material.name}.json"
    level_0 = source.read(material.path)
    truth_key = run.key_of_truth(level_0, settings)
    programs = sorted(file for file in run.HERE.glob("*.py") if file.name not in (*run.PAGE_FILES, "limits_page.py"))
    key = run.digest(truth_key, options.roughcast, str(options.samples), *programs)
    if stored.exists() and (old := json.loads(stored.read_text()))["key"] == key:
        return old
    reference = run.truths(material, level_0, truth_key, settings, options)
    result = {"key": key, "name": material.name, "settings": vars(settings) | {"footprints": options.samples}}
    result["noise"] = {n.removeprefix("noise, "): list(map(float, reference[n])) for n in reference if "noise" in n}
    result["variants"] = measured(variants(material, level_0, options), settings, reference, options.samples)
    stored.write_text(json.dumps(result, indent=1))
    return result


def variants(material, level_0, options):
    """Returns what the study compares, with fresh bakes."""
    folder = options.output / "limits" / material.name
    shutil.rmtree(folder, ignore_errors=True)
    bake = lambda name: baked.bake(options.roughcast, material.path, folder / name, name, BAKES[name])
    return parts.Material(level_0, truth.Maps(level_0), peers.plain(level_0), bake("bake"), bake("best"))


def measured(material, settings, reference, samples):
    """Returns errors by row, filter and view, in the form of the results of `run.py`."""
    result = {}
    for view in settings.views():
        view_pixels = pixels(view)
        right = reference[view.name][:, view_pixels["mask"]]
        for name, anisotropic in score.FILTERS.items():
            errors = parts.errors(material, view, view_pixels, anisotropic, right, samples)
            for row, values in errors.items():
                result.setdefault(row, {}).setdefault(name, {})[view.name] = values
    return result


if __name__ == "__main__":
    sys.exit(main())
