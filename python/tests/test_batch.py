import gc

import numpy as np
import pytest

import pliant

DENSITY = "bodies[cloth].material.areal_density"


def test_each_does_what_it_does_alone(cloth):
    densities = [0.1, 0.2, 0.4]
    batch = pliant.Batch(cloth, [{DENSITY: density} for density in densities], threads=2)
    batch.step(count=15)
    together = batch.positions("cloth")
    assert together.shape == (3, 36, 3) and len(batch) == 3
    for index, density in enumerate(densities):
        alone = pliant.Simulator(cloth, values={DENSITY: density}, threads=1)
        alone.step(15)
        np.testing.assert_array_equal(together[index], alone.positions("cloth"))
        np.testing.assert_array_equal(batch[index].velocities("cloth"), alone.velocities("cloth"))
    assert (together[0] != together[2]).any()
    assert [simulator.time for simulator in batch] == [pytest.approx(0.15)] * 3


def test_actions_move_the_robots(tray):
    batch = pliant.Batch(tray, 2, solver="jacobi", solver_parameters={"iterations": 5})
    batch.step([[0.0], [0.001]])
    np.testing.assert_allclose(batch.joint_positions, [[0.0], [0.001]])
    for actions, part in [
        ([[0.1]], "1 rows and 1 columns"),
        ([[0.1], [0.6]], "joint 'height' is 0.6"),
        ([0.1, 0.2], "1 dimensions"),
    ]:
        with pytest.raises(pliant.InputError, match=part):
            batch.step(actions)
    np.testing.assert_allclose(batch.joint_positions, [[0.0], [0.001]])  # nothing changed


def test_one_that_stops_stops_no_other(cloth):
    batch = pliant.Batch(cloth, [{}, {"limits.max_speed": 0.01}])
    batch.step(count=5)
    assert batch.failures[0] == "" and "cloth" in batch.failures[1]
    assert batch[0].time == pytest.approx(0.05) and batch[1].time < 0.05
    batch.reset(1)
    assert batch.failures == ["", ""] and batch[1].time == 0.0
    batch.reset()
    assert batch[0].time == 0.0


def test_fills_an_array_that_is_given(cloth):
    batch = pliant.Batch(cloth, 2)
    batch.step()
    out = np.empty((2, 36, 3))
    assert batch.positions("cloth", out) is out
    np.testing.assert_array_equal(out, batch.positions("cloth"))
    for bad in (np.empty((2, 35, 3)), np.empty((2, 36, 3), np.float32), np.empty((2, 3, 36)).transpose(0, 2, 1)):
        with pytest.raises(pliant.InputError, match="out must"):
            batch.velocities("cloth", bad)


def test_says_which_row_is_refused_and_what_cannot_be_gathered(cloth):
    with pytest.raises(pliant.InputError, match="areal_density"):
        pliant.Batch(cloth, [{}, {DENSITY: -1}])
    with pytest.raises(pliant.InputError, match="rows"):
        pliant.Batch(cloth, 0)
    with pytest.raises(pliant.InputError, match="rows"):
        pliant.Batch(cloth, [])
    batch = pliant.Batch(cloth, [{}, {"bodies[cloth].geometry.grid.vertices": [4, 4]}])
    with pytest.raises(pliant.InputError, match="36 particles in simulator 0 and 16 in 1"):
        batch.positions("cloth")


def test_its_simulators_are_stepped_by_it_alone_and_keep_it_alive(cloth):
    batch = pliant.Batch(cloth, 2)
    last = batch[-1]
    with pytest.raises(pliant.InputError, match="step the batch"):
        last.step()
    with pytest.raises(pliant.InputError, match="batch"):
        last.reset()
    with pytest.raises(IndexError):
        batch[2]
    view = last.positions("cloth")
    expected = view.copy()
    del batch, last
    gc.collect()
    np.testing.assert_array_equal(view, expected)
