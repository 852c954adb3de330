#!/usr/bin/python3
"""A node outlives its ROS master, and registers its topics and services with the next one."""

import os
import signal
import socket
import subprocess
import sys
import tempfile
import unittest

import rosgraph
import rospkg
import rostest

from support import wait_until

SCENE = os.path.join(rospkg.RosPack().get_path("pliant"), "tests/ros/scenes/hanging.yaml")
SERVICES = ["apply_force", "attach", "clear_forces", "detach", "list_solvers", "pause", "reset",
            "resume", "set_field", "step", "switch_solver", "get_loggers", "set_logger_level"]
TOPICS = ["surface", "points", "markers", "contacts", "contact_wrenches", "status", "mesh/points",
          "mesh/topology", "wrench/ball", "wrench/ground"]


def free_port():
    with socket.socket() as any_socket:
        any_socket.bind(("127.0.0.1", 0))
        return any_socket.getsockname()[1]


class MasterRestartTest(unittest.TestCase):
    def setUp(self):
        self.processes = []
        self.port = free_port()
        uri = "http://127.0.0.1:%d" % self.port
        self.environment = dict(os.environ, ROS_MASTER_URI=uri, ROS_HOSTNAME="127.0.0.1",
                                PYTHONUNBUFFERED="1")
        self.master = rosgraph.Master("/master_restart_test", master_uri=uri)

    def tearDown(self):
        for process in reversed(self.processes):
            if process.poll() is None:
                process.kill()
            process.wait()

    def start(self, *command, **options):
        self.processes.append(subprocess.Popen(command, env=self.environment, **options))
        return self.processes[-1]

    def start_master(self):
        master = self.start("rosmaster", "--core", "-p", str(self.port))
        wait_until(self.master.is_online, "a master")
        return master

    def has_service(self, name):
        try:
            return self.master.lookupService("/cloth/" + name)
        except rosgraph.MasterError:
            return None

    def run_tool(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True,
                              timeout=30).stdout

    def test_node_registers_again(self):
        first = self.start_master()
        log = tempfile.TemporaryFile("w+")
        node = self.start("rosrun", "pliant", "cloth_node", "__name:=cloth", "_scene:=" + SCENE,
                          stdout=log, stderr=log)
        wait_until(lambda: self.has_service("pause"), "the node's services")
        heard = self.start("rostopic", "echo", "-p", "/cloth/status/step", stdout=subprocess.PIPE,
                           text=True)
        heard.stdout.readline()
        before = dict(self.master.getTopicTypes())

        first.send_signal(signal.SIGKILL)
        first.wait()
        wait_until(lambda: not self.master.is_online(), "no master")
        # Who is connected goes on hearing.
        for _ in range(20):
            self.assertTrue(heard.stdout.readline())
        self.start_master()
        wait_until(lambda: self.has_service("set_logger_level"), "services at the new master", 30.0)

        for service in SERVICES:
            self.assertTrue(self.has_service(service), service)
        after = dict(self.master.getTopicTypes())
        for topic in TOPICS:
            topic = "/cloth/" + topic
            self.assertEqual(after[topic], before[topic])
        for topic in ("/diagnostics", "/tf", "/tf_static"):
            self.assertIn(topic, after)
        subscribed = dict(self.master.getSystemState()[1])
        self.assertIn("/cloth", subscribed["/tf"])
        self.assertIn("success: True", self.run_tool("rosservice", "call", "/cloth/pause"))
        self.assertIn("paused: True", self.run_tool("rostopic", "echo", "-n1", "/cloth/status"))
        self.assertTrue(heard.stdout.readline(), "who was connected still is")
        self.assertIsNone(node.poll())
        log.seek(0)
        text = log.read()
        self.assertEqual(text.count("does not answer"), 1, text)
        self.assertEqual(text.count("the ROS master came back"), 1, text)


if __name__ == "__main__":
    rostest.rosrun("pliant", "master_restart_test", MasterRestartTest, sys.argv)
