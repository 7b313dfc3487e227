"""Prepares the measurements: other people's tools, our builds, the inputs, and a description of the machine."""

import os
import platform
import shutil
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# Versions are pinned, so that figures of different runs compare.
WHEELS = ["OpenImageIO==3.2.2.0", "libclang==18.1.1"]


class Tools:
    """Paths of everything that is run."""

    def __init__(self, target):
        self.work = target / "peers"
        self.work.mkdir(parents=True, exist_ok=True)
        self.environment = self.work / "environment"
        self.maketx = str(self.environment / "bin" / "maketx")
        self.roughcast = str(target / "release" / "roughcast")
        self.peers = str(target / "release" / "peers")
        self.ktx = shutil.which("ktx")


def pin_to_two_cores():
    """Limits everything that runs from here on to two cores, since basis_universal takes as many threads as there are
    cores. Returns their number."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:2])
        cores = len(os.sched_getaffinity(0))
    else:
        cores = os.cpu_count()
    os.environ["RAYON_NUM_THREADS"] = "2"
    return cores


def install(tools):
    """Installs OpenImageIO, and libclang for the bindings of basis_universal, from PyPI into a scratch environment.
    Returns why that failed, or nothing."""
    if not (tools.environment / "bin" / "python").exists():
        venv.create(tools.environment, with_pip=True)
    pip = [str(tools.environment / "bin" / "pip"), "install", "-q", "--disable-pip-version-check", *WHEELS]
    done = subprocess.run(pip, capture_output=True, text=True)
    return None if done.returncode == 0 else (done.stderr.strip().split("\n") or [""])[-1]


def build(tools):
    """Builds Roughcast as it is shipped, and this folder's crate."""
    target = str(Path(tools.roughcast).parents[1])
    manifest = str(ROOT / "benches" / "peers" / "Cargo.toml")
    run(
        ["cargo", "build", "--release", "--locked", "--manifest-path", str(ROOT / "Cargo.toml"), "--target-dir", target]
    )
    environment = os.environ | {"CXXFLAGS": cxx_flags()}
    clang = next(tools.environment.glob("lib/python*/site-packages/clang/native"), None)
    if clang and "LIBCLANG_PATH" not in os.environ:
        environment["LIBCLANG_PATH"] = str(clang)
    run(["cargo", "build", "--release", "--locked", "--manifest-path", manifest, "--target-dir", target], environment)


def cxx_flags():
    """Returns flags of basis_universal's own CMakeLists.txt, which its crate leaves out: no assertions, and SSE 4.1."""
    sse = ["-DBASISU_SUPPORT_SSE=1", "-msse4.1"] if is_x86() else []
    return " ".join(["-DNDEBUG", *sse])


def is_x86():
    """Returns whether this machine has SSE."""
    return platform.machine() in ("x86_64", "AMD64")


def inputs(tools, data, size, count):
    """Returns the folder of `count` assets with maps of `size` texels a side. Makes the folder when it is missing."""
    folder = tools.work / "inputs" / f"{size}{'' if data else '-synthetic'}"
    done = folder / f"{count}.done"
    if not done.exists():
        shutil.rmtree(folder, ignore_errors=True)
        run([tools.peers, "inputs", "asset", str(folder), str(size), str(count), *([str(data)] if data else [])])
        done.touch()
    return folder


def run(argv, environment=None):
    """Runs a step that must not fail."""
    if subprocess.run(argv, env=environment, stdout=subprocess.DEVNULL).returncode != 0:
        sys.exit(f"error: {' '.join(argv[:3])} failed")


def machine(tools, cores, load):
    """Describes the machine, on which figures depend. `load` is what else the machine did."""
    text = lambda argv: subprocess.run(argv, capture_output=True, text=True).stdout.strip()
    facts = {"cores": f"{cores} of {os.cpu_count()} ({processor()})"}
    facts["memory"] = f"{os.sysconf('SC_PAGE_SIZE') * os.sysconf('SC_PHYS_PAGES') / 2**30:.0f} GiB"
    facts["system"] = f"{platform.system()} {platform.release()}, {platform.libc_ver()[0]} {platform.libc_ver()[1]}"
    facts["load average before the run"] = load
    facts["compilers"] = f"{text(['rustc', '--version'])}; {text(['c++', '--version']).split(chr(10))[0]}"
    facts["Roughcast"] = text([tools.roughcast, "--version"]).removeprefix("roughcast ")
    facts["basis_universal"] = f"2.50 (basisu_c_sys 0.9.1), {'SSE 4.1, ' if is_x86() else ''}without assertions"
    facts["OpenImageIO"] = WHEELS[0].split("==")[1]
    facts["KTX-Software"] = text([tools.ktx, "--version"]) if tools.ktx else "no `ktx` on this machine: a stand-in"
    return facts


def commit():
    """Describes what is measured."""
    argv = ["git", "-C", str(ROOT), "describe", "--always", "--dirty"]
    return subprocess.run(argv, capture_output=True, text=True).stdout.strip() or "unknown"


def processor():
    """Returns the name of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text().split("\n")
    except OSError:
        return platform.processor() or platform.machine()
    find = lambda key: next((line.split(":", 1)[1].strip() for line in lines if line.startswith(key)), "?")
    return f"{find('model name')}, family {find('cpu family')} model {find('model')}"
