"""Folds a towel in many worlds at once, and draws one of them as it goes (needs python3-matplotlib)."""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from pliant.envs import TowelFold

# Per clip: speed along y, speed along z, of 0.3 m/s; and for how many actions.
MOTION = [((-0.4, 1.0), 10), ((-1.0, 0.0), 8), ((-0.8, -0.8), 8), ((-0.25, -1.0), 6)]

env = TowelFold(16, threads=2, randomize={"bodies[towel].material.areal_density": (0.2, 0.5)}, seed=1)
env.reset()
triangles = env.batch[0].triangles("towel")
figure = plt.figure(figsize=(12, 3.2))
total, done = np.zeros(env.num_envs), np.zeros(env.num_envs, bool)
for part, (action, times) in enumerate(MOTION):
    for _ in range(times):
        observations, rewards, terminations, truncations, infos = env.step(np.tile(action, (env.num_envs, 2)))
        total += np.where(done, 0.0, rewards)
        done |= terminations
        if done.all():
            break
    axes = figure.add_subplot(1, len(MOTION), part + 1, projection="3d")
    x, y, z = env.batch.positions("towel")[0].T
    axes.plot_trisurf(x, y, z, triangles=triangles, color="#4073cc", edgecolor="#27467d", linewidth=0.3)
    axes.set(xlim=(-0.2, 0.2), ylim=(-0.2, 0.2), zlim=(0, 0.3), title=f"{env.batch[0].time:.2f} s")
    axes.view_init(25, -35)
picture = sys.argv[1] if len(sys.argv) > 1 else "fold_towel.png"
figure.savefig(picture, dpi=80, bbox_inches="tight")
print(f"{done.sum()} of {env.num_envs} folded, mean reward {total.mean():.2f}; see {picture}")
