#!/usr/bin/python3
"""The viscoelastic node: a block that melts on a hot plate."""

import sys

import numpy as np
import rospy
import rostest
from visualization_msgs.msg import Marker

from pliant.msg import LinkWrenches
from support import Latest, ModelTest, PROJECTIVE_SOLVERS, columns

GRAVITY = 9.81  # [m/s^2]


class ViscoelasticNodeTest(ModelTest):
    node = "/viscoelastic"
    solver = "jacobi"
    parameters = {"iterations": 10}

    def test_it_melts_and_the_surface_follows(self):
        fields = columns(self.model.points.new())
        for name in ("beta", "temperature", "density", "clusters"):
            self.assertIn(name, fields)
            self.assertTrue(np.isfinite(fields[name]).all(), name)
        np.testing.assert_allclose(fields["beta"], 0.0)
        np.testing.assert_allclose(fields["temperature"], 290.0, rtol=1e-6)
        self.assertGreater(fields["clusters"].min(), 0.0)
        surface = Latest("/viscoelastic/surface", Marker)
        before = surface.first()
        self.assertGreater(len(before.points), 100)
        self.assertEqual(len(before.points), len(before.colors))
        self.model.step(400)
        melted = columns(self.model.points.new())
        self.assertGreater(melted["beta"].max(), 0.9)
        self.assertLess(melted["z"].max(), 0.9 * fields["z"].max())
        # What is liquid belongs to no cluster (these follow within 0.02 s).
        self.assertEqual(melted["clusters"][melted["beta"] == 1.0].min(), 0.0)
        surface.message = None
        after = surface.first()
        self.assertEqual(len(after.points), len(after.colors))
        z = np.array([point.z for point in after.points])
        self.assertTrue(np.isfinite(z).all())
        self.assertLess(z.max(), 0.9 * max(point.z for point in before.points))
        surface.subscriber.unregister()

    def test_the_plate_carries_it(self):
        self.model.step(200)
        wrenches = Latest("/viscoelastic/contact_wrenches", LinkWrenches)
        self.model.step(40)
        plate = wrenches.first().links[0]
        weight = self.model.status.new().total_mass * GRAVITY
        self.assertAlmostEqual(-plate.wrench.force.z / weight, 1.0, delta=0.1)
        wrenches.subscriber.unregister()

    def test_every_solver_takes_over(self):
        self.model.step(100)
        for solver in PROJECTIVE_SOLVERS:
            self.takes_over(solver)
        self.assertFalse(self.model.switch("imex").success)


if __name__ == "__main__":
    rospy.init_node("viscoelastic_node_test")
    rostest.rosrun("pliant", "viscoelastic_node_test", ViscoelasticNodeTest, sys.argv)
