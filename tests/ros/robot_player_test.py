#!/usr/bin/python3
"""robot_player solves keyframes of a link's pose: tf then has that link there."""

import sys
import unittest

import numpy as np
import rospy
import rostest
import tf2_ros

from support import wait_until

POSITION = [0.5, 0.1, 0.25]  # of tests/ros/scenes/pose_motion.yaml [m]
# [x, y, z, w] of a turn by pi about x, then by 0.5 about z.
ROTATION = np.array([np.cos(0.25), np.sin(0.25), 0.0, 0.0])


class RobotPlayerTest(unittest.TestCase):
    def test_pose(self):
        frames = tf2_ros.Buffer()
        listener = tf2_ros.TransformListener(frames)  # noqa: F841

        def is_there():
            try:
                tool = frames.lookup_transform("base", "tool", rospy.Time(0)).transform
            except tf2_ros.TransformException:
                return False
            at, turn = tool.translation, tool.rotation
            distance = np.linalg.norm(np.array([at.x, at.y, at.z]) - POSITION)
            likeness = abs(np.dot([turn.x, turn.y, turn.z, turn.w], ROTATION))
            return distance < 1e-4 and likeness > 1.0 - 1e-6

        wait_until(is_there, "the tool at its pose")


if __name__ == "__main__":
    rospy.init_node("robot_player_test")
    rostest.rosrun("pliant", "robot_player_test", RobotPlayerTest, sys.argv)
