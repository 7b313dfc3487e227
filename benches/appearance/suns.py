"""Measures pictures of base colours that are baked for suns, and writes their table of docs/limits.md.

python3 benches/appearance/suns.py [-o DIR] [--roughcast PATH] [--data DIR] [--only NAME ...]
"""

import shutil
import sys

import numpy as np

import limits  # Imports `run` first of all, which sets the number of FLIP's threads.
import baked
import run
import score
import shading
import source
from limits_page import replaced
from views import pixels

ALL = ["--profile", "portable", "--quality", "best", "--textures", "all"]
BAKES = {light: [*ALL, "--diffuse-light", light] for light in ("environment", "suns")}
LIGHTS = {"suns": slice(1, None), "environment": slice(0, 1)}
# Dielectrics, and a material of metal and rust.
NAMES = ("mossy_rock", "bricks", "gravel", "leather", "painted_rust")


def main():
    options = limits.arguments()
    options.only = options.only or NAMES
    settings = score.Settings()
    rows = [row(material, settings, options) for material in limits.listed(options)]
    heads = [f"{under}, {state}" for under in LIGHTS for state in ("off", "on")]
    table = "\n".join([line("material", heads), "| --- |" + " ---: |" * len(heads), *rows])
    print(table)
    if options.only == NAMES:
        page = run.ROOT / "docs" / "limits.md"
        page.write_text(replaced(page.read_text(), "suns", table))


def row(material, settings, options):
    """Returns the line of a material: errors under each light of the bakes for each light, and their light."""
    level_0 = source.read(material.path)
    reference = run.truths(material, level_0, run.key_of_truth(level_0, settings), settings, options)
    folder = options.output / "suns" / material.name
    shutil.rmtree(folder, ignore_errors=True)
    measured = {}
    for light, arguments in BAKES.items():
        variant = baked.bake(options.roughcast, material.path, folder / light, light, arguments)
        measured[light] = errors(variant, level_0.size, settings, reference)
    text = lambda error, light: f"{error:.3f} ({100 * (light - 1):+.0f} %)"
    return line(material.name, [text(*measured[light][under]) for under in LIGHTS for light in BAKES])


def errors(variant, size, settings, reference):
    """Returns relative L1 and light, compared with the truth, by light: means over views and filters."""
    found = {under: [] for under in LIGHTS}
    for view in settings.views():
        view_pixels = pixels(view)
        right = reference[view.name][:, view_pixels["mask"]]
        for anisotropic in score.FILTERS.values():
            picture = shading.render(view_pixels, variant.surface(view_pixels, size, anisotropic), view.suns)
            for under, lights in LIGHTS.items():
                whole = right[lights].sum(dtype=np.float64)
                error = np.abs(picture[lights] - right[lights]).sum(dtype=np.float64)
                found[under].append((error / whole, picture[lights].sum(dtype=np.float64) / whole))
    return {under: np.mean(values, axis=0) for under, values in found.items()}


def line(first, cells):
    """Returns a line of a table."""
    return f"| {' | '.join([first, *cells])} |"


if __name__ == "__main__":
    sys.exit(main())
