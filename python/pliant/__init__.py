"""Deformable objects that a program steps. docs/python.md tells how.

>>> import pliant
>>> simulator = pliant.Simulator("config/scenes/small_hanging_cloth.yaml")
>>> simulator.step(100)
>>> simulator.positions("cloth").shape
"""

import importlib

__all__ = ["Simulator", "Batch", "State", "Report", "Wrench", "Contact", "InputError", "StepError"]


def __getattr__(name):
    # Not before somebody asks: where Pliant was built with ROS, `pliant.msg` and `pliant.srv` are in
    # this package too, and who wants these alone need not load the library.
    if name in __all__:
        return getattr(importlib.import_module("pliant._pliant"), name)
    if name == "envs":
        return importlib.import_module("pliant.envs")
    raise AttributeError(f"module 'pliant' has no attribute '{name}'")


def __dir__():
    return sorted([*globals(), *__all__, "envs"])
