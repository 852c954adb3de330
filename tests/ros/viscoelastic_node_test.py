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

    def test_a_field_is_set_near_a_point(self):
        corner = (0.02, 0.02, 0.0425)
        answer = self.model.set_near("temperature", 360.0, corner, 0.015, duration=0.05)
        self.assertTrue(answer.success, answer.message)
        before = columns(self.model.points.new())
        self.assertLess(before["beta"].max(), 1.0)
        self.model.step(12)
        after = columns(self.model.points.new())
        distance = np.linalg.norm([before[a] - c for a, c in zip("xyz", corner)], axis=0)
        near = distance < 0.015
        self.assertIn(" %d vertices" % near.sum(), answer.message)
        # Heat conducts away meanwhile, but what was set has melted, and what is far from it and
        # from the hot plate has not.
        self.assertGreater(after["beta"][near].min(), 0.9)
        far = (distance > 0.035) & (before["z"] > 0.03)
        self.assertGreater(far.sum(), 0)
        self.assertEqual(after["beta"][far].max(), 0.0)

    def test_fields_that_are_refused(self):
        for answer, words in (
                (self.model.set_near("temperatur", 300.0), ["'temperatur'", "'temperature'"]),
                (self.model.set_near("beta", 0.5), ["beta", "temperature"]),
                (self.model.set_near("temperature", -1.0), ["temperature", ">= 0"]),
                (self.model.set_near("temperature", float("nan")), ["temperature", "finite"]),
                (self.model.set_near("temperature", 300.0, radius=0.0), ["radius", "positive"]),
                (self.model.set_near("temperature", 300.0, duration=-1.0), ["duration"]),
                (self.model.set_near("temperature", 300.0, (9.0, 0.0, 0.0)), ["nearest vertex"])):
            self.assertFalse(answer.success)
            for word in words:
                self.assertIn(word, answer.message)

    def test_every_solver_takes_over(self):
        self.model.step(100)
        for solver in PROJECTIVE_SOLVERS:
            self.takes_over(solver)
        self.assertFalse(self.model.switch("trigonometric").success)


if __name__ == "__main__":
    rospy.init_node("viscoelastic_node_test")
    rostest.rosrun("pliant", "viscoelastic_node_test", ViscoelasticNodeTest, sys.argv)
