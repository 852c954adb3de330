import numpy as np
import pytest

import pliant
from pliant import envs


def fold(env):
    """Lifts the two corners over the middle and lays them down; returns what the last step did."""
    for action in [(-0.4, 1.0)] * 10 + [(-1.0, 0.0)] * 8 + [(-0.8, -0.8)] * 8 + [(-0.25, -1.0)] * 6:
        result = env.step(np.tile(action, (env.num_envs, 2)))
        if result[2].any():
            break
    return result


def lift(env):
    """Closes the fingers and lifts."""
    for grip, up in [(0.3, 0.0)] * 10 + [(0.0, 0.5)] * 20:
        result = env.step(np.tile([up, grip], (env.num_envs, 1)))
        if result[2].any():
            break
    return result


@pytest.mark.parametrize("kind, policy", [(envs.TowelFold, fold), (envs.JellyLift, lift)])
def test_is_solved_by_hand_and_starts_again(kind, policy):
    env = kind(2, threads=2)
    first, infos = env.reset(seed=3)
    assert first.shape == env.observation_space.shape and infos == {}
    assert env.single_observation_space.contains(first[0])
    observations, rewards, terminations, truncations, infos = policy(env)
    assert terminations.all() and not truncations.any() and infos == {}
    assert (rewards > 0.9).all()
    observations, rewards, terminations, _, _ = env.step(env.action_space.sample())
    np.testing.assert_array_equal(observations, first)
    assert (rewards == 0.0).all() and not terminations.any()


def test_does_the_same_again():
    runs = []
    for _ in range(2):
        env = envs.JellyLift(2, randomize={"bodies[jelly].material.young": (1e4, 4e4)}, seed=5)
        env.reset(seed=7)
        runs.append([env.step(env.action_space.sample())[:2] for _ in range(4)])
    for (one, its_reward), (other, other_reward) in zip(*runs):
        np.testing.assert_array_equal(one, other)
        np.testing.assert_array_equal(its_reward, other_reward)
    assert (runs[0][-1][0][0] != runs[0][-1][0][1]).any()  # they differ by what was drawn


def test_ends_after_so_many_actions_and_refuses_what_is_no_action():
    env = envs.JellyLift(1, max_actions=2)
    with pytest.raises(pliant.InputError, match="reset"):
        env.step(np.zeros((1, 2)))
    env.reset()
    with pytest.raises(pliant.InputError, match="options"):
        env.reset(options={"a": 1})
    for bad in (np.zeros(2), np.full((1, 2), np.nan)):
        with pytest.raises(pliant.InputError, match="actions"):
            env.step(bad)
    assert [bool(env.step(np.zeros((1, 2)))[3][0]) for _ in range(4)] == [False, True, False, False]
