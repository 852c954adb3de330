#!/usr/bin/python3
"""Runs every command of docs/ros.md and of the ten minutes of docs/robot.md, one after the other.

What docs/ros.md says they answer is compared: an answer's lines must be found in this order, each within
a line of the output. Numbers with a decimal point may be others.
"""

import concurrent.futures
import csv
import os
import re
import signal
import subprocess
import sys
import tempfile
import unittest

import rosgraph
import rospkg
import rostest

from support import wait_until

DOCS = os.path.join(rospkg.RosPack().get_path("pliant"), "docs")
PAGE = os.path.join(DOCS, "ros.md")
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


class PageTest(unittest.TestCase):
    """Has one node or launch file, and what else runs beside it."""

    def setUp(self):
        self.running = []
        self.master = rosgraph.Master("/ros_page_test")

    def tearDown(self):
        self.stop()

    def stop(self):
        """As Ctrl-C does."""
        for process in self.running:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGINT)
                process.wait(timeout=20)
        self.running.clear()

    def run_beside(self, command, folder=None):
        self.running.append(subprocess.Popen(["bash", "-c", command], start_new_session=True,
                                             cwd=folder))

    def is_up(self, name):
        try:
            return self.master.lookupService(name + "/list_solvers")
        except rosgraph.MasterError:
            return False

    def start(self, command, folder=None):
        name = "/" + (re.findall(r"__name:=(\w+)", command) or ["pliant"])[0]
        self.stop()
        wait_until(lambda: not self.is_up(name), "the end of the node " + name)
        self.run_beside(command, folder)
        wait_until(lambda: self.is_up(name), "node " + name)


class RosPageTest(PageTest):
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


class TenMinutesTest(PageTest):
    """Your robot, your object, ten minutes: docs/robot.md."""

    def setUp(self):
        super().setUp()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        text = open(os.path.join(DOCS, "robot.md"), encoding="utf-8").read()
        section = text.split("\n## Your robot, your object, ten minutes\n")[1].split("\n## ")[0]
        names = re.findall(r"`(my_\w+\.\w+)`.*?^```(?:xml|yaml)\n(.*?)^```", section, re.M | re.S)
        self.assertEqual([name for name, _ in names],
                         ["my_robot.urdf", "my_scene.yaml", "my_motion.yaml"])
        for name, content in names:
            with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
                file.write(content)
        blocks = "".join(command for command, _ in BLOCKS.findall(section))
        self.commands = blocks.replace("\\\n", " ").splitlines()

    def output(self, command):
        done = subprocess.run(["bash", "-c", command], cwd=self.folder, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, command + "\n" + done.stdout)
        return done.stdout

    def test_section(self):
        answers = {"pliant check": self.checks, "pliant run": self.runs,
                   "roslaunch pliant": self.launches, "rostopic pub": self.moves,
                   "rosservice call": self.pushes, "rostopic echo": self.feels}
        self.assertEqual([" ".join(command.split()[:2]) for command in self.commands],
                         ["pliant check", "pliant run", "roslaunch pliant", "roslaunch pliant",
                          "rostopic pub", "rosservice call", "rostopic echo"])
        for command in self.commands:
            answers[" ".join(command.split()[:2])](command)

    def checks(self, command):
        self.assertEqual(self.output(command), "my_scene.yaml: OK\n")

    def runs(self, command):
        self.assertNotIn("warning", self.output(command))
        with open(os.path.join(self.folder, "my_run", "steps.csv")) as file:
            pressed = [float(row["finger.force_z"]) for row in csv.DictReader(file)]
        self.assertGreater(max(pressed), 0.1, "the finger presses the object down [N]")

    def launches(self, command):
        if "rviz:=true" not in command:  # at which launch_files_test.py looks
            self.start(command + " rviz:=false", self.folder)

    def moves(self, command):
        self.run_beside(command, self.folder)

    def pushes(self, command):
        # The finger is at the end of 0.25 m of arm, turned by 0.6 from a shoulder at 0.28 m.
        wait_until(lambda: "'object' at (0.206334, 0, 0.138839) m" in self.output(command),
                   "the finger where joint_states puts it")
        wait_until(lambda: self.output("rostopic echo -n1 /pliant/status/warnings") == "[]\n---\n",
                   "a status without warnings")

    def feels(self, command):
        answer = self.output(command)
        self.assertRegex(answer, 'name: "finger"\n +is_robot_link: True')


class PagesTest(unittest.TestSuite):
    def __init__(self):
        super().__init__()
        load = unittest.defaultTestLoader.loadTestsFromTestCase
        for tests in (RosPageTest, TenMinutesTest):
            self.addTests(load(tests))


if __name__ == "__main__":
    rostest.rosrun("pliant", "ros_page_test", "ros_page_test.PagesTest", sys.argv)
