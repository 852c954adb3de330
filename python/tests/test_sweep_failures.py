"""`pliant sweep` where workers, children, the sweep itself and the disk fail, and with very many shards."""

import os
import pathlib
import resource
import signal
import subprocess
import sys
import time

import pytest

from conftest import SOURCES

PROGRAM = os.environ["PLIANT_PROGRAM"]
SCENE = str(SOURCES / "config/scenes/small_hanging_cloth.yaml")

# Instead of a cluster: sbatch starts the tasks here, each in a session of its own.
SBATCH = """#!/bin/bash
for word; do
  case $word in
    --array=1-*) tasks=${word#*1-} ;;
    --wrap=*) work=${word#*=} ;;
    --output=*) log=${word#*=} ;;
    --partition=*) echo "$word" >>asked ;;
  esac
done
for ((k = 1; k <= tasks; ++k)); do
  file=${log/\\%A/17} file=${file/\\%a/$k}
  env -u PYTHONPATH setsid bash -c "$work" >"$file" 2>&1 </dev/null &
  echo $! >>workers
done
echo "17;here"
"""
SQUEUE = "#!/bin/bash\n[[ $3 == 17 ]] && echo running\n"
SCANCEL = "#!/bin/bash\n[[ $1 == 17 ]] && kill $(<workers) 2>/dev/null; echo $1 >cancelled\n"

# Instead of `pliant run`: a row's result is its number. `first`: what the calls do before.
STAND_IN = """#!/bin/dash
while [ $# -gt 0 ]; do case $1 in --rows) rows=$2 ;; --out) out=$2 ;; esac; shift; done
{first}
mkdir "$out"
k=${{rows%:*}} end=${{rows#*:}}
{{ echo scene,x,failure,refused; while [ $k -lt $end ]; do echo $k,$k,,; k=$((k + 1)); done; }} >"$out/scenes.csv"
echo 'inputs: "same"' >"$out/batch.yaml"
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def program(name, text):
    path = pathlib.Path(name).resolve()
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)
    path.chmod(0o755)
    return str(path)


def sweep(rows, *options, first="", **how):
    pathlib.Path("t.csv").write_text("x\n" + "".join(f"{k}\n" for k in range(rows)))
    command = [PROGRAM, "sweep", SCENE, "--vary", "t.csv", "--out", "swept", "--shard-rows", "1", "--program",
               program("stand_in", STAND_IN.format(first=first)), *options]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **how)


def ended(child):
    out, errors = child.communicate(timeout=120)
    return child.returncode, out, errors


def table(rows):
    return "scene,x,failure,refused\n" + "".join(f"{k},{k},,\n" for k in range(rows))


def finished():
    return list(pathlib.Path("swept/shards").glob("*/done.json"))


def wait_for(condition):
    for _ in range(6000):
        if condition():
            return
        time.sleep(0.01)
    raise AssertionError("it did not come")


def is_running(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def test_a_child_that_is_killed_is_tried_again(folder):
    # The first call for row 1 dies, once.
    code, out, errors = ended(sweep(3, first='[ $rows = 1:2 ] && [ ! -e died ] && { : >died; kill -KILL $$; }'))
    assert code == 0, errors
    assert errors == "" and pathlib.Path("died").exists()
    assert pathlib.Path("swept/scenes.csv").read_text() == table(3)


def test_children_die_with_the_sweep_and_the_same_command_goes_on(folder):
    first = 'if [ ! -e go ] && [ $rows != 0:1 ]; then echo $$ >>children; exec sleep 60; fi'
    child = sweep(4, "--workers", "2", first=first)
    begun = pathlib.Path("children")
    wait_for(lambda: finished() and begun.exists())  # maybe while the second begins
    child.kill()  # the scheduler: nothing can be caught
    child.communicate()
    wait_for(lambda: not any(is_running(pid) for pid in begun.read_text().split()))
    kept = finished()[0].stat().st_mtime_ns
    pathlib.Path("go").touch()
    code, out, errors = ended(sweep(4, "--workers", "2", first=first))
    assert code == 0, errors
    assert "3 of them now" in out
    assert pathlib.Path("swept/shards/00000000/done.json").stat().st_mtime_ns == kept
    assert pathlib.Path("swept/scenes.csv").read_text() == table(4)
    assert not list(pathlib.Path("swept/shards").glob("*.tmp"))


def test_a_full_disk_loses_nothing_that_is_finished(folder):
    # Files may not grow beyond 600 bytes: what is laid together does not fit, as on a disk that fills up at the end.
    limit = {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (600, 600))}
    code, out, errors = ended(sweep(100, **limit))
    assert code == 2 and "File too large" in errors, errors
    assert len(finished()) == 100 and not pathlib.Path("swept/scenes.csv").exists()
    code, out, errors = ended(sweep(100))
    assert code == 0 and "0 of them now" in out, errors
    assert pathlib.Path("swept/scenes.csv").read_text() == table(100)
    # A shard that does not fit is told with the rows; the others of before stay.
    code, out, errors = ended(sweep(3, "--overwrite", first="[ $rows = 2:3 ] && { echo the disk is full >&2; exit 2; }"))
    assert code == 2 and "rows 2 to 3: the disk is full" in errors
    assert "the same command goes on" in errors


def test_many_shards_on_a_hundred_threads(folder):
    rows = int(os.environ.get("PLIANT_TEST_SHARDS", "150"))
    begin = time.time()
    code, out, errors = ended(sweep(rows, "--workers", "100"))
    assert code == 0, errors
    assert f"{rows} scenes in {rows} shards" in out
    print(f"{rows / (time.time() - begin):.0f} shards a second", file=sys.stderr)
    assert pathlib.Path("swept/scenes.csv").read_text() == table(rows)
    assert len(pathlib.Path("swept/summary.csv").read_text().splitlines()) == rows + 1


def test_slurm_starts_workers_and_a_lost_one_loses_no_shard(folder, monkeypatch):
    pytest.importorskip("distributed")
    for name, text in (("sbatch", SBATCH), ("squeue", SQUEUE), ("scancel", SCANCEL)):
        program(f"bin/{name}", text)
    monkeypatch.setenv("PATH", f"{folder}/bin", prepend=os.pathsep)
    first = "echo $$ >>children; sleep 0.2"
    child = sweep(10, "--engine", "slurm", "--workers", "2", "--sbatch=--partition=short", "--host", "127.0.0.1",
                  "--verify", "10%", first=first)
    try:
        wait_for(lambda: finished() or child.poll() is not None)
        lost = int(pathlib.Path("workers").read_text().split()[0])
        os.killpg(lost, signal.SIGKILL)
        code, out, errors = ended(child)
        assert code == 0, errors
        assert "Slurm: job 17, 2 workers of tcp://127.0.0.1:" in errors and "dashboard: http://127.0.0.1" in errors
        assert "verified: 1 of 10 shards ran again, 0 differ" in out
        assert pathlib.Path("swept/scenes.csv").read_text() == table(10)
        assert pathlib.Path("asked").read_text().split() == ["--partition=short"]
        assert pathlib.Path("cancelled").read_text().split() == ["17"]
        assert not any(is_running(int(pid)) for pid in pathlib.Path("children").read_text().split())
    finally:
        child.kill()
        for pid in pathlib.Path("workers").read_text().split() if pathlib.Path("workers").exists() else []:
            if is_running(pid):
                os.killpg(int(pid), signal.SIGKILL)


def test_slurm_tells_why_there_are_no_workers(folder, monkeypatch):
    code, _, errors = ended(sweep(2, "--sbatch=--time=1"))
    assert code == 2 and "--sbatch is for --engine slurm" in errors
    monkeypatch.syspath_prepend(str(SOURCES / "scripts"))
    monkeypatch.setenv("PATH", f"{folder}/bin")  # this machine may have Slurm
    from sweep_engines import SlurmEngine
    from sweep_shard import SweepError

    class Options:
        workers, sbatch, out, engine = 3, "--qos='a b'", "swept", "slurm"

    engine = SlurmEngine(Options)
    with pytest.raises(SweepError, match="there is no program 'sbatch' on PATH"), engine:
        pass
    program("bin/sbatch", "#!/bin/bash\necho invalid qos >&2\nexit 1\n")
    with pytest.raises(SweepError, match="sbatch: invalid qos"):
        engine.submit("tcp://a:1")
    program("bin/sbatch", "#!/bin/bash\nprintf '%s\\n' \"$@\" >words\necho 5\n")
    engine.job = engine.submit("tcp://a:1")
    words = pathlib.Path("words").read_text().splitlines()
    assert engine.job == "5" and words[1] == "--array=1-3" and "--qos=a b" in words
    program("bin/squeue", "#!/bin/bash\n")
    with pytest.raises(SweepError, match="job 5 ended before a worker came: swept/slurm-5_1.log"):
        engine.check()
