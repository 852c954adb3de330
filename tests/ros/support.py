"""What the rostests share: a client of one model node, and tests that begin from its first state."""

import faulthandler
import threading
import time
import unittest

import numpy as np
import rosgraph
import rospy
from sensor_msgs.msg import PointCloud2
from std_srvs.srv import Trigger

from pliant.msg import SolverStatus
from pliant.srv import (ApplyForce, ApplyForceRequest, Attach, AttachRequest, ClearForces, Detach,
                        ListSolvers, SetField, SetFieldRequest, Step, SwitchSolver)

PATIENCE = 15.0  # [s] of wall time for anything to happen


# rostest ends a test that takes too long without a word about where it was.
faulthandler.dump_traceback_later(50.0)


def wait_until(condition, what, patience=PATIENCE):
    """Returns the first true value of `condition()`. In wall time: ROS time may stand still."""
    deadline = time.monotonic() + patience
    while not rospy.is_shutdown():
        value = condition()
        if value:
            return value
        if time.monotonic() > deadline:
            raise AssertionError("%s: not within %g s" % (what, patience))
        time.sleep(0.002)
    raise AssertionError("shut down while waiting for " + what)


class Latest:
    """The latest message of a topic, and how many there were."""

    def __init__(self, topic, kind, callback=None, **options):
        self.callback = callback
        self.lock = threading.Lock()
        self.message = None
        self.count = 0
        self.topic = topic
        # Else the kernel holds small messages back until the last one is acknowledged, up to 40 ms,
        # and meanwhile the node's queue drops those that follow.
        options.setdefault("tcp_nodelay", True)
        self.subscriber = rospy.Subscriber(topic, kind, self.take, **options)

    def take(self, message):
        with self.lock:
            self.message = message
            self.count += 1
        if self.callback:
            self.callback(message)

    def first(self):
        return wait_until(lambda: self.message, "a message on " + self.topic)

    def new(self, skip=2):
        """A message that was made after this call: those that were on their way are skipped."""
        seen = self.count
        wait_until(lambda: self.count > seen + skip, "messages on " + self.topic)
        return self.message

    def when(self, condition, what):
        """The first message for which `condition(message)` is true."""
        return wait_until(lambda: self.message is not None and condition(self.message)
                          and self.message, what + " on " + self.topic)


def columns(cloud):
    """Fields of a PointCloud2 by name, each an array of float32."""
    names = [field.name for field in cloud.fields]
    values = np.frombuffer(cloud.data, np.float32).reshape(-1, len(names))
    return {name: values[:, k] for k, name in enumerate(names)}


def wait_for_service(name):
    """Asks the master alone: rospy's function of this name opens a connection and closes it at once,
    and the next one, which gets its file descriptor, may be lost by that (see Service)."""
    master = rosgraph.Master("/test")

    def is_offered():
        try:
            return master.lookupService(name)
        except rosgraph.MasterException:
            return None
    wait_until(is_offered, "service " + name)


class Service:
    """Calls a service over a connection that each thread opens once.

    Not a connection a call, as rospy does without `persistent`: under load roscpp's poll thread now
    and then takes the hang-up of a connection that it just closed for one of the next connection,
    which got the same file descriptor, and drops that. Then the call fails although the node is
    well. (A bare roscpp server does the same; ros/ros_comm#1976 is akin.)
    """

    def __init__(self, name, kind):
        self.name = name
        self.kind = kind
        self.local = threading.local()

    def __call__(self, *arguments, **keywords):
        if not hasattr(self.local, "proxy"):
            self.local.proxy = rospy.ServiceProxy(self.name, self.kind, persistent=True)
        return self.local.proxy(*arguments, **keywords)


class Model:
    """Services and topics of the model node `name`. Any thread may call."""

    def __init__(self, name="/cloth"):
        self.name = name
        kinds = {"apply_force": ApplyForce, "clear_forces": ClearForces, "attach": Attach,
                 "detach": Detach, "list_solvers": ListSolvers, "set_field": SetField, "step": Step,
                 "switch_solver": SwitchSolver,
                 "pause": Trigger, "resume": Trigger, "reset": Trigger}
        for service, kind in kinds.items():
            wait_for_service(name + "/" + service)
            setattr(self, service, Service(name + "/" + service, kind))
        self.points = Latest(name + "/points", PointCloud2, queue_size=1, buff_size=1 << 22)
        self.status = Latest(name + "/status", SolverStatus, queue_size=1)

    def push(self, force=(0.0, 0.0, 0.0), point=(0.0, 0.0, 0.0), frame="", radius=0.1,
             duration=0.0, start=0.0, body=""):
        request = ApplyForceRequest(reference_frame=frame, radius=radius, body=body)
        request.force.x, request.force.y, request.force.z = force
        request.reference_point.x, request.reference_point.y, request.reference_point.z = point
        request.duration = rospy.Duration(duration)
        request.start_time = rospy.Time(start)
        return self.apply_force(request)

    def hold(self, point=(0.0, 0.0, 0.0), radius=0.1, to="", stiffness=1e3, name="", frame="",
             body=""):
        request = AttachRequest(name=name, reference_frame=frame, radius=radius, to=to,
                                stiffness=stiffness, body=body)
        request.reference_point.x, request.reference_point.y, request.reference_point.z = point
        return self.attach(request)

    def set_near(self, field, value, point=(0.0, 0.0, 0.0), radius=0.1, duration=0.0, frame="",
                 body=""):
        request = SetFieldRequest(field=field, value=value, reference_frame=frame, radius=radius,
                                  body=body)
        request.reference_point.x, request.reference_point.y, request.reference_point.z = point
        request.duration = rospy.Duration(duration)
        return self.set_field(request)

    def switch(self, solver, backend="", body="", time_integration="", **parameters):
        return self.switch_solver(solver, backend, list(parameters),
                                  [str(value) for value in parameters.values()], body,
                                  time_integration)


# Of every model whose elements are projected.
PROJECTIVE_SOLVERS = ["jacobi", "line_search_jacobi", "gauss_seidel", "hybrid", "chebyshev", "direct",
                      "lbfgs", "newton", "xpbd"]


class ModelTest(unittest.TestCase):
    """Each test begins with a paused node in its first state, moved by a solver of known name."""

    node = ""
    solver = ""
    parameters = {}

    @classmethod
    def setUpClass(cls):
        cls.model = Model(cls.node)

    @classmethod
    def tearDownClass(cls):
        cls.model.resume()

    def setUp(self):
        self.model.clear_forces()
        self.model.pause()
        self.model.reset()
        answer = self.model.switch(self.solver, **self.parameters)
        self.assertTrue(answer.success, answer.message)

    def takes_over(self, solver):
        """It moves the body on, and the body stays finite."""
        answer = self.model.switch(solver)
        self.assertTrue(answer.success, answer.message)
        self.assertTrue(self.model.step(2).success)
        x = columns(self.model.points.new())["x"]
        self.assertTrue(np.isfinite(x).all(), solver)
