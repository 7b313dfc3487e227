"""The measurements. Each part returns data; `page.py` makes tables of the data, and `bars.py` verdicts."""

import json
import os
import shlex
from pathlib import Path

from measure import Contender, Failed, alternate, once
from prepare import inputs

# The two forms of a bake: the fewest textures, and the chosen model with a PNG of level 0 beside each texture.
TWO = ["--gltf", "strict", "--model", "isotropic"]
PNG_COPIES = ["--gltf", "fallback"]


class Bench:
    """State that parts share."""

    def __init__(self, tools, data, quick):
        self.tools, self.data, self.quick = tools, data, quick
        self.maps = data / "maps" if data else None
        self.size = 1024 if quick else 4096
        self.rounds = 1 if quick else 5
        self.out = str(tools.work / "out")
        self.report = tools.work / "report.json"

    def sizes(self):
        """Returns the sides of the maps of growing materials."""
        return [256, 512, 1024, 2048] + ([] if self.quick else [4096, 8192, 16384])

    def folder(self, size=None, count=None):
        """Returns the folder of assets with maps of `size`, as many as any part needs."""
        size = size or self.size
        most = {512: 100 if self.quick else 1000, self.size: 10}
        return inputs(self.tools, self.maps, size, most.get(size, 1))

    def normal(self, size=None):
        return str(self.folder(size) / "maps" / "normal.png")

    def surface(self):
        return str(self.folder() / "maps" / "surface.png")

    def bake(self, size, count, form):
        """Runs Roughcast on `count` assets."""
        assets = [str(self.folder(size) / f"{index:04}.gltf") for index in range(count)]
        argv = [self.tools.roughcast, "bake", *assets, "-o", self.out, "--threads", "2", "--quiet", *form]
        return Contender(argv, out=self.out)

    def map(self, size, form):
        """Runs Roughcast on one normal map."""
        argv = [
            self.tools.roughcast,
            "map",
            self.normal(size),
            "-o",
            f"{self.out}/normal.ktx2",
            "--roughness-factor",
            "0.4",
            "--quiet",
            *form,
        ]
        return Contender(argv, out=self.out)

    def maketx(self, size=None):
        argv = [self.tools.maketx, "--bumpslopes", "--bumpformat", "normal", "-d", "half", "--threads", "2"]
        return Contender([*argv, self.normal(size), "-o", f"{self.out}/slopes.exr"], out=self.out)

    def packed(self, image, target):
        """Returns the command line of `ktx create` where it is installed, else that of our stand-in."""
        if self.tools.ktx:
            argv = [self.tools.ktx, "create", "--format", "R8G8B8_UNORM", "--assign-tf", "linear", "--generate-mipmap"]
            argv += ["--encode", "uastc", "--uastc-quality", "0", "--zstd", "5", "--threads", "2"]
            return [*argv, image, target]
        return [self.tools.peers, "pack", image, target]

    def pack(self, size=None):
        return Contender(self.packed(self.normal(size), f"{self.out}/packed.ktx2"), out=self.out)

    def pack_both(self):
        """Packs both maps, one after the other: as many textures as a bake makes."""
        normal = shlex.join(self.packed(self.normal(), f"{self.out}/normal.ktx2"))
        surface = shlex.join(self.packed(self.surface(), f"{self.out}/surface.ktx2"))
        return Contender(["sh", "-c", f"{normal} && {surface}"], out=self.out)

    def inner(self, *argv, rounds=None):
        """Returns the contender that runs a subcommand of this folder's crate. The subcommand times itself."""
        return Contender([self.tools.peers, *argv], times_itself=True, rounds=rounds)

    def real(self, *names):
        """Returns files of the data whose names hold one of `names`, or our own inputs where there is no data."""
        if not self.data:
            return [self.normal()]
        files = sorted(path for path in self.data.rglob("*") if path.suffix in (".png", ".jpg"))
        return [str(path) for path in files if any(name in path.stem.lower() for name in names)]


def encoders(bench):
    """Measures UASTC encoders: the time of one level, then the quality on real maps."""
    names = [
        "fast",
        "level 0",
        "level 0 with statistics",
        "best",
        "level 1",
        "level 1 with statistics",
        "fast rgb",
        "best rgb",
    ]
    # The slowest encoder is shown, and no bar uses it.
    rounds = {"level 1 with statistics": 1}
    contenders = {name: bench.inner("encode", name, bench.normal(), rounds=rounds.get(name)) for name in names}
    surfaces = ["fast surface", "level 0", "best surface", "level 1"]
    contenders |= {f"{name}, roughness": bench.inner("encode", name, bench.surface()) for name in surfaces}
    times = alternate(contenders, bench.rounds)
    print("  distance from the source, lobe errors")
    maps = bench.real("normal", "_nor_", "rough", "depth", "_arm_")
    few = bench.real("sand_normal", "water_normal", "wool_normal", "bricks_normal", "aluminium_normal")
    if bench.quick:
        maps, few = maps[-4:], few[-1:]
    return {
        "size": bench.size,
        "times": times,
        "quality": printed(bench, "quality", *maps),
        "lobes": printed(bench, "lobes", *few),
    }


def printed(bench, *argv):
    """Returns what a subcommand prints, or why it failed."""
    try:
        run = once(bench.inner(*argv))
    except Failed as reason:
        return {"failed": str(reason)}
    return {name: row for name, row in run.items() if isinstance(row, dict)}


def kernels(bench):
    """Measures the pyramid's kernel and copies."""
    names = ["copy in place", "copy of moments", "moments", "copy of shape", "shape"]
    contenders = {name: bench.inner("kernel", name, bench.normal()) for name in names}
    return {"size": bench.size, "times": alternate(contenders, bench.rounds if bench.quick else 9)}


def decoders(bench):
    """Measures PNG and JPEG decoders."""
    jpeg = f"{bench.tools.work}/normal-{bench.size}.jpg"
    os.path.exists(jpeg) or once(bench.inner("inputs", "jpeg", bench.normal(), jpeg))
    contenders = {
        f"PNG, {name}": bench.inner("decode", name, bench.normal()) for name in ["png", "zune-png", "roughcast"]
    }
    contenders |= {
        f"JPEG, {name}": bench.inner("decode", name, jpeg) for name in ["zune-jpeg", "jpeg-decoder", "roughcast"]
    }
    return {"size": bench.size, "times": alternate(contenders, bench.rounds)}


def whole(bench):
    """Measures a whole bake of one material, from files to files."""
    both = [bench.normal(), bench.surface()]
    with_report = [*PNG_COPIES, "--report", str(bench.report)]
    contenders = {
        "decoding in turn": bench.inner("images", "in turn", *both),
        "decoding side by side": bench.inner("images", "side by side", *both),
        "two textures": bench.bake(bench.size, 1, TWO),
        "PNG copies": bench.bake(bench.size, 1, with_report),
        "maketx": bench.maketx(),
        "pack": bench.pack(),
        "pack both": bench.pack_both(),
    }
    times = alternate(contenders, bench.rounds)
    return {"size": bench.size, "times": times, "errors": errors(bench), "ktx": bool(bench.tools.ktx)}


def errors(bench):
    """Returns lobe errors by level, decoded from blocks, of each model in full size and of the chosen model
    (`chosen`), and the errors that the bake had estimated before its choice. Returns nothing where the run failed."""
    if not bench.report.exists():
        return {}
    choice = json.loads(bench.report.read_text())["assets"][0]["layers"][0]["choice"]
    bench.report.unlink()
    candidates = choice["candidates"]
    finest = min(candidate["first"] for candidate in candidates)
    found = {c["model"]: c["errors"] for c in candidates if c["first"] == finest}
    return found | {"chosen": candidates[choice["chosen"]]["errors"]}


def growth(bench):
    """Measures time and memory against size and number of materials."""
    counts = [1, 10, 100] + ([] if bench.quick else [200, 1000])
    result = {"sizes": {}, "counts": {}, "ktx": bool(bench.tools.ktx)}
    for size in bench.sizes():
        print(f"  {size} x {size}")
        rounds = 1 if bench.quick or size > 4096 else 3 if size > 2048 else 5
        with_report = [*PNG_COPIES, "--report", str(bench.report)]
        contenders = {"two textures": bench.bake(size, 1, TWO), "PNG copies": bench.bake(size, 1, with_report)}
        if size <= 8192:
            contenders |= {"maketx": bench.maketx(size), "pack": bench.pack(size)}
        result["sizes"][str(size)] = alternate(contenders, rounds, lambda _: None) | {"errors": errors(bench)}
    for count in counts:
        print(f"  {count} materials")
        # The promise about cores is for 200 materials; the other points are for the curve.
        rounds = 1 if bench.quick else {1: 5, 10: 5, 200: 3}.get(count, 1)
        forms = {"two textures": bench.bake(512, count, TWO)}
        # The curve of the other form leaves out points that take minutes.
        forms |= {"PNG copies": bench.bake(512, count, PNG_COPIES)} if count <= 200 else {}
        result["counts"][str(count)] = alternate(forms, rounds, lambda _: None)
    print("  ten maps at a time")
    forms = {"two textures": bench.bake(bench.size, 10, TWO), "PNG copies": bench.bake(bench.size, 10, PNG_COPIES)}
    result["ten"] = alternate(forms, 1, lambda _: None)
    return result


def memory(bench):
    """Measures time and memory of the largest normal map."""
    size = max(bench.sizes())
    forms = {
        "two textures": bench.map(size, ["--model", "isotropic"]),
        "three textures": bench.map(size, ["--model", "anisotropic"]),
    }
    return {"size": size, "runs": alternate(forms, 1, lambda _: None)}


PARTS = {
    "encoders": encoders,
    "kernels": kernels,
    "decoders": decoders,
    "whole": whole,
    "growth": growth,
    "memory": memory,
}
