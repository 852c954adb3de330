"""`pliant identify`: finds a scene's own numbers back from measurements with noise, and says what it cannot find."""

import csv
import importlib.util
import os
import pathlib
import subprocess
from importlib.machinery import SourceFileLoader

import numpy as np
import pytest

from conftest import SOURCES

PROGRAM = os.environ["PLIANT_PROGRAM"]
pytest.importorskip("cmaes")

CLOTH = """
time_step: 0.01
threads: 1
bodies:
  - name: cloth
    model: cloth
    geometry: {grid: {size: [0.3, 0.3], vertices: [7, 7]}}
    position: [0, 0, 1]
    material: {areal_density: 0.2, stretch_warp: 10, stretch_weft: 10, shear: 5, bending: 1e-4}
    fixed: [{vertices: [42, 43, 44, 45, 46, 47, 48]}]
effects:
  gravity: {acceleration: [0, 0, -9.81]}
  damping: {rate: 0.5}
solver: {name: newton, iterations: 3}
"""
SLOPE = """
time_step: 0.01
threads: 1
bodies:
  - name: cloth
    model: cloth
    geometry: {grid: {size: [0.2, 0.2], vertices: [4, 4]}}
    position: [0, 0, 0.01]
    rotation_rpy: [0, 0.5, 0]
    material: {areal_density: 0.2, stretch_warp: 100, stretch_weft: 100, shear: 10, bending: 1e-5}
obstacles:
  - {name: slope, shape: plane, rotation_rpy: [0, 0.5, 0]}
effects:
  gravity: {acceleration: [0, 0, -9.81]}
  contact: {thickness: 0.004}
  friction: {coefficient: 0.3}
solver: {name: xpbd, iterations: 10}
"""
# A cube of another model on the slope; and what needs none.
CUBE = """
time_step: 0.01
threads: 1
bodies:
  - name: cloth
    model: MODEL
    position: [0, 0, 0.06]
    rotation_rpy: [0, 0.5, 0]
""" + SLOPE[SLOPE.index("obstacles:"):]
BEAM = """
time_step: 0.01
threads: 1
bodies:
  - name: cloth
    model: reduced
    geometry: {example: {name: beam, young: 2e5, scale: 0.2}}
    material: {alpha: 0.3, beta: 1e-3}
effects: {gravity: {acceleration: [0, 0, -9.81]}}
solver: {name: trigonometric, tolerance: 0.001}
"""
MODELS = {
    "patch": "patch\n    geometry: {block: {size: [0.1, 0.1, 0.1], cells: [1, 1, 1]}}\n"
             "    material: {young: 5e3, density: 1000}",
    "viscoelastic": "viscoelastic\n    geometry: {block: {size: [0.1, 0.1, 0.1]}, particles: 27}\n"
                    "    material: {young: 5e3, density: 1000}",
    "rigid": "rigid\n    geometry: {box: {size: [0.1, 0.1, 0.1]}}\n    material: {density: 300}",
}
FRICTION, YOUNG = "effects.friction.coefficient", "bodies[cloth].material.young"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(SOURCES / "scripts"))
    return tmp_path


def simulate(scene, values, steps=50, fields="positions"):
    """Writes scene.yaml, and returns the folder of a run with other values, a frame a step."""
    pathlib.Path("scene.yaml").write_text(scene)
    pathlib.Path("truth.csv").write_text(",".join(values) + "\n" + ",".join(str(v) for v in values.values()) + "\n")
    subprocess.run([PROGRAM, "run", "scene.yaml", "--vary", "truth.csv", "--steps", str(steps), "--trajectory",
                    "every:1", f"fields:{fields}", "--out", "truth", "--quiet", "--overwrite"], check=True)
    return pathlib.Path("truth")


def measured(scene, values, noise=0.01, steps=50):
    """Of a scene with other values: positions with noise, as a share of the body's size, in motion.npy."""
    frames = np.load(simulate(scene, values, steps) / "trajectory_cloth_positions.npy")[0]
    sigma = noise * np.ptp(frames[0], axis=0).max()
    np.save("motion.npy", frames + np.random.default_rng(0).normal(0, sigma, frames.shape))
    pathlib.Path("data.yaml").write_text(f"measurements:\n  - {{file: motion.npy, rate: 100, noise: {sigma}}}\n")


def identify(*options, parameters=("effects.friction.coefficient",), data="data.yaml"):
    return subprocess.run([PROGRAM, "identify", "scene.yaml", "--data", data, "--parameters", *parameters, "--out",
                           "found", "--workers", "1", "--no-plot", *options], capture_output=True, text=True)


def found():
    with open("found/confidence.csv", newline="") as file:
        return [{key: float(text) if key in ("value", "low", "high") and text else text for key, text in row.items()}
                for row in csv.DictReader(file)]


@pytest.mark.parametrize("scene, values, precision", [
    (CLOTH, {"bodies[cloth].material.bending": 4e-4, "bodies[cloth].material.stretch_weft": 20}, "10"),
    (SLOPE, {"effects.friction.coefficient": 0.2}, "3"),
], ids=["bending and stretch", "friction"])
def test_finds_its_own_numbers_back(folder, scene, values, precision):
    measured(scene, values)
    result = identify("--population", "8", "--precision", precision, parameters=values)
    assert result.returncode == 0, result.stderr
    for row in found():
        assert row["value"] == pytest.approx(values[row["path"]], rel=0.05)
        assert row["low"] < row["value"] < row["high"] < 1.2 * row["low"]
    with open("found/errors.csv", newline="") as file:
        errors = list(csv.DictReader(file))
    held = [row for row in errors if row["held_out"] == "1"]
    assert 0.1 * len(errors) < len(held) < 0.3 * len(errors)
    noise = float(pathlib.Path("data.yaml").read_text().rsplit(" ", 1)[1].strip("}\n"))
    for rows in (errors, held):  # to the noise, in what was predicted too
        assert np.mean([float(row["fitted"]) for row in rows]) == pytest.approx(noise, rel=0.1)
        assert np.mean([float(row["before"]) for row in rows]) > 1.1 * noise
    # The same command goes on, here from before its last generation, and what it found is a table of --vary.
    sorted(pathlib.Path("found").glob("generation-*.json"))[-1].unlink()
    again = identify("--population", "8", "--precision", precision, parameters=values)
    assert "\n8 scenes now" in again.stdout, again.stdout
    assert result.stdout.splitlines()[:len(values)] == again.stdout.splitlines()[:len(values)]
    assert subprocess.run([PROGRAM, "run", "scene.yaml", "--steps", "1", "--vary", "found/identified.csv", "--out",
                           "run", "--quiet"]).returncode == 0


@pytest.mark.parametrize("model, truth", [
    ("patch", {FRICTION + "=0.1:0.4": 0.2, YOUNG + "=4e3:2e4": 9e3}),
    ("viscoelastic", {YOUNG + "=4e3:2e4": 9e3}),
    ("rigid", {FRICTION + "=0.1:0.4": 0.2}),
    ("reduced", {"bodies[cloth].geometry.example.young=1e5:1e6": 3e5}),
])
def test_finds_the_numbers_of_each_model(folder, model, truth):
    scene = CUBE.replace("MODEL", MODELS[model]) if model in MODELS else BEAM
    truth_of = {parameter.split("=")[0]: value for parameter, value in truth.items()}
    measured(scene, truth_of, steps=15)
    result = identify("--population", "4", "--precision", "10", parameters=truth)
    assert result.returncode == 0, result.stderr
    for row in found():
        assert row["value"] == pytest.approx(truth_of[row["path"]], rel=0.05)
        assert row["low"] < row["value"] < row["high"] < 1.2 * row["low"]


def test_fits_clouds_and_forces(folder):
    measured(SLOPE, {"effects.friction.coefficient": 0.2})
    truth = simulate(SLOPE, {"effects.friction.coefficient": 0.2}, fields="points,wrenches")
    random = np.random.default_rng(1)
    with open("cloud.csv", "w") as file:
        file.write("time,x,y,z\n")
        for frame, points in enumerate(np.load(truth / "trajectory_cloth_points.npy")[0]):
            for point in random.permutation(points)[:12] + random.normal(0, 0.002, (12, 3)):
                file.write(f"{0.01 * frame},{point[0]},{point[1]},{point[2]}\n")
    with open("forces.csv", "w") as file:
        file.write("time,force_x,force_y,force_z\n")
        for frame, wrench in enumerate(np.load(truth / "trajectory_wrenches.npy")[0, :, 0]):
            file.write(f"{0.01 * frame},{wrench[0]},{wrench[1]},{wrench[2]}\n")
    pathlib.Path("data.yaml").write_text("measurements:\n  - {file: cloud.csv, partial: true, noise: 0.002}\n"
                                         "  - {file: forces.csv, link: slope, noise: 0.01}\n")
    result = identify("--population", "6", "--precision", "5")
    assert result.returncode == 0, result.stderr
    assert found()[0]["value"] == pytest.approx(0.2, rel=0.05)


def test_says_what_the_data_do_not_say(folder):
    measured(SLOPE, {"effects.friction.coefficient": 0.2})
    # A body slides as fast whatever it weighs.
    result = identify("--population", "4", "--generations", "3", parameters=["bodies[0].material.areal_density=0.1:0.4"])
    assert result.returncode == 4, result.stdout
    assert "the data do not say" in result.stdout and found()[0]["low"] == ""
    # What steps warn of is told, of the fitted scene.
    pathlib.Path("found/fitted/warnings.csv").write_text('scene,warning\n0,of before\n1,"cloth: coarse, by far"\n')
    again = identify_script().warnings_of("found")
    assert again == ["cloth: coarse, by far"]


def identify_script():
    loader = SourceFileLoader("identify", str(SOURCES / "scripts/identify"))
    script = importlib.util.module_from_spec(importlib.util.spec_from_loader("identify", loader))
    loader.exec_module(script)
    return script


@pytest.mark.parametrize("options, words", [
    (["bodies[0].material.bendin"], "did you mean 'bending'"),
    (["bodies[0].material.damping"], "is 0 in the scene: give bounds"),
    (["bodies[0].material.bending=1:2:3"], "bounds are written LOW:HIGH"),
    (["bodies[0].material.bending=2:1"], "LOW must be less than HIGH"),
    (["bodies[0].material.areal_density=0:1"], "must be a number > 0 and <= 1000 [kg/m^2]"),
    (["obstacles[0].radius"], "no registry describes it: give bounds"),
    (["bodies[0].material.bending", "bodies[0].material.bending"], "a path is given twice"),
    (["bodies[0].material.bending", "--steps", "3"], "--steps is the search's own"),
    (["bodies[0].material.bending", "--sbatch=x"], "--sbatch is for --engine slurm"),
    (["bodies[0].material.bending", "--population", "3"], "--population must be 4 or more"),
    (["bodies[0].material.bending", "--data", "none.yaml"], "there is no file 'none.yaml'"),
])
def test_refuses_bad_parameters(folder, options, words, capsys):
    script = identify_script()  # many in one process
    pathlib.Path("scene.yaml").write_text(SLOPE)
    np.save("motion.npy", np.zeros((2, 16, 3)))
    pathlib.Path("data.yaml").write_text("measurements:\n  - {file: motion.npy, rate: 50, noise: 1}\n")
    command = ["scene.yaml", "--data", "data.yaml", "--out", "found", "--program", PROGRAM, "--parameters", *options]
    with pytest.raises((SystemExit, script.SweepError)) as refusal:
        script.work(script.parse_arguments(command))
    assert words in str(refusal.value) + capsys.readouterr().err
    assert not pathlib.Path("found").exists()


def test_a_refusal_is_code_2(folder):
    pathlib.Path("scene.yaml").write_text(SLOPE)
    pathlib.Path("data.yaml").write_text("measurements: 3")
    result = identify()
    assert result.returncode == 2 and result.stderr.startswith("error: data.yaml: it must hold"), result.stderr


def test_replaces_nothing_of_others(folder):
    measured(SLOPE, {"effects.friction.coefficient": 0.2})
    short = ["--generations", "1", "--population", "4"]
    pathlib.Path("found").mkdir()
    pathlib.Path("found/mine").write_text("mine")
    result = identify(*short)
    assert result.returncode == 2 and "is no empty folder" in result.stderr
    os.remove("found/mine")
    assert identify(*short).returncode in (0, 4)
    other = identify(*short, "--seed", "2")
    assert other.returncode == 2 and "of another scene, data, program or options" in other.stderr
    assert identify(*short, "--seed", "2", "--overwrite").returncode in (0, 4)


# ---- data ---------------------------------------------------------------------------------------------------------


def point_cache(frames, kind="<f4"):
    head = np.zeros(1, [("kind", "S12"), ("numbers", "<i4", 2), ("floats", "<f4", 2), ("frames", "<i4")])
    head["kind"], head["numbers"], head["frames"] = b"POINTCACHE2", (1, len(frames[0])), len(frames)
    return head.tobytes() + frames.astype(kind).tobytes()


def test_reads_motions_of_all_formats(folder):
    from identify_data import DataError, read_motion

    frames = np.arange(24.0).reshape(2, 4, 3) / 8
    np.save("m.npy", frames)
    pathlib.Path("m.pc2").write_bytes(point_cache(frames))
    pathlib.Path("m.pc16").write_bytes(point_cache(frames, "<f2"))
    triangle = np.array([[0, 1, 2]], "<i4")
    anime = np.array([2, 4, 1], "<i4").tobytes() + frames[0].astype("<f4").tobytes() + triangle.tobytes()
    pathlib.Path("m.anime").write_bytes(anime + (frames[1] - frames[0]).astype("<f4").tobytes())
    formats = ["m.npy", "m.pc2", "m.pc16", "m.anime"]
    try:
        import meshio

        pathlib.Path("obj").mkdir()
        pathlib.Path("ply").mkdir()
        for k, frame in enumerate(frames):
            meshio.Mesh(frame, [("triangle", triangle)]).write(f"obj/{k:03d}.obj")
            meshio.Mesh(frame, [("triangle", triangle)]).write(f"ply/{k:03d}.ply")
        pathlib.Path("obj/readme.txt").write_text("no frame")
        formats += ["obj", "ply"]
    except ImportError:
        pass
    for name in formats:
        times, read = read_motion(name, rate=25, start=0.5)
        np.testing.assert_allclose(times, [0.5, 0.54])
        np.testing.assert_array_equal(read, frames)
    rows = [f"{t},{p},{x},{y},{z}" for t, frame in enumerate(frames) for p, (x, y, z) in enumerate(frame) if t + p != 4]
    pathlib.Path("m.csv").write_text("time,particle,x,y,z\n" + "\n".join(reversed(rows)) + "\n")
    times, read = read_motion("m.csv")
    np.testing.assert_array_equal(times, [0, 1])
    assert np.isnan(read[1][3]).all()
    np.testing.assert_array_equal(np.nan_to_num(read, nan=23.0)[:, :3], frames[:, :3])
    for name in ("m.pc2", "m.pc16", "m.anime"):
        whole = pathlib.Path(name).read_bytes()
        for bad in (whole[:-1], whole + b"x", b"", b"x" * 40):
            pathlib.Path(name).write_bytes(bad)
            with pytest.raises(DataError, match=name):
                read_motion(name, rate=25)
    for name, rate, words in [("m.npy", None, "say its frames a second"), ("m.fbx", 1, "no format of motions")]:
        with pytest.raises(DataError, match=words):
            read_motion(name, rate)


def test_the_samples_are_one_motion(folder):
    from identify_data import read_data, read_motion

    samples = SOURCES / "examples/identify"
    times, first = read_motion(str(samples / "motion.pc2"), rate=50)
    assert len(times) == 41 and np.shape(first) == (41, 49, 3)
    for name, precision in [("motion.anime", 1e-6), ("motion.pc16", 1e-3)]:
        np.testing.assert_allclose(read_motion(str(samples / name), rate=50)[1], first, rtol=0, atol=precision)
    (measurement,), files = read_data(str(samples / "data.yaml"), ["cloth"])
    assert measurement.scale == 0.003 and [pathlib.Path(file).name for file in files] == ["data.yaml", "motion.pc2"]


@pytest.mark.parametrize("text, words", [
    ("measurements: []", "must hold 'measurements:'"),
    ("measurements: [{file: none.npy}]", "there is no file"),
    ("measurements: [{file: m.npy, rate: 1, boddy: a}]", "unknown key 'boddy'"),
    ("measurements: [{file: m.npy, rate: 1, body: napkin}]", "there is no body 'napkin'; there are cloth"),
    ("measurements: [{file: m.npy, rate: 1, kind: spots}]", "must be one of points, cloud, forces"),
    ("measurements: [{file: m.npy, rate: 1, match: any}]", "must be number or nearest"),
    ("measurements: [{file: m.npy, rate: 1, start: -1}]", "the scene begins at 0"),
    ("measurements: [{file: f.csv}]", "say on which link or obstacle"),
    ("measurements: [{file: bad.csv}]", "bad.csv:2: 2 cells"),
    ("measurements: [{file: c.csv, kind: points}]", "from 1 to 2 points"),
])
def test_refuses_bad_data(folder, text, words):
    from identify_data import DataError, read_data

    np.save("m.npy", np.arange(24.0).reshape(2, 4, 3))
    pathlib.Path("f.csv").write_text("time,force_x,force_y,force_z\n0,1,0,0\n1,0,0,0\n")
    pathlib.Path("c.csv").write_text("time,x,y,z\n0,1,0,0\n1,0,0,0\n1,1,0,0\n")
    pathlib.Path("bad.csv").write_text("time,x,y,z\n0,1\n")
    pathlib.Path("d.yaml").write_text(text)
    with pytest.raises(DataError) as refusal:
        read_data("d.yaml", ["cloth"])
    assert words in str(refusal.value)


def test_measures_distances_to_a_surface(folder):
    from identify_data import surface_distances, turned

    x, y = np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 5))
    grid = np.stack([x.ravel(), y.ravel(), np.zeros(25)], axis=1)
    points = np.array([[0.33, 0.41, 0.1], [0.5, 0.5, -0.2], [2, 1, 0]])
    np.testing.assert_allclose(surface_distances(points, grid), [0.1, 0.2, 1.0], atol=1e-12)
    np.testing.assert_allclose(turned([np.array([[1.0, 0, 0]])], 2, [0, 0, np.pi / 2], [0, 0, 1])[0], [[0, 2, 1]],
                               atol=1e-12)


class MovedGrid:
    """Stands for results: a grid that rises by a metre a second."""

    def __init__(self):
        x, y = np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 5))
        self.start = np.stack([x.ravel(), y.ravel(), np.zeros(25)], axis=1)

    def at(self, name, scene, times):
        assert name in ("cloth_positions", "cloth_points")
        return self.start + times[:, None, None] * [0, 0, 1.0]


def test_points_follow_what_is_nearest_to_them(folder):
    from identify_data import DataError, Points

    results, times = MovedGrid(), np.array([0, 0.5, 1])
    markers = np.array([[0.26, 0.24, 0.01], [0.74, 0.76, 0.01]])  # above two vertices, in another order than these
    np.save("m.npy", (markers + times[:, None, None] * [0, 0, 1.0])[:, ::-1])
    item = {"file": "m.npy", "body": "cloth", "rate": 2}
    np.testing.assert_allclose(Points({**item, "match": "nearest"}, "m").residuals(results, 0), 0, atol=1e-12)
    by_number = np.array(Points(item, "m").residuals(results, 0))
    np.testing.assert_allclose(by_number[:, :3], np.tile([[-0.74, -0.76, -0.01]], (3, 1)), atol=1e-12)
    np.save("m.npy", np.zeros((3, 26, 3)) + np.arange(3)[:, None, None])
    with pytest.raises(DataError, match="26 points, but the body has 25 particles"):
        Points(item, "m").residuals(results, 0)


def test_clouds_are_compared_in_both_directions_unless_they_are_parts(folder):
    from identify_data import Cloud

    results = MovedGrid()
    half = results.start[results.start[:, 0] <= 0.5] + [0, 0, 0.1]
    np.save("m.npy", np.stack([half, half + [0, 0, 1.0]]))
    item = {"file": "m.npy", "body": "cloth", "rate": 1, "kind": "cloud"}
    for frame in Cloud({**item, "partial": True}, "m").residuals(results, 0):
        np.testing.assert_allclose(frame, 0.1, atol=1e-12)
    for frame in Cloud(item, "m").residuals(results, 0):
        assert len(frame) == 15 + 25
        np.testing.assert_allclose(frame[:15], 0.1, atol=1e-12)
        # Both directions count the same; the far edge is half a metre from any point.
        np.testing.assert_allclose(frame[15:].max(), np.sqrt(15 / 25) * np.hypot(0.5, 0.1), atol=1e-12)
    assert len(Cloud({**item, "most_points": 4}, "m").frames[0]) == 4
