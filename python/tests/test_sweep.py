"""`pliant sweep`: shards on the engine `local`, and on Dask where that is installed."""

import os
import signal
import subprocess
import time

import numpy as np
import pytest

from conftest import SOURCES

PROGRAM = os.environ["PLIANT_PROGRAM"]
SCENE = str(SOURCES / "config/scenes/small_hanging_cloth.yaml")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = ["0.1", "0.2", "-1", "0.3", "0.4", "0.5", "0.6"]
    (tmp_path / "t.csv").write_text("bodies[0].material.areal_density\n" + "\n".join(rows) + "\n")
    return tmp_path


def run(command, *options, program=PROGRAM):
    arguments = [PROGRAM, command, SCENE, "--vary", "t.csv", "--steps", "4", *options]
    if program != PROGRAM:
        arguments += ["--program", str(program)]
    return subprocess.run(arguments, capture_output=True, text=True)


@pytest.mark.parametrize("engine", ["local", "dask"])
def test_gives_the_bytes_of_one_run(folder, engine):
    if engine == "dask":
        pytest.importorskip("distributed")
    assert run("run", "--out", "plain").returncode == 3  # a row is refused
    result = run("sweep", "--out", "swept", "--shard-rows", "3", "--engine", engine, "--workers", "2", "--verify", "40%")
    assert result.returncode == 3, result.stderr
    assert "verified: 2 of 3 shards ran again, 0 differ" in result.stdout
    for name in ("scenes.csv", "positions_cloth.npy"):
        assert (folder / "swept" / name).read_bytes() == (folder / "plain" / name).read_bytes(), name
    assert np.load(folder / "swept/positions_cloth.npy").shape[::2] == (7, 3)


def test_goes_on_and_runs_no_finished_shard_again(folder):
    run("sweep", "--out", "swept", "--shard-rows", "3")
    first = (folder / "swept/scenes.csv").read_bytes()
    kept = (folder / "swept/shards/00000000/done.json").stat().st_mtime_ns
    os.remove(folder / "swept/shards/00000003/done.json")
    result = run("sweep", "--out", "swept", "--shard-rows", "5")  # shards stay as they were begun
    assert "7 scenes in 3 shards, 1 of them now" in result.stdout, result.stderr
    assert (folder / "swept/scenes.csv").read_bytes() == first
    assert (folder / "swept/shards/00000000/done.json").stat().st_mtime_ns == kept
    refused = run("sweep", "--out", "swept", "--solver", "xpbd")
    assert refused.returncode == 2 and "of another scene, table, program or options" in refused.stderr
    assert run("sweep", "--out", "swept", "--solver", "xpbd", "--overwrite").returncode == 3


def test_names_the_row_that_crashes_or_hangs(folder):
    program = folder / "stand_in"
    program.write_text(
        "#!/bin/bash\n"
        'while [[ $1 ]]; do [[ $1 == --rows ]] && rows=$2; all+=("$1"); shift; done\n'
        "first=${rows%:*} last=${rows#*:}\n"
        "((first <= 4 && 4 < last)) && kill -SEGV $$\n"
        "((first <= 6 && 6 < last)) && exec sleep 20\n"
        f'exec {PROGRAM} "${{all[@]}}"\n'
    )
    program.chmod(0o755)
    result = run("sweep", "--out", "swept", "--shard-rows", "4", "--timeout", "1", program=program)
    assert result.returncode == 3, result.stderr
    assert "error: scene 4: crashed: signal 11" in result.stderr
    assert "error: scene 6: hung" in result.stderr
    rows = (folder / "swept/scenes.csv").read_text().splitlines()
    assert [row.split(",")[0] for row in rows[1:]] == list("0123456")
    assert rows[5].endswith(",crashed: signal 11")
    positions = np.load(folder / "swept/positions_cloth.npy")
    assert np.isnan(positions[[2, 4, 6]]).all() and np.isfinite(positions[[0, 1, 3, 5]]).all()


def test_refuses_what_cannot_be_run(folder):
    for options, words in [
        (["--durration", "1"], "--durration"),
        (["--rows", "0:1"], "--rows is the sweep's own"),
        (["--checkpoint", "1"], "--checkpoint is for `pliant run`"),
        (["--vary", "none.csv"], "no file 'none.csv'"),
        (["--address", "host:1"], "--address is for --engine dask"),
        (["--verify", "200"], "from 0% to 100%"),
        (["--shard-rows", "0"], "must be > 0"),
    ]:
        result = run("sweep", "--out", "swept", *options)
        assert result.returncode == 2 and words in result.stderr, (options, result.stderr)
    assert not (folder / "swept/scenes.csv").exists()


def test_is_stopped_as_by_ctrl_c_and_has_its_folder_for_itself(folder):
    command = [PROGRAM, "sweep", SCENE, "--vary", "t.csv", "--steps", "20000", "--out", "swept", "--shard-rows", "1",
               "--workers", "1"]
    left = set()  # by the sweep that was stopped before
    for number in (signal.SIGTERM, signal.SIGHUP):
        child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(2000):
            if set((folder / "swept").glob("shards/*.tmp")) - left:
                break
            time.sleep(0.01)
        second = run("sweep", "--out", "swept")
        assert second.returncode == 2 and "another one is at work there" in second.stderr
        child.send_signal(number)
        _, text = child.communicate(timeout=60)
        assert child.returncode == 130, text
        assert "the same command goes on" in text
        there = set((folder / "swept").glob("shards/*.tmp"))
        assert not left & there
        left = there
    assert run("sweep", "--out", "swept", "--overwrite").returncode == 3  # nobody holds it any more


@pytest.mark.parametrize("name", ["scenes.csv", "positions_cloth.npy", "shards/mine"])
def test_replaces_nothing_that_no_sweep_wrote(folder, name):
    (folder / "swept" / name).parent.mkdir(parents=True)
    (folder / "swept" / name).write_text("mine")
    for options in ([], ["--overwrite"]):
        result = run("sweep", "--out", "swept", *options)
        assert result.returncode == 2 and "was not written by a sweep" in result.stderr, result.stderr
        assert (folder / "swept" / name).read_text() == "mine"


def test_files_of_scripts_appear_whole_and_follow_no_link(folder, monkeypatch):
    monkeypatch.syspath_prepend(str(SOURCES / "scripts"))
    from whole_file import save_picture, whole_file

    (folder / "precious").write_text("mine")
    (folder / "link").symlink_to(folder / "precious")
    with whole_file(folder / "link") as file:
        file.write("new")
        assert (folder / "link").read_text() == "mine"
    assert (folder / "link").read_text() == "new" and not (folder / "link").is_symlink()
    with pytest.raises(ZeroDivisionError), whole_file(folder / "half") as file:
        file.write("half of it")
        1 / 0
    assert (folder / "precious").read_text() == "mine"
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib.figure import Figure

    for name in ("a.png", "a.svg"):
        save_picture(Figure((1, 1)), folder / name)
        save_picture(Figure((2, 1)), folder / name)  # its own
        (folder / name).write_text("mine")
        with pytest.raises(SystemExit, match="was not drawn by Pliant"):
            save_picture(Figure((1, 1)), folder / name)
        assert (folder / name).read_text() == "mine"
    assert sorted(path.name for path in folder.iterdir()) == ["a.png", "a.svg", "link", "precious", "t.csv"]
