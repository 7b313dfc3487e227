"""What was promised, and whether the figures keep it."""

from statistics import mean


def bars(results):
    """Rows of the promise, its bound, what was measured, and the verdict; parts that were not measured have none."""
    rows = []
    for name, of in PARTS.items():
        try:
            rows += of(results[name]) if name in results else []
        except KeyError as missing:
            rows.append((f"those of {name}", "", f"no figure for {missing}", "not measured"))
    return rows


def at_most(promise, bound, measured, form="{:.2f}"):
    """A row that is met by figures up to `bound`."""
    return (promise, "at most " + form.format(bound), form.format(measured), "met" if measured <= bound else "not met")


def at_least(promise, bound, measured, form="{:.2f}"):
    """A row that is met by figures from `bound` on."""
    return (promise, "at least " + form.format(bound), form.format(measured), "met" if measured >= bound else "not met")


def ratio(times, one, other, what="wall"):
    """Time of one beside that of the other."""
    return times[one][what] / times[other][what]


def encoders(part):
    times, quality = part["times"], part["quality"]
    gap = lambda a, b, key: {name: row[a][key] - row[b][key] for name, row in quality.items() if key in row.get(a, {})}
    psnr, angle = gap("fast rgb", "level 0", "psnr"), gap("best rgb", "level 2", "psnr")
    directions = [row for row in quality.values() if "degrees" in row["fast"]]
    worst = lambda gaps: min(gaps, key=gaps.get)
    rows = [
        at_most("UASTC `fast` beside level 0, time", 1 / 5, ratio(times, "fast", "level 0")),
        at_most("the same beside level 0 with statistics", 1 / 5, ratio(times, "fast", "level 0 with statistics")),
        at_least(f"`fast` less level 0, PSNR on the worst map ({worst(psnr)}), dB", 0, psnr[worst(psnr)]),
        at_least("`fast` less level 1, mean PSNR, dB", -1, mean(gap("fast rgb", "level 1", "psnr").values())),
    ]
    if directions:
        turned = lambda name: mean(row[name]["degrees"] for row in directions)
        rows.append(at_most("`fast` beside level 1, mean angle of normals", 1, turned("fast") / turned("level 1")))
    rows += [
        at_least(f"`best` less level 2, PSNR on the worst map ({worst(angle)}), dB", 0, angle[worst(angle)]),
        at_most("`best` beside level 1, time", 1 / 4, ratio(times, "best", "level 1")),
    ]
    return rows


def kernels(part):
    times = part["times"]
    return [
        at_most("mean and K of all levels beside a copy of the same bytes", 4, ratio(times, "moments", "copy of moments")),
        at_most("with moments of shape beside a copy of the same bytes", 8, ratio(times, "shape", "copy of shape")),
    ]


def whole(part):
    times = part["times"]
    ktx = "`ktx create`" if part["ktx"] else "the stand-in for `ktx create`"
    return [
        at_most("bake to two textures beside decoding its images in turn", 6, ratio(times, "two textures", "decoding in turn")),
        at_most("the same beside decoding them side by side", 6, ratio(times, "two textures", "decoding side by side")),
        at_least("`maketx --bumpslopes` beside the bake to two textures", 4, ratio(times, "maketx", "two textures")),
        at_least(f"{ktx} of one map beside the bake of two", 6, ratio(times, "pack", "two textures")),
    ]


def growth(part):
    rows = []
    for form in ("two textures", "default"):
        if "16384" in part["sizes"]:
            peak = part["sizes"]["16384"][form]["peak"]
            rows.append(at_most(f"a material of 16384 x 16384, {form}: peak memory, MiB", 2048, peak, "{:.0f}"))
        rows.append(at_most(f"ten large maps at a time, {form}: peak memory, MiB", 2048, part["ten"][form]["peak"], "{:.0f}"))
        if "200" in part["counts"]:
            run = part["counts"]["200"][form]
            rows.append(at_least(f"200 materials of 512 x 512, {form}: share of both cores, %", 90, share(run), "{:.0f}"))
    return rows


def share(run):
    """Of two cores, in percent."""
    return 100 * run["cpu"] / (2 * run["wall"])


PARTS = {"encoders": encoders, "kernels": kernels, "whole": whole, "growth": growth}
