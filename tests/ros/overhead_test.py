#!/usr/bin/python3
"""What a node of 2,500 vertices costs on top of its simulation, in CPU time; prints the figures."""

import os
import sys
import time
import unittest

import rosgraph
import rospy
import rostest
from sensor_msgs.msg import PointCloud2
from visualization_msgs.msg import Marker
from xmlrpc.client import ServerProxy

from support import Latest, Model, wait_until

SECONDS = 4.0
MAX_SHARE = 0.05  # of one core, or of the steps' own time


def cpu_seconds(pid):
    with open("/proc/%d/stat" % pid) as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class OverheadTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        uri = rosgraph.Master("/overhead_test").lookupNode("/cloth")
        cls.pid = ServerProxy(uri).getPid("/overhead_test")[2]
        cls.model = Model()
        cls.model.pause()
        cls.model.points.subscriber.unregister()

    def test_publishing(self):
        """Surface and points at 30 Hz, to one subscriber each."""
        idle = self.share()
        surface = Latest("/cloth/surface", Marker)
        points = Latest("/cloth/points", PointCloud2)
        surface.first()
        points.first()
        count = surface.count, points.count
        busy = self.share()
        rates = [(now - then) / SECONDS for now, then in zip((surface.count, points.count), count)]
        surface.subscriber.unregister()
        points.subscriber.unregister()
        print("publishing surface at %.1f Hz and points at %.1f Hz: %.1f %% of a core" %
              (rates[0], rates[1], 100 * (busy - idle)))
        self.assertEqual(points.message.width, 2500)
        for rate in rates:
            self.assertGreater(rate, 25.0)
        self.assertLess(busy - idle, MAX_SHARE)

    def share(self):
        start, before = time.monotonic(), cpu_seconds(self.pid)
        time.sleep(SECONDS)
        return (cpu_seconds(self.pid) - before) / (time.monotonic() - start)

    def test_steps_through_the_service(self):
        """1000 steps by ~step against the time that World::step took."""
        self.model.reset()
        stepping = [0.0, 0]  # sum of step times [s], last step
        self.model.status.callback = lambda s: self.add(stepping, s)
        start = time.monotonic()
        answer = self.model.step(1000)
        wall = time.monotonic() - start
        self.assertTrue(answer.success, answer.message)
        wait_until(lambda: stepping[1] == 1000, "the last status")
        print("1000 steps: %.3f s through the service, %.3f s in the library: %+.1f %%" %
              (wall, stepping[0], 100 * (wall / stepping[0] - 1)))
        self.assertLess(wall / stepping[0], 1.0 + MAX_SHARE)

    @staticmethod
    def add(stepping, status):
        stepping[0] += status.step_time * (status.step - stepping[1])
        stepping[1] = status.step


if __name__ == "__main__":
    rospy.init_node("overhead_test")
    rostest.rosrun("pliant", "overhead_test", OverheadTest, sys.argv)
