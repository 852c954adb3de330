#!/usr/bin/python3
"""Nodes that are started wrongly end at once with exit code 2 and say what is wrong."""

import os
import subprocess
import sys
import tempfile
import unittest

import roslib.packages
import rospkg
import rospy
import rostest

PACKAGE = rospkg.RosPack().get_path("pliant")
SCENE = PACKAGE + "/tests/ros/scenes/hanging.yaml"


class BadParametersTest(unittest.TestCase):
    def refused(self, node, parameters, *words):
        # As roslaunch finds it; rosrun misses nodes in a build folder named `build`.
        program = roslib.packages.find_node("pliant", node)[0]
        command = [program, "__name:=bad"] + ["_%s:=%s" % entry for entry in parameters.items()]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=20, check=False)
        if rospy.has_param("/bad"):
            rospy.delete_param("/bad")
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn("FATAL", done.stdout)
        for word in words:
            self.assertIn(word, done.stdout)

    def test_node(self):
        self.refused("pliant_node", {}, "'scene' is missing")
        self.refused("cloth_node", {"scene": "/none.yaml"}, "/none.yaml")
        self.refused("cloth_node", {"scene": SCENE, "surface_rat": 3},
                     "did you mean 'surface_rate'")
        self.refused("cloth_node", {"scene": SCENE, "surface_rate": -1}, "surface_rate", ">= 0")
        self.refused("cloth_node", {"scene": SCENE, "real_time": "maybe"}, "real_time",
                     "true or false")
        self.refused("cloth_node", {"scene": SCENE, "solver": "xpdb"}, "did you mean 'xpbd'")
        self.refused("cloth_node", {"scene": SCENE, "time_step": "nan"}, "time_step")
        self.refused("cloth_node", {"scene": SCENE, "color_by": "strian"}, "~color_by",
                     "did you mean 'strain'")
        self.refused("cloth_node", {"scene": SCENE, "color_by": "temperature"}, "~color_by",
                     "stretch")
        self.refused("cloth_node", {"scene": SCENE, "color_min": 2, "color_max": 1}, "color_min",
                     "must not be above")
        self.refused("cloth_node", {"scene": SCENE, "backend": "gpu"}, "backend", "cuda")
        self.refused("cloth_node", {"scene": SCENE, "solver": "verlet", "backend": "cuda"},
                     "verlet", "on the CPU only")
        self.refused("cloth_node", {"scene": SCENE, "publish_robot_base": "true"}, "no robot")
        self.refused("cloth_node", {"scene": SCENE, "use_joint_states": "true"}, "no robot")
        self.refused("cloth_node", {"scene": SCENE, "publish_robot_tf": "true"}, "no robot")
        grippers = PACKAGE + "/tests/ros/scenes/two_grippers.yaml"
        self.refused("pliant_node", {"scene": grippers, "hand_link": "palm, left_plam"},
                     "~hand_link", "did you mean 'left_palm'")
        self.refused("pliant_node", {"scene": grippers, "hand_link": "left_palm, left_column"},
                     "two links of one robot")

    def test_default_scenes(self):
        """Each node that is called after a model runs a scene of its own when it is given none."""
        for node, scene in (("cloth_node", "demo_cloth"), ("patch_node", "demo_patch"),
                            ("reduced_node", "plucked_bridge"),
                            ("viscoelastic_node", "demo_viscoelastic")):
            program = roslib.packages.find_node("pliant", node)[0]
            text = subprocess.run([program, "--help"], stdout=subprocess.PIPE, text=True,
                                  timeout=20, check=True).stdout
            path = "%s/config/scenes/%s.yaml" % (PACKAGE, scene)
            self.assertIn(path, text)
            self.assertTrue(os.path.exists(path), path)

    def test_bad_scene(self):
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            file.write("time_stp: 0.01\n")
            file.flush()
            self.refused("cloth_node", {"scene": file.name}, os.path.basename(file.name) + ":1",
                         "did you mean 'time_step'")

    def test_robot_player(self):
        self.refused("robot_player", {}, "'keyframes' is missing")
        self.refused("robot_player", {"keyframes": "/none.yaml"}, "/none.yaml")
        motion = PACKAGE + "/config/robots/demo_cloth_motion.yaml"
        self.refused("robot_player", {"keyframes": motion, "rate": 0}, "rate", "> 0")
        # Poses need the robot, and nobody describes one here.
        posed = PACKAGE + "/config/robots/demo_motion.yaml"
        self.refused("robot_player", {"keyframes": posed}, "it has poses", "'robot_description'")


if __name__ == "__main__":
    rospy.init_node("bad_parameters_test")
    rostest.rosrun("pliant", "bad_parameters_test", BadParametersTest, sys.argv)
