"""Growth as a picture: two logarithmic charts side by side, light and dark."""

import math

WIDTH, HEIGHT = 380, 300
LEFT, TOP, RIGHT, BOTTOM = 56, 56, 16, 44
GAP = 16
COLOURS = {
    "light": {
        "ink": "#1c2430",
        "soft": "#6b7480",
        "grid": "#e3e6ea",
        "paper": "#ffffff",
        "two": "#0060a8",
        "pngs": "#4a9bd9",
        "maketx": "#b34700",
        "pack": "#7a5195",
    },
    "dark": {
        "ink": "#e8ebef",
        "soft": "#9aa3ae",
        "grid": "#333a44",
        "paper": "#14181d",
        "two": "#6cbcf2",
        "pngs": "#3f7fb0",
        "maketx": "#f0a35e",
        "pack": "#c49be0",
    },
}
# Name of each line in the results, and its class.
LINES = {"two textures": "two", "PNG copies": "pngs", "maketx": "maketx", "pack": "pack"}


def growth(results):
    """Draws the part `growth` as an SVG."""
    charts = [
        ("Time against the side of one material's maps", "texels", results["sizes"]),
        ("Time against materials of 512 x 512", "materials", results["counts"]),
    ]
    names = {"pack": "ktx create" if results["ktx"] else "ktx stand-in"}
    width = 2 * WIDTH + GAP
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {HEIGHT}" width="{width}" height="{HEIGHT}">'
    ]
    parts += [f"<style>{style()}</style>", '<rect class="paper" width="100%" height="100%"/>']
    for index, (title, unit, points) in enumerate(charts):
        parts.append(f'<g transform="translate({index * (WIDTH + GAP)} 0)">{chart(title, unit, points, names)}</g>')
    return "".join(parts) + "</svg>\n"


def style():
    """Returns the colours of both schemes, and the classes that have them."""
    names = lambda scheme: ";".join(f"--{name}:{value}" for name, value in COLOURS[scheme].items())
    lines = "".join(
        f".{c}{{stroke:var(--{c});stroke-width:1.8}}text.{c}{{fill:var(--{c});stroke:none}}" for c in LINES.values()
    )
    return (
        f"svg{{{names('light')}}}@media(prefers-color-scheme:dark){{svg{{{names('dark')}}}}}"
        "text{font:11px system-ui,sans-serif;fill:var(--ink)}.title{font-weight:600;font-size:13px}"
        ".soft{fill:var(--soft)}.paper{fill:var(--paper)}path{fill:none}.grid{stroke:var(--grid)}" + lines
    )


def chart(title, unit, points, names):
    """Draws one chart. `points` are summaries by name, then by size or number. `names` replaces names of lines."""
    xs = sorted(int(x) for x in points)
    series = []
    for name, kind in LINES.items():
        known = [(x, points[str(x)][name]["wall"]) for x in xs if "wall" in points[str(x)].get(name, {})]
        if known:
            series.append((kind, names.get(name, name), known))
    walls = [wall for _, _, known in series for _, wall in known] or [1.0]
    low, high = math.floor(math.log10(min(walls))), math.ceil(math.log10(max(walls)) + 1e-9)
    first, last = math.log(xs[0]), math.log(max(xs[-1], xs[0] + 1))
    at_x = lambda x: LEFT + (math.log(x) - first) / (last - first) * (WIDTH - LEFT - RIGHT - 70)
    at_y = lambda y: HEIGHT - BOTTOM - (math.log10(y) - low) / (high - low) * (HEIGHT - TOP - BOTTOM)
    parts = [f'<text class="title" x="{LEFT}" y="20">{title}</text>']
    end = WIDTH - RIGHT - 70
    for power in range(low, high + 1):
        y = at_y(10.0**power)
        parts.append(f'<path class="grid" d="M{LEFT} {y:.1f}H{end}"/>')
        parts.append(f'<text class="soft" x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{10.0**power:g} s</text>')
    for x in xs:
        parts.append(f'<text class="soft" x="{at_x(x):.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{x}</text>')
    parts.append(f'<text class="soft" x="{(LEFT + end) / 2}" y="{HEIGHT - 8}" text-anchor="middle">{unit}</text>')
    free = HEIGHT
    for kind, label, known in sorted(series, key=lambda s: at_y(s[2][-1][1]), reverse=True):
        line = "L".join(f"{at_x(x):.1f} {at_y(wall):.1f}" for x, wall in known)
        # Labels go beside the chart from below, and cover neither each other nor a line.
        free = min(at_y(known[-1][1]) + 4, free - 13)
        parts.append(f'<path class="{kind}" d="M{line}"/>')
        parts.append(f'<text class="{kind}" x="{end + 6}" y="{free:.1f}">{label}</text>')
    return "".join(parts)
