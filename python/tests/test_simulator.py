import gc
import os
import subprocess
import threading
import time

import numpy as np
import pytest

import pliant

QUICK = {"solver": "jacobi", "solver_parameters": {"iterations": 5}}


def test_loads_a_scene_and_steps_it(tray):
    simulator = pliant.Simulator(tray, **QUICK)
    assert simulator.bodies == ["napkin", "jelly"]
    assert simulator.joint_names == ["height"]
    assert simulator.warnings == []
    assert simulator.vertices("napkin").shape == (169, 3)
    assert simulator.triangles("napkin").shape == (288, 3)
    assert simulator.triangles("napkin").max() == 168
    assert simulator.field("napkin", "stretch").shape == (169,)
    simulator.step(3)
    assert simulator.time == pytest.approx(0.015)
    report = simulator.report("napkin")
    assert (report.solver, report.iterations, report.warnings) == ("jacobi", 5, [])


def test_builds_a_scene_in_python(cloth):
    cloth["bodies"][0]["position"] = np.array([0.0, 0.0, 2.0])
    simulator = pliant.Simulator(cloth)
    positions = simulator.positions("cloth")
    assert positions.shape == (36, 3)
    np.testing.assert_allclose(positions[:, 2], 2.0)
    np.testing.assert_allclose(positions[:, 0].min(), -0.1)
    before = positions.copy()
    simulator.step(10)
    moved = simulator.positions("cloth") - before
    assert (moved[:6, 2] < -0.01).all()
    np.testing.assert_array_equal(moved[[30, 35]], 0.0)  # the corners that are fixed


def test_does_what_the_program_does(tray, tmp_path):
    program = os.environ["PLIANT_PROGRAM"]
    command = [program, "run", tray, "--steps", "12", "--batch", "1", "--out", tmp_path]
    subprocess.run(command, check=True, capture_output=True)
    simulator = pliant.Simulator(tray)
    simulator.step(12)
    for body in simulator.bodies:
        written = np.load(tmp_path / f"positions_{body}.npy")[0]
        np.testing.assert_array_equal(simulator.positions(body), written)


def test_views_share_memory_and_outlive_the_world(cloth):
    simulator = pliant.Simulator(cloth)
    view = simulator.positions("cloth")
    assert np.shares_memory(view, simulator.positions("cloth"))
    with pytest.raises(ValueError):
        view[0, 0] = 1.0
    expected = view.copy()
    del simulator
    gc.collect()
    filled = [np.full(36 * 3, 7.0) for _ in range(100)]  # that a freed world's memory would go to
    np.testing.assert_array_equal(view, expected)
    del filled


def test_a_view_from_before_a_step_is_still_memory_of_the_world(cloth):
    simulator = pliant.Simulator(cloth)
    view = simulator.positions("cloth")
    for _ in range(3):
        simulator.step()
        state = simulator.save()
        simulator.reset()
        simulator.load(state)
    assert np.isfinite(view).all() and np.abs(view).max() < 2.0


def test_takes_values_instead_of_the_scenes(tray):
    values = {"bodies[napkin].geometry.grid.vertices": [4, 4], "bodies[jelly].material.density": 800}
    simulator = pliant.Simulator(tray, values=values, time_step=0.01, time_integration="bdf2", **QUICK)
    assert simulator.vertices("napkin").shape == (16, 3)
    assert simulator.time_step == 0.01
    simulator.step()
    assert simulator.report("napkin").time_integration == "bdf2"


@pytest.mark.parametrize(
    "call, parts",
    [
        (lambda s: s.positions("napkins"), ["unknown body 'napkins'", "did you mean 'napkin'"]),
        (lambda s: s.field("napkin", "strech"), ["unknown field of body 'napkin'", "'stretch'"]),
        (lambda s: s.set_joint_positions({"hight": 0.1}), ["unknown joint 'hight'", "'height'"]),
        (lambda s: s.set_joint_positions({"height": 0.6}), ["joint 'height' is 0.6", "from 0 to 0.5"]),
        (lambda s: s.step(-1), ["count is -1", ">= 0"]),
        (lambda s: s.apply_force("jelly", (0, 0, 0), -1.0, (0, 0, 1), 0.0), ["radius"]),
        (lambda s: s.attach("napkin", "a", (9, 9, 9), 0.01), ["vertex"]),
        (lambda s: s.attach("napkin", "a", (0, 0, 0), 1.0, "tary"), ["'tary'", "'tray'"]),
        (lambda s: s.detach("napkin", "a"), ["nothing holds body 'napkin'"]),
        (lambda s: s.link_pose("tary"), ["unknown link 'tary'", "'tray'"]),
        (lambda s: pliant.Simulator("nowhere.yaml"), ["nowhere.yaml"]),
        (lambda s: pliant.Simulator({"time_step": 0.01, "bodies": []}), ["scene:3", "bodies"]),
    ],
)
def test_refuses_bad_input_with_the_librarys_words(tray, call, parts):
    simulator = pliant.Simulator(tray, **QUICK)
    with pytest.raises(pliant.InputError) as refusal:
        call(simulator)
    assert isinstance(refusal.value, ValueError)
    for part in parts:
        assert part in str(refusal.value)


def test_refuses_keywords_that_there_are_not(tray):
    with pytest.raises(TypeError, match="unknown keyword 'solvr'.*did you mean 'solver'"):
        pliant.Simulator(tray, solvr="direct")
    with pytest.raises(TypeError, match="texts, numbers, lists and dicts"):
        pliant.Simulator({"time_step": object()})


def test_says_why_a_step_is_not_finite(tray):
    simulator = pliant.Simulator(tray, values={"limits.max_speed": 0.01}, **QUICK)
    with pytest.raises(pliant.StepError, match="vertex"):
        simulator.step(100)
    assert np.abs(simulator.velocities("napkin")).max() < 0.01


def test_moves_the_robot_and_feels_the_weight(tray):
    simulator = pliant.Simulator(tray)
    assert simulator.joint_limits("height") == (0.0, 0.5)
    simulator.step(60)
    start = simulator.link_pose("tray")[2, 3]
    for k in range(1, 61):
        simulator.set_joint_positions({"height": 0.0005 * k})
        simulator.step()
    assert simulator.joint_positions == pytest.approx([0.03])
    assert simulator.link_pose("tray")[2, 3] == pytest.approx(start + 0.03)
    wrench = simulator.wrenches()[0]
    assert (wrench.name, wrench.is_link, wrench.force.shape) == ("tray", True, (3,))
    contacts = simulator.contacts()
    assert {contact.other for contact in contacts} == {"tray"}
    assert {contact.body for contact in contacts} == {"napkin", "jelly"}
    assert sum(contact.force for contact in contacts)[2] == pytest.approx(-wrench.force[2], rel=1e-6)
    assert all(contact.normal[2] > 0.9 for contact in contacts if contact.body == "napkin")


def test_pushes_holds_and_lets_go(cloth):
    cloth["bodies"][0]["fixed"] = [{"corner": "upper_left"}]
    simulator = pliant.Simulator(cloth)
    corner = simulator.positions("cloth")[35].copy()
    assert simulator.attach("cloth", "held", corner, 0.01, stiffness=1e4) == 1
    assert simulator.attachments("cloth") == ["held"]
    simulator.step(20)
    assert np.linalg.norm(simulator.positions("cloth")[35] - corner) < 1e-3
    simulator.detach("cloth", "held")
    state = simulator.save()
    simulator.step(10)
    assert np.linalg.norm(simulator.positions("cloth")[35] - corner) > 0.01
    without = simulator.velocities("cloth")[35, 1]
    simulator.load(state)
    simulator.apply_force("cloth", corner, 0.02, (0, 0.1, 0), -1.0)
    simulator.step(10)
    assert simulator.velocities("cloth")[35, 1] > without + 0.1
    simulator.clear_forces()
    simulator.reset()
    assert simulator.attachments("cloth") == []


def test_goes_on_bit_for_bit_from_a_saved_state(tray):
    simulator = pliant.Simulator(tray, **QUICK)
    simulator.set_joint_positions({"height": 0.002})
    simulator.step(5)
    state = simulator.save()
    assert state.time == simulator.time
    simulator.step(10)
    expected = simulator.positions("jelly").copy()
    simulator.set_joint_positions({"height": 0.1})
    simulator.step(10)
    simulator.load(state)
    simulator.step(10)
    np.testing.assert_array_equal(simulator.positions("jelly"), expected)
    other = pliant.Simulator(tray, values={"bodies[napkin].geometry.grid.vertices": [4, 4]}, **QUICK)
    with pytest.raises(pliant.InputError, match="saved state"):
        other.load(state)


def test_keeps_a_state_in_a_file(tray, tmp_path):
    simulator, file = pliant.Simulator(tray, **QUICK), tmp_path / "tray.state"
    simulator.set_joint_positions({"height": 0.002})
    simulator.step(5)
    simulator.save().write(file)
    simulator.step(10)
    other = pliant.Simulator(tray, **QUICK)
    state = pliant.State.read(str(file))
    other.load(state)
    assert other.time == state.time == pytest.approx(0.025)
    other.step(10)
    np.testing.assert_array_equal(other.positions("jelly"), simulator.positions("jelly"))
    np.testing.assert_array_equal(other.positions("napkin"), simulator.positions("napkin"))
    assert list(other.joint_positions) == [0.002]
    whole = file.read_bytes()
    for bad in (whole[:-1], whole + b"x", whole[:200] + b"x" + whole[201:], b"", b"something else"):
        file.write_bytes(bad)
        with pytest.raises(pliant.InputError, match="tray.state: it is no whole state"):
            pliant.State.read(file)
    simulator.apply_force("jelly", [0, 0, 0], 0, [0, 0, 1], 1)
    with pytest.raises(pliant.InputError, match="clear_forces"):
        simulator.save().write(file)
    with pytest.raises(pliant.InputError, match="none.state"):
        pliant.State.read(tmp_path / "none.state")


def test_lets_other_threads_run_but_not_into_a_step(cloth):
    cloth["bodies"][0]["geometry"]["grid"]["vertices"] = [40, 40]
    simulator = pliant.Simulator(cloth)
    thread = threading.Thread(target=simulator.step, args=(100,))
    thread.start()
    refusal, counted = None, 0
    while thread.is_alive():
        counted += 1  # which only a thread that holds the interpreter's lock does
        try:
            simulator.positions("cloth")
        except RuntimeError as error:
            refusal = str(error)
        time.sleep(0.001)
    thread.join()
    assert counted > 3
    assert refusal == "another thread uses this simulator: one at a time may"
    assert simulator.time == pytest.approx(1.0)
