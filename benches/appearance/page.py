"""The page docs/appearance.md, written from results alone."""

import textwrap

import charts
import summary
from intervals import mean_interval
from views import SHAPES

SHOWN = ("brushed", "mirror_tiles", "painted_rust", "weave", "gravel")
SHOWN_VARIANTS = ("plain mips", "Toksvig", "Chan, WWII", "LEAN", "portable, fast", "portable, best", "pyramid, best")
TABLE = ("portable, isotropic", "portable, fast", "portable, best", "pyramid, fast", "pyramid, best")
LABELS = {"suns": "suns", "environment": "environment", "flip": "FLIP"}

INTRODUCTION = """
This page compares pictures of baked materials with the truth, by measures of others, beside plain mips and beside
lobes of other tools and papers. This command measures again and writes the page, its figures and its charts:

```sh
python3 -m venv venv && venv/bin/pip install -r benches/appearance/requirements.txt
cargo build --release && venv/bin/python benches/appearance/run.py
```

[docs/limits.md](limits.md) shows which part of these pictures limits whole materials: lobes, filters, mean colours or
diffuse light.

`run.py FOLDER` adds materials of your own: glTF files with images beside them, or else bare normal maps. `--quick` is
a small run for CI. A second run measures only what has changed, since results and truths are kept in
`target/appearance`.
"""

METHOD = """
## What is measured

- **Truth.** Level 0 is magnified bilinearly, as engines do, and supersampled with Mitsuba 3. Facets of level 0 neither
  hide nor light each other, as in an engine close to the surface. `tests/test_mitsuba.py` compares these pictures with
  those of Mitsuba's own materials, normal maps and lights.
- **Variants.** Each pixel has one shading point. Textures are filtered as a GPU does, trilinear and with up to
  {anisotropy} anisotropic samples; figures are means of both filters. The formula is glTF's: GGX with height-correlated
  masking, Schlick's Fresnel term, and a Lambertian base. Under the environment, rough lobes get back the light that
  single scattering loses, as in three.js and Filament. This energy compensation is computed exactly, and so is the
  integral over the environment: errors of an engine's own approximations are not part of these figures. Normals that
  face away from the eye are turned until they are perpendicular to it, as engines clamp the cosine.
- **Views.** Planes are seen at 75, 45 and 20 degrees of elevation, and a sphere. Footprints at the centre are
  {levels}: half-way between mip levels. Pictures have {pixels} x {pixels} pixels, and the truth has {samples} samples
  for each of them.
- **Lights.** Eight suns, one at a time, of which four make highlights in the picture of a plane, and an environment of
  soft lights. *suns* is relative L1 of linear radiance: the sum of differences over all suns, divided by the sum of the
  truth's radiance, so that suns count by their light. *environment* is the same measure under the environment.
  *Picture error* is the mean of the two.
- **FLIP** compares displayed pictures (environment and one sun) by the program of its authors.
- **Flicker** is the change from frame to frame beyond that of the truth, pixel by pixel, in thousandths of the
  brightest value of the display. A slow camera passes a plane at 20 degrees and a sphere. ColorVideoVDP is not used: it
  needs PyTorch, whose package for Linux brings about three gigabytes of CUDA libraries, too much for this benchmark.
- **Closer** is the picture error of plain mips divided by that of the variant: the geometric mean over materials.
- **Materials.** {count} materials: {origins}. Intervals hold 95 %, by resampling materials.
- **Encoding.** Ours are UASTC textures in KTX2 as `roughcast bake --scale-normals=false` writes them with all other
  settings at their defaults: `auto` may choose any model and size. *isotropic* has `--model isotropic`. Plain mips and
  peers have 8 bits per channel without block compression, and LEAN has half floats. *plain mips, UASTC* is
  `--model none`.
- **Pyramid.** The lobe is A' = A + 2 c K, with the masking of all its roughness. The plugins have the masking of the
  base lobe, since bumps do not hide each other, and that of three.js averages the environment over the slopes of the
  bumps. Neither is done here.
- **Not here.** MIPNet (A. Gauthier et al., "MIPNet: Neural normal-to-anisotropic-roughness MIP mapping", 2022) learns
  normals and anisotropic roughness by a loss on rendered pictures. Its authors publish the training program, but no
  trained network, since their training materials are proprietary. A network that we trained on materials of our own
  would not be their method.
"""


def write(results, pictures, docs):
    """Writes the page and its charts below a folder."""
    materials = results["materials"]
    (docs / "pictures").mkdir(parents=True, exist_ok=True)
    overall = summary.overall(materials)
    shown = [m for m in materials if m["name"] in SHOWN] or materials[:3]
    svgs = {
        "appearance-variants": charts.by_variant(overall),
        "appearance-materials": charts.by_material(materials),
        "appearance-pictures": charts.pictures(SHOWN_VARIANTS, shown, pictures),
    }
    for name, svg in svgs.items():
        (docs / "pictures" / f"{name}.svg").write_text(svg)
    parts = ["# Appearance", INTRODUCTION, in_short(materials, overall), table_of_variants(overall), method(results)]
    parts += [by_material(materials), by_view(materials), where_ours_loses(materials), seen(shown)]
    (docs / "appearance.md").write_text("\n\n".join(part.strip() for part in parts) + "\n")


def row(cells):
    """Returns one line of a table."""
    return f"| {' | '.join(cells)} |"


def table(head, rows):
    """Returns a table whose first column is text and whose other columns are numbers."""
    return "\n".join([row(head), row(["---"] + ["---:"] * (len(head) - 1)), *map(row, rows)])


def wrapped(text):
    """Returns a paragraph with lines of at most 120 columns."""
    return textwrap.fill(text, 120, break_long_words=False, break_on_hyphens=False)


def in_short(materials, overall):
    """Returns the summary of the page."""
    peers = [name for name in overall if not summary.is_ours(name) and not name.startswith("plain")]
    best = max(peers, key=lambda name: overall[name]["closer"][0])
    times = lambda name: "{:.2f} x ({:.2f} to {:.2f})".format(*overall[name]["closer"])
    behind = lambda name: sum(summary.closer(m, name) < 1.0 for m in materials)
    ours = "; ".join(f"*{name}* {times(name)}, behind plain mips on {behind(name)}" for name in TABLE)
    return "## In short\n\n" + wrapped(
        f"Closer to the truth than plain mips, on {len(materials)} materials: {ours}. The best peer in the mean is "
        f"{best}: {times(best)}, behind plain mips on {behind(best)}. {against(best, materials)}"
    )


def against(peer, materials):
    """Returns sentences on *portable, best* against one peer, and against the best peer of each material."""
    ours = "portable, best"
    ratio = [summary.picture_error(m, peer) / summary.picture_error(m, ours) for m in materials]
    ahead = [m["name"] for m in materials if summary.best_peer_error(m) < summary.picture_error(m, ours)]
    return (
        "Against it, *{}* is {:.2f} x ({:.2f} to {:.2f}) closer. ".format(ours, *mean_interval(ratio, geometric=True))
        + f"The best of all peers on each material is ahead of *{ours}* on {len(ahead)}: {', '.join(ahead) or 'none'}."
    )


def table_of_variants(overall):
    """Returns the table of means and intervals."""
    cell = lambda figure: "{:.3f} ({:.3f} to {:.3f})".format(*figure)
    short = lambda figure: "{:.2f} ({:.2f} to {:.2f})".format(*figure)
    rows = [
        [name, short(r["closer"]), cell(r["picture"]), cell(r["suns"]), cell(r["environment"]), cell(r["flip"]),
         short(r["flicker"])]
        for name, r in overall.items()
    ]  # fmt: skip
    head = ["variant", "closer", "picture error", "suns", "environment", "FLIP", "flicker"]
    chart = "![Picture error of each variant](pictures/appearance-variants.svg)"
    return f"{chart}\n\n{table(head, rows)}"


def method(results):
    """Returns the section on what is measured."""
    materials, settings = results["materials"], results["settings"]
    origins = {}
    for material in materials:
        origins[material["origin"]] = origins.get(material["origin"], 0) + 1
    names = {"test data": "of the [test data](../CONTRIBUTING.md#test-data)", "generated": "generated", "user": "named"}
    text = METHOD.format(
        anisotropy=8,
        levels="2^" + ", 2^".join(f"{level:g}" for level in settings["levels"]) + " texels wide",
        pixels=settings["pixels"],
        samples=settings["samples"],
        count=len(materials),
        origins=", ".join(f"{count} {names[origin]}" for origin, count in origins.items()),
    )
    return "\n".join(rewrapped(line) for line in joined(text.strip().splitlines()))


def joined(lines):
    """Returns lines with those of each list item joined to one."""
    result = []
    for line in lines:
        if line.startswith("  "):
            result[-1] += " " + line.strip()
        else:
            result.append(line)
    return result


def rewrapped(line):
    """Returns a list item in lines of at most 120 columns."""
    if not line.startswith("- "):
        return line
    return textwrap.fill(line, 120, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def by_material(materials):
    """Returns the table of materials."""
    rows = []
    for material in materials:
        peer = summary.best_peer(material)
        error = lambda name: summary.picture_error(material, name)
        ours = [f"{error(name):.3f} ({summary.closer(material, name):.2f} x)" for name in TABLE]
        rows.append(
            [material["name"], f"{summary.noise(material):.3f}", f"{error(summary.PLAIN):.3f}",
             f"{peer} {error(peer):.3f}", *ours]
        )  # fmt: skip
    head = ["material", "noise", "plain mips", "best peer", *TABLE]
    return (
        "## By material\n\n"
        + wrapped(
            "Cells are picture errors, with times closer than plain mips in brackets. *noise* is the expected picture "
            "error of the truth itself, which every variant has at least. *best peer* is the best of all peers and of "
            "plain mips on that material."
        )
        + "\n\n"
        "![Picture error by material](pictures/appearance-materials.svg)\n\n" + table(head, rows)
    )


def by_view(materials):
    """Returns the table of shapes, distances and filters: times closer."""
    names = ["Toksvig", "Chan, WWII", "LEAN", *TABLE]
    views = sorted({view.split(", ")[1] for view in materials[0]["noise"]})
    chosen = [(shape, {"view": shape}) for shape in SHAPES] + [(view, {"view": view}) for view in views]
    chosen += [(f"{name} filter", {"filters": (name,)}) for name in ("trilinear", "anisotropic")]
    rows = []
    for label, choice in chosen:
        means = [mean_interval([summary.closer(m, n, **choice) for m in materials], geometric=True) for n in names]
        rows.append([label, *(f"{mean:.2f} ({low:.2f} to {high:.2f})" for mean, low, high in means)])
    text = "Times closer than plain mips: geometric means over materials, with intervals."
    return f"## By shape, distance and filter\n\n{text}\n\n" + table(["views", *names], rows)


def where_ours_loses(materials):
    """Returns the table of losses against plain mips, by measure."""
    found = summary.losses(materials)
    if not found:
        return "## Where ours loses\n\nNo bake has a larger error than plain mips on any material, by any measure."
    text = wrapped(
        "A bake should never be worse than plain mips. These are the materials and measures by which at least one is, "
        "by more than a percent. Cells are times closer than plain mips; those below 1 are losses, in bold."
    )
    cell = lambda times: f"**{times:.2f}**" if times < 1.0 / 1.01 else f"{times:.2f}"
    rows = [[name, LABELS[measure], *(cell(times[n]) for n in TABLE)] for name, measure, times in found]
    return f"## Where ours loses\n\n{text}\n\n" + table(["material", "measure", *TABLE], rows)


def seen(shown):
    """Returns the section of pictures."""
    names = ", ".join(material["name"] for material in shown)
    text = wrapped(
        f"View *{shown[0]['shown']}* under the environment and one sun: {names}. Below each picture is the picture "
        "error of the variant over all views."
    )
    return f"## Pictures\n\n{text}\n\n![Pictures of the truth and of variants](pictures/appearance-pictures.svg)"
