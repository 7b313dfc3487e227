"""Runs commands in turn: wall time, processor seconds and peak memory of each."""

import json
import os
import shutil
import statistics
import subprocess
import tempfile
import threading
import time
from dataclasses import dataclass

# Seconds after which a run is killed.
LIMIT = 900


class Failed(Exception):
    """Why a command gave no measurement."""


@dataclass
class Contender:
    """A command that is compared with others."""

    argv: list
    # Output folder, emptied before each run.
    out: str | None = None
    # Whether the command prints its own times as JSON. Otherwise the whole process is timed.
    times_itself: bool = False
    # Number of first rounds that the command takes part in; all by default. Slow commands take part in few.
    rounds: int | None = None


def once(contender):
    """Runs a contender once. Returns `wall` and `cpu` in seconds, `peak` and `written` in MiB, and what the command
    printed."""
    if contender.out:
        shutil.rmtree(contender.out, ignore_errors=True)
        os.makedirs(contender.out)
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        start = time.perf_counter()
        try:
            process = subprocess.Popen(contender.argv, stdin=subprocess.DEVNULL, stdout=out, stderr=err)
        except OSError as error:
            raise Failed(f"{contender.argv[0]}: {error.strerror}") from error
        timer = threading.Timer(LIMIT, process.kill)
        timer.start()
        # `wait4` and not `wait`, since `wait4` returns the resources of this child alone.
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        if process.returncode != 0:
            lines = err.read().decode(errors="replace").split("\n")
            message = next((line.strip() for line in reversed(lines) if line.strip()), "no message")
            raise Failed(f"ended with {process.returncode}: {message[:160]}")
        files = [os.path.join(folder, name) for folder, _, names in os.walk(contender.out or "") for name in names]
        written = sum(map(os.path.getsize, files)) / 1048576
        run = {"wall": wall, "cpu": usage.ru_utime + usage.ru_stime, "peak": usage.ru_maxrss / 1024, "written": written}
        if contender.times_itself:
            run |= json.loads(out.read())
        return run


def alternate(contenders, rounds, note=print):
    """Runs rounds in which every contender runs once, in turn. Returns the results by name: medians of `wall` and
    `cpu`, the largest `peak`, the `least` and `most` wall time, and the number of `runs`. A contender that failed has
    only `failed`, the reason."""
    runs = {name: [] for name in contenders}
    failed = {}
    for index in range(rounds):
        for name, contender in contenders.items():
            if name in failed or index >= (contender.rounds or rounds):
                continue
            try:
                runs[name].append(once(contender))
            except Failed as reason:
                failed[name] = str(reason)
        note(f"  round {index + 1} of {rounds}")
    return {name: {"failed": failed[name]} if name in failed else summary(runs[name]) for name in contenders}


def summary(runs):
    """Summarises several runs of one contender."""
    walls = [run["wall"] for run in runs]
    return {
        "wall": statistics.median(walls),
        "cpu": statistics.median(run["cpu"] for run in runs),
        "peak": max(run["peak"] for run in runs),
        "least": min(walls),
        "most": max(walls),
        "runs": len(runs),
        "written": runs[-1]["written"],
    }
