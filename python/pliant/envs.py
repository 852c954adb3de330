"""Vectorised environments for learning, in the shape of Gymnasium's VectorEnv, which they do not need.

An environment that ended (terminated or truncated) starts again in the next step(), whose reward for it is 0: what
Gymnasium calls autoreset in the next step.
"""

import pathlib

import numpy as np

import pliant

SCENES = pathlib.Path(__file__).resolve().parent / "scenes"


class Box:
    """Arrays between two bounds, as gymnasium.spaces.Box."""

    def __init__(self, low, high, shape, dtype=np.float64):
        self.shape, self.dtype = tuple(shape), np.dtype(dtype)
        self.low, self.high = np.full(shape, low, dtype), np.full(shape, high, dtype)
        self._random = np.random.default_rng()

    def seed(self, seed=None):
        self._random = np.random.default_rng(seed)

    def sample(self):
        """Evenly between the bounds; where these are infinite, normally distributed."""
        if np.isinf(self.low).any() or np.isinf(self.high).any():
            return self._random.normal(size=self.shape).astype(self.dtype)
        return self._random.uniform(self.low, self.high).astype(self.dtype)

    def contains(self, value):
        value = np.asarray(value)
        return value.shape == self.shape and bool(((value >= self.low) & (value <= self.high)).all())

    def __repr__(self):
        return f"Box({self.low.min()}, {self.high.max()}, {self.shape}, {self.dtype})"


class VectorEnv:
    """Environments of one scene with one body that a robot handles.

    An action is a number from -1 to 1 for each joint: its speed as a share of `top_speed`, which it keeps for
    `steps_per_action` steps of the scene. An observation holds the joints' positions, then the positions of some of
    the body's particles, then their velocities. Subclasses say what is good: reward_and_success().

    randomize: {path in the scene: (low, high)}, of which each environment draws a number once, by `seed`.
    """

    scene = None  # file
    body = None
    top_speed = 0.3  # [m/s]
    observed = 32  # particles, evenly chosen from all; the rest is seen by `batch`
    metadata = {"autoreset_mode": "next_step"}

    def __init__(self, num_envs, *, threads=None, steps_per_action=5, max_actions=100, randomize=None, seed=None):
        random = np.random.default_rng(seed)
        rows = [
            {path: float(random.uniform(low, high)) for path, (low, high) in (randomize or {}).items()}
            for _ in range(num_envs)
        ]
        self.num_envs, self.steps_per_action, self.max_actions = num_envs, steps_per_action, max_actions
        self.batch = pliant.Batch(self.scene, rows, threads=threads)
        first = self.batch[0]
        limits = [first.joint_limits(joint) for joint in self.batch.joint_names]
        self._low, self._high = (np.array(bounds) for bounds in zip(*limits))
        self._start = self.batch.joint_positions
        self._joints = self._start.copy()
        self._reach = self.top_speed * first.time_step  # [m] a step
        count = len(first.positions(self.body))
        self._seen = np.unique(np.linspace(0, count - 1, min(self.observed, count)).round().astype(int))
        self._positions = np.empty((num_envs, count, 3))
        self._velocities = np.empty((num_envs, count, 3))
        self.single_action_space = Box(-1.0, 1.0, (len(limits),))
        self.action_space = Box(-1.0, 1.0, (num_envs, len(limits)))
        size = len(limits) + 6 * len(self._seen)
        self.single_observation_space = Box(-np.inf, np.inf, (size,))
        self.observation_space = Box(-np.inf, np.inf, (num_envs, size))
        self._actions = np.zeros(num_envs, int)
        self._ended = np.zeros(num_envs, bool)
        self._value = np.zeros(num_envs)
        self._is_begun = False

    def reset(self, *, seed=None, options=None):
        """All of them to their start. `seed` is that of action_space.sample(); there are no options."""
        if options:
            raise pliant.InputError(f"reset: there are no options, but these were given: {sorted(options)}")
        if seed is not None:
            self.action_space.seed(seed)
            self.single_action_space.seed(seed)
        self._restart(np.ones(self.num_envs, bool))
        self._is_begun = True
        return self._observe(), {}

    def step(self, actions):
        """Returns observations, rewards, terminations, truncations, infos. infos["failure"] says why an environment
        ended whose step was not finite."""
        if not self._is_begun:
            raise pliant.InputError("step: call reset() first")
        actions = np.asarray(actions, float)
        if actions.shape != self.action_space.shape or not np.isfinite(actions).all():
            raise pliant.InputError(
                f"step: actions must be finite numbers of the shape {self.action_space.shape}, but theirs is {actions.shape}"
            )
        speeds = np.clip(actions, -1.0, 1.0) * self._reach
        for _ in range(self.steps_per_action):
            self._joints = np.clip(self._joints + speeds, self._low, self._high)
            self.batch.step(self._joints)
        self._actions += 1
        again = self._ended
        if again.any():
            self._restart(again)
        observations = self._observe()
        value, success = self.value_and_success(self._positions)
        failures = np.array(self.batch.failures)
        failed = failures != ""
        rewards = np.where(again | failed, 0.0, value - self._value + success)
        self._value = value
        terminations = (success | failed) & ~again
        truncations = (self._actions >= self.max_actions) & ~terminations & ~again
        self._ended = terminations | truncations
        return observations, rewards, terminations, truncations, {"failure": failures} if failed.any() else {}

    def close(self):
        """Lets go of the worlds."""
        self.batch = None

    def value_and_success(self, positions):
        """Of the particles' positions, (environments, n, 3): a number for each environment whose growth is its
        reward, and whether it has done its task."""
        raise NotImplementedError

    def _restart(self, which):
        self._joints[which] = self._start[which]
        # A reset puts the links where the joints are.
        for index in np.flatnonzero(which):
            self.batch[int(index)].set_joint_positions(dict(zip(self.batch.joint_names, self._start[index])))
            self.batch.reset(int(index))
        self._actions[which] = 0
        self.batch.positions(self.body, self._positions)
        self._value[which] = self.value_and_success(self._positions)[0][which]

    def _observe(self):
        self.batch.positions(self.body, self._positions)
        self.batch.velocities(self.body, self._velocities)
        parts = [self._joints, self._positions[:, self._seen], self._velocities[:, self._seen]]
        return np.concatenate([part.reshape(self.num_envs, -1) for part in parts], axis=1)


class TowelFold(VectorEnv):
    """Folds a towel on a table in half: two clips hold corners of it and move along y and z (four joints). The value
    is minus the mean distance of the far half's vertices from where the other half's mirror images are, over the
    towel's length; done below 0.1 with all of it lying low."""

    scene = SCENES / "towel_fold.yaml"
    body = "towel"
    _side, _length = 13, 0.3  # vertices along an edge; [m]

    def value_and_success(self, positions):
        rows = positions.reshape(len(positions), self._side, self._side, 3)
        near = rows[:, : self._side // 2]
        far = rows[:, ::-1][:, : self._side // 2]
        distance = np.linalg.norm((far - near)[..., :2], axis=-1).mean(axis=(1, 2)) / self._length
        return -distance, (distance < 0.1) & (positions[..., 2].max(axis=1) < 0.05)


class JellyLift(VectorEnv):
    """Takes a block of jelly between two fingers and lifts it by 10 cm (joints: lift, grip). The value is its height
    over these."""

    scene = SCENES / "jelly_lift.yaml"
    body = "jelly"
    _height = 0.1  # [m]

    def value_and_success(self, positions):
        height = (positions[..., 2].mean(axis=1) - 0.02) / self._height
        return height, height > 1.0
