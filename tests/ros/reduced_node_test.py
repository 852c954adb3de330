#!/usr/bin/python3
"""A reduced body in a node: its services, fields, energies and solvers."""

import math
import sys

import numpy as np
import rospy
import rostest

from support import ModelTest, columns


class ReducedNodeTest(ModelTest):
    node = "/reduced"
    solver = "trigonometric"

    def fields(self):
        return columns(self.model.points.new())

    def metric(self, status, name):
        return status.metric_values[status.metrics.index(name)]

    def test_fields_are_finite(self):
        self.model.step(100)
        fields = self.fields()
        self.assertTrue({"x", "y", "z", "vx", "displacement", "von_mises"} <= set(fields))
        for name, values in fields.items():
            self.assertTrue(name == "rgb" or np.isfinite(values).all(), name)
        self.assertGreater(fields["displacement"].max(), 0.02)
        self.assertEqual(fields["displacement"].min(), 0.0)
        self.assertGreater(fields["von_mises"].max(), 1e3)

    def test_energies(self):
        self.model.step(50)
        status = self.model.status.new()
        self.assertEqual((status.model, status.solver), ("reduced", "trigonometric"))
        self.assertGreater(status.kinetic_energy, 0.0)
        self.assertGreater(status.elastic_energy, 0.0)
        high = self.metric(status, "high_frequency_energy")
        self.assertTrue(0.0 <= high <= status.kinetic_energy + status.elastic_energy, high)

    def test_contact_carries_the_beam(self):
        self.model.step(1000)
        self.assertGreater(self.model.status.new().contacts, 0)

    def test_force_moves_it(self):
        answer = self.model.push(force=(0.0, 200.0, 0.0), point=(1.0, 0.0, 0.5), radius=0.1,
                                 duration=-1.0)
        self.assertTrue(answer.success, answer.message)
        self.model.step(10)
        self.assertGreater(float(np.max(self.fields()["vy"])), 0.05)

    def test_attached_and_let_go(self):
        # The beam's end falls by more than 2 cm in 100 steps (test_fields_are_finite).
        answer = self.model.hold(point=(1.0, 0.0, 0.5), radius=0.1, stiffness=1e6, name="hook")
        self.assertTrue(answer.success, answer.message)
        self.assertIn("'hook' holds", answer.message)
        before = self.fields()
        self.model.step(100)
        self.assertIn("attachment", self.model.status.new().effects)
        end = before["x"] > 0.95
        self.assertTrue(end.any())
        self.assertLess(float(np.max(np.abs(self.fields()["z"] - before["z"])[end])), 1e-3)
        answer = self.model.detach(name="hook")
        self.assertTrue(answer.success, answer.message)
        self.model.step(100)
        self.assertGreater(float(np.min(np.abs(self.fields()["z"] - before["z"])[end])), 0.01)

    def test_reset(self):
        before = self.model.points.new().data
        self.model.step(20)
        self.assertNotEqual(self.model.points.new().data, before)
        self.model.reset()
        self.assertEqual(self.model.points.new().data, before)

    def test_step_counts(self):
        answer = self.model.step(7)
        self.assertTrue(answer.success, answer.message)
        self.assertAlmostEqual(answer.sim_time, 0.028)

    def test_solvers_are_swapped_in_motion(self):
        names = [solver.name for solver in self.model.list_solvers().solvers]
        self.assertEqual(set(names), {"trigonometric", "imex_thesis", "newmark", "midpoint",
                                      "stoermer_verlet", "reference"})
        for name in ("newmark", "midpoint", "trigonometric"):
            self.model.step(20)
            before = self.model.points.new().data
            answer = self.model.switch(name)
            self.assertTrue(answer.success, answer.message)
            self.assertEqual(self.model.list_solvers().current, name)
            self.assertEqual(self.model.points.new().data, before)
            self.model.step(1)
            self.assertEqual(self.model.status.new().solver, name)
        self.assertTrue(all(math.isfinite(v) for v in self.fields()["z"]))

    def test_bad_solvers_are_refused(self):
        for name, words in (("xpbd", ["does not work for model 'reduced'", "trigonometric"]),
                            ("midpiont", ["did you mean 'midpoint'"])):
            answer = self.model.switch(name)
            self.assertFalse(answer.success)
            for word in words:
                self.assertIn(word, answer.message)
        self.assertEqual(self.model.list_solvers().current, "trigonometric")


if __name__ == "__main__":
    rospy.init_node("reduced_node_test")
    rostest.rosrun("pliant", "reduced_node_test", ReducedNodeTest, sys.argv)
