#!/usr/bin/python3
"""A step that is not finite: undone, paused, ERROR with a message, and a way out."""

import sys
import unittest

import numpy as np
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

from support import Latest, Model, columns


class FailureTest(unittest.TestCase):
    def setUp(self):
        self.model = Model()
        self.diagnostics = Latest("/diagnostics", DiagnosticArray)
        self.model.clear_forces()
        self.model.reset()
        self.model.resume()

    def tearDown(self):
        self.diagnostics.subscriber.unregister()

    def level(self, level):
        array = self.diagnostics.when(
            lambda a: a.status[0].name.startswith("cloth") and a.status[0].level == level,
            "level %d" % level)
        return array.status[0].message

    def break_it(self):
        self.assertTrue(self.model.push(force=(0.0, 0.0, 1e12), duration=-1.0).success)
        self.model.status.when(lambda s: s.paused, "a pause")

    def test_report(self):
        self.level(DiagnosticStatus.OK)
        self.break_it()
        message = self.level(DiagnosticStatus.ERROR)
        for word in ("vertex", "undone", "Try a time step"):
            self.assertIn(word, message)
        self.assertIn(message, self.model.status.new().warnings)
        for name, values in columns(self.model.points.new()).items():
            self.assertTrue(name == "rgb" or np.isfinite(values).all(), name)

    def test_it_fails_again_until_the_cause_is_gone(self):
        self.break_it()
        before = self.model.points.new().data
        for answer in (self.model.resume(), self.model.step(10)):
            self.assertFalse(answer.success)
            self.assertIn("vertex", answer.message)
        self.assertEqual(self.model.points.new().data, before)
        self.assertTrue(self.model.clear_forces().success)
        answer = self.model.step(1)
        self.assertTrue(answer.success, answer.message)
        self.assertTrue(self.model.resume().success)
        self.level(DiagnosticStatus.OK)

    def test_reset_mends(self):
        self.break_it()
        self.assertTrue(self.model.reset().success)
        self.assertTrue(self.model.resume().success)
        self.model.status.when(lambda s: s.step > 3 and not s.paused, "steps")
        self.level(DiagnosticStatus.OK)

    def test_another_solver_mends(self):
        """Verlet blows up where it may not take this step in substeps; xpbd does not."""
        self.assertTrue(self.model.switch("verlet", max_substeps=1).success)
        self.model.status.when(lambda s: s.paused, "a pause")
        self.level(DiagnosticStatus.ERROR)
        self.assertTrue(self.model.switch("xpbd", iterations=100).success)
        self.model.reset()
        answer = self.model.resume()
        self.assertTrue(answer.success, answer.message)
        self.level(DiagnosticStatus.OK)


if __name__ == "__main__":
    rospy.init_node("failure_test")
    rostest.rosrun("pliant", "failure_test", FailureTest, sys.argv)
