#!/usr/bin/python3
"""A node with two bodies of different models: topics, status and services of each."""

import sys

import numpy as np
import rosgraph
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from sensor_msgs.msg import PointCloud2
from visualization_msgs.msg import Marker, MarkerArray

from pliant.msg import SolverStatus
from support import Latest, ModelTest, columns

TOWEL_VERTICES = 81
ON_THE_BALL = (0.04, 0.0, 0.042)  # nearer to the ball than to the towel [m]
ON_THE_TOWEL = (0.06, 0.06, 0.1)  # [m]


class SceneNodeTest(ModelTest):
    node = "/scene"
    solver = "xpbd"
    parameters = {"iterations": 10}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.towel = Latest("/scene/towel/points", PointCloud2)
        cls.ball = Latest("/scene/soft_ball/points", PointCloud2)

    def velocities(self):
        """Mean along x of the towel and the ball [m/s]."""
        return [float(np.mean(columns(points.new())["vx"])) for points in (self.towel, self.ball)]

    def refused(self, answer, *words):
        self.assertFalse(answer.success)
        for word in words:
            self.assertIn(word, answer.message)

    def accepted(self, answer, *words):
        self.assertTrue(answer.success, answer.message)
        for word in words:
            self.assertIn(word, answer.message)

    def test_topics(self):
        topics = dict(rosgraph.Master("/scene_node_test").getTopicTypes())
        for body in ("towel", "soft_ball"):
            self.assertEqual(topics["/scene/%s/surface" % body], "visualization_msgs/Marker")
            self.assertEqual(topics["/scene/%s/points" % body], "sensor_msgs/PointCloud2")
        self.assertEqual(topics["/scene/surface_array"], "visualization_msgs/MarkerArray")
        self.assertFalse([topic for topic in topics if "soft-ball" in topic])
        # One body alone has the plain names only.
        self.assertFalse([topic for topic in topics if topic.startswith("/other/cloth/")])
        self.assertNotIn("/other/surface_array", topics)

    def test_points_of_each_body(self):
        self.model.step(1)
        towel, ball = self.towel.new(), self.ball.new()
        self.assertEqual(towel.width, TOWEL_VERTICES)
        self.assertEqual(self.model.points.new().data, towel.data, "the first has the plain name")
        self.assertIn("stretch", columns(towel))
        self.assertNotIn("von_mises", columns(towel))
        self.assertIn("von_mises", columns(ball))
        self.assertNotIn("stretch", columns(ball))
        self.assertGreater(np.min(columns(towel)["z"]), np.max(columns(ball)["z"]))

    def test_surfaces(self):
        all_surfaces = Latest("/scene/surface_array", MarkerArray)
        plain = Latest("/scene/surface", Marker)
        ball = Latest("/scene/soft_ball/surface", Marker)
        array = all_surfaces.new()
        self.assertEqual([marker.ns for marker in array.markers], ["towel", "soft_ball"])
        # rviz keeps one of two markers with the same namespace and id.
        self.assertEqual((plain.new().ns, plain.message.id), ("towel", array.markers[0].id))
        self.assertEqual(plain.message.points, array.markers[0].points)
        self.assertEqual(ball.new().points, array.markers[1].points)
        # Whatever the light: the towel is blue, the ball is not.
        for marker, is_blue in zip(array.markers, (True, False)):
            self.assertEqual(marker.colors[0].b > marker.colors[0].r, is_blue)
        for latest in (all_surfaces, plain, ball):
            latest.subscriber.unregister()

    def test_status_of_each_body(self):
        self.model.step(5)
        status = self.model.status.new()
        towel, ball = status.bodies
        self.assertEqual((towel.name, towel.topics, towel.model), ("towel", "towel", "cloth"))
        self.assertEqual((ball.name, ball.topics, ball.model), ("soft-ball", "soft_ball", "patch"))
        self.assertEqual((towel.moved_with, ball.moved_with), (["soft-ball"], ["towel"]))
        self.assertEqual(status.vertices, towel.vertices + ball.vertices)
        self.assertAlmostEqual(status.total_mass, towel.mass + ball.mass)
        self.assertIn("wetness", towel.effects)
        self.assertNotIn("wetness", ball.effects)
        self.assertEqual(list(status.effects), list(towel.effects), "those of the first")
        for body in (towel, ball):
            self.assertEqual((body.solver, body.backend, body.iterations), ("xpbd", "cpu", 10))
            self.assertTrue(body.ended_by)
            self.assertTrue(np.isfinite([body.residual, body.error, body.step_time]).all())
        # What it cost is told while there are steps.
        self.model.resume()
        status = self.model.status.when(lambda s: s.bodies[1].step_time > 0.0, "a step's time")
        self.assertEqual(status.bodies[0].step_time, status.bodies[1].step_time, "moved together")
        self.assertLessEqual(status.bodies[0].step_time, 1.05 * status.step_time)

    def test_one_body_alone(self):
        status = Latest("/other/status", SolverStatus).first()
        self.assertEqual(status.model, "cloth", "in a node that is called reduced_node")
        self.assertEqual([body.topics for body in status.bodies], [""])
        self.assertEqual(status.bodies[0].moved_with, [])

    def test_diagnostics_of_each_body(self):
        diagnostics = Latest("/diagnostics", DiagnosticArray)

        def own(array):
            return {s.name: s for s in array.status if s.name.startswith("scene: ")}

        found = own(diagnostics.when(own, "a status of the node"))
        self.assertEqual(list(found), ["scene: simulation", "scene: body towel",
                                       "scene: body soft-ball", "scene: scene", "scene: ROS"])
        values = {v.key: v.value for v in found["scene: body soft-ball"].values}
        self.assertEqual((values["model"], values["solver"], values["backend"]),
                         ("patch", "xpbd", "cpu"))
        # What is wrong with one body is said of that one.
        self.model.push(force=(0.0, 0.0, 1e12), point=ON_THE_TOWEL, duration=-1.0)
        self.assertFalse(self.model.step(1).success)
        broken = own(diagnostics.when(
            lambda a: own(a) and own(a)["scene: simulation"].level == DiagnosticStatus.ERROR,
            "ERROR"))
        self.assertEqual(broken["scene: body towel"].level, DiagnosticStatus.ERROR)
        self.assertIn("body 'towel'", broken["scene: body towel"].message)
        self.assertNotEqual(broken["scene: body soft-ball"].level, DiagnosticStatus.ERROR)
        diagnostics.subscriber.unregister()

    def test_force_on_the_nearest_body(self):
        self.accepted(self.model.push(force=(1.0, 0.0, 0.0), point=ON_THE_BALL, radius=1.0,
                                      duration=-1.0), "1 N on 'soft-ball'")
        self.model.step(2)
        towel, ball = self.velocities()
        self.assertGreater(ball, 0.05)
        self.assertLess(abs(towel), 1e-3)

    def test_force_on_a_named_body(self):
        # Although the point is at the other one.
        self.accepted(self.model.push(force=(0.1, 0.0, 0.0), point=ON_THE_BALL, radius=1.0,
                                      duration=-1.0, body="towel"), "N on 'towel'")
        self.model.step(2)
        towel, ball = self.velocities()
        self.assertGreater(towel, 0.05)
        self.assertLess(abs(ball), 1e-3)

    def test_forces_are_cleared_of_one_body_or_all(self):
        for body in ("towel", "soft-ball", "soft_ball"):
            self.accepted(self.model.push(force=(0.1, 0.0, 0.0), duration=-1.0, body=body))
        self.assertEqual(self.model.clear_forces("soft-ball").message, "2 cleared on 'soft-ball'")
        self.assertEqual(self.model.clear_forces("").message, "1 cleared on all 2 bodies")

    def test_attachments(self):
        self.accepted(self.model.hold(point=ON_THE_TOWEL, radius=0.005),
                      "'attachment_1' holds 1 vertices of 'towel'")
        # The ball lies in the region too, but not as near.
        self.accepted(self.model.hold(point=ON_THE_TOWEL, radius=0.2, name="all"), "of 'towel'")
        self.accepted(self.model.hold(point=ON_THE_TOWEL, radius=0.2, name="ball",
                                      body="soft-ball"), "of 'soft-ball'")
        self.refused(self.model.hold(point=ON_THE_TOWEL, radius=0.005, body="soft-ball"),
                     "no vertex that may move", "nearest vertex")
        self.refused(self.model.detach("al", "towel"), "unknown attachment", "did you mean 'all'")
        self.refused(self.model.detach("all", "soft-ball"), "allowed is ball")
        self.assertEqual(self.model.detach("", "soft-ball").message, "let go: ball of 'soft-ball'")
        self.assertEqual(self.model.detach("", "soft-ball").message,
                         "nothing was held of 'soft-ball'")
        self.assertEqual(self.model.detach("", "").message,
                         "let go: attachment_1 of 'towel', all of 'towel'")

    def test_fields(self):
        self.accepted(self.model.set_near("wetness", 0.5, radius=1.0), "81 vertices of 'towel'")
        self.accepted(self.model.set_near("wetness", 0.2, radius=1.0, body="towel"), "of 'towel'")
        self.refused(self.model.set_near("wetness", 0.5, radius=1.0, body="soft-ball"),
                     "body 'soft-ball' has no field to set")
        self.refused(self.model.set_near("wetnes", 0.5, radius=1.0, body="towel"),
                     "did you mean 'wetness'")
        self.refused(self.model.set_near("wetness", 0.5, point=(9.0, 0.0, 0.0), body="towel"),
                     "nearest vertex")

    def test_solvers_of_each_body(self):
        self.accepted(self.model.switch("newton", body="soft-ball", iterations=2),
                      "newton for 'soft-ball'")
        self.model.step(1)
        status = self.model.status.new()
        self.assertEqual([body.solver for body in status.bodies], ["xpbd", "newton"])
        self.assertEqual(status.solver, "xpbd")
        listed = self.model.list_solvers("")
        self.assertEqual((listed.bodies, listed.currents), (["towel", "soft-ball"],
                                                            ["xpbd", "newton"]))
        self.assertEqual(listed.current, "xpbd")
        self.assertEqual(listed.solvers[0].bodies, ["towel", "soft-ball"])
        listed = self.model.list_solvers("soft_ball")
        self.assertEqual((listed.bodies, listed.current), (["soft-ball"], "newton"))
        self.assertTrue(all(solver.bodies == ["soft-ball"] for solver in listed.solvers))
        # Bodies that may touch do not take any two solvers.
        self.refused(self.model.switch("jacobi", body="towel"), "'jacobi'", "'towel'")
        self.assertEqual(self.model.list_solvers("").currents, ["xpbd", "newton"])
        self.accepted(self.model.switch("xpbd"), "xpbd for all 2 bodies")
        self.assertEqual(self.model.list_solvers("").currents, ["xpbd", "xpbd"])

    def test_unknown_bodies(self):
        """Each service refuses them with the names that there are and the nearest one."""
        words = ("unknown body 'towl'", "allowed are towel, soft-ball", "did you mean 'towel'")
        answers = {
            "apply_force": self.model.push(force=(1.0, 0.0, 0.0), body="towl", duration=-1.0),
            "clear_forces": self.model.clear_forces("towl"),
            "attach": self.model.hold(point=ON_THE_TOWEL, body="towl"),
            "detach": self.model.detach("", "towl"),
            "set_field": self.model.set_near("wetness", 0.5, radius=1.0, body="towl"),
            "switch_solver": self.model.switch("jacobi", body="towl"),
            "list_solvers": self.model.list_solvers("towl")}
        for service, answer in answers.items():
            self.refused(answer, service + ": ", *words)
        self.assertEqual(self.model.clear_forces("").message, "0 cleared on all 2 bodies")
        self.assertEqual(self.model.list_solvers("").currents, ["xpbd", "xpbd"])

    def test_reset_is_of_all_bodies(self):
        before = self.towel.new().data, self.ball.new().data
        self.model.step(20)
        self.assertNotEqual(self.towel.new().data, before[0])
        self.assertNotEqual(self.ball.new().data, before[1])
        self.model.reset()
        self.assertEqual((self.towel.new().data, self.ball.new().data), before)


if __name__ == "__main__":
    rospy.init_node("scene_node_test")
    rostest.rosrun("pliant", "scene_node_test", SceneNodeTest, sys.argv)
