#!/usr/bin/python3
"""Two publishers of /clock hear of each other, and no longer once one of them is gone."""

import sys
import unittest

import rosnode
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

from support import Latest, wait_until


class SecondClockTest(unittest.TestCase):
    def setUp(self):
        self.latest = {}
        self.diagnostics = Latest("/diagnostics", DiagnosticArray, callback=self.take,
                                  queue_size=10)

    def take(self, array):
        for status in array.status:
            self.latest[status.name] = status

    def wait_for_level(self, node, level):
        name = node + ": ROS"
        wait_until(lambda: name in self.latest and self.latest[name].level == level,
                   "%s at level %d" % (name, level[0] if isinstance(level, bytes) else level))
        return self.latest[name].message

    def test_both_are_told(self):
        for node, other in (("cloth", "/other"), ("other", "/cloth")):
            message = self.wait_for_level(node, DiagnosticStatus.WARN)
            self.assertIn(other + " publishes /clock as this node does", message)
            self.assertIn("_publish_clock:=false", message)
        self.wait_for_level("innocent", DiagnosticStatus.OK)
        rosnode.kill_nodes(["/other"])
        self.wait_for_level("cloth", DiagnosticStatus.OK)


if __name__ == "__main__":
    rospy.init_node("second_clock_test")
    rostest.rosrun("pliant", "second_clock_test", SecondClockTest, sys.argv)
