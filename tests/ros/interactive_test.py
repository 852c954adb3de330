#!/usr/bin/python3
"""What the mouse takes hold of in rviz, by feedback messages as rviz sends them."""

import sys
import unittest

import numpy as np
import rosgraph
import rospy
import rostest
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import PointCloud2
from visualization_msgs.msg import (InteractiveMarkerFeedback, InteractiveMarkerInit,
                                    InteractiveMarkerUpdate, MarkerArray)

from support import Latest, Model, columns, wait_until

Feedback = InteractiveMarkerFeedback


def xyz(point):
    return np.array([point.x, point.y, point.z])


class Hands:
    """A client of a node's interactive markers, as rviz is one."""

    def __init__(self, node):
        self.node = node
        self.markers = {}  # by name
        self.pose_updates = {}  # how many of each
        self.log = []
        self.unknown_lines = 1000  # of menus; each is asked for once
        # First of all: some things are said but once.
        log = rospy.Subscriber("/rosout", Log, self.take_log)
        wait_until(lambda: 0 < count_publishers("/rosout") <= log.get_num_connections(), "the log")
        self.subscribers = [
            log,
            rospy.Subscriber(node + "/interactive/update_full", InteractiveMarkerInit, self.take),
            rospy.Subscriber(node + "/interactive/update", InteractiveMarkerUpdate, self.take)]
        self.feedback = rospy.Publisher(node + "/interactive/feedback", Feedback, queue_size=10)
        wait_until(lambda: self.feedback.get_num_connections() > 0, "the server of " + node)

    def take(self, message):
        for marker in message.markers:
            self.markers[marker.name] = marker
        for pose in getattr(message, "poses", []):
            self.markers[pose.name].pose = pose.pose
            self.pose_updates[pose.name] = self.pose_updates.get(pose.name, 0) + 1
        for name in getattr(message, "erases", []):
            self.markers.pop(name, None)

    def take_log(self, message):
        if message.name == self.node:
            self.log.append(message.msg)

    def close(self):
        for subscriber in self.subscribers:
            subscriber.unregister()
        self.feedback.unregister()

    def marker(self, name):
        return wait_until(lambda: self.markers.get(name), "marker " + name)

    def titles(self, name):
        return [entry.title for entry in self.marker(name).menu_entries]

    def send(self, marker, event, position=(0, 0, 0), mouse=None, line=0, turn=(0, 0, 0, 1),
             frame="world"):
        message = Feedback(client_id="/test", marker_name=marker, event_type=event,
                           menu_entry_id=line)
        message.header.frame_id = frame
        pose = message.pose
        pose.position.x, pose.position.y, pose.position.z = position
        (pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w) = turn
        if mouse is not None:
            message.mouse_point_valid = True
            (message.mouse_point.x, message.mouse_point.y, message.mouse_point.z) = mouse
        self.feedback.publish(message)

    def choose(self, marker, title, mouse=None):
        """Returns what the node said to it."""
        line = [entry.id for entry in self.marker(marker).menu_entries if entry.title == title]
        assert line, (title, self.titles(marker))
        count = len(self.log)
        self.send(marker, Feedback.MENU_SELECT, line=line[0], mouse=mouse)
        return wait_until(lambda: len(self.log) > count and self.log[-1], "an answer to " + title)

    def wait_until_taken(self, marker="hand"):
        """Returns when the node has acted on all that was sent: it takes feedback in order and
        answers a line that no menu has."""
        self.unknown_lines += 1
        self.send(marker, Feedback.MENU_SELECT, line=self.unknown_lines)
        self.said("no line %d" % self.unknown_lines)

    def drag_hand(self, position, marker="hand", turn=(0, 0, 0, 1)):
        """The server publishes the mouse's poses like its own: the mouse's has come when this
        returns, and the next one is where the hand is."""
        self.send(marker, Feedback.MOUSE_DOWN)
        self.send(marker, Feedback.POSE_UPDATE, position=position, turn=turn)
        wait_until(lambda: np.allclose(xyz(self.markers[marker].pose.position), position),
                   "the mouse's pose")
        self.wait_until_taken(marker)

    def said(self, words):
        return wait_until(lambda: [text for text in self.log if words in text], words)


def count_publishers(topic):
    publishers = rosgraph.Master("/test").getSystemState()[0]
    return sum(len(who) for name, who in publishers if name == topic)


def is_listening(node):
    subscribers = rosgraph.Master("/test").getSystemState()[1]
    return any(topic == node + "/interactive/feedback" and node in who
               for topic, who in subscribers)


class WithoutSubscriber(unittest.TestCase):
    def test_there_is_no_server(self):
        for node in ("/hands", "/off"):
            Model(node)
            self.assertFalse(is_listening(node))
        hands = Hands("/hands")
        hands.marker("body/napkin")
        self.assertTrue(is_listening("/hands"))
        # Whoever closes rviz while dragging lets go.
        point = (0.0, 0.9, 0.5)
        hands.send("body/napkin", Feedback.MOUSE_DOWN, mouse=point)
        hands.marker("body/napkin/spring")
        hands.close()
        wait_until(lambda: not is_listening("/hands"), "the end of the server")
        again = Hands("/hands")
        again.marker("body/napkin")
        self.assertNotIn("body/napkin/spring", again.markers)
        again.close()

    def test_rate_zero_is_off(self):
        update = Latest("/off/interactive/update", InteractiveMarkerUpdate)
        rospy.sleep(0.3)
        self.assertFalse(is_listening("/off"))
        self.assertEqual(update.subscriber.get_num_connections(), 0)
        update.subscriber.unregister()


class NodeTest(unittest.TestCase):
    node = ""

    @classmethod
    def setUpClass(cls):
        cls.model = Model(cls.node)
        cls.hands = Hands(cls.node)
        cls.obstacles = {}
        cls.marker_subscriber = rospy.Subscriber(cls.node + "/markers", MarkerArray, cls.take)

    @classmethod
    def tearDownClass(cls):
        cls.marker_subscriber.unregister()
        cls.hands.close()

    @classmethod
    def take(cls, array):
        for marker in array.markers:
            if marker.ns == "obstacles":
                cls.obstacles[marker.id] = xyz(marker.pose.position)

    def setUp(self):
        self.model.pause()
        self.model.reset()
        for name in list(self.hands.markers):
            if not name.endswith("/spring"):
                self.hands.send(name, Feedback.MOUSE_UP)
        wait_until(lambda: not any(name.endswith("/spring") for name in self.hands.markers),
                   "the end of what an earlier test dragged")

    def steps(self, count):
        answer = self.model.step(count)
        self.assertTrue(answer.success, answer.message)

    def let_go_of_hand(self, name="hand"):
        """Where the hand is: the marker goes back to it, wherever the mouse left that."""
        count = self.hands.pose_updates.get(name, 0)
        self.hands.send(name, Feedback.MOUSE_UP)
        wait_until(lambda: self.hands.pose_updates.get(name, 0) > count, "the marker's way back")
        return self.hands.marker(name).pose


class BodiesTest(NodeTest):
    node = "/hands"

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.clouds = {name: Latest("%s/%s/points" % (cls.node, name), PointCloud2)
                      for name in ("napkin", "block", "beam")}

    def points(self, body):
        fields = columns(self.clouds[body].new())
        return np.array([fields["x"], fields["y"], fields["z"]]).T

    def field(self, body, name):
        return columns(self.clouds[body].new())[name]

    def grab(self, body, point):
        self.hands.send("body/" + body, Feedback.POSE_UPDATE, mouse=point)
        self.hands.send("body/" + body, Feedback.MOUSE_DOWN, mouse=point)
        self.hands.marker("body/%s/spring" % body)

    def line_end(self, name):
        return xyz(self.hands.marker(name + "/spring").controls[0].markers[0].points[1])

    def drag(self, body, offset):
        name = "body/" + body
        end = self.line_end(name)
        self.hands.send(name, Feedback.POSE_UPDATE, position=offset)
        wait_until(lambda: not np.allclose(end, self.line_end(name)), "the line's end")

    def let_go(self, body):
        self.hands.send("body/" + body, Feedback.MOUSE_UP)
        wait_until(lambda: "body/%s/spring" % body not in self.hands.markers, "the line's end")

    def test_dragging_brings_a_vertex_near_the_mouse_and_lets_go(self):
        for body, index in (("napkin", 4), ("block", -1), ("beam", -1)):
            with self.subTest(body=body):
                self.model.reset()
                first = self.points(body)
                vertex = first[index]
                self.grab(body, vertex)
                # A beam is stiff and held at one end.
                offset = np.array([0.0, 0.02, 0.05]) if body != "beam" else np.array([0, 0, 0.005])
                self.drag(body, offset)
                self.steps(300)
                near = np.linalg.norm(first - vertex, axis=1) <= 0.015
                moved = (self.points(body) - first)[near].mean(axis=0)
                # Its own weight keeps a body that hangs on the spring alone 1 cm below; the beam
                # bends as far as the spring can bend it.
                self.assertLess(np.linalg.norm(moved - offset), 0.015)
                self.assertGreater(moved[2], 0.1 * offset[2])
                self.let_go(body)
                self.steps(200)
                after = (self.points(body) - first)[near].mean(axis=0)
                self.assertLess(after[2], 0.7 * moved[2])

    def test_menus_show_what_a_body_can_do(self):
        shared = ["Attach here", "Push here", "Release pins and attachments", "Reset the scene",
                  "to world", "to table", "to palm"]
        own = {"napkin": ["Pin here", "Wet here", "Dry here"],
               "block": ["Pin here", "Heat here by 50 K", "Cool here by 50 K"], "beam": []}
        every = set(sum(own.values(), []))
        for body, titles in own.items():
            shown = self.hands.titles("body/" + body)
            for title in shared + titles:
                self.assertIn(title, shown, body)
            for title in every - set(titles):
                self.assertNotIn(title, shown, body)

    def test_attach_pin_and_release(self):
        first = self.points("napkin")
        corner = first[0]  # the lower left one: what is held keeps its height
        said = self.hands.choose("body/napkin", "Pin here", corner)
        self.assertIn("pinned 1 vertices of 'napkin'", said)
        self.steps(100)
        np.testing.assert_allclose(self.points("napkin")[0], corner, atol=1e-6)
        said = self.hands.choose("body/napkin", "Release pins and attachments")
        self.assertIn("released 1 pinned", said)
        self.steps(100)
        self.assertLess(self.points("napkin")[0][2], corner[2] - 0.02)
        self.model.reset()
        self.assertIn("holds 1 vertices", self.hands.choose("body/napkin", "to world", corner))
        self.steps(100)
        np.testing.assert_allclose(self.points("napkin")[0], corner, atol=2e-3)
        self.assertIn("let go", self.hands.choose("body/napkin", "Release pins and attachments"))
        self.steps(100)
        self.assertLess(self.points("napkin")[0][2], corner[2] - 0.02)

    def test_push_goes_into_the_body(self):
        first = self.points("block")
        top = np.array([0.0, 2.0 + 0.02, 0.0225])  # the middle of the side towards +y
        self.assertIn("block", self.hands.choose("body/block", "Push here", top))
        self.steps(20)
        moved = (self.points("block") - first).mean(axis=0)
        self.assertLess(moved[1], -0.01)
        self.assertLess(abs(moved[0]), 0.3 * abs(moved[1]))

    def test_heat_and_wet(self):
        first = self.points("block")
        near = np.linalg.norm(first - first[0], axis=1) < 0.01
        self.hands.choose("body/block", "Heat here by 50 K", first[0])
        self.steps(250)
        self.assertGreater(self.field("block", "temperature")[near].max(), 320.0)
        corner = self.points("napkin")[0]
        self.hands.choose("body/napkin", "Wet here", corner)
        self.steps(1)
        wetness = self.field("napkin", "wetness")
        self.assertGreater(wetness[0], 0.9)
        self.assertEqual(wetness[-1], 0.0)
        self.hands.choose("body/napkin", "Dry here", self.points("napkin")[0])
        self.steps(1)
        self.assertLess(self.field("napkin", "wetness")[0], 0.1)

    def test_reset(self):
        first = self.points("napkin")
        self.steps(20)
        self.assertIn("reset", self.hands.choose("body/napkin", "Reset the scene"))
        np.testing.assert_array_equal(self.points("napkin"), first)

    def test_what_is_refused_says_why(self):
        self.hands.send("body/napkin", Feedback.MOUSE_DOWN)
        self.hands.said("click on the body itself")
        count = len(self.hands.log)
        self.hands.send("body/napkin", Feedback.MENU_SELECT, line=77, mouse=(0, 1, 0.5))
        self.hands.said("no line 77")
        self.hands.send("body/napkin", Feedback.MOUSE_DOWN, mouse=(0, 1, 0.5), frame="nowhere")
        self.hands.said("'nowhere'")
        self.assertGreaterEqual(len(self.hands.log), count + 2)
        self.assertNotIn("body/napkin/spring", self.hands.markers)


class ArmTest(NodeTest):
    node = "/hands"

    def move_hand(self, position, turn, steps):
        self.hands.drag_hand(position, turn=turn)
        self.steps(steps)
        return self.let_go_of_hand()

    def quaternion(self, pose):
        q = pose.orientation
        return np.array([q.x, q.y, q.z, q.w])

    def test_the_hand_goes_to_the_pose(self):
        start = self.hands.marker("hand").pose
        turn = self.quaternion(start)
        target = xyz(start.position) + [0.05, -0.06, 0.04]
        pose = self.move_hand(target, turn, 300)
        self.assertLess(np.linalg.norm(xyz(pose.position) - target), 1e-3)
        self.assertGreater(abs(np.dot(self.quaternion(pose), turn)), 1 - 1e-6)
        # Links move with the joints, none faster than its URDF says: not all in one step.
        self.model.reset()
        rospy.sleep(0.2)
        before = dict(self.obstacles)
        self.hands.send("hand", Feedback.POSE_UPDATE, position=target, turn=turn)
        self.hands.wait_until_taken()
        self.steps(1)
        rospy.sleep(0.1)
        jump = max(np.linalg.norm(self.obstacles[i] - p) for i, p in before.items())
        self.assertLess(jump, 0.02)

    def test_out_of_reach_it_stops_where_the_arm_ends(self):
        start = self.hands.marker("hand").pose
        far = xyz(start.position) + [5.0, 0.0, 0.0]
        pose = self.move_hand(far, self.quaternion(start), 600)
        reached = xyz(pose.position)
        self.assertTrue(np.isfinite(reached).all())
        self.assertLess(np.linalg.norm(reached), 1.6)
        again = self.move_hand(far, self.quaternion(start), 200)
        self.assertLess(np.linalg.norm(xyz(again.position) - reached), 0.02)

    def test_the_gripper_opens_and_closes(self):
        def width():
            rospy.sleep(0.1)
            return max(np.linalg.norm(self.obstacles[a] - self.obstacles[b])
                       for a in self.fingers() for b in self.fingers())
        closed = width()
        self.assertIn("open", self.hands.choose("hand", "Open the gripper"))
        self.steps(200)
        self.assertGreater(width(), closed + 0.04)
        self.assertIn("close", self.hands.choose("hand", "Close the gripper"))
        self.steps(200)
        self.assertAlmostEqual(width(), closed, delta=1e-6)

    def fingers(self):
        """Collision shapes that move when the gripper opens; found once."""
        if not hasattr(type(self), "finger_ids"):
            rospy.sleep(0.2)
            before = dict(self.obstacles)
            self.hands.choose("hand", "Open the gripper")
            self.steps(100)
            rospy.sleep(0.2)
            type(self).finger_ids = [i for i, p in before.items()
                                     if np.linalg.norm(self.obstacles[i] - p) > 1e-3]
            self.model.reset()
            rospy.sleep(0.2)
        return self.finger_ids


class GantryTest(NodeTest):
    node = "/gantry"

    def palm(self):
        rospy.sleep(0.1)
        return self.hands.marker("hand").pose

    def test_keyframes_wait_while_the_hand_is_taken(self):
        self.steps(100)
        self.assertAlmostEqual(self.palm().position.x, 0.05, delta=1e-6)
        self.hands.drag_hand((-0.1, 0.1, 0.3))
        self.steps(200)
        np.testing.assert_allclose(xyz(self.let_go_of_hand().position), (-0.1, 0.1, 0.3),
                                   atol=1e-3)
        self.steps(100)  # and it stays
        np.testing.assert_allclose(xyz(self.palm().position), (-0.1, 0.1, 0.3), atol=1e-3)
        self.assertIn("goes back", self.hands.choose("hand", "Back to the keyframes"))
        self.steps(33)  # 0.15 m at 1 m/s, then on with the keyframes
        self.assertAlmostEqual(self.palm().position.x, 0.05, delta=1e-3)
        self.steps(100)
        self.assertAlmostEqual(self.palm().position.x, 0.10, delta=1e-3)

    def test_beyond_its_limits_it_stops(self):
        self.hands.send("hand", Feedback.POSE_UPDATE, position=(3.0, 0.0, 0.2))
        self.hands.wait_until_taken()
        self.steps(200)
        self.assertAlmostEqual(self.palm().position.x, 0.25, delta=1e-3)

    def test_each_robot_has_a_hand(self):
        rospy.sleep(0.1)
        left = xyz(self.hands.marker("left_hand").pose.position)
        np.testing.assert_allclose(left, [0.0, 1.0, 0.0], atol=1e-6)
        self.hands.drag_hand((0.15, 1.1, 0.3), "left_hand")
        self.steps(100)
        np.testing.assert_allclose(xyz(self.let_go_of_hand("left_hand").position),
                                   (0.15, 1.1, 0.3), atol=1e-3)
        # The other one plays its keyframes meanwhile.
        self.assertAlmostEqual(self.palm().position.x, 0.05, delta=1e-6)
        self.assertIn("Back to the keyframes", self.hands.titles("hand"))
        self.assertIn("goes back", self.hands.choose("left_hand", "Back to the start"))
        self.steps(100)
        rospy.sleep(0.1)
        np.testing.assert_allclose(xyz(self.hands.marker("left_hand").pose.position), left,
                                   atol=1e-3)

    def test_a_hand_of_few_joints_has_no_rings(self):
        names = [control.name for control in self.hands.marker("hand").controls]
        self.assertIn("move_x", names)
        self.assertNotIn("turn_x", names)


class FollowedTest(unittest.TestCase):
    def test_a_robot_that_follows_joint_states_is_not_dragged_and_says_why(self):
        model = Model("/followed")
        hands = Hands("/followed")
        hands.said("follows joint_states")
        hands.marker("body/cloth")
        self.assertNotIn("hand", hands.markers)
        hands.close()
        wait_until(lambda: not is_listening("/followed"), "the end of the server")
        again = Hands("/followed")
        again.marker("body/cloth")
        rospy.sleep(0.2)
        self.assertEqual([text for text in again.log if "joint_states" in text], [])
        again.close()
        del model


class InteractiveTest(unittest.TestSuite):
    def __init__(self):
        super().__init__()
        load = unittest.defaultTestLoader.loadTestsFromTestCase
        for tests in (WithoutSubscriber, BodiesTest, ArmTest, GantryTest, FollowedTest):
            self.addTests(load(tests))


if __name__ == "__main__":
    rospy.init_node("interactive_test")
    rostest.rosrun("pliant", "interactive", "interactive_test.InteractiveTest", sys.argv)
