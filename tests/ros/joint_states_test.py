#!/usr/bin/python3
"""The robot's obstacles follow joint_states smoothly; what is not finite or fits not is refused."""

import math
import sys
import time
import unittest

import rospy
import rostest
from sensor_msgs.msg import JointState
from visualization_msgs.msg import MarkerArray

from pliant.msg import LinkWrenches
from support import Latest, Model, wait_until

PALM = 2  # its marker, after those of the table and the wrist
PALM_ABOVE_TOOL = 0.095  # [m] in gripper.urdf


class JointStatesTest(unittest.TestCase):
    def setUp(self):
        self.model = Model()
        self.heights = []
        self.joints = rospy.Publisher("joint_states", JointState, queue_size=10)
        self.markers = rospy.Subscriber("/cloth/markers", MarkerArray, self.on_markers)
        wait_until(lambda: self.joints.get_num_connections() > 0, "the node's subscription")

    def on_markers(self, array):
        for marker in array.markers:
            if marker.ns == "obstacles" and marker.id == PALM:
                self.heights.append(marker.pose.position.z - PALM_ABOVE_TOOL)

    def send(self, names, positions):
        message = JointState(name=names, position=positions)
        message.header.stamp = rospy.Time.now()
        self.joints.publish(message)

    def wait_for_height(self, height):
        wait_until(lambda: self.heights and abs(self.heights[-1] - height) < 1e-6,
                   "palm at %g" % height)

    def test_motion(self):
        # At the start it is put where the joints are.
        self.send(["gantry_z"], [0.2])
        self.wait_for_height(0.2)
        self.assertEqual(self.model.status.new().step, 0)

        # Later it moves there.
        self.model.resume()
        del self.heights[:]
        self.send(["gantry_z"], [0.1])
        self.wait_for_height(0.1)
        between = [h for h in self.heights if 0.105 < h < 0.195]
        self.assertGreater(len(between), 3, self.heights)
        self.assertEqual(sorted(self.heights, reverse=True), self.heights)

        # A joint that a message does not name stays; one that the robot lacks is left out.
        self.send(["gantry_x", "wheel"], [0.05, 1.0])
        time.sleep(0.4)
        self.wait_for_height(0.1)

        for names, positions in ((["gantry_z"], [math.nan]), (["gantry_z"], [math.inf]),
                                 (["gantry_z"], [1e300]), (["gantry_z", "gantry_y"], [0.2]),
                                 ([], [0.2])):
            self.send(names, positions)
        time.sleep(0.4)
        # All is sent again from time to time.
        count = len(self.heights)
        wait_until(lambda: len(self.heights) > count, "further markers")
        self.assertAlmostEqual(self.heights[-1], 0.1)

        self.send(["gantry_z"], [0.15])
        self.wait_for_height(0.15)

    def test_wrenches_name_the_links(self):
        wrenches = Latest("/cloth/contact_wrenches", LinkWrenches)
        links = {link.name: link.is_robot_link for link in wrenches.first().links}
        self.assertEqual(links, {"wrist_link": True, "palm": True, "left_finger": True,
                                 "right_finger": True, "table": False})


if __name__ == "__main__":
    rospy.init_node("joint_states_test")
    rostest.rosrun("pliant", "joint_states_test", JointStatesTest, sys.argv)
