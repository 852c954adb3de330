#!/usr/bin/python3
"""Every service of a model node, with good and bad requests, while the simulation runs."""

import concurrent.futures
import math
import os
import sys

import numpy as np
import rospy
import rostest
import tf2_ros
from geometry_msgs.msg import TransformStamped

from support import ModelTest, columns, wait_until


class ServicesTest(ModelTest):
    node = "/cloth"
    solver = "xpbd"

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # Turned by a quarter about z: its x axis is the world's y axis.
        transform = TransformStamped()
        transform.header.frame_id = "world"
        transform.child_frame_id = "camera"
        transform.transform.translation.z = 0.5
        transform.transform.rotation.z = transform.transform.rotation.w = math.sqrt(0.5)
        cls.broadcaster = tf2_ros.StaticTransformBroadcaster()
        cls.broadcaster.sendTransform(transform)
        wait_until(lambda: cls.model.push(frame="camera").success, "frame 'camera'")

    def velocity(self, axis):
        return float(np.mean(columns(self.model.points.new())[axis]))

    def refused(self, answer, *words):
        self.assertFalse(answer.success)
        for word in words:
            self.assertIn(word, answer.message)

    def test_force_moves_the_cloth(self):
        answer = self.model.push(force=(0.0, 1.0, 0.0), radius=1.0, duration=-1.0)
        self.assertTrue(answer.success, answer.message)
        self.model.step(5)
        self.assertGreater(self.velocity("vy"), 0.05)

    def test_force_in_another_frame(self):
        answer = self.model.push(force=(1.0, 0.0, 0.0), frame="camera", radius=1.0, duration=-1.0)
        self.assertTrue(answer.success, answer.message)
        self.model.step(5)
        self.assertGreater(self.velocity("vy"), 0.05)
        self.assertLess(abs(self.velocity("vx")), 0.01)

    def test_force_of_one_step(self):
        # Without duration it acts for one step: the impulse is F dt, but for the two held corners.
        self.model.push(force=(0.0, 0.5, 0.0), radius=1.0)
        self.model.step(1)
        expected = 0.5 * 0.005 / (0.2 * 0.16)
        self.assertAlmostEqual(self.velocity("vy"), expected, delta=0.1 * expected)
        self.assertEqual(self.model.clear_forces().message, "0 cleared on 'cloth'")

    def test_force_starts_later(self):
        start = rospy.get_time() + 1e6
        self.assertTrue(self.model.push(force=(0.0, 9.0, 0.0), start=start).success)
        self.model.step(5)
        self.assertLess(abs(self.velocity("vy")), 0.01)
        self.assertEqual(self.model.clear_forces().message, "1 cleared on 'cloth'")

    def test_bad_forces(self):
        nan, inf = math.nan, math.inf
        self.refused(self.model.push(force=(nan, 0.0, 0.0)), "force", "finite")
        self.refused(self.model.push(force=(0.0, inf, 0.0)), "force", "finite")
        self.refused(self.model.push(point=(0.0, 0.0, -inf)), "point", "finite")
        self.refused(self.model.push(radius=nan), "radius")
        self.refused(self.model.push(radius=-1e-9), "radius", ">= 0")
        self.refused(self.model.push(frame="camra"), "unknown frame", "did you mean 'camera'")
        self.assertEqual(self.model.clear_forces().message, "0 cleared on 'cloth'")

    def test_refused_forces_change_nothing(self):
        self.model.push(force=(0.0, 0.3, 0.0), duration=-1.0)
        self.model.step(5)
        before = self.model.points.new().data
        self.refused(self.model.push(force=(0.0, 0.0, math.nan), duration=-1.0), "force")
        self.assertEqual(self.model.points.new().data, before)
        self.assertEqual(self.model.clear_forces().message, "1 cleared on 'cloth'")

    def test_attach_and_detach(self):
        # The cloth lies in z = 0.5 at the start: its lower edge swings down unless it is held.
        answer = self.model.hold(point=(0.0, -0.2, 0.5), radius=0.05, to="ball", stiffness=1e4)
        self.assertTrue(answer.success, answer.message)
        self.assertIn("'attachment_1' holds 4 vertices of 'cloth' to ball", answer.message)
        before = columns(self.model.points.new())
        held = (np.hypot(before["x"], before["y"] + 0.2) < 0.05) & (before["z"] > 0.49)
        self.assertEqual(int(held.sum()), 4)
        self.model.step(60)
        after = columns(self.model.points.new())
        self.assertLess(float(np.max(np.abs(after["z"] - before["z"])[held])), 0.002)
        answer = self.model.detach(name="")
        self.assertEqual(answer.message, "let go: attachment_1 of 'cloth'")
        self.model.step(60)
        after = columns(self.model.points.new())
        self.assertGreater(float(np.min(np.abs(after["z"] - before["z"])[held])), 0.01)
        self.assertEqual(self.model.detach(name="").message, "nothing was held of 'cloth'")

    def test_bad_attachments(self):
        nan = math.nan
        self.refused(self.model.hold(point=(nan, 0.0, 0.5)), "reference_point", "finite")
        for bad in (0.0, -1.0, nan, math.inf):
            self.refused(self.model.hold(point=(0.0, 0.0, 0.5), radius=bad), "radius", "[m]")
            self.refused(self.model.hold(point=(0.0, 0.0, 0.5), stiffness=bad), "stiffness", "N/m")
        self.refused(self.model.hold(point=(0.0, 0.0, 9.0)), "no vertex that may move", "nearest")
        self.refused(self.model.hold(point=(0.0, 0.0, 0.5), to="bal"), "did you mean 'ball'")
        self.refused(self.model.hold(point=(0.0, 0.0, 0.5), frame="camra"), "unknown frame")
        self.assertTrue(self.model.hold(point=(0.0, 0.0, 0.5), name="a").success)
        self.refused(self.model.hold(point=(0.0, 0.0, 0.5), name="a"), "'a' is taken")
        self.refused(self.model.detach(name="b"), "unknown attachment 'b'")
        self.assertTrue(self.model.detach(name="a").success)

    def test_bad_steps(self):
        for steps in (-1, 0, 10000001):
            answer = self.model.step(steps)
            self.refused(answer, "steps", "1 to 10000000")
            self.assertEqual(answer.sim_time, 0.0)
        self.model.resume()
        self.refused(self.model.step(1), "pause first")

    def test_step_counts(self):
        answer = self.model.step(7)
        self.assertTrue(answer.success, answer.message)
        self.assertAlmostEqual(answer.sim_time, 0.035)
        self.assertEqual(self.model.status.new().step, 7)

    def test_pause_ends_a_long_step_request(self):
        with concurrent.futures.ThreadPoolExecutor() as pool:
            long = pool.submit(self.model.step, 10000000)
            self.model.status.when(lambda s: s.step > 10, "steps")
            self.refused(self.model.step(1), "another ~step request")
            self.assertTrue(self.model.pause().success)
            self.refused(long.result(timeout=10), "ended by ~pause")

    def test_list_solvers(self):
        answer = self.model.list_solvers()
        self.assertTrue(answer.success)
        self.assertEqual(answer.current, "xpbd")
        names = [s.name for s in answer.solvers]
        self.assertEqual(len(set(names)), len(names))
        self.assertTrue({"verlet", "xpbd", "jacobi", "newton"} <= set(names), names)
        for solver in answer.solvers:
            self.assertTrue(solver.description)
            self.assertTrue(self.model.switch(solver.name).success, solver.name)
            self.assertEqual(self.model.list_solvers().current, solver.name)
            for parameter in solver.parameters:
                self.assertTrue(parameter.range and parameter.meaning, parameter.name)

    def test_refused_solver_changes_nothing(self):
        self.model.switch("jacobi", iterations=7)
        self.model.step(3)
        before = self.model.points.new().data
        self.refused(self.model.switch("jacoby"), "unknown solver", "did you mean 'jacobi'")
        self.refused(self.model.switch("xpbd", backend="cuda"), "cuda", "cpu")
        self.refused(self.model.switch("xpbd", backend="gpu"), "unknown backend")
        self.refused(self.model.switch("xpbd", iteration=3), "did you mean 'iterations'")
        self.refused(self.model.switch("xpbd", iterations=-1), "iterations", "-1")
        for bad in ("nan", "inf", "-1", "", "many", "[1, 2]"):
            self.refused(self.model.switch("xpbd", tolerance=bad), "tolerance")
        self.refused(self.model.switch("verlet", iterations=3), "unknown parameter 'iterations'")
        self.refused(self.model.switch(""), "unknown solver")
        self.refused(self.model.switch_solver("xpbd", "", ["iterations"], [], "", ""), "as many")
        self.refused(self.model.switch_solver("xpbd", "", ["budget"] * 2, ["1"] * 2, "", ""),
                     "twice")
        self.refused(self.model.switch("xpbd", body="clot"), "unknown body", "did you mean 'cloth'")
        self.assertEqual(self.model.points.new().data, before)
        self.model.step(1)
        status = self.model.status.new()
        self.assertEqual((status.solver, status.iterations), ("jacobi", 7))

    def test_time_integration_is_swapped_too(self):
        self.model.switch("jacobi", iterations=7)
        self.assertEqual(self.model.list_solvers().current_time_integrations, ["implicit_euler"])
        self.assertEqual(self.model.list_solvers().time_integrations,
                         ["implicit_euler", "bdf2", "midpoint"])
        answer = self.model.switch("", time_integration="bdf2")
        self.assertTrue(answer.success, answer.message)
        self.assertIn("bdf2 for ", answer.message)
        self.model.step(2)
        status = self.model.status.new()
        self.assertEqual((status.solver, status.time_integration), ("jacobi", "bdf2"))
        self.refused(self.model.switch("", time_integration="bdf3"), "did you mean 'bdf2'")
        self.refused(self.model.switch("verlet"), "'bdf2' is for implicit solvers", "verlet")
        self.refused(self.model.switch("", time_integration="bdf2", iterations=3), "unknown solver")
        answer = self.model.switch("verlet", time_integration="implicit_euler")
        self.assertTrue(answer.success, answer.message)
        listed = self.model.list_solvers()
        self.assertEqual((listed.current, listed.current_time_integrations), ("verlet", [""]))
        self.refused(self.model.switch("", time_integration="bdf2"), "verlet")
        self.assertTrue(self.model.switch("jacobi", time_integration="midpoint").success)
        self.assertTrue(self.model.switch(self.solver, time_integration="implicit_euler").success)

    def test_backend_that_is_not_there(self):
        """Without a GPU the answer says so, and nothing changed; with one it is taken."""
        has_gpu = os.path.exists("/dev/nvidiactl")
        for answer in (self.model.switch("jacobi", backend="cuda"),
                       self.model.switch_solver("jacobi", "", ["backend"], ["cuda"], "", "")):
            self.assertEqual(answer.success, has_gpu, answer.message)
            if not has_gpu:
                self.refused(answer, "backend 'cuda': ", "use backend 'cpu' or 'auto'")
                self.assertEqual(self.model.list_solvers().current, "xpbd")
        for backend in ("auto", "cpu", ""):
            answer = self.model.switch("jacobi", backend=backend)
            self.assertTrue(answer.success, answer.message)

    def test_solver_of_one_body(self):
        answer = self.model.switch("xpbd", body="cloth", iterations=5)
        self.assertTrue(answer.success, answer.message)
        self.assertIn("for 'cloth'", answer.message)
        self.model.step(1)
        self.assertEqual(self.model.status.new().iterations, 5)

    def test_solver_parameters_take_effect(self):
        self.assertTrue(self.model.switch("xpbd", iterations=3).success)
        self.model.step(1)
        self.assertEqual(self.model.status.new().iterations, 3)

    def test_flood_of_requests(self):
        """Many callers at once, good and bad requests, while it runs: all answered, all finite."""
        self.model.resume()
        calls = [(lambda: self.model.push(force=(0.0, 0.2, 0.0)), True),
                 (lambda: self.model.push(radius=-1.0), False),
                 (lambda: self.model.switch("jacobi"), True),
                 (lambda: self.model.switch("xpbd"), True),
                 (lambda: self.model.switch("jacoby"), False),
                 (lambda: self.model.step(-1), False),
                 (self.model.pause, True),
                 (self.model.resume, True)]
        with concurrent.futures.ThreadPoolExecutor(max_workers=8) as pool:
            answers = list(pool.map(lambda k: calls[k % len(calls)][0](), range(400)))
        for k, answer in enumerate(answers):
            self.assertEqual(answer.success, calls[k % len(calls)][1], (k, answer.message))
        self.model.resume()
        step = self.model.status.new().step
        self.model.status.when(lambda s: s.step > step, "further steps")
        for name, values in columns(self.model.points.new()).items():
            self.assertTrue(name == "rgb" or np.isfinite(values).all(), name)


if __name__ == "__main__":
    rospy.init_node("services_test")
    rostest.rosrun("pliant", "services_test", ServicesTest, sys.argv)
