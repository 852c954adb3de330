#!/usr/bin/python3
"""The demo's robot lifts the cloth: it and the table carry its weight, and the robot most of it.

What moves the robot is stopped while it lowers the gripper, as a busy machine may stop it: the
simulation, which sets the time, waits. Where it is stopped for good the simulation goes on.
"""

import os
import signal
import sys
import time
import unittest
import xmlrpc.client

import numpy as np
import rosgraph
import rosnode
import rospy
import rostest

from pliant.msg import LinkWrenches
from support import Model, columns, wait_until

GRAVITY = 9.81  # [m/s^2]
ON_TABLE = 0.001  # [m]
LIFTED = 6.5  # [s] of simulated time, when the robot has been holding still for a while
AVERAGE = 0.5  # [s] of simulated time
LOWERS = 0.3  # [s] of simulated time
STANDS = 0.2  # [s] of wall time


def process_of(node):
    """The id of the process of a ROS node."""
    name = rospy.get_name()
    uri = rosnode.get_api_uri(rosgraph.Master(name), node)
    _, _, process = xmlrpc.client.ServerProxy(uri).getPid(name)
    return process


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
        player = process_of("/robot_player")
        self.stop_for_a_while(player)
        status = self.wait_for_time(LIFTED + AVERAGE, 60.0)
        self.assertFalse(status.paused, status.warnings)
        height = columns(self.model.points.new())["z"]
        self.assertTrue(np.isfinite(height).all())
        self.assertGreater(height.max(), 0.285)
        lifted = np.mean(height > ON_TABLE + 0.01)
        self.assertGreater(lifted, 0.3)
        self.assertLess(status.kinetic_energy, 1e-3)
        weight = status.total_mass * GRAVITY
        self.assertGreater(len(self.by_all), 3)
        self.assertAlmostEqual(np.mean(self.by_all) / weight, 1.0, delta=0.02)
        self.assertGreater(np.mean(self.by_robot) / weight, 0.3)
        self.stop_for_good(player)

    def stop_for_a_while(self, player):
        wait_until(lambda: rospy.get_time() >= LOWERS, "%g s of simulated time" % LOWERS)
        os.kill(player, signal.SIGSTOP)
        try:
            wait_until(self.time_stands_still, "the simulation to wait", 0.9)
        finally:
            os.kill(player, signal.SIGCONT)

    def time_stands_still(self):
        before = rospy.get_time()
        time.sleep(STANDS)
        return rospy.get_time() == before

    def stop_for_good(self, player):
        def late():
            return [text for text in self.model.status.message.warnings if "sender_stopped" in text]

        self.assertEqual(late(), [])
        os.kill(player, signal.SIGSTOP)
        try:
            wait_until(late, "a warning that the simulation goes on without it")
            self.assertIn("joint_states", late()[0])
            wait_until(lambda: not self.time_stands_still(), "the simulation to go on")
        finally:
            os.kill(player, signal.SIGCONT)
        wait_until(lambda: not late(), "the warning to go")

    def wait_for_time(self, time, patience):
        wait_until(lambda: self.model.status.message is not None
                   and self.model.status.message.sim_time >= time,
                   "%g s of simulated time" % time, patience)
        return self.model.status.message


if __name__ == "__main__":
    rospy.init_node("demo_lift_test")
    rostest.rosrun("pliant", "demo_lift_test", DemoLiftTest, sys.argv)
