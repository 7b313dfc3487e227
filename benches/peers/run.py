"""Roughcast beside its peers: installs, builds, makes inputs, measures, prints, and writes docs/performance.md.

python3 benches/peers/run.py [--only PART ...] [--quick] [--data DIR]
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path

import page
import plot
from parts import PARTS, Bench
from prepare import ROOT, Tools, build, commit, install, machine, pin_to_two_cores


def main():
    parser = argparse.ArgumentParser(description="Measures Roughcast beside its peers and writes docs/performance.md.")
    parser.add_argument(
        "--only", nargs="+", choices=PARTS, metavar="PART", help=f"measure only these: {', '.join(PARTS)}"
    )
    parser.add_argument("--quick", action="store_true", help="small maps, one run each: shows that it works")
    parser.add_argument(
        "--data", type=Path, default=ROOT.parent / "shared" / "data", help="real materials, used where present"
    )
    options = parser.parse_args()
    start = time.monotonic()
    step = lambda text: print(f"== {text} ({time.monotonic() - start:.0f} s)", flush=True)

    tools = Tools(Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")))
    # Load by other work, before this script begins.
    load = " ".join(f"{load:.1f}" for load in os.getloadavg())
    step("OpenImageIO")
    missing = install(tools)
    if missing:
        print(f"  not installed, its rows say so: {missing}")
    step("builds")
    build(tools)
    cores = pin_to_two_cores()

    stored = tools.work / "results.json"
    results = json.loads(stored.read_text()) if stored.exists() else {}
    facts = machine(tools, cores, load)
    bench = Bench(tools, options.data if options.data.is_dir() else None, options.quick)
    step("inputs")
    for size in bench.sizes() if {"growth", "memory"} & set(options.only or PARTS) else [bench.size]:
        bench.folder(size)
    for name in options.only or PARTS:
        step(name)
        results[name] = PARTS[name](bench) | {"quick": options.quick, "machine": facts | {"commit": commit()}}
        stored.write_text(json.dumps(results, indent=1))
        print(page.SECTIONS[name](results[name]), flush=True)
    # docs/performance.md is written from complete measurements only. A page without parts that were measured elsewhere
    # would lose their figures, and figures of small maps do not count.
    lacking = [name for name in PARTS if results.get(name, {"quick": True})["quick"]]
    docs = tools.work if lacking else ROOT / "docs"
    (docs / "performance.md").write_text(page.page(results))
    if "growth" in results:
        (docs / "pictures").mkdir(exist_ok=True)
        (docs / "pictures" / "growth.svg").write_text(plot.growth(results["growth"]))
    step(f"{docs / 'performance.md'}{' lacks ' + ', '.join(lacking) if lacking else ''}")


if __name__ == "__main__":
    sys.exit(main())
