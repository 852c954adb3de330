"""`pliant sweep`: shards on the engine `local`, and on Dask where that is installed."""

import os
import subprocess

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
    assert (folder / "swept/scenes.csv").read_bytes() == (folder / "plain/scenes.csv").read_bytes()
    whole, parts = (np.load(folder / name / "positions_cloth.npy") for name in ("plain", "swept"))
    np.testing.assert_array_equal(whole, parts)


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
        (["--vary", "none.csv"], "no file 'none.csv'"),
        (["--address", "host:1"], "--address is for --engine dask"),
        (["--verify", "200"], "from 0% to 100%"),
        (["--shard-rows", "0"], "must be > 0"),
    ]:
        result = run("sweep", "--out", "swept", *options)
        assert result.returncode == 2 and words in result.stderr, (options, result.stderr)
    assert not (folder / "swept/scenes.csv").exists()
