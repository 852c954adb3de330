"""Types of the package pliant. Units are SI, positions are in the world's frame.

Bad input is an InputError with the same text as in C++ and on the command line; nothing has changed then.
"""

from os import PathLike
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant import envs as envs

Scene = Union[str, "PathLike[str]", Mapping[str, Any]]
Point = Sequence[float]

class InputError(ValueError):
    """A scene, a name or a value that is refused: the text says where, what is allowed, the nearest name."""

class StepError(RuntimeError):
    """A step that was not finite: it was undone. The text names body, vertex and time, and what to try."""

class Report:
    """How the last step went for a body."""

    @property
    def solver(self) -> str: ...
    @property
    def iterations(self) -> int: ...
    @property
    def error(self) -> Optional[float]:
        """Estimated distance from where converged steps would be, as a share of the path; None: not estimated."""
    @property
    def contacts(self) -> int:
        """Contacts that carry force."""
    @property
    def seconds(self) -> float:
        """Wall time of the step [s]."""
    @property
    def warnings(self) -> List[str]: ...
    @property
    def time_integration(self) -> str: ...
    @property
    def first_order(self) -> str:
        """Why the step was one of implicit Euler where time_integration is another; "": it was not."""

class Wrench:
    """What bodies did to a robot link or an obstacle in the last step, about the origin and in the axes of its frame."""

    @property
    def name(self) -> str: ...
    @property
    def is_link(self) -> bool: ...
    @property
    def force(self) -> NDArray[np.float64]:
        """(3,) [N]"""
    @property
    def torque(self) -> NDArray[np.float64]:
        """(3,) [N m]"""

class Contact:
    """A place where a body is touched and force is carried, at the end of the last step."""

    @property
    def body(self) -> str: ...
    @property
    def vertex(self) -> int: ...
    @property
    def other(self) -> str:
        """The obstacle, robot link or body that touches it."""
    @property
    def point(self) -> NDArray[np.float64]:
        """(3,) [m]"""
    @property
    def normal(self) -> NDArray[np.float64]:
        """(3,), of length 1, away from the other"""
    @property
    def force(self) -> NDArray[np.float64]:
        """(3,), on the body, friction too [N]"""

class State:
    """A saved state: for Simulator.load() of the same scene."""

    @property
    def time(self) -> float:
        """[s]"""
    def write(self, path: Union[str, "PathLike[str]"]) -> None:
        """To a file, in place of what is there. Refused while forces of the program act: clear_forces() first."""
    @staticmethod
    def read(path: Union[str, "PathLike[str]"]) -> "State":
        """Back from a file that this version of Pliant wrote on such a machine."""

class Simulator:
    """Soft bodies, obstacles and robots of a scene. One thread at a time may use it; another one's call raises
    RuntimeError. While it steps, other threads of Python run."""

    def __init__(
        self,
        scene: Scene,
        *,
        values: Optional[Mapping[str, Any]] = None,
        solver: str = "",
        solver_parameters: Optional[Mapping[str, Any]] = None,
        time_integration: str = "",
        time_step: Optional[float] = None,
        threads: Optional[int] = None,
        urdf: str = "",
        robot_follows_keyframes: bool = True,
    ) -> None:
        """scene: a scene file, or a dict with the same keys, whose relative paths begin in the working directory.
        values: others than the scene's, by their path, as {"bodies[towel].material.areal_density": 0.2}."""
    @property
    def warnings(self) -> List[str]: ...
    @property
    def time(self) -> float:
        """[s]"""
    @property
    def time_step(self) -> float:
        """[s]"""
    def step(self, count: int = 1) -> None:
        """Takes `count` steps. Raises StepError where one is not finite: those before it are kept."""
    def reset(self) -> None:
        """Back to the start, bit for bit; forces and attachments of the program are gone, joints stay."""
    def save(self) -> State: ...
    def load(self, state: State) -> None: ...
    @property
    def bodies(self) -> List[str]: ...
    def vertices(self, body: str) -> NDArray[np.float64]:
        """A copy of the vertices of the surface that is drawn, (n, 3) [m]."""
    def triangles(self, body: str) -> NDArray[np.int32]:
        """A copy of its triangles, (m, 3)."""
    def positions(self, body: str) -> NDArray[np.float64]:
        """A read-only view of the particles, (n, 3) [m]: of now until the next step, load or reset. It may be kept
        as long as you like, but what it shows after that is undefined: take .copy() for later."""
    def velocities(self, body: str) -> NDArray[np.float64]:
        """Likewise [m/s]."""
    def field(self, body: str, name: str) -> NDArray[np.float64]:
        """A copy of a number of each particle, as "temperature" or "stretch", (n,)."""
    def report(self, body: str) -> Report: ...
    def apply_force(self, body: str, point: Point, radius: float, force: Point, duration: float) -> None:
        """Lets `force` [N] act for `duration` [s] (below 0: until clear_forces(); 0: one step) on what is now within
        `radius` of `point` [m]; radius 0: on the nearest vertex."""
    def clear_forces(self) -> None: ...
    def attach(
        self, body: str, name: str, point: Point, radius: float, holder: str = "world", stiffness: float = 1000.0
    ) -> int:
        """Holds the vertices that are now within `radius` of `point` [m] to an obstacle, a robot link or the world,
        by springs of `stiffness` together [N/m]. Returns how many."""
    def detach(self, body: str, name: str) -> None: ...
    def attachments(self, body: str) -> List[str]: ...
    def contacts(self) -> List[Contact]: ...
    def wrenches(self) -> List[Wrench]:
        """Of all links that have a collision shape, then of all obstacles."""
    @property
    def joint_names(self) -> List[str]: ...
    @property
    def joint_positions(self) -> NDArray[np.float64]:
        """At the end of the last step, in the order of joint_names [m] or [rad]."""
    def set_joint_positions(self, positions: Dict[str, float]) -> None:
        """Where joints shall be at the end of the next step; those that are not named stay."""
    def joint_limits(self, joint: str) -> Tuple[float, float]: ...
    def link_pose(self, link: str) -> NDArray[np.float64]:
        """(4, 4), world from link."""

class Batch:
    """Many simulators of one scene, stepped side by side on `threads` threads; batch[i] is one of them, which the
    batch alone steps. Each does what it does alone, to the last bit."""

    def __init__(
        self,
        scene: Scene,
        rows: Union[int, Sequence[Mapping[str, Any]]],
        *,
        values: Optional[Mapping[str, Any]] = None,
        solver: str = "",
        solver_parameters: Optional[Mapping[str, Any]] = None,
        time_integration: str = "",
        time_step: Optional[float] = None,
        threads: Optional[int] = None,
        urdf: str = "",
        robot_follows_keyframes: bool = True,
    ) -> None:
        """rows: how many, or the values of each by their path in the scene."""
    def __len__(self) -> int: ...
    def __getitem__(self, index: int) -> Simulator: ...
    def step(self, actions: Optional[ArrayLike] = None, count: int = 1) -> None:
        """`count` steps of each that has not stopped. actions: where joints shall be at the end of the first of them
        [m] or [rad], a row a simulator, a column a joint."""
    def reset(self, index: Optional[int] = None) -> None:
        """One of them, or all, back to the start; those that stopped go on."""
    @property
    def failures(self) -> List[str]:
        """Why each of them stopped, since a step was not finite; "": it goes on."""
    @property
    def joint_names(self) -> List[str]: ...
    @property
    def joint_positions(self) -> NDArray[np.float64]:
        """(len, joints)"""
    def positions(self, body: str, out: Optional[NDArray[np.float64]] = None) -> NDArray[np.float64]:
        """A copy of all, (len, n, 3) [m], in `out` if that is given."""
    def velocities(self, body: str, out: Optional[NDArray[np.float64]] = None) -> NDArray[np.float64]: ...
