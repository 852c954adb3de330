"""A shard of a sweep: what workers do. Nothing of a sweep is imported by them but this."""

import hashlib
import json
import os
import shutil
import socket
import subprocess
import threading
import time

from whole_file import whole_file

# Before a command: it is killed when this process dies. The shell looks whether that happened before the first of
# the two took effect; the word after these is this process.
DIES_WITH_US = ["setpriv", "--pdeathsig", "KILL", "sh", "-c", '[ "$PPID" = "$0" ] && exec "$@"']
RETRIES = 1  # of a child that was killed, before its rows are looked at one by one


class SweepError(Exception):
    """What ends a sweep: its text says why."""


def sha256(path):
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        for block in iter(lambda: file.read(1 << 20), b""):
            digest.update(block)
    return digest.hexdigest()


def worker_name():
    return f"{socket.gethostname()}:{os.getpid()}"


def run_rows(task, begin, end, folder, children):
    """Runs some rows. Returns why that failed, if the program crashed or hung; "" where it ended by itself."""
    command = [*DIES_WITH_US, str(os.getpid()), task["program"], "run", task["scene"], "--vary", task["table"]]
    command += ["--rows", f"{begin}:{end}", "--out", folder, "--overwrite", "--quiet", *task["run_options"]]
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                             cwd=task["folder"])
    children.append(child)
    try:
        _, text = child.communicate(timeout=task["timeout"])
    except subprocess.TimeoutExpired:
        child.kill()
        child.communicate()
        return f"hung: it took more than {task['timeout']:g} s"
    finally:
        children.remove(child)
    if child.returncode in (0, 3):
        return ""
    if child.returncode < 0:
        return f"crashed: signal {-child.returncode}"
    if child.returncode == 130:
        raise KeyboardInterrupt
    raise SweepError(f"rows {begin} to {end}: {text.strip() or f'exit code {child.returncode}'}")


def run_parts(task, begin, end, folder, children, parts, isolated):
    """Runs rows; those that crash or hang are found by halving."""
    name = f"rows-{begin:08d}-{end:08d}"
    for attempt in range(RETRIES + 1):
        why = run_rows(task, begin, end, os.path.join(folder, name), children)
        if not why:
            parts.append([begin, end, name])
            return
        shutil.rmtree(os.path.join(folder, name), ignore_errors=True)
        if why.startswith("hung"):
            break
    if end - begin == 1:
        isolated[begin] = why
        return
    middle = (begin + end) // 2
    run_parts(task, begin, middle, folder, children, parts, isolated)
    run_parts(task, middle, end, folder, children, parts, isolated)


def run_shard(task, begin, end, target, children=None):
    """Makes the folder `target`, whole or not at all, and returns what its done.json says."""
    children = [] if children is None else children
    work = f"{target}.{socket.gethostname()}.{os.getpid()}.{threading.get_ident()}.tmp"
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    start, parts, isolated = time.time(), [], {}
    try:
        run_parts(task, begin, end, work, children, parts, isolated)
        files, inputs = {}, set()
        for _, _, name in parts:
            for file in sorted(os.listdir(os.path.join(work, name))):
                files[f"{name}/{file}"] = sha256(os.path.join(work, name, file))
            with open(os.path.join(work, name, "batch.yaml")) as notes:
                inputs.update(line.split('"')[1] for line in notes if line.startswith("inputs:"))
        done = {"begin": begin, "end": end, "identity": task["identity"], "inputs": sorted(inputs), "files": files,
                "parts": parts, "isolated": isolated, "seconds": round(time.time() - start, 3), "worker": worker_name()}
        with whole_file(os.path.join(work, "done.json")) as file:
            json.dump(done, file, indent=1)
        try:
            os.rename(work, target)
        except OSError:
            if not os.path.exists(os.path.join(target, "done.json")):
                raise
        return done
    finally:
        shutil.rmtree(work, ignore_errors=True)
