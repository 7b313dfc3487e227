"""The tables of docs/limits.md, written between markers from results alone."""

import re

import summary
from page import table, wrapped
from parts import POWERS, power_name

MEASURES = ("suns", "environment")
# Rows of errors that remain if all other parts are exact, and their names in the table.
ALONE = {
    "only the filter": "filter",
    "only the lobes": "lobes",
    "only the colours": "mean colours",
    "only the diffuse light": "diffuse light",
}
# Rows whose picture error is compared with that of the bake in the summary, and what they change.
CHANGES = {
    "bake in floats": "Picture errors without an encoding of the lobes",
    "metalness by colour": "Picture errors with mips of metalness that are weighted by base colour",
}
# Rows of the tables of materials.
ROWS = (
    "plain mips",
    "bake",
    "bake in floats",
    "exact lobes",
    "exact lobes by area",
    "exact energy of lobes",
    "exact mean colours",
    "metalness by colour",
    "exact diffuse light",
    "exact filter",
    "only the filter",
)


def write(results, path):
    """Replaces the blocks between the markers of a page."""
    text = path.read_text()
    for name, build in (("short", in_short), ("alone", alone), ("powers", powers), ("materials", by_material)):
        text = replaced(text, name, build(results))
    path.write_text(text)


def replaced(text, name, block):
    """Returns a text with another block between the markers of a name."""
    begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    if text.count(begin) != 1 or text.count(end) != 1:
        raise ValueError(f"expected the markers {begin} and {end} once each; add them to the page")
    pattern = re.escape(begin) + ".*" + re.escape(end)
    return re.sub(pattern, lambda _: f"{begin}\n\n{block}\n\n{end}", text, flags=re.DOTALL)


def largest(material, measure):
    """Returns the name of the part that has the largest error alone."""
    return ALONE[max(ALONE, key=lambda row: summary.error(material, row, measure))]


def in_short(results):
    """Returns sentences that name the largest part of each material."""
    lines = []
    for measure, label in zip(MEASURES, ("Under suns", "Under the environment")):
        found = {}
        for material in results:
            found.setdefault(largest(material, measure), []).append(material["name"])
        order = sorted(found.items(), key=lambda item: -len(item[1]))
        text = "; ".join(f"**{part}** on {', '.join(names)}" for part, names in order)
        lines.append(item(f"{label}, the largest part is {text}."))
    for row, text in CHANGES.items():
        changed = lambda material: abs(summary.picture_error(material, row) - summary.picture_error(material, "bake"))
        figures = [change(material, row) for material in results if changed(material) > 0.0005]
        lines.append(item(f"{text}: {', '.join(figures) or 'no material changes'}."))
    return "\n".join(lines)


def item(text):
    """Returns an item of a list, in lines of at most 120 columns."""
    return wrapped(f"- {text}").replace("\n", "\n  ")


def change(material, row):
    """Returns the picture errors of the bake and of another row."""
    return f"{material['name']} {' to '.join(f'{summary.picture_error(material, r):.3f}' for r in ('bake', row))}"


def alone(results):
    """Returns the table of what each part costs by itself, the largest part in bold."""
    rows = []
    for material in results:
        for measure in MEASURES:
            error = lambda row: summary.error(material, row, measure)
            bold = lambda row: "**{:.3f}**" if ALONE[row] == largest(material, measure) else "{:.3f}"
            parts = [bold(row).format(error(row)) for row in ALONE]
            whole = [f"{error(row):.3f}" for row in ("plain mips", "bake")]
            rows.append([f"{material['name']}, {measure}", *whole, *parts, light_of_lobes(material, measure)])
    return table(["material and light", "plain mips", "bake", *ALONE.values(), "light of the lobes"], rows)


def light_of_lobes(material, measure):
    """Returns the light of baked lobes by that of exact ones."""
    light = lambda row: summary.error(material, row, f"light, {measure}")
    return f"{light('only the lobes') / light('light of exact lobes'):.2f}"


def powers(results):
    """Returns the table of diffuse light times powers of the length of the mean normal."""
    names = [*map(power_name, POWERS), "exact diffuse light"]
    rows = []
    for material in filter(has_diffuse_light, results):
        cells = []
        for measure in MEASURES:
            light = lambda row: 100.0 * (summary.error(material, row, f"light, {measure}") - 1.0)
            cells += [f"{summary.error(material, row, measure):.3f} ({light(row):+.0f} %)" for row in names]
        rows.append([material["name"], *cells])
    short = {"suns": "suns", "environment": "env."}
    labels = [*(f"p = {power:g}" for power in POWERS), "exact"]
    return table(["material", *(f"{short[measure]}, {label}" for measure in MEASURES for label in labels)], rows)


def has_diffuse_light(material):
    """Returns whether diffuse light is more than a percent of a material's light."""
    light = lambda row: summary.error(material, row, "light, suns")
    return light("bake") - light("only the lobes") > 0.01


def by_material(results):
    """Returns a table for each material: shapes and lights apart, and distances."""
    parts = []
    for material in results:
        levels = [f"level {level:g}" for level in material["settings"]["levels"]]
        rows = []
        for row in ROWS:
            cells = [summary.error(material, row, m, view=shape) for m in MEASURES for shape in ("plane", "sphere")]
            cells += [summary.picture_error(material, row, view=level) for level in levels]
            rows.append([row, *(f"{cell:.3f}" for cell in cells)])
        head = [f"{m}, {shape}" for m in ("suns", "env.") for shape in ("planes", "sphere")]
        title = f"### {material['name']}\n\nThe truth itself has an expected error of {summary.noise(material):.3f}."
        parts.append(f"{title}\n\n{table(['picture', *head, *levels], rows)}")
    return "\n\n".join(parts)
