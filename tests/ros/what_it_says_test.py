#!/usr/bin/python3
"""Contacts, the wrench on each link, meshes and tf frames of a gripper that presses a towel on a ball."""

import io
import sys

import numpy as np
import rosgraph
import rospy
import rostest
import tf2_ros
from geometry_msgs.msg import WrenchStamped

from pliant.msg import Contacts, LinkWrenches, MeshPoints, MeshTopology
from support import Latest, Model, ModelTest, columns, wait_until

LINKS = ["wrist_link", "palm", "left_finger", "right_finger"]


def vectors(messages):
    return np.array([[m.x, m.y, m.z] for m in messages]).reshape(-1, 3)


def size_of(message):
    buffer = io.BytesIO()
    message.serialize(buffer)
    return len(buffer.getvalue())


class WhatItSaysTest(ModelTest):
    node = "/pressed"
    solver = "xpbd"
    parameters = {"iterations": 20}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.tf = tf2_ros.Buffer()
        cls.listener = tf2_ros.TransformListener(cls.tf)

    def setUp(self):
        super().setUp()
        self.topics = []
        self.model.detach(name="")

    def tearDown(self):
        for topic in self.topics:
            topic.subscriber.unregister()

    def latest(self, name, kind):
        self.topics.append(Latest(self.node + name, kind))
        return self.topics[-1]

    def step(self, count):
        answer = self.model.step(count)
        self.assertTrue(answer.success, answer.message)

    def place(self, frame, parent="world"):
        """Where tf says that a frame is now, without waiting for a frame that it does not know."""
        transform = self.tf.lookup_transform(parent, frame, rospy.Time(0)).transform
        return vectors([transform.translation])[0]

    def wait_for_place(self, frame, place):
        def is_there():
            try:
                return np.allclose(self.place(frame), place, atol=1e-6)
            except tf2_ros.TransformException:
                return False
        wait_until(is_there, "frame '%s' at %s" % (frame, place))

    def test_contacts_and_wrenches_of_one_step(self):
        contacts = self.latest("/contacts", Contacts)
        wrenches = {name: self.latest("/wrench/" + name, WrenchStamped)
                    for name in LINKS + ["table", "side_wall"]}
        together = self.latest("/contact_wrenches", LinkWrenches)
        # They are there before anything touches, and while the simulation is paused.
        for name, wrench in wrenches.items():
            message = wrench.new(skip=3)
            own = name if name in LINKS else "pressed/" + name
            self.assertEqual(message.header.frame_id, own)
            self.assertEqual(vectors([message.wrench.force]).any(), False, name)
        self.assertEqual(len(contacts.new().points), 0)
        self.step(110)
        # The mean over the steps since the last message is that of one step.
        together.new()
        self.step(1)
        message = contacts.when(lambda m: m.step == 111, "the contacts of step 111")
        total = together.new()
        points, forces = vectors(message.points), vectors(message.forces)
        count = len(points)
        self.assertGreater(count, 5)
        for array in (message.normals, forces, message.bodies, message.vertices, message.others,
                      message.kinds):
            self.assertEqual(len(array), count)
        np.testing.assert_allclose(np.linalg.norm(vectors(message.normals), axis=1), 1.0)
        self.assertEqual(message.header.frame_id, "world")
        found = set(zip(message.bodies, message.others, message.kinds))
        self.assertIn(("soft-ball", "table", Contacts.OBSTACLE), found)
        self.assertTrue({("towel", "left_finger", Contacts.LINK),
                         ("towel", "right_finger", Contacts.LINK)} & found, found)
        self.assertTrue({("towel", "soft-ball", Contacts.BODY),
                         ("soft-ball", "towel", Contacts.BODY)} & found, found)
        # No frame of a link that touches is turned against the world.
        for name in ("table", "left_finger", "right_finger"):
            of_link = np.array([other == name for other in message.others])
            expected = -forces[of_link].sum(axis=0) if of_link.any() else np.zeros(3)
            told = vectors([wrenches[name].new().wrench.force])[0]
            np.testing.assert_allclose(told, expected, atol=1e-6, err_msg=name)
            same = [link.wrench.force for link in total.links if link.name == name]
            np.testing.assert_allclose(vectors(same)[0], told, atol=1e-9)
        # The towel's vertices are where the points say.
        towel = columns(self.model.points.new())
        for k in range(count):
            if message.bodies[k] == "towel" and message.kinds[k] == Contacts.LINK:
                place = [towel[axis][message.vertices[k]] for axis in "xyz"]
                np.testing.assert_allclose(points[k], place, atol=1e-6)

    def test_meshes(self):
        points = self.latest("/mesh/points", MeshPoints)
        self.step(3)
        now = points.new()
        # One who comes late gets the triangles too.
        topology = self.latest("/mesh/topology", MeshTopology).first()
        self.assertEqual((topology.body, topology.vertices, len(topology.triangles)),
                         ("towel", 81, 3 * 128))
        self.assertEqual(topology.version, now.version)
        self.assertLess(max(topology.triangles), 81)
        self.assertEqual(len(now.xyz), 3 * 81)
        self.assertLessEqual(size_of(now), 15 * 81)
        cloud = columns(self.model.points.new())
        xyz = np.array(now.xyz, np.float32).reshape(-1, 3)
        for k, axis in enumerate("xyz"):
            np.testing.assert_array_equal(xyz[:, k], cloud[axis])
        # Each body has its own.
        ball = self.latest("/soft_ball/mesh/points", MeshPoints).first()
        ball_topology = self.latest("/soft_ball/mesh/topology", MeshTopology).first()
        self.assertEqual(ball_topology.body, "soft-ball")
        self.assertEqual(len(ball.xyz), 3 * ball_topology.vertices)
        self.assertLessEqual(size_of(ball), 15 * ball_topology.vertices)
        self.assertEqual(self.latest("/towel/mesh/points", MeshPoints).first().xyz, now.xyz)
        # A surface that stays as it is says its triangles once.
        count = self.topics[1].count
        self.step(2)
        points.new()
        self.assertEqual(self.topics[1].count, count)

    def test_a_surface_that_is_made_anew(self):
        liquid = Model("/liquid")
        points = Latest("/liquid/mesh/points", MeshPoints)
        topology = Latest("/liquid/mesh/topology", MeshTopology)
        first = topology.first()
        answer = liquid.step(40)
        self.assertTrue(answer.success, answer.message)
        points.first()
        wait_until(lambda: topology.message.version > first.version
                   and points.message.version == topology.message.version, "new triangles")
        self.assertEqual(len(points.message.xyz), 3 * topology.message.vertices)
        for latest in (points, topology):
            latest.subscriber.unregister()

    def test_frames(self):
        # Of obstacles, from the beginning.
        self.wait_for_place("pressed/table", (0.0, 0.0, 0.0))
        self.wait_for_place("pressed/side_wall", (0.5, 0.0, 0.1))
        # Of links, also of those that have no collision shape: the keyframes move them.
        self.wait_for_place("gantry_base", (0.0, 0.0, 0.0))
        self.wait_for_place("left_finger", (0.0, 0.0, 0.15))
        self.step(100)
        self.wait_for_place("left_finger", (0.0, 0.0, 0.076))
        # A service takes them as they are, though no robot_state_publisher runs.
        answer = self.model.push(force=(0.0, 0.0, -0.1), frame="left_finger", body="towel")
        self.assertTrue(answer.success, answer.message)
        self.assertIn("at (0, 0, 0.076) m", answer.message)
        # A frame of an obstacle that is turned by a quarter turns the force too.
        answer = self.model.push(force=(1.0, 0.0, 0.0), frame="pressed/side_wall", body="towel")
        self.assertIn("at (0.5, 0, 0.1) m", answer.message)

    def test_frames_of_attachments(self):
        answer = self.model.hold(point=(0.06, 0.06, 0.088), radius=0.01, to="left_finger",
                                 name="hook", body="towel")
        self.assertIn("holds 1 vertices", answer.message)
        x = columns(self.model.points.new())
        start = np.array([x[axis][80] for axis in "xyz"])
        self.wait_for_place("pressed/attachments/hook", start)
        # It goes down as the finger does.
        self.step(100)
        self.wait_for_place("pressed/attachments/hook", start - [0.0, 0.0, 0.15 - 0.076])
        self.model.detach(name="hook")
        last = self.tf.get_latest_common_time("world", "pressed/attachments/hook")
        wait_until(lambda: self.tf.get_latest_common_time("world", "left_finger") > last
                   + rospy.Duration(0.2), "further frames")
        self.assertLess((self.tf.get_latest_common_time("world", "pressed/attachments/hook")
                         - last).to_sec(), 0.2)

    def test_topics(self):
        topics = dict(rosgraph.Master("/what_it_says_test").getTopicTypes())
        own = {name[len("/pressed/wrench/"):]: kind for name, kind in topics.items()
               if name.startswith("/pressed/wrench/")}
        self.assertEqual(own, {name: "geometry_msgs/WrenchStamped"
                               for name in LINKS + ["table", "side_wall"]})


if __name__ == "__main__":
    rospy.init_node("what_it_says_test")
    rostest.rosrun("pliant", "what_it_says_test", WhatItSaysTest, sys.argv)
