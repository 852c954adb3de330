#!/usr/bin/python3
"""The patch node: a soft ball on a table, with every service."""

import sys

import numpy as np
import rospy
import rostest
from visualization_msgs.msg import Marker

from pliant.msg import LinkWrenches
from support import Latest, ModelTest, PROJECTIVE_SOLVERS, columns

RADIUS = 0.04  # [m]
TETRAHEDRA = 400
DENSITY = 300.0  # [kg/m^3]
GRAVITY = 9.81  # [m/s^2]
TRIANGLES = 20 * 3 * 3  # of the surface: patches times level squared


class PatchNodeTest(ModelTest):
    node = "/patch"
    solver = "chebyshev"
    parameters = {"iterations": 40}

    def test_points_carry_the_fields_of_a_solid(self):
        cloud = self.model.points.new()
        fields = columns(cloud)
        for name in ("strain", "volume", "von_mises"):
            self.assertIn(name, fields)
            self.assertTrue(np.isfinite(fields[name]).all(), name)
        np.testing.assert_allclose(fields["volume"], 1.0, atol=1e-5)

    def test_surface_is_the_smooth_one(self):
        surface = Latest("/patch/surface", Marker)
        marker = surface.first()
        self.assertEqual(len(marker.points), 3 * TRIANGLES)
        center = np.array([0.0, 0.0, 0.0405])
        at = np.array([[point.x, point.y, point.z] for point in marker.points]) - center
        # Vertices of the base lie within the tetrahedra's surface or out of it: the ball is round
        # all the same.
        np.testing.assert_allclose(np.linalg.norm(at, axis=1), RADIUS, rtol=1e-3)
        surface.subscriber.unregister()

    def test_the_table_carries_the_ball(self):
        self.model.switch("direct", iterations=20)
        self.model.step(200)
        wrenches = Latest("/patch/contact_wrenches", LinkWrenches)
        self.model.step(20)
        table = wrenches.first().links[0]
        weight = self.model.status.new().total_mass * GRAVITY
        self.assertAlmostEqual(-table.wrench.force.z / weight, 1.0, delta=0.02)
        # Flat faces leave out what lies between them and the ball: chords as long as a cell's
        # diagonal sqrt(3) c lie 3 c^2 / (8 r) deep, together less than 9/8 (c/r)^2 of the volume.
        volume = 4.0 / 3.0 * np.pi * RADIUS ** 3
        cell = (12.0 * volume / TETRAHEDRA) ** (1.0 / 3.0)
        share = weight / (DENSITY * GRAVITY * volume)
        self.assertLess(share, 1.0)
        self.assertGreater(share, 1.0 - 9.0 / 8.0 * (cell / RADIUS) ** 2)
        wrenches.subscriber.unregister()

    def test_a_push_moves_it_and_a_solver_takes_over(self):
        self.model.push(force=(0.5, 0.0, 0.0), point=(0.0, 0.0, 0.04), radius=1.0, duration=-1.0)
        for solver in PROJECTIVE_SOLVERS:
            self.takes_over(solver)
        self.assertGreater(np.mean(columns(self.model.points.new())["vx"]), 0.02)

    def test_what_is_attached_hangs(self):
        # By its top, over the table that is then out of reach.
        top = (0.0, 0.0, 0.0405 + RADIUS)
        answer = self.model.hold(point=top, radius=0.5 * RADIUS, stiffness=1e3)
        self.assertTrue(answer.success, answer.message)
        self.assertFalse(self.model.hold(point=(0.0, 0.0, 9.0)).success)
        self.model.push(force=(0.3, 0.0, 0.0), point=(0.0, 0.0, 0.04), radius=1.0, duration=-1.0)
        self.model.step(100)
        held = np.mean(columns(self.model.points.new())["x"])
        self.assertTrue(self.model.detach(name="").success)
        self.model.step(100)
        self.assertGreater(np.mean(columns(self.model.points.new())["x"]), held + RADIUS)
        self.assertTrue(self.model.clear_forces().success)
        self.assertTrue(self.model.reset().success)
        self.assertAlmostEqual(np.mean(columns(self.model.points.new())["x"]), 0.0, delta=1e-3)

    def test_what_does_not_suit_is_refused(self):
        answer = self.model.switch("chebyshef")
        self.assertFalse(answer.success)
        self.assertIn("did you mean 'chebyshev'", answer.message)
        self.assertFalse(self.model.switch("newton", itertions=3).success)
        listed = {solver.name for solver in self.model.list_solvers().solvers}
        self.assertTrue(set(PROJECTIVE_SOLVERS) <= listed)


if __name__ == "__main__":
    rospy.init_node("patch_node_test")
    rostest.rosrun("pliant", "patch_node_test", PatchNodeTest, sys.argv)
