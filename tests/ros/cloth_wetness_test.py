#!/usr/bin/python3
"""Users wet a cloth by the service ~set_field: what it then weighs and looks like."""

import sys

import numpy as np
import rospy
import rostest

from support import ModelTest, columns

CAPACITY = 0.3  # [kg/m^2], the scene's
DENSITY = 0.15  # [kg/m^2]
AREA = 0.2 * 0.2  # [m^2]


def brightness(fields):
    """Sum of red, green and blue of each point."""
    packed = fields["rgb"].view(np.uint32)
    return sum((packed >> shift) & 255 for shift in (0, 8, 16)).astype(float)


class ClothWetnessTest(ModelTest):
    node = "/cloth"
    solver = "xpbd"
    parameters = {"iterations": 10}

    def test_a_region_is_wetted(self):
        dry = columns(self.model.points.new())
        np.testing.assert_array_equal(dry["wetness"], 0.0)
        self.model.step(1)
        self.assertAlmostEqual(self.model.status.new().total_mass, DENSITY * AREA, places=9)
        corner, radius = (0.1, 0.1, 0.001), 0.05
        near = np.linalg.norm([dry[a] - c for a, c in zip("xyz", corner)], axis=0) < radius
        answer = self.model.set_near("wetness", 1.0, corner, radius)
        self.assertTrue(answer.success, answer.message)
        self.assertIn(" %d vertices" % near.sum(), answer.message)
        self.model.step(2)
        wet = columns(self.model.points.new())
        np.testing.assert_array_equal(wet["wetness"], near.astype(np.float32))
        # Wet cloth is darker, by half where it is full.
        np.testing.assert_allclose(brightness(wet)[near] / brightness(dry)[near], 0.5, atol=0.02)
        np.testing.assert_array_equal(brightness(wet)[~near], brightness(dry)[~near])

    def test_all_of_it_weighs_its_water_once_it_has_come(self):
        answer = self.model.set_near("wetness", 0.5, radius=1.0, duration=0.1)
        self.assertTrue(answer.success, answer.message)
        self.model.step(5)
        halfway = columns(self.model.points.new())["wetness"]
        self.assertTrue(((halfway > 0.1) & (halfway < 0.4)).all(), halfway)
        self.model.step(10)
        np.testing.assert_allclose(columns(self.model.points.new())["wetness"], 0.5, rtol=1e-6)
        # Masses follow the water to 1 %.
        wanted = (DENSITY + 0.5 * CAPACITY) * AREA
        self.assertAlmostEqual(self.model.status.new().total_mass / wanted, 1.0, delta=0.01)

    def test_a_reset_dries_it(self):
        self.assertTrue(self.model.set_near("wetness", 1.0, radius=1.0).success)
        self.model.step(1)
        self.assertTrue(self.model.reset().success)
        np.testing.assert_array_equal(columns(self.model.points.new())["wetness"], 0.0)

    def test_what_is_refused_changes_nothing(self):
        for answer, words in (
                (self.model.set_near("wetnes", 1.0), ["'wetnes'", "'wetness'"]),
                (self.model.set_near("wetness", 1.5), ["wetness", "<= 1"]),
                (self.model.set_near("wetness", -0.1), ["wetness", "0"]),
                (self.model.set_near("wetness", float("nan")), ["wetness", "finite"]),
                (self.model.set_near("wetness", 1.0, radius=-1.0), ["radius", "positive"]),
                (self.model.set_near("wetness", 1.0, duration=-1.0), ["duration"]),
                (self.model.set_near("wetness", 1.0, (9.0, 0.0, 0.0)), ["nearest vertex"])):
            self.assertFalse(answer.success)
            for word in words:
                self.assertIn(word, answer.message)
        np.testing.assert_array_equal(columns(self.model.points.new())["wetness"], 0.0)


if __name__ == "__main__":
    rospy.init_node("cloth_wetness_test")
    rostest.rosrun("pliant", "cloth_wetness_test", ClothWetnessTest, sys.argv)
