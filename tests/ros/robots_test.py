#!/usr/bin/python3
"""Robots of a node: prefixes, a base and a floating joint that follow tf, link frames, warnings."""

import sys
import time
import unittest

import rospy
import rostest
import tf2_ros
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import JointState
from visualization_msgs.msg import MarkerArray

from support import Model, wait_until

HAND, BOX = 0.11, 0.12  # widths by which the robots' cylinders are told apart [m]


class RobotsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.model = Model("/robots")
        cls.boxes = {}
        cls.hand_path = []  # x of the hand in all markers
        cls.diagnostics = {}
        cls.joints = rospy.Publisher("joint_states", JointState, queue_size=10)
        cls.tf = tf2_ros.TransformBroadcaster()
        cls.subscribers = [rospy.Subscriber("/robots/markers", MarkerArray, cls.on_markers),
                           rospy.Subscriber("/diagnostics", DiagnosticArray, cls.on_diagnostics)]
        wait_until(lambda: cls.joints.get_num_connections() > 0
                   and cls.tf.pub_tf.get_num_connections() > 1, "the nodes' subscriptions")

    @classmethod
    def on_markers(cls, array):
        for marker in array.markers:
            if marker.ns == "obstacles":
                at = marker.pose.position
                width = round(marker.scale.x, 3)
                cls.boxes[width] = (at.x, at.y, at.z)
                if width == HAND:
                    cls.hand_path.append(at.x)

    @classmethod
    def on_diagnostics(cls, array):
        for status in array.status:
            cls.diagnostics[status.name] = status

    def send(self, **positions):
        self.joints.publish(JointState(name=list(positions), position=list(positions.values())))

    def put(self, parent, child, position):
        transform = TransformStamped(child_frame_id=child)
        transform.header.frame_id = parent
        transform.header.stamp = rospy.Time.now()
        at = transform.transform.translation
        at.x, at.y, at.z = position
        transform.transform.rotation.w = 1.0
        self.tf.sendTransform(transform)

    def wait_for_box(self, width, position):
        def is_there():
            at = self.boxes.get(width)
            return at and all(abs(a - b) < 1e-6 for a, b in zip(at, position))
        wait_until(is_there, "box of %g m at %s, not %s" % (width, position, self.boxes.get(width)))

    def told(self):
        """Warnings of ~status, and the node's diagnostics."""
        diagnostics = self.diagnostics.get("robots: scene")
        text = "\n".join(self.model.status.new().warnings)
        return text, diagnostics.message if diagnostics else ""

    def wait_until_told(self, *words):
        wait_until(lambda: all(word in text for text in self.told() for word in words),
                   "%s among %s" % (words, self.told()))

    def test_1_what_tf_does_not_know_is_told_until_it_comes(self):
        self.send(a_lift=0.1)
        self.put("world", "cart", (1, 0, 0))
        self.wait_until_told("robot_input: robot 'free_box': floating joint 'b_floats'",
                             "tf knows no frame 'b_base'")
        self.wait_for_box(HAND, (1, 0, 0.6))
        self.wait_for_box(BOX, (0, 3, 0))
        self.put("b_base", "b_box", (0, 0, 2))
        self.wait_for_box(BOX, (0, 3, 2))
        wait_until(lambda: not any("robot_input" in text for text in self.told()), "tf is there")

    def test_2_base_and_joint_move_evenly(self):
        del self.hand_path[:]
        self.put("world", "cart", (1.5, 0, 0))
        self.wait_for_box(HAND, (1.5, 0, 0.6))
        path = list(self.hand_path)
        self.assertGreater(len([x for x in path if 1.01 < x < 1.49]), 2, path)
        self.assertEqual(path, sorted(path))

    def test_3_a_link_without_shape_is_a_frame_without_tf(self):
        answer = self.model.push((0, 0, 1), frame="a_tip", radius=0.05, point=(0, 0, 4.4))
        self.assertIn("at (1.7, 0, 5) m", answer.message)
        self.assertFalse(self.model.push((0, 0, 1), frame="a_tipp").success)
        self.assertIn("did you mean 'a_tip'?", self.model.push(frame="a_tipp").message)
        held = self.model.hold((-1.5, 0, 4.4), frame="a_hand", name="held", radius=0.2)
        self.assertTrue(held.success, held.message)
        self.model.detach("held", "")

    def test_4_joints_that_no_robot_has_are_told(self):
        self.send(a_lift=0.1, a_lfit=0.2, lift=0.4, a_follower=0.1)
        self.wait_until_told("unknown_joint: joint_states names joint 'a_lfit'",
                             "did you mean 'a_lift'?", "names joint 'lift'")
        self.wait_for_box(HAND, (1.5, 0, 0.6))

    def test_5_limits_and_jumps_are_told(self):
        self.assertFalse(any("joint_jump" in text or "joint_limit" in text for text in self.told()))
        self.send(a_lift=0.9)
        self.wait_for_box(HAND, (1.5, 0, 1.4))
        self.wait_until_told("joint_limit: joint 'a_lift'", "limits 0 to 0.5",
                             "joint_jump: joint 'a_lift' moved at", "allows 1 m/s")

    def test_6_a_description_without_a_robot_is_told(self):
        wait_until(lambda: "no_robot: scene" in self.diagnostics, "diagnostics")
        status = self.diagnostics["no_robot: scene"]
        self.assertEqual(status.level, 1)
        self.assertIn("'robot_description', but the scene has no 'robot'", status.message)

    def test_7_joints_that_no_message_names_are_told(self):
        self.wait_until_told("missing_joint", "'a_grip' (only 'a_follower', which mimics it)")


if __name__ == "__main__":
    rospy.init_node("robots_test")
    rostest.rosrun("pliant", "robots_test", RobotsTest, sys.argv)
