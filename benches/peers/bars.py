"""The promised figures, and whether the measured figures keep them."""

from statistics import mean


def bars(results):
    """Returns rows of a promise, its bound, the measured figure and the verdict. Parts that were not fully measured
    have no rows."""
    rows = []
    for name, of in PARTS.items():
        rows += of(results[name]) if name in results and not results[name]["quick"] else []
    return rows


def upper_bound(promise, bound, measured, form="{:.2f}"):
    """Returns the row of a promise that figures up to `bound` meet."""
    return (promise, "at most " + form.format(bound), *verdict(measured, lambda: measured <= bound, form))


def lower_bound(promise, bound, measured, form="{:.2f}"):
    """Returns the row of a promise that figures from `bound` on meet."""
    return (promise, "at least " + form.format(bound), *verdict(measured, lambda: measured >= bound, form))


def verdict(measured, is_met, form):
    """Returns the text of the figure and the verdict on it. `measured` is `None` where a run failed."""
    if measured is None:
        return "-", "not measured"
    return form.format(measured), "met" if is_met() else "not met"


def ratio(times, one, other):
    """Returns the ratio of two times, or `None` where either run failed."""
    runs = times.get(one, {}), times.get(other, {})
    return runs[0]["wall"] / runs[1]["wall"] if all("wall" in run for run in runs) else None


def encoders(part):
    times, quality = part["times"], {name: row for name, row in part["quality"].items() if name != "failed"}
    # Maps that both tools keep exactly (99 dB) would otherwise weigh as much as any difference.
    is_measured = lambda row, a, b, key: key in row.get(a, {}) and min(row[a][key], row[b][key]) < 99
    gap = lambda a, b, key: {
        name: row[a][key] - row[b][key] for name, row in quality.items() if is_measured(row, a, b, key)
    }
    worst = lambda gaps: min(gaps.items(), key=lambda gap: gap[1], default=("none", None))
    average = lambda values: mean(values) if values else None
    rows = []
    for what, ours, key in [("by colour", "rgb", "psnr"), ("by roughness", "surface", "green")]:
        kind = "PSNR" if key == "psnr" else f"PSNR of {key}"
        fast, best = f"fast {ours}", f"best {ours}"
        for name, mine, other in [("fast", fast, "level 0"), ("best", best, "level 2")]:
            place, least = worst(gap(mine, other, key))
            rows.append(lower_bound(f"`{name}` {what} less {other}, {kind} on the worst map ({place}), dB", 0, least))
        rows.append(
            lower_bound(
                f"`fast` {what} less level 1, mean {kind}, dB", -1, average(list(gap(fast, "level 1", key).values()))
            )
        )
    directions = [row for row in quality.values() if "degrees" in row["fast"]]
    angles = [average([row[encoder]["degrees"] for row in directions]) for encoder in ("fast", "level 1")]
    return rows + [
        upper_bound("UASTC `fast` by direction over level 0, time", 1 / 5, ratio(times, "fast", "level 0")),
        upper_bound(
            "UASTC `fast` by direction over level 0 with statistics (the C interface), time",
            1 / 5,
            ratio(times, "fast", "level 0 with statistics"),
        ),
        upper_bound("`fast` by colour over level 0, time", 1 / 5, ratio(times, "fast rgb", "level 0")),
        upper_bound(
            "`fast` by roughness over level 0, time",
            1 / 5,
            ratio(times, "fast surface, roughness", "level 0, roughness"),
        ),
        upper_bound("`fast` by direction over level 1, mean angle of normals", 1, angles[0] and angles[0] / angles[1]),
        upper_bound("`best` by direction over level 1, time", 1 / 4, ratio(times, "best", "level 1")),
        upper_bound("`best` by colour over level 1, time", 1 / 4, ratio(times, "best rgb", "level 1")),
        upper_bound(
            "`best` by roughness over level 1, time",
            1 / 4,
            ratio(times, "best surface, roughness", "level 1, roughness"),
        ),
    ]


def kernels(part):
    times = part["times"]
    return [
        upper_bound(
            "mean and K of all levels over a copy of as many bytes, time", 4, ratio(times, "moments", "copy of moments")
        ),
        upper_bound("mean and K of all levels over a copy in place, time", 4, ratio(times, "moments", "copy in place")),
        upper_bound(
            "mean, K and moments of shape over a copy of as many bytes, time", 8, ratio(times, "shape", "copy of shape")
        ),
    ]


def whole(part):
    times = part["times"]
    ktx = "`ktx create`" if part["ktx"] else "the stand-in for `ktx create`"
    return [
        upper_bound(
            "bake to two textures over decoding its images in turn, time",
            6,
            ratio(times, "two textures", "decoding in turn"),
        ),
        upper_bound(
            "bake to two textures over decoding its images side by side, time",
            6,
            ratio(times, "two textures", "decoding side by side"),
        ),
        lower_bound(
            "`maketx --bumpslopes` over the bake to two textures, time", 4, ratio(times, "maketx", "two textures")
        ),
        lower_bound(f"{ktx} of one map over the bake to two textures, time", 6, ratio(times, "pack", "two textures")),
        lower_bound(
            f"{ktx} of both maps over the bake to two textures, time", 6, ratio(times, "pack both", "two textures")
        ),
    ]


def growth(part):
    rows = []
    for form in ("two textures", "PNG copies"):
        if "16384" in part["sizes"]:
            peak = part["sizes"]["16384"][form].get("peak")
            rows.append(upper_bound(f"a material of 16384 x 16384, {form}: peak memory, MiB", 2048, peak, "{:.0f}"))
        peak = part["ten"][form].get("peak")
        rows.append(upper_bound(f"ten large maps at a time, {form}: peak memory, MiB", 2048, peak, "{:.0f}"))
        if "200" in part["counts"]:
            busy = share(part["counts"]["200"][form])
            rows.append(lower_bound(f"200 materials of 512 x 512, {form}: share of both cores, %", 90, busy, "{:.1f}"))
    return rows


def memory(part):
    size = part["size"]
    return [
        upper_bound(
            f"a normal map of {size} x {size} by itself, {form}: peak memory, MiB", 2048, run.get("peak"), "{:.0f}"
        )
        for form, run in part["runs"].items()
    ]


def share(run):
    """Returns the use of two cores in percent, or `None` where the run failed."""
    return 100 * run["cpu"] / (2 * run["wall"]) if "cpu" in run else None


PARTS = {"encoders": encoders, "kernels": kernels, "whole": whole, "growth": growth, "memory": memory}
