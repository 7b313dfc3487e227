"""Charts and pictures of the page as SVG, for light and dark backgrounds."""

import base64

import summary

COLOURS = {
    "light": {"ink": "#1c2430", "soft": "#6b7480", "grid": "#e3e6ea", "paper": "#ffffff", "ours": "#0060a8",
              "peer": "#b34700", "plain": "#6b7480"},
    "dark": {"ink": "#e8ebef", "soft": "#9aa3ae", "grid": "#333a44", "paper": "#14181d", "ours": "#6cbcf2",
             "peer": "#f0a35e", "plain": "#9aa3ae"},
}  # fmt: skip
ROW = 22
SIZE = 96


def kind(name):
    """Returns the class of a variant's colour."""
    if summary.is_ours(name):
        return "ours"
    return "plain" if name.startswith("plain") else "peer"


def framed(width, height, parts):
    """Returns an SVG with styles for light and dark backgrounds."""
    names = lambda scheme: ";".join(f"--{name}:{value}" for name, value in COLOURS[scheme].items())
    classes = "".join(f".{c}{{fill:var(--{c});stroke:var(--{c})}}" for c in ("ours", "peer", "plain"))
    style = (
        f"svg{{{names('light')}}}@media(prefers-color-scheme:dark){{svg{{{names('dark')}}}}}"
        "text{font:11px system-ui,sans-serif;fill:var(--ink);stroke:none}.title{font-weight:600;font-size:13px}"
        ".soft{fill:var(--soft)}.paper{fill:var(--paper)}.grid{stroke:var(--grid)}" + classes
    )
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">'
    return f'{head}<style>{style}</style><rect class="paper" width="100%" height="100%"/>{"".join(parts)}</svg>\n'


def axis(left, right, top, bottom, highest, step):
    """Returns grid lines with labels from 0 to `highest`."""
    parts = []
    for i in range(int(highest / step + 1e-9) + 1):
        x = left + (right - left) * i * step / highest
        parts.append(f'<path class="grid" d="M{x:.1f} {top}V{bottom}"/>')
        parts.append(f'<text class="soft" x="{x:.1f}" y="{bottom + 14}" text-anchor="middle">{i * step:g}</text>')
    return parts


def by_variant(overall):
    """Draws the picture error of each variant with its interval."""
    left, right, top = 150, 620, 40
    bottom = top + ROW * len(overall)
    highest = max(row["picture"][2] for row in overall.values()) * 1.02
    at = lambda value: left + (right - left) * value / highest
    title = "Picture error of each variant, mean over materials, 95 % interval"
    parts = [f'<text class="title" x="12" y="22">{title}</text>']
    parts += axis(left, right, top, bottom, highest, 0.1)
    for index, (name, row) in enumerate(overall.items()):
        y = top + ROW * index + 11
        mean, low, high = row["picture"]
        parts.append(f'<text x="{left - 8}" y="{y + 4}" text-anchor="end">{name}</text>')
        parts.append(f'<path class="{kind(name)}" stroke-width="2" d="M{at(low):.1f} {y}H{at(high):.1f}"/>')
        parts.append(f'<circle class="{kind(name)}" cx="{at(mean):.1f}" cy="{y}" r="4"/>')
        parts.append(f'<text class="soft" x="{at(high) + 6:.1f}" y="{y + 4}">{mean:.3f}</text>')
    return framed(680, bottom + 28, parts)


def by_material(materials):
    """Draws the picture error of plain mips, of the best peer and of our variants for each material."""
    left, right, top = 150, 660, 56
    bottom = top + ROW * len(materials)
    drawn = ["portable, best", "pyramid, best"]
    highest = max(summary.picture_error(m, n) for m in materials for n in [summary.PLAIN, *drawn]) * 1.02
    at = lambda value: left + (right - left) * value / highest
    parts = ['<text class="title" x="12" y="22">Picture error by material</text>']
    legend = (("plain", "plain mips"), ("peer", "best peer"), ("ours", "portable, best; ring: pyramid, best"))
    for index, (name, label) in enumerate(legend):
        parts.append(f'<circle class="{name}" cx="{left + 150 * index}" cy="38" r="4"/>')
        parts.append(f'<text x="{left + 150 * index + 8}" y="42">{label}</text>')
    parts += axis(left, right, top, bottom, highest, 0.2)
    for index, material in enumerate(materials):
        y = top + ROW * index + 11
        error = lambda name: at(summary.picture_error(material, name))
        parts.append(f'<text x="{left - 8}" y="{y + 4}" text-anchor="end">{material["name"]}</text>')
        parts.append(f'<circle class="plain" cx="{error(summary.PLAIN):.1f}" cy="{y}" r="4"/>')
        parts.append(f'<circle class="peer" cx="{error(summary.best_peer(material)):.1f}" cy="{y}" r="4"/>')
        parts.append(f'<circle class="ours" cx="{error(drawn[0]):.1f}" cy="{y}" r="4"/>')
        ring = f'cx="{error(drawn[1]):.1f}" cy="{y}" r="6"'
        parts.append(f'<circle class="ours" {ring} style="fill:none"/>')
    return framed(700, bottom + 28, parts)


def pictures(names, materials, folder):
    """Draws pictures of materials: the truth, then variants, with the picture error of each variant below."""
    left, top, gap = 100, 40, 6
    parts = []
    for column, name in enumerate(["truth", *names]):
        x = left + (SIZE + gap) * column
        parts.append(f'<text x="{x + SIZE / 2}" y="{top - 10}" text-anchor="middle">{name}</text>')
        for row, material in enumerate(materials):
            y = top + (SIZE + 24) * row
            data = base64.b64encode((folder / material["name"] / f"{name}.png").read_bytes()).decode()
            parts.append(f'<image x="{x}" y="{y}" width="{SIZE}" height="{SIZE}" href="data:image/png;base64,{data}"/>')
            label = "" if name == "truth" else f"{summary.picture_error(material, name):.2f}"
            place = f'x="{x + SIZE / 2}" y="{y + SIZE + 14}" text-anchor="middle"'
            parts.append(f'<text class="soft" {place}>{label}</text>')
    for row, material in enumerate(materials):
        y = top + (SIZE + 24) * row + SIZE / 2
        parts.append(f'<text x="{left - 8}" y="{y}" text-anchor="end">{material["name"]}</text>')
    return framed(left + (SIZE + gap) * (len(names) + 1) + 6, top + (SIZE + 24) * len(materials) + 6, parts)
