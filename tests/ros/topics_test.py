#!/usr/bin/python3
"""What a model node publishes: types, sizes, frames, finite values, rates, nothing unasked."""

import sys
import time
import unittest

import numpy as np
import rosgraph
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from visualization_msgs.msg import Marker, MarkerArray

from pliant.msg import LinkWrenches
from support import Latest, Model, columns, wait_until

VERTICES = 12 * 11
TRIANGLES = 2 * 11 * 10


class TopicsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.model = Model()
        cls.model.resume()

    def test_points(self):
        cloud = self.model.points.first()
        self.assertEqual(cloud.header.frame_id, "world")
        self.assertGreater(cloud.header.stamp.to_sec(), 0.0)
        self.assertEqual((cloud.width, cloud.height), (VERTICES, 1))
        self.assertTrue(cloud.is_dense)
        names = [field.name for field in cloud.fields]
        self.assertEqual(names[:7], ["x", "y", "z", "rgb", "vx", "vy", "vz"])
        self.assertIn("stretch", names)
        self.assertEqual(len(cloud.data), cloud.point_step * VERTICES)
        for name, values in columns(cloud).items():
            if name != "rgb":  # bits of a colour, not a number
                self.assertTrue(np.isfinite(values).all(), name)

    def test_point_index_is_vertex(self):
        # The fixed corners are the ends of the grid's last row of 12.
        z = columns(self.model.points.new())["z"]
        self.assertAlmostEqual(z[-1], 0.5, places=6)
        self.assertAlmostEqual(z[-12], 0.5, places=6)

    def test_surface(self):
        surface = Latest("/cloth/surface", Marker)
        marker = surface.first()
        self.assertEqual(marker.type, Marker.TRIANGLE_LIST)
        self.assertEqual(marker.header.frame_id, "world")
        self.assertEqual(len(marker.points), 3 * TRIANGLES)
        self.assertEqual(len(marker.colors), 3 * TRIANGLES)
        self.assertTrue(all(0.0 <= c <= 1.0 for color in marker.colors
                            for c in (color.r, color.g, color.b)))
        later = surface.new()
        self.assertEqual((later.ns, later.id), (marker.ns, marker.id))
        self.assertEqual(len(later.points), len(marker.points))
        surface.subscriber.unregister()

    def test_markers(self):
        markers = Latest("/cloth/markers", MarkerArray)
        found = {(m.ns, m.id): m for m in markers.first().markers}
        ball, ground = found[("obstacles", 0)], found[("obstacles", 1)]
        self.assertEqual(ball.type, Marker.SPHERE)
        self.assertAlmostEqual(ball.scale.x, 0.1)
        self.assertAlmostEqual(ball.pose.position.z, 0.3)
        self.assertEqual(ground.type, Marker.TRIANGLE_LIST)
        self.assertAlmostEqual(max(point.z for point in ground.points), 0.0)
        fixed = found[("fixed_vertices", 0)]
        self.assertEqual(len(fixed.points), 2)
        # What does not move is not sent every time.
        markers.when(lambda a: not self.marks(a, "obstacles"), "an array without obstacles")
        self.model.push(force=(0.0, 0.1, 0.0), duration=-1.0)
        arrow = markers.when(lambda a: self.marks(a, "applied_forces"), "an arrow")
        self.assertEqual(self.marks(arrow, "applied_forces")[0].type, Marker.ARROW)
        self.model.clear_forces()
        markers.when(lambda a: [m for m in self.marks(a, "applied_forces")
                                if m.action == Marker.DELETE], "its end")
        markers.subscriber.unregister()
        # One who comes later sees everything.
        late = Latest("/cloth/markers", MarkerArray)
        self.assertEqual(len(self.marks(late.first(), "obstacles")), 2)
        late.subscriber.unregister()

    @staticmethod
    def marks(array, space):
        return [marker for marker in array.markers if marker.ns == space]

    def test_status(self):
        status = self.model.status.new()
        self.assertEqual(status.header.frame_id, "world")
        self.assertEqual((status.model, status.solver, status.backend), ("cloth", "xpbd", "cpu"))
        self.assertEqual(sorted(status.effects), ["contact", "damping", "friction", "gravity"])
        self.assertEqual(status.vertices, VERTICES)
        self.assertAlmostEqual(status.total_mass, 0.2 * 0.4 * 0.4, places=9)
        self.assertAlmostEqual(status.sim_time, 0.005 * status.step, places=9)
        self.assertEqual(len(status.phases), len(status.phase_times))
        self.assertIn("gravity", status.phases)
        self.assertLessEqual(sum(status.phase_times), status.step_time * 1.05)
        self.assertGreaterEqual(status.step_time_max, status.step_time)
        for value in (status.kinetic_energy, status.elastic_energy, status.potential_energy,
                      status.residual, status.real_time_factor):
            self.assertTrue(np.isfinite(value))

    def test_real_time(self):
        first, start = self.model.status.new(), time.monotonic()
        time.sleep(1.0)
        last, end = self.model.status.new(), time.monotonic()
        factor = (last.sim_time - first.sim_time) / (end - start)
        # A message is up to 0.1 s old.
        self.assertLess(factor, 1.15)
        self.assertGreater(factor, 0.5)

    def test_slow_subscriber(self):
        """One that takes seconds for a message does not hold up the simulation."""
        slow = Latest("/cloth/surface", Marker, queue_size=None, callback=lambda _: time.sleep(3.0))
        slow.first()
        first, start = self.model.status.new(), time.monotonic()
        time.sleep(1.5)
        last, end = self.model.status.new(), time.monotonic()
        self.assertGreater((last.sim_time - first.sim_time) / (end - start), 0.5)
        self.assertLess(last.step_time_max, 0.1)
        slow.subscriber.unregister()

    def test_wrenches(self):
        wrenches = Latest("/cloth/contact_wrenches", LinkWrenches)
        message = wrenches.first()
        self.assertEqual(message.header.frame_id, "world")
        self.assertEqual([link.name for link in message.links], ["ball", "ground"])
        self.assertFalse(any(link.is_robot_link for link in message.links))
        wrenches.subscriber.unregister()

    def test_weight_on_the_table(self):
        """The table carries the cloth that lies on it."""
        status = Model("/lying").status
        status.when(lambda s: s.sim_time > 1.5, "rest")
        wrenches = Latest("/lying/contact_wrenches", LinkWrenches)
        force = wrenches.new().links[0].wrench.force
        weight = status.message.total_mass * 9.81
        self.assertAlmostEqual(-force.z / weight, 1.0, delta=0.01)
        wrenches.subscriber.unregister()

    def test_diagnostics(self):
        diagnostics = Latest("/diagnostics", DiagnosticArray)

        def of_cloth(array):
            return [s for s in array.status if s.name == "cloth: simulation"]

        def is_well(array):
            return [s for s in of_cloth(array) if s.level == DiagnosticStatus.OK]

        # For half a second after the cloth met the ball its error is told to be 5.2 %.
        status = of_cloth(diagnostics.when(of_cloth, "a status of the node"))[0]
        if status.level != DiagnosticStatus.OK:
            self.assertIn("inaccurate", status.message)
        diagnostics.when(is_well, "a status of the node without a warning")
        diagnostics.subscriber.unregister()

    def test_nodes_are_independent(self):
        """Two nodes of the same kind: pausing one leaves the other running."""
        other = Model("/lying")
        self.assertTrue(other.pause().success)
        paused = other.status.when(lambda s: s.paused, "a pause")
        step = self.model.status.new().step
        self.model.status.when(lambda s: s.step > step, "a step")
        self.assertEqual(other.status.new().step, paused.step)
        self.assertTrue(other.resume().success)
        # So does another solver in one of them.
        self.assertTrue(other.switch("jacobi").success)
        other.status.when(lambda s: s.solver == "jacobi", "another solver")
        self.assertEqual(self.model.status.new().solver, "xpbd")
        self.assertTrue(other.switch("xpbd").success)

    def test_clock_is_not_published(self):
        topics = dict(rosgraph.Master("/topics_test").getTopicTypes())
        self.assertNotIn("/clock", topics)
        wait_until(lambda: "/cloth/surface" in topics, "the surface's topic")


if __name__ == "__main__":
    rospy.init_node("topics_test")
    rostest.rosrun("pliant", "topics_test", TopicsTest, sys.argv)
