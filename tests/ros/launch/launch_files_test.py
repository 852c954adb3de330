#!/usr/bin/python3
"""Every launch file starts, shows what it is for, and stops clean.

rviz runs on a virtual display with its panel of displays open, where the name of a display that has
an error is red. What it draws is judged by its colours: enough of each body's, enough of the
table's, not too much of the background's. A configuration with planted faults is found.
"""

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import rosbag
import yaml

ROOT = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), *3 * [os.pardir]))
CONFIG = os.path.join(ROOT, "config")
WIDTH, HEIGHT = 1000, 560
PANEL = 330  # [pixels] on the left, where the names of displays are
PATIENCE = 90.0  # [s] of wall time until rviz shows everything
STOPPING = 25.0  # [s] from an interrupt to the end of all processes
ERROR_COLOR = (178, 23, 46)  # of the name of a display with an error
BACKGROUND = (226, 234, 242)

MIN_BODIES = 0.012  # share of the picture that has a body's hue, of all bodies together
MIN_TABLE = 0.05  # share that has the table's hue
MAX_BACKGROUND = 0.9
MIN_RED = 60  # pixels: a short word in red has more, icons have some

DEMOS = {"all": "demo", "cloth": "demo_cloth", "patch": "demo_patch", "reduced": "demo_reduced",
         "viscoelastic": "demo_viscoelastic"}
# Launch files that show nothing unless asked to.
# By SIGABRT or SIGSEGV.
RVIZ_CRASHED = re.compile(r"has died \[pid \d+, exit code -(6|11), cmd \S*/rviz/rviz ")
WITHOUT_RVIZ = ["cloth.launch", "patch.launch", "reduced.launch", "viscoelastic.launch"]


PORTS = set()  # that were given out: a system gives a port again that nobody listens to yet
PORTS_LOCK = threading.Lock()


def free_port():
    while True:
        with socket.socket() as s:
            s.bind(("127.0.0.1", 0))
            port = s.getsockname()[1]
        with PORTS_LOCK:
            if port not in PORTS:
                PORTS.add(port)
                return port


def count_near(picture, color, within):
    return int((np.abs(picture.astype(int) - color).max(axis=2) <= within).sum())


def share_of_hue(picture, color):
    """Share of the pixels that have the colour's hue, however bright they are."""
    pixels = picture.reshape(-1, 3).astype(float)
    chroma = pixels - pixels.mean(axis=1, keepdims=True)
    wanted = np.asarray(color, float) - np.mean(color)
    norms = np.linalg.norm(chroma, axis=1) * np.linalg.norm(wanted) + 1e-9
    is_colored = np.linalg.norm(chroma, axis=1) > 12.0
    return float(((chroma @ wanted / norms > 0.97) & is_colored).mean())


class Display:
    """A virtual X display."""

    def __init__(self, folder):
        number = self.start()
        if not number:
            raise AssertionError("Xvfb did not start")
        self.environment = {"DISPLAY": ":" + number, "LIBGL_ALWAYS_SOFTWARE": "1",
                            "QT_QPA_PLATFORM": "xcb", "XDG_RUNTIME_DIR": folder}

    def start(self):
        """Its number; empty when it ended at once. It goes on when its last client leaves."""
        read, write = os.pipe()
        self.process = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", "%dx%dx24" % (WIDTH, HEIGHT),
             "+extension", "GLX", "-nolisten", "tcp", "-noreset"], pass_fds=[write],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(write)
        # To the end of the line: Xvfb writes it in two pieces, and ends where it cannot.
        with os.fdopen(read) as line:
            return line.readline().strip()

    def picture(self):
        """Height x width x 3 bytes; None where X did not answer."""
        done = subprocess.run(["import", "-window", "root", "-depth", "8", "rgb:-"],
                              env=dict(os.environ, **self.environment), stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, timeout=30)
        if len(done.stdout) != WIDTH * HEIGHT * 3:
            return None
        return np.frombuffer(done.stdout, np.uint8).reshape(HEIGHT, WIDTH, 3)

    def stop(self):
        self.process.terminate()
        self.process.wait()


class Launch:
    """A roslaunch with a master of its own."""

    def __init__(self, file, arguments, folder, environment=None):
        self.uri = "http://127.0.0.1:%d" % free_port()
        self.log = tempfile.NamedTemporaryFile(dir=folder, suffix=".log", delete=False)
        self.name = " ".join([file] + arguments)
        # A group of its own, so that an interrupt reaches roslaunch alone.
        self.process = subprocess.Popen(
            ["roslaunch", "pliant", file] + arguments, stdin=subprocess.DEVNULL, stdout=self.log,
            stderr=subprocess.STDOUT, start_new_session=True,
            env=dict(os.environ, ROS_MASTER_URI=self.uri, **(environment or {})))

    def output(self):
        with open(self.log.name, errors="replace") as file:
            return file.read()

    def nodes_left(self):
        """Processes that have this master in their environment."""
        left = []
        for pid in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open("/proc/%s/environ" % pid, "rb") as file:
                    if ("ROS_MASTER_URI=" + self.uri).encode() not in file.read().split(b"\0"):
                        continue
                with open("/proc/%s/cmdline" % pid, "rb") as file:
                    left.append(file.read().replace(b"\0", b" ").decode()[:100])
            except OSError:
                pass  # ended meanwhile, or another user's
        return left

    def problems(self):
        """Of its run so far: what ended by itself, and errors that nodes told."""
        found = re.findall(r".*(?:\[ *(?:ERROR|FATAL)\]|has died|RLException|Traceback).*",
                           self.output())
        if self.process.poll() is not None:
            found.append("roslaunch ended with %d; its output:\n%s" % (self.process.returncode, self.output()[-3000:]))
        return found

    def stop(self):
        """Interrupts it, as Ctrl-C does; what is wrong with its end."""
        self.process.send_signal(signal.SIGINT)
        try:
            code = self.process.wait(STOPPING)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            return ["did not stop within %g s" % STOPPING]
        found = [] if code == 0 else ["exit code %d" % code]
        found += ["still runs: " + line for line in self.nodes_left()]
        found += ["did not stop when it was asked to: " + name
                  for name in re.findall(r"\[([\w-]+)\] escalating", self.output())]
        return found


def with_open_panel(name, folder, plant=False):
    """A copy of a configuration that shows the panel of displays, with faults if asked to."""
    with open(os.path.join(CONFIG, "rviz", name + ".rviz")) as file:
        config = yaml.safe_load(file)
    config["Window Geometry"] = {"Hide Left Dock": False, "Hide Right Dock": True,
                                 "Width": WIDTH, "Height": HEIGHT, "X": 0, "Y": 0}
    if plant:
        for display in config["Visualization Manager"]["Displays"]:
            if display["Name"] == "Robot":
                display["Robot Description"] = "no_such_description"
            if display["Name"] == "Surface":
                display["Marker Topic"] = "/no/such/surface"
    path = os.path.join(folder, name + ("_planted" if plant else "") + ".rviz")
    with open(path, "w") as file:
        yaml.safe_dump(config, file)
    return path


class Seen:
    """What a picture of rviz shows."""

    def __init__(self, picture, scene):
        panel, drawn = picture[:, :PANEL], picture[60:-30, PANEL + 30:]
        self.red = count_near(panel, ERROR_COLOR, 40)
        self.panel_is_there = count_near(panel, (255, 255, 255), 0) > 0.3 * panel[..., 0].size
        self.bodies = [share_of_hue(drawn, body["color"]) for body in scene["bodies"]
                       if "color" in body]
        self.background = count_near(drawn, BACKGROUND, 2) / drawn[..., 0].size
        tables = [o for o in scene.get("obstacles", [])
                  if o["name"] == "table" and np.ptp(o.get("color", [0])[:3]) > 0.1]
        self.table = share_of_hue(drawn, tables[0]["color"][:3]) if tables else None

    def shows_bodies(self):
        return not self.bodies or (min(self.bodies) > 0.1 * MIN_BODIES
                                   and sum(self.bodies) > MIN_BODIES)

    def is_good(self):
        return (self.panel_is_there and self.red < MIN_RED and self.shows_bodies()
                and self.background < MAX_BACKGROUND
                and (self.table is None or self.table > MIN_TABLE))

    def __str__(self):
        return ("%d red pixels in the panel (there: %s), bodies %s, table %s, background %.2f" % (
            self.red, self.panel_is_there, ["%.3f" % share for share in self.bodies],
            "none" if self.table is None else "%.3f" % self.table, self.background))


def look(launch, display, scene, is_done):
    """Looks at rviz until `is_done(what is seen)`; returns the last that was seen, or None."""
    deadline = time.monotonic() + PATIENCE
    seen = None
    while time.monotonic() < deadline and launch.process.poll() is None:
        picture = display.picture()
        if picture is not None:
            seen = Seen(picture, scene)
            if is_done(seen):
                return seen
        time.sleep(0.5)
    return seen


class LaunchFilesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        missing = [tool for tool in ("Xvfb", "rviz", "import", "roslaunch")
                   if shutil.which(tool) is None]
        if missing:
            raise AssertionError(
                "%s: not found. scripts/setup installs it; cmake -DPLIANT_DISPLAY_TESTS=OFF leaves "
                "this test out" % ", ".join(missing))
        cls.folder = tempfile.mkdtemp()

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def run_with_rviz(self, *run, **options):
        """Problems of a launch file whose rviz is looked at, and what was seen.

        Once more where rviz crashed: now and then its heap is corrupt as it starts, before it has
        any message of ours, and nothing of ours is loaded in it.
        """
        problems, seen = self.run_once(*run, **options)
        if any(RVIZ_CRASHED.search(problem) for problem in problems):
            print("rviz crashed, and is started once more:", " ".join([run[0]] + run[1]))
            problems, seen = self.run_once(*run, **options)
        return problems, seen

    def run_once(self, file, arguments, config, scene_file, plant=False):
        with open(os.path.join(CONFIG, "scenes", scene_file + ".yaml")) as text:
            scene = yaml.safe_load(text)
        folder = tempfile.mkdtemp(dir=self.folder)
        display = Display(folder)
        launch = Launch(
            file, arguments + ["rviz:=true",
                               "rviz_config:=" + with_open_panel(config, folder, plant)],
            folder, display.environment)
        try:
            # The planted fault has to be seen; what is well has to become so.
            seen = look(launch, display, scene,
                        (lambda s: s.panel_is_there and s.red >= MIN_RED and not s.shows_bodies()
                         and s.table > MIN_TABLE) if plant else Seen.is_good)
            problems = launch.problems()
            if not plant and (seen is None or not seen.is_good()):
                problems.append("rviz shows: %s" % seen)
        finally:
            problems_at_end = launch.stop()
            display.stop()
        return ["%s: %s" % (launch.name, p) for p in problems + problems_at_end], seen

    def test_demos_and_any_scene(self):
        runs = [("pliant.launch", ["model:=" + model], "demo" if model == "all" else model, scene)
                for model, scene in DEMOS.items() if model != "cloth"]
        runs += [("demo.launch", ["model:=cloth"], "cloth", "demo_cloth"),
                 ("scene.launch", [], "scene", "cloth_on_jelly")]
        # Two at once: most of a start is waiting.
        with ThreadPoolExecutor(2) as pool:
            results = list(pool.map(lambda run: self.run_with_rviz(*run), runs))
        for run, (problems, seen) in zip(runs, results):
            print(" ".join([run[0]] + run[1]), "-", seen)
        problems = [problem for problems, _ in results for problem in problems]
        if problems:
            self.fail("\n".join(problems))

    def test_planted_faults_are_found(self):
        _, seen = self.run_with_rviz("pliant.launch", ["model:=patch"], "patch", "demo_patch",
                                     plant=True)
        self.assertIsNotNone(seen)
        print("planted -", seen)
        self.assertTrue(seen.panel_is_there)
        self.assertGreaterEqual(seen.red, MIN_RED, "the robot's display is red: %s" % seen)
        self.assertFalse(seen.shows_bodies(), "the body is not drawn: %s" % seen)

    def test_those_without_rviz(self):
        recording = os.path.join(self.folder, "recording.bag")
        launches = [Launch(file, ["record:=" + recording] if file == "cloth.launch" else [],
                           self.folder) for file in WITHOUT_RVIZ]
        deadline = time.monotonic() + PATIENCE
        while (any("  scene      " not in launch.output() for launch in launches)
               and time.monotonic() < deadline):
            time.sleep(0.2)
        started = ["  scene      " in launch.output() for launch in launches]
        time.sleep(4.0)  # rosbag looks for new topics once a second
        problems = [launch.problems() for launch in launches]
        ends = [None] * len(launches)

        def stop(k):
            ends[k] = launches[k].stop()

        threads = [threading.Thread(target=stop, args=[k]) for k in range(len(launches))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for k, launch in enumerate(launches):
            self.assertTrue(started[k], launch.name + ": " + launch.output())
            self.assertEqual(problems[k] + ends[k], [], launch.name)
        self.check_recording(recording)

    def check_recording(self, path):
        """It holds what rviz shows and what is measured."""
        topics = set(rosbag.Bag(path).get_type_and_topic_info().topics)
        shown = {"/cloth/surface", "/cloth/shadows", "/cloth/markers", "/cloth/status",
                 "/cloth/mesh/topology", "/cloth/mesh/points", "/tf", "/tf_static"}
        self.assertEqual(shown - topics, set())
        self.assertNotIn("/cloth/interactive/update_full", topics)

    def test_panels_are_collapsed(self):
        """Qt restores the panel as hidden; rviz alone would leave it open, whatever else is written."""
        panel = b"\xfb" + bytes([0, 0, 0, 16]) + "Displays".encode("utf-16-be")
        files = os.listdir(os.path.join(CONFIG, "rviz"))
        self.assertGreaterEqual(len(files), 6)
        for file in files:
            with open(os.path.join(CONFIG, "rviz", file)) as text:
                window = yaml.safe_load(text)["Window Geometry"]
            state = bytes.fromhex(window["QMainWindow State"])
            self.assertIn(panel, state, file)
            is_visible = state[state.index(panel) + len(panel)]
            self.assertEqual(is_visible, 0, file)
            self.assertTrue(window["Hide Left Dock"] and window["Displays"]["collapsed"], file)

    def test_the_camera_shows_the_scene(self):
        def command(*arguments):
            return subprocess.run(["roslaunch", "--args=/rviz", "pliant", "pliant.launch",
                                   *arguments], text=True, stdout=subprocess.PIPE).stdout

        scene = os.path.join(CONFIG, "scenes", "hands_on.yaml")
        config = os.path.join(CONFIG, "rviz", "scene.rviz")
        framed = command("scene:=" + scene)
        self.assertRegex(framed, "rviz_of_scene.* %s %s " % (scene, config))
        self.assertNotIn("rviz_of_scene", command("scene:=" + scene, "rviz_config:=" + config))
        self.assertNotIn("rviz_of_scene", command("model:=patch"))
        # It becomes rviz: here a program that prints what it was given.
        stand_in = os.path.join(self.folder, "rviz")
        with open(stand_in, "w") as file:
            file.write("#!/bin/sh\ncat \"$2\"; shift 2; echo \"# $*\"\n")
        os.chmod(stand_in, 0o755)
        for scene_file, distance in ((scene, (1.2, 2.4)), ("/no/such.yaml", (0.85, 0.85))):
            done = subprocess.run(
                ["rosrun", "pliant", "rviz_of_scene", scene_file, config, "--fullscreen"], text=True,
                stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                env=dict(os.environ, XDG_CACHE_HOME=self.folder,
                         PATH=self.folder + ":" + os.environ["PATH"]))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("# --fullscreen", done.stdout)
            view = yaml.safe_load(done.stdout)["Visualization Manager"]["Views"]["Current"]
            self.assertTrue(distance[0] <= view["Distance"] <= distance[1], view)
            self.assertEqual("does not look at the scene" in done.stderr + done.stdout,
                             scene_file != scene)

    def test_no_launch_file_is_left_out(self):
        files = set(os.listdir(os.path.join(ROOT, "launch")))
        self.assertEqual(files, {"pliant.launch", "demo.launch", "scene.launch", *WITHOUT_RVIZ})
        done = subprocess.run([os.path.join(ROOT, "scripts", "make_rviz"), "--check"], text=True,
                              stderr=subprocess.PIPE)
        self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv, verbosity=2)
