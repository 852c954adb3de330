#!/usr/bin/python3
"""Runs every command of docs/ros.md, one after the other, and compares what the page says they answer.

An answer's lines must be found in this order, each within a line of the output. Numbers with a decimal
point may be others.
"""

import concurrent.futures
import os
import re
import signal
import subprocess
import sys
import unittest

import rosgraph
import rospkg
import rostest

from support import wait_until

PAGE = os.path.join(rospkg.RosPack().get_path("pliant"), "docs/ros.md")
BLOCKS = re.compile(r"^```sh\n(.*?)^```\n(?:^```text\n(.*?)^```\n)?", re.M | re.S)
DECIMAL = re.compile(r"-?\d+\.\d+")
ANY_NUMBER = r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?"


def starts_a_node(command):
    return command.startswith("rosrun pliant pliant_node ") and "_scene:=" in command


def missing_line(answer, output):
    """The first line of an answer that the output does not have in its place; None: it has all."""
    lines = iter(output.splitlines())
    for line in filter(None, (line.strip() for line in answer.splitlines())):
        pattern = re.compile(ANY_NUMBER.join(re.escape(part) for part in DECIMAL.split(line)))
        if not any(pattern.search(found) for found in lines):
            return line
    return None


class RosPageTest(unittest.TestCase):
    def setUp(self):
        self.node = None
        self.master = rosgraph.Master("/ros_page_test")

    def tearDown(self):
        self.stop()

    def stop(self):
        """As Ctrl-C does."""
        if self.node:
            os.killpg(self.node.pid, signal.SIGINT)
            self.node.wait(timeout=10)

    def start(self, command):
        name = "/" + (re.findall(r"__name:=(\w+)", command) or ["pliant"])[0]
        self.stop()
        self.node = subprocess.Popen(["bash", "-c", command], start_new_session=True)

        def is_up():
            try:
                return self.master.lookupService(name + "/list_solvers")
            except rosgraph.MasterError:
                return False
        wait_until(is_up, "node " + name)

    @staticmethod
    def run_command(block):
        command, answer = block
        done = subprocess.run(["bash", "-c", command], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=40)
        missing = missing_line(answer, done.stdout)
        if done.returncode != 0:
            return "%s\nexit code %d:\n%s" % (command, done.returncode, done.stdout)
        if missing is not None:
            return "%s\n'%s' is not in its place:\n%s" % (command, missing, done.stdout[:4000])
        return None

    def test_page(self):
        blocks = BLOCKS.findall(open(PAGE, encoding="utf-8").read())
        self.assertGreater(len(blocks), 20)
        together = []  # commands that only look

        def run_together():
            with concurrent.futures.ThreadPoolExecutor(3) as pool:
                errors = [error for error in pool.map(self.run_command, together) if error]
            together.clear()
            self.assertFalse(errors, "\n\n".join(errors))

        for command, answer in blocks:
            if starts_a_node(command):
                self.start(command)
                continue
            self.assertTrue(answer, "the page does not say what it answers: " + command)
            looks = command.startswith(("rostopic echo ", "rosrun "))
            if not looks:
                run_together()
            together.append((command, answer))
            if not looks:
                run_together()
        run_together()

    def test_every_service_and_topic_is_there(self):
        """What the nodes have is what the page runs, and nothing is left out."""
        text = open(PAGE, encoding="utf-8").read()
        commands = "".join(command for command, _ in BLOCKS.findall(text))
        services = [name[:-4] for name in os.listdir(os.path.dirname(PAGE) + "/../srv")]
        names = [re.sub(r"(?<!^)(?=[A-Z])", "_", service).lower() for service in services]
        for name in names + ["pause", "resume", "reset"]:
            self.assertIn("rosservice call /pliant/" + name, commands)
        for topic in ("status", "surface", "points", "mesh/topology", "mesh/points", "contacts",
                      "contact_wrenches", "wrench/plate", "markers"):
            self.assertRegex(commands, "rostopic echo .*/pliant/" + topic)


if __name__ == "__main__":
    rostest.rosrun("pliant", "ros_page_test", RosPageTest, sys.argv)
