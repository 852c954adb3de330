import pathlib

import pytest

SOURCES = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture
def tray():
    """A robot lifts a napkin and a jelly on a tray."""
    return SOURCES / "examples/library/tray.yaml"


@pytest.fixture
def cloth():
    """A cloth that hangs by its corners, as Python's dict."""
    return {
        "time_step": 0.01,
        "bodies": [
            {
                "name": "cloth",
                "model": "cloth",
                "geometry": {"grid": {"size": [0.2, 0.2], "vertices": [6, 6]}},
                "position": [0, 0, 1],
                "material": {"areal_density": 0.2, "stretch_warp": 100, "stretch_weft": 100, "shear": 10, "bending": 1e-5},
                "fixed": [{"corner": "upper_left"}, {"corner": "upper_right"}],
            }
        ],
        "effects": {"gravity": {"acceleration": [0, 0, -9.81]}},
        "solver": {"name": "direct", "iterations": 5},
    }
