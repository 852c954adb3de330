"""A sweep: its options, its folder, and what is done with its shards (docs/sweep.md)."""

import argparse
import collections
import contextlib
import csv
import fcntl
import functools
import glob
import hashlib
import json
import math
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import time

from sweep_engines import ENGINES
from sweep_merge import merge, table_rows
from sweep_shard import SweepError, sha256
from whole_file import whole_file

@functools.lru_cache(maxsize=None)
def program_hash(program):
    """Of the program, and of the libraries of Pliant that it loads, at its start and later."""
    found = subprocess.run(["ldd", program], capture_output=True, text=True).stdout
    core = [part for line in found.splitlines() if "libpliant" in line for part in line.split() if part.startswith("/")]
    paths = {path for one in core for path in glob.glob(os.path.join(os.path.dirname(one), "libpliant_*.so"))}
    return "".join(sha256(path) for path in [program, *sorted(paths)])


def identity_of(options):
    """What decides the results, as a hash."""
    digest = hashlib.sha256()
    digest.update(program_hash(options.program).encode())
    for path in (options.scene, options.vary):
        digest.update(sha256(path).encode())
    digest.update(json.dumps(options.run_options).encode())
    return digest.hexdigest()


class Progress:
    """A line on stderr: a bar on a terminal."""

    def __init__(self, total, there, quiet=False):
        self.total, self.done, self.there, self.start = total, there, there, time.time()
        self.is_shown = sys.stderr.isatty() and not quiet

    def note(self, done):
        self.done += 1
        for row, why in done["isolated"].items():
            print(f"{self._begin()}error: scene {row}: {why}", file=sys.stderr)
        if self.is_shown:
            left = (time.time() - self.start) / (self.done - self.there) * (self.total - self.done)
            bar = "#" * (40 * self.done // self.total)
            print(f"\r[{bar:40s}] {self.done} of {self.total} shards, {left:.0f} s left ", end="", file=sys.stderr)

    def end(self):
        print(self._begin(), end="", file=sys.stderr)

    def _begin(self):
        return "\r\033[K" if self.is_shown else ""


def finished(target, identity):
    """What a shard's done.json says, if it is there and of this sweep."""
    try:
        with open(os.path.join(target, "done.json")) as file:
            done = json.load(file)
    except (OSError, ValueError):
        return None
    return done if done["identity"] == identity else None


def hold_folder(folder):
    """Makes the folder and holds it for this process until it ends, by the system's lock."""
    os.makedirs(folder, exist_ok=True)
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise SweepError(f"{folder}: another one is at work there; wait for it, or choose another --out")


def results_in(folder):
    """Names of the files there that are called as a sweep's results."""
    names = sorted(os.listdir(folder))
    return [name for name in names if name in ("scenes.csv", "summary.csv", "trajectory_contacts.csv", "warnings.csv")
            or name.endswith(".npy") and name.startswith(("positions_", "trajectory_"))]


def check_free(folder):
    """Where no sweep was, nothing may be that a sweep would replace."""
    there = results_in(folder)
    if os.path.lexists(os.path.join(folder, "shards")):
        there.append("shards")
    if there:
        raise SweepError(f"'{os.path.join(folder, there[0])}' is there and was not written by a sweep: choose another "
                         "--out, or move it away")


def begin_folder(options, identity):
    """Makes the folder or takes up the sweep in it. Returns the rows of a shard."""
    notes = os.path.join(options.out, "sweep.json")
    if options.overwrite and os.path.exists(notes):
        shutil.rmtree(os.path.join(options.out, "shards"), ignore_errors=True)
        for name in results_in(options.out):
            os.remove(os.path.join(options.out, name))
        os.remove(notes)
    if os.path.exists(notes):
        with open(notes) as file:
            there = json.load(file)
        if there["identity"] != identity:
            raise SweepError(f"{notes} is of another scene, table, program or options: choose another folder, or give "
                             "--overwrite to remove its shards")
        return there["shard_rows"]
    check_free(options.out)
    with whole_file(notes) as file:
        json.dump({"identity": identity, "shard_rows": options.shard_rows}, file)
    os.makedirs(os.path.join(options.out, "shards"))
    return options.shard_rows


def verify(options, task, shards, engine):
    """Runs some shards again and compares their files. Returns how many differ."""
    count = min(len(shards), math.ceil(len(shards) * options.verify / 100.0))
    chosen = {target: done for target, done in random.Random(task["identity"]).sample(shards, count)}
    again = [(done["begin"], done["end"], target + ".again") for target, done in chosen.items()]
    results = []
    engine.run(task, again, results.append, {done["begin"]: done["worker"] for done in chosen.values()})
    first = {done["begin"]: done for done in chosen.values()}
    differing = [done["begin"] for done in results if done["files"] != first[done["begin"]]["files"]]
    for _, _, target in again:
        shutil.rmtree(target)
    same = sum(1 for done in results if done["worker"] == first[done["begin"]]["worker"])
    for begin in differing:
        print(f"error: the shard that begins with row {begin} gave other bytes the second time", file=sys.stderr)
    print(f"verified: {count} of {len(shards)} shards ran again, {len(differing)} differ; {count - same} ran in another "
          "process than before")
    return len(differing)


def sweep(options, engine=None):
    """Runs the sweep, on an engine that is open already or on that of the options. Returns the exit code."""
    if engine is not None:
        return sweep_on(options, lambda: contextlib.nullcontext(engine))
    return sweep_on(options, lambda: ENGINES[options.engine](options))


def sweep_on(options, open_engine):
    identity = identity_of(options)
    hold_folder(options.out)
    size = begin_folder(options, identity)
    rows = sum(1 for _ in table_rows(options.vary))
    if rows == 0:
        raise SweepError(f"{options.vary}: no rows")
    task = {"program": options.program, "scene": options.scene, "table": options.vary, "folder": os.getcwd(),
            "run_options": options.run_options, "timeout": options.timeout, "identity": identity}
    folder = os.path.abspath(os.path.join(options.out, "shards"))
    wanted = [(begin, min(begin + size, rows), f"{folder}/{begin:08d}") for begin in range(0, rows, size)]
    for name in os.listdir(folder):  # of a sweep that was stopped on this machine, which nobody works on any more
        if name.endswith(".tmp") and f".{socket.gethostname()}." in name:
            shutil.rmtree(os.path.join(folder, name), ignore_errors=True)
    left = [shard for shard in wanted if finished(shard[2], identity) is None]
    for _, _, target in left:  # of another program, before --overwrite; or half removed by hand
        shutil.rmtree(target, ignore_errors=True)
    progress = Progress(len(wanted), len(wanted) - len(left), options.quiet)
    with contextlib.ExitStack() as stack:
        if left or options.verify > 0:
            engine = stack.enter_context(open_engine())
        try:
            if left:
                engine.run(task, left, progress.note)
        finally:
            progress.end()
            if progress.done < len(wanted):
                print(f"{progress.done} of {len(wanted)} shards are finished in {options.out}; the same command goes "
                      "on", file=sys.stderr)
        shards = [(target, finished(target, identity)) for _, _, target in wanted]
        merge(options, shards)
        isolated = sum(len(done["isolated"]) for _, done in shards)
        if not options.quiet:
            print(f"{rows} scenes in {len(wanted)} shards, {len(left)} of them now; {isolated} crashed or hung: "
                  f"{options.out}/scenes.csv")
            tell_warnings(os.path.join(options.out, "warnings.csv"))
        if options.verify > 0 and verify(options, task, shards, engine) > 0:
            return 4
    return 3 if has_failures(os.path.join(options.out, "scenes.csv")) else 0


def tell_warnings(table):
    """What steps warned of, and in how many scenes."""
    if not os.path.exists(table):
        return
    with open(table, newline="") as file:
        counts = collections.Counter(row["warning"] for row in csv.DictReader(file))
    for text, scenes in sorted(counts.items()):
        print(f"warning ({scenes} scene{'s' if scenes > 1 else ''}): {text}")


def has_failures(table):
    with open(table, newline="") as file:
        return any(row["failure"] or row["refused"] for row in csv.DictReader(file))


def percent(text):
    value = float(text.rstrip("%"))
    if not 0.0 <= value <= 100.0:
        raise argparse.ArgumentTypeError(f"'{text}' must be from 0% to 100%")
    return value


def positive(kind):
    def parse(text):
        value = kind(text)
        if not value > 0:
            raise argparse.ArgumentTypeError(f"'{text}' must be > 0")
        return value

    return parse


def add_engine_options(parser):
    """Those that say who runs shards: of a sweep, and of what is built on sweeps."""
    parser.add_argument("--engine", choices=sorted(ENGINES), default="local",
                        help="who runs shards: processes of this machine, Dask (Debian: python3-distributed), or Dask's "
                        "workers as jobs of Slurm")
    parser.add_argument("--workers", type=positive(int), default=len(os.sched_getaffinity(0)), metavar="N",
                        help="shards at once, unless --address; as many as there are processors")
    parser.add_argument("--address", metavar="HOST:PORT", help="of Dask's scheduler; without, one begins on this machine")
    parser.add_argument("--sbatch", metavar="OPTIONS", help="more options of sbatch, as '--partition=P --time=60'")
    parser.add_argument("--host", metavar="ADDRESS", help="of this machine as Slurm's nodes reach it")
    parser.add_argument("--timeout", type=positive(float), default=3600.0, metavar="S",
                        help="after which rows count as hanging [s] (3600)")
    parser.add_argument("--program", default=os.environ.get("PLIANT_PROGRAM") or shutil.which("pliant"),
                        metavar="FILE", help=argparse.SUPPRESS)


def check_engine_options(parser, options):
    if not options.program:
        parser.error("there is no program 'pliant' on PATH; start this as `pliant sweep`")
    if options.address and options.engine != "dask":
        parser.error("--address is for --engine dask")
    for name in ("sbatch", "host"):
        if getattr(options, name) is not None and options.engine != "slurm":
            parser.error(f"--{name} is for --engine slurm")
    options.sbatch = options.sbatch or ""


def parse_arguments(arguments, description):
    parser = argparse.ArgumentParser(prog="pliant sweep", description=description, allow_abbrev=False,
                                     formatter_class=argparse.RawDescriptionHelpFormatter, usage=argparse.SUPPRESS)
    parser.add_argument("scene", metavar="SCENE", help="scene file")
    parser.add_argument("--vary", metavar="TABLE.csv", required=True, help="what differs between the scenes (docs/batch.md)")
    parser.add_argument("--out", metavar="DIR", required=True, help="folder of shards and results")
    add_engine_options(parser)
    parser.add_argument("--shard-rows", type=positive(int), default=64, metavar="N", help="rows of a shard (64)")
    parser.add_argument("--verify", type=percent, default=0.0, metavar="P%", help="share of shards to run again and compare")
    parser.add_argument("--overwrite", action="store_true", help="remove the sweep that is in DIR first")
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
    options, options.run_options = parser.parse_known_args(arguments)
    for path in (options.scene, options.vary):
        if not os.path.isfile(path):
            parser.error(f"there is no file '{path}'")
    check_engine_options(parser, options)
    for taken in ("--rows", "--out", "--resume", "--overwrite", "--batch"):
        if taken in options.run_options:
            parser.error(f"{taken} is the sweep's own")
    if any(option.startswith("--checkpoint") for option in options.run_options):
        parser.error("--checkpoint is for `pliant run`: a shard that was cut off begins anew; take fewer --shard-rows")
    return options


def stop(*_):
    raise KeyboardInterrupt


def exit_code_of(work):
    """Of a program whose `work` is a sweep or is built on some: signals and errors become exit codes."""
    for number in (signal.SIGTERM, signal.SIGHUP):  # as Ctrl-C, unless nohup says that it is to be ignored
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, stop)
    try:
        return work()
    except KeyboardInterrupt:
        return 130
    except (SweepError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


def end(code):
    """Ends this process: threads of an interrupted sweep may still wait for their children."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
