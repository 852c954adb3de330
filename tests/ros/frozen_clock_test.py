#!/usr/bin/python3
"""Every service works while ROS time stands still: use_sim_time is set and no clock runs."""

import sys
import time
import unittest

import rospy
import rostest

from support import Model, columns


class FrozenClockTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.model = Model()

    def test_time_stands_still(self):
        self.assertTrue(rospy.rostime.is_wallclock() is False)
        self.assertEqual(rospy.get_time(), 0.0)

    def test_pause_step_resume(self):
        self.assertTrue(self.model.pause().success)
        answer = self.model.step(20)
        self.assertTrue(answer.success, answer.message)
        stepped = self.model.status.new()
        self.assertTrue(stepped.paused)
        time.sleep(0.2)
        self.assertEqual(self.model.status.new().step, stepped.step)
        self.assertTrue(self.model.resume().success)
        self.model.status.when(lambda s: s.step > stepped.step, "further steps")

    def test_reset_gives_the_first_state_bit_for_bit(self):
        self.model.pause()
        self.model.switch("xpbd")
        runs = []
        for _ in range(2):
            self.assertTrue(self.model.reset().success)
            states = [self.model.points.new().data]
            for steps in (1, 9, 90):
                self.assertTrue(self.model.push(force=(0.1, 0.3, 0.0), duration=0.2).success)
                self.assertTrue(self.model.step(steps).success)
                states.append(self.model.points.new().data)
            runs.append(states)
            self.assertEqual(len(set(states)), 4)
        self.assertEqual(runs[0], runs[1])

    def test_force_and_frames(self):
        self.model.pause()
        self.model.reset()
        self.assertTrue(self.model.push(force=(0.0, 1.0, 0.0), radius=1.0, duration=-1.0).success)
        start = time.monotonic()
        self.assertFalse(self.model.push(frame="nowhere").success)
        self.assertLess(time.monotonic() - start, 2.0)
        self.assertTrue(self.model.step(1).success)
        self.assertGreater(columns(self.model.points.new())["vy"].mean(), 0.01)
        self.model.clear_forces()

    def test_solver_swapped_in_motion(self):
        """A hundred swaps, with a step between them: each leaves positions and velocities alone.

        Over every solver; the launch file's step is one that all of them take.
        """
        self.model.pause()
        self.model.reset()
        self.model.step(30)
        solvers = [solver.name for solver in self.model.list_solvers().solvers]
        # Points come every two milliseconds: of a busy machine a dozen may be on their way.
        underway = 15
        for k in range(100):
            before = self.model.points.new(underway).data
            answer = self.model.switch(solvers[k % len(solvers)])
            self.assertTrue(answer.success, answer.message)
            self.assertEqual(self.model.points.new(underway).data, before, "swap %d" % k)
            self.assertTrue(self.model.step(1).success)
        moved = columns(self.model.points.new())
        self.assertGreater(abs(moved["vz"]).max(), 0.01)
        self.assertLess(abs(moved["vz"]).max(), 10.0)


if __name__ == "__main__":
    rospy.init_node("frozen_clock_test")
    rostest.rosrun("pliant", "frozen_clock_test", FrozenClockTest, sys.argv)
