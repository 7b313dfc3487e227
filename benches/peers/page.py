"""Writes docs/performance.md from the results."""

import textwrap
from statistics import mean

from bars import bars, ratio, share

# Names of the contenders in the tables.
NAMES = {
    "two textures": "Roughcast, two textures: `bake --gltf strict --model isotropic --threads 2`",
    "PNG copies": "Roughcast, PNG copies: `bake --gltf fallback --threads 2`",
    "maketx": "`maketx --bumpslopes -d half --threads 2`",
    "decoding in turn": "decoding both images, one after the other",
    "decoding side by side": "decoding both images side by side",
    "moments": "mean and K of all levels",
    "shape": "mean, K, third and fourth moments of all levels",
    "fast": "Roughcast `fast`, by direction",
    "best": "Roughcast `best`, by direction",
    "fast rgb": "Roughcast `fast`, by colour",
    "best rgb": "Roughcast `best`, by colour",
    "fast surface, roughness": "Roughcast `fast`, by roughness, of roughness",
    "best surface, roughness": "Roughcast `best`, by roughness, of roughness",
    **{
        f"level {i}{s}": f"basis_universal level {i}{s and ', C interface' + s}"
        for i in (0, 1)
        for s in ("", " with statistics")
    },
    **{f"level {i}, roughness": f"basis_universal level {i}, of roughness" for i in (0, 1)},
    "copy in place": "copy: as in the next row, but into memory that was written before",
    "copy of moments": "copy: reads the map and writes as many bytes as means and K have",
    "copy of shape": "copy: reads the map and writes as many bytes as all moments have",
    "pack both": "the same for both maps, one after the other",
}


def page(results):
    """Returns the whole document."""
    sections = [head(results)]
    sections += [of(results[name]) for name, of in SECTIONS.items() if name in results]
    return "\n\n".join(filled(block) for block in "\n\n".join(sections).split("\n\n")) + "\n"


def filled(block):
    """Wraps the prose of a block of the document at 120 columns."""
    if block.startswith(("|", "#", "```", "<", "- ")):
        return block
    return textwrap.fill(block, 120, break_long_words=False, break_on_hyphens=False)


def table(header, rows):
    """Formats a table in Markdown."""
    lines = [header, ["---"] + ["---:"] * (len(header) - 1), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def timed(times, base, extra=lambda name: [], columns=(), pack="pack"):
    """Returns a table with a row for each contender: times, the ratio to `base`, memory."""
    rows = []
    wall = times.get(base, {}).get("wall")
    for name, run in times.items():
        label = pack if name == "pack" else NAMES.get(name, name)
        if "failed" in run:
            rows.append([label, "failed: " + run["failed"].replace("|", "/"), *[""] * (5 + len(columns))])
            continue
        beside = f"{run['wall'] / wall:.2f}" if wall else "-"
        rows.append(
            [
                label,
                seconds(run["wall"]),
                f"{seconds(run['least'])} - {seconds(run['most'])}",
                seconds(run["cpu"]),
                beside,
                f"{run['peak']:.0f}",
                run["runs"],
                *extra(name),
            ]
        )
    short = NAMES.get(base, base).split(":")[0]
    return table(["", "wall s", "least - most", "CPU s", f"ratio to {short}", "peak MiB", "runs", *columns], rows)


def seconds(value):
    """Formats a number with three significant digits."""
    return f"{value:.3g}" if value < 100 else f"{value:.0f}"


def lobes(errors):
    """Formats the mean of all levels and the worst level."""
    return f"{mean(errors):.3f}, {max(errors):.3f}" if errors else "-"


def head(results):
    quick = [name for name, part in results.items() if part.get("quick")]
    lines = ["# Performance", ""]
    if quick:
        lines += [
            f"**Measured with `--quick`, on small maps with one run each: {', '.join(quick)}. "
            "These figures only show that the script runs.**",
            "",
        ]
    lines += [
        "This page compares Roughcast with tools that do parts of its work, on one machine, in alternating runs. "
        "`python3 benches/peers/run.py` writes this page in 30 minutes on Linux. It needs Rust, a C++ compiler, "
        "Python 3.10 with venv, and `ktx` of KTX-Software on the PATH. Without `ktx`, a stand-in is timed. The script "
        "installs OpenImageIO from PyPI into a scratch environment under `target/peers`, builds, makes the inputs, "
        "measures, and prints the tables below. `--only PART` measures one of encoders, kernels, decoders, whole, "
        "growth, memory again.",
        "",
        "Times are medians of the runs, whose number the tables have. CPU seconds are the sum over all threads, and "
        "peak memory is the resident set of the process. The inputs are PNGs of 8 bits. Normals are tiles of the maps "
        "of the [test data](../CONTRIBUTING.md#test-data) (wool, sand, bricks), rotated and mirrored so that no two "
        "neighbours are equal. Without that folder, normals are synthetic. Roughness is synthetic.",
        "",
        "## The machine",
        "",
    ]
    facts = {fact: None for name in SECTIONS if name in results for fact in results[name]["machine"]}
    lines += [f"- {fact}: {agreed(fact, results)}" for fact in facts]
    lines += ["", "## Bounds", ""]
    verdicts = [[*row[:3], row[3] if row[3] == "met" else f"**{row[3]}**"] for row in bars(results)]
    lines += [
        table(["", "bound", "measured", ""], verdicts),
        "",
        "[Goals](accuracy.md#goals) compares bakes with an earlier build in one run.",
    ]
    return "\n".join(lines)


def agreed(fact, results):
    """Returns a fact about the machines of the parts, once if the parts agree."""
    values = {}
    for name in SECTIONS:
        if name in results:
            values.setdefault(results[name]["machine"].get(fact, "?"), []).append(name)
    if len(values) == 1:
        return next(iter(values))
    return "; ".join(f"{value} ({', '.join(names)})" for value, names in values.items())


def square(size):
    return f"{size} x {size}"


def encoders(part):
    lobes = part["lobes"]
    known = {} if "failed" in lobes else lobes
    lobe = lambda name: [
        f"{mean(row[name] for row in known.values()):.4f}" if known and name in next(iter(known.values())) else "-"
    ]
    same = {"level 0 with statistics": "level 0", "level 1 with statistics": "level 1"}
    more = lambda name: [rate(part, name), *lobe(same.get(name, name))]
    lines = [
        f"## UASTC: one level of {square(part['size'])}",
        "",
        "`--only encoders`. The times are from normals in memory to blocks in memory. basis_universal also wraps its "
        "blocks into a file in that time, which one call cannot leave out. Its C interface always computes PSNR, SSIM "
        "and PSNR-HVS-M as well. The rows without the C interface call the C++ function underneath without these "
        "statistics, which is faster, and the bounds above are for these rows. A bake encodes normals by direction, "
        "roughness with occlusion and metal by roughness, and everything else by",
        'colour. Rows "of roughness" encode the roughness map of the bakes below. Its occlusion and metal are',
        "constant, which makes its blocks fast to encode.",
        "Lobe errors are means over real normal maps, levels 1 to 4, alpha 0.2, baked to anisotropic lobes",
        "of which only the normals are encoded"
        + (f". With half floats the error is {lobe('half floats')[0]}." if known else "."),
        "",
        timed(part["times"], "level 0", more, ["Mtexel/s", "lobe error"]),
        "",
        "Differences between decoded texels and their source: PSNR of red, green and blue in dB for the encoders that "
        "fit colours, 99 for equal images; root mean square angles of normals in degrees for the encoders that fit "
        "directions.",
        "",
    ]
    if "failed" in part["quality"]:
        return "\n".join([*lines, f"failed: {part['quality']['failed']}"])
    psnr, angle = ["fast rgb", "best rgb", "level 0", "level 1", "level 2"], [
        "fast",
        "best",
        "level 0",
        "level 1",
        "level 2",
    ]
    rows = []
    for name, row in part["quality"].items():
        angles = [f"{row[e]['degrees']:.2f}" if "degrees" in row[e] else "" for e in angle]
        rows.append([name, *[f"{row[e]['psnr']:.1f}" for e in psnr], *angles])
    means = lambda keys, key: [
        f"{mean(row[e][key] for row in part['quality'].values() if key in row[e]):.2f}"
        for e in keys
        if any(key in row[e] for row in part["quality"].values())
    ]
    rows.append(["mean", *means(psnr, "psnr"), *means(angle, "degrees")])
    header = ["", "`fast` dB", "`best` dB", "level 0 dB", "level 1 dB", "level 2 dB"]
    lines += [table([*header, "`fast` °", "`best` °", "level 0 °", "level 1 °", "level 2 °"], rows)]
    green = ["fast surface", "best surface", "level 0", "level 1", "level 2"]
    rows = [
        [name, *[f"{row[e]['green']:.1f}" for e in green]]
        for name, row in part["quality"].items()
        if "green" in row["level 0"]
    ]
    lines += [
        "",
        "PSNR of green, the channel of roughness, for the encoder of roughness (occlusion and metal have a quarter of "
        "the weight):",
        "",
    ]
    return "\n".join([*lines, table(header, [*rows, ["mean", *means(green, "green")]])])


def rate(part, name):
    """Returns the millions of texels of the largest level per second."""
    wall = part["times"][name].get("wall")
    return f"{part['size'] ** 2 / 1e6 / wall:.1f}" if wall else "-"


def kernels(part):
    texels = part["size"] ** 2
    # The kernel reads three bytes for each texel. Coarser levels have a third of the texels.
    bandwidth = lambda name, size: (3 + size / 3) * texels / 1e9 / part["times"][name]["wall"]
    sizes = {"copy in place": 20, "copy of moments": 20, "moments": 20, "copy of shape": 56, "shape": 56}
    beside = lambda name: ratio(part["times"], name, f"copy of {name}")
    more = lambda name: [
        rate(part, name),
        f"{bandwidth(name, sizes[name]):.1f}" if "wall" in part["times"][name] else "-",
        f"{beside(name):.2f}" if beside(name) else "-",
    ]
    in_place = [ratio(part["times"], name, "copy in place") for name in ("copy of moments", "moments")]
    return "\n".join(
        [
            f"## From a normal map to its pyramid: {square(part['size'])}",
            "",
            "`--only kernels`. The times are from 8-bit texels in memory to the means and covariances K (20 bytes a "
            "texel) of all coarser levels, or to these and the moments of shape (56 bytes). They are of the second "
            "run of a process, on two threads. All but the first copy write to new memory, as a bake does, which the "
            "system clears page by page. No lobe is fitted, so there is no lobe error.",
            *[
                "Compared with the copy in place, the copy to new memory takes {:.1f} times the time, means and K "
                "{:.1f} times.".format(
                    *in_place
                )
            ]
            * all(in_place),
            "",
            timed(part["times"], "copy of moments", more, ["Mtexel/s", "GB/s", "ratio to its copy"]),
        ]
    )


def decoders(part):
    return "\n".join(
        [
            f"## Decoders: {square(part['size'])} normals",
            "",
            "`--only decoders`. The times are from a file in memory to 8-bit texels. Roughcast decodes PNG with `png` "
            "(through `image`) and JPEG with `zune-jpeg`, to which `image` moved from `jpeg-decoder` in 0.25. "
            "Decoding is exact, and JPEG is exact within rounding, so lobe errors do not depend on the decoder.",
            "",
            timed(part["times"], "PNG, png"),
        ]
    )


def whole(part):
    found = part["errors"]
    model = {"two textures": "isotropic", "PNG copies": "chosen", "pack": "none", "pack both": "none"}
    written = lambda name: part["times"][name]["written"]
    more = lambda name: [
        rate(part, name),
        f"{written(name):.1f}" if written(name) else "-",
        lobes(found.get(model.get(name))),
    ]
    pack = "`ktx create --encode uastc --uastc-quality 0 --zstd 5`" if part["ktx"] else PACK
    return "\n".join(
        [
            f"## A whole bake: one material, normal and roughness of {square(part['size'])}",
            "",
            "`--only whole`. The times are from PNGs on disk to files on disk, mips included. `maketx` and the first "
            "`ktx create` process the normal map only. Lobe errors (mean of all levels, worst level) are the "
            "estimates by which the bake with PNG copies chose its model, from decoded blocks: of isotropic lobes, of "
            "the chosen model, and of plain mips with the material's roughness. The errors of plain mips are in the "
            "rows of `ktx create`, which makes such mips, but they are of Roughcast's blocks. `maketx` writes data "
            "for renderers that roughen lobes themselves. Mtexel/s are texels of level 0 of one map; the table of "
            "kernels above has copies.",
            "",
            timed(part["times"], "two textures", more, ["Mtexel/s", "written MiB", "lobe error"], pack),
        ]
    )


PACK = (
    "stand-in for `ktx create --generate-mipmap --encode uastc --uastc-quality 0 --zstd 5` (boxes, basis_universal "
    "level 0, zstd 3)"
)


def growth(part):
    header = [
        f"{form}: {what}" for form in ("two textures", "PNG copies") for what in ("wall s", "CPU s", "peak MiB", "{}")
    ]
    with_last = lambda last: [column.format(last) for column in header]
    return "\n".join(
        [
            "## How cost grows",
            "",
            "`--only growth`. One material of growing size. Other tools process its normal map, up to 8192 x 8192. "
            "Lobe errors: mean of all levels, worst level.",
            "",
            "![Time of bakes against the side of maps and against the number of materials](pictures/growth.svg)",
            "",
            table(
                [
                    "",
                    *with_last("lobe error"),
                    "maketx: wall s",
                    f"{'`ktx create`' if part['ktx'] else 'its stand-in'}: wall s",
                    "runs",
                ],
                size_rows(part),
            ),
            "",
            "Materials of 512 x 512, each in its own document, in one bake; busy is the share of both cores. Every "
            "material has the texels and the lobe errors of the row 512 x 512 above.",
            "",
            table(["", *with_last("busy %"), "runs"], count_rows(part)),
            "",
            "Ten materials of 4096 x 4096 in one bake, which runs as many at a time as fit into a memory budget of 1 "
            "GiB (`crates/pipeline/src/run/budget.rs`), at least one: "
            + "; ".join(
                f"{form} {run['peak']:.0f} MiB, {seconds(run['wall'])} s"
                for form, run in part["ten"].items()
                if "wall" in run
            )
            + ".",
        ]
    )


def cells(run, more=()):
    """Returns the cells of a run in the tables of growth."""
    if "failed" in run:
        return [run["failed"]] + [""] * (2 + len(more))
    return [seconds(run["wall"]), seconds(run["cpu"]), f"{run['peak']:.0f}", *more]


def size_rows(part):
    """Returns a row for each size of a map."""
    rows = []
    for size, point in part["sizes"].items():
        found = point["errors"]
        other = [seconds(point[name]["wall"]) if "wall" in point.get(name, {}) else "-" for name in ("maketx", "pack")]
        two, copies = point["two textures"], point["PNG copies"]
        rows.append(
            [
                square(size),
                *cells(two, [lobes(found.get("isotropic"))]),
                *cells(copies, [lobes(found.get("chosen"))]),
                *other,
                two.get("runs", 0),
            ]
        )
    return rows


def count_rows(part):
    """Returns a row for each number of materials."""
    rows = []
    for count, point in part["counts"].items():
        two, copies = point["two textures"], point.get("PNG copies", {"failed": "-"})
        busy = lambda run: [f"{share(run):.1f}" if "cpu" in run else ""]
        rows.append([count, *cells(two, busy(two)), *cells(copies, busy(copies)), two.get("runs", 0)])
    return rows


def memory(part):
    runs = [
        f"{form} {run['peak']:.0f} MiB, {seconds(run['wall'])} s" for form, run in part["runs"].items() if "wall" in run
    ]
    return "\n".join(
        [
            f"## Memory: a normal map of {square(part['size'])} by itself",
            "",
            "`--only memory`. `roughcast map --roughness-factor 0.4`, with `--model isotropic` or `anisotropic`: "
            + "; ".join(runs)
            + ". Above, assets",
            "also have a roughness map of three channels and equal size, and with PNG copies also PNGs of level 0 for "
            "engines without KTX2. An explicit model is not compared with others. The lobe errors of these normals "
            "are in the last row of sizes above.",
        ]
    )


SECTIONS = {
    "encoders": encoders,
    "kernels": kernels,
    "decoders": decoders,
    "whole": whole,
    "growth": growth,
    "memory": memory,
}
