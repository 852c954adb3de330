#!/usr/bin/python3
"""The demo's robot lifts the cloth: it and the table carry its weight, and the robot most of it."""

import sys
import unittest

import numpy as np
import rospy
import rostest

from pliant.msg import LinkWrenches
from support import Model, columns, wait_until

GRAVITY = 9.81  # [m/s^2]
LIFTED = 6.5  # [s] of simulated time, when the robot has been holding still for a while
AVERAGE = 0.5  # [s] of simulated time


class DemoLiftTest(unittest.TestCase):
    def setUp(self):
        self.model = Model()
        self.by_robot = []  # [N], upward
        self.by_all = []  # [N], upward: by the robot and the table
        self.wrenches = rospy.Subscriber("/cloth/contact_wrenches", LinkWrenches, self.on_wrenches)

    def on_wrenches(self, message):
        # The frames of the gripper and of the table are not turned against the world's. What carries
        # the cloth is pulled down; the table, to which the wet cloth sticks, is pulled up.
        time = message.header.stamp.to_sec()
        if LIFTED <= time < LIFTED + AVERAGE:
            self.by_robot.append(-sum(link.wrench.force.z for link in message.links
                                      if link.is_robot_link))
            self.by_all.append(-sum(link.wrench.force.z for link in message.links))

    def test_lift(self):
        start = columns(self.model.points.first())["z"].max()
        status = self.wait_for_time(LIFTED + AVERAGE, 60.0)
        self.assertFalse(status.paused, status.warnings)
        height = columns(self.model.points.new())["z"]
        self.assertTrue(np.isfinite(height).all())
        self.assertGreater(height.max(), start + 0.15)
        lifted = np.mean(height > start + 0.01)
        self.assertGreater(lifted, 0.3)
        self.assertLess(status.kinetic_energy, 1e-3)
        weight = status.total_mass * GRAVITY
        self.assertGreater(len(self.by_all), 3)
        self.assertAlmostEqual(np.mean(self.by_all) / weight, 1.0, delta=0.02)
        self.assertGreater(np.mean(self.by_robot) / weight, 0.3)

    def wait_for_time(self, time, patience):
        wait_until(lambda: self.model.status.message is not None
                   and self.model.status.message.sim_time >= time,
                   "%g s of simulated time" % time, patience)
        return self.model.status.message


if __name__ == "__main__":
    rospy.init_node("demo_lift_test")
    rostest.rosrun("pliant", "demo_lift_test", DemoLiftTest, sys.argv)
