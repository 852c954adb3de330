"""Builds each fault of scripts/mutate as a library of the one file it is in, and runs tests with it.

That library is loaded before Pliant's own, so that whatever calls a function of that file calls the
faulty one. No source is written to, Pliant is linked once, and many faults are judged at a time.
"""

import collections
import glob
import hashlib
import json
import os
import queue
import re
import shlex
import signal
import subprocess
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor

from mutate_list import ROOT, fail, lines_of, path, place_of

FOLDER = path("build", "mutants")
LIBRARIES = os.path.join(FOLDER, "lib")
PRISTINE = "none"  # in place of a fault's name: tests as they are
NEAR_SHARES = 4    # processes that the tests near a fault are split into
MANY_FILES = 20    # whose tests near are about all tests


# ---- Faults as libraries ---------------------------------------------------------------------

def text_of_headers():
    names = sorted(glob.glob(path("src", "**", "*.h"), recursive=True))
    return "".join(open(name, encoding="utf-8").read() for name in names)


class Faults:
    """The library of each entry: build/mutants/NAME.so, NAME a hash of all it is made of."""

    def __init__(self, entries):
        headers = text_of_headers()
        self.texts = {}
        self.names = {}
        for entry in entries:
            number, mutant = place_of(entry)
            lines = lines_of(entry.file)
            lines[number] = mutant
            text = "\n".join(lines)
            name = hashlib.sha1("\0".join((entry.file, text, headers)).encode()).hexdigest()[:16]
            self.texts[entry] = text
            self.names[entry] = name

    def library(self, entry):
        return os.path.join(FOLDER, self.names[entry] + ".so")

    def is_built(self, entry):
        return os.path.exists(self.library(entry))

    def build(self, jobs):
        """Those that do not compile have no library afterwards."""
        os.makedirs(LIBRARIES, exist_ok=True)
        target = "pliant_core_to_interpose"
        done = subprocess.run(["cmake", "--build", path("build"), "--target", target], text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if done.returncode != 0:
            fail("cannot build %s:\n%s" % (target, done.stdout[-2000:]))
        link_others()
        with open(path("build", "compile_commands.json"), encoding="utf-8") as file:
            commands = [shlex.split(command["command"]) for command in json.load(file)]
        with ThreadPoolExecutor(jobs) as pool:
            list(pool.map(lambda entry: self.compile(entry, commands), self.texts))

    def compile(self, entry, commands):
        if self.is_built(entry):
            return
        words = compiler_of(entry.file, commands)
        part = self.library(entry) + ".part"
        with tempfile.TemporaryDirectory(dir=FOLDER) as folder:
            source = os.path.join(folder, entry.file[len("src/"):])
            os.makedirs(os.path.dirname(source))
            with open(source, "w", encoding="utf-8") as file:
                file.write(self.texts[entry])
            sources = [source] if source.endswith(".cpp") else instances_of(entry.file)
            done = subprocess.run(
                words[:1] + ["-I" + folder] + words[1:] + ["-w", "-shared", "-s", "-o", part] + sources,
                cwd=path("build"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        if done.returncode == 0:
            os.replace(part, self.library(entry))


def instances_of(header):
    """The files that compile the templates of a header for all others."""
    include = '#include "%s"' % header[len("src/"):]
    found = []
    for name in sorted(glob.glob(path("src", "**", "*.cpp"), recursive=True)):
        text = open(name, encoding="utf-8").read()
        own = os.path.splitext(name)[0] + ".h"
        if os.path.exists(own):
            text += open(own, encoding="utf-8").read()
        if include in text and "\ntemplate class " in text:
            found.append(name)
    if not found:
        fail("%s: no file compiles it for others (`template class`): faults of it cannot be loaded" % header)
    return found


def compiler_of(source, commands):
    """How a file of the same floor is compiled, without its own name and its object's."""
    ending = "pliant_floor_%s.dir/" % source.split("/")[2]
    for words in commands:
        at = words.index("-o")
        if ending in words[at + 1] and words[at + 1].endswith(".o"):  # not a precompiled header
            words = words[:at] + words[at + 2:]
            at = words.index("-c")
            return words[:at] + words[at + 2:]
    fail("build/compile_commands.json has no file of %s: configure first" % ending)


def link_others():
    """What the library loads while a program runs lies beside it."""
    for name in glob.glob(path("devel", "lib", "libpliant_*.so")):
        link = os.path.join(LIBRARIES, os.path.basename(name))
        if not os.path.lexists(link):
            os.symlink(name, link)


# ---- Which tests -----------------------------------------------------------------------------

def suites_in(name):
    text = "\n".join(lines_of(name))
    suites = set()
    for macro, suite in re.findall(r"^(TEST|TEST_F|TEST_P|TYPED_TEST|TYPED_TEST_P)\(\s*(\w+)", text, re.M):
        if macro in ("TEST", "TEST_F"):
            suites.add(suite + ".*")
        else:
            suites.update(("*/%s.*" % suite, "*/%s/*" % suite, "%s/*" % suite))
    return suites


def tests_near(program, source):
    """A filter of the suites that cover a source file in one of the test programs; '' for none."""
    header = os.path.splitext(source)[0][len("src/"):] + ".h"
    files = glob.glob(os.path.join("tests", program, "**", "*.cpp"), root_dir=ROOT, recursive=True)
    own = {name for name in files if '#include "%s"' % header in "\n".join(lines_of(name))}
    folder, stem = os.path.split(os.path.splitext(header)[0])
    folder = folder[len("pliant/"):]
    words = (stem, os.path.basename(folder))
    named = {name for name in files if any(word in os.path.basename(name) for word in words)}
    while program == "unit" and folder and not own:
        own = {name for name in files if name.startswith("tests/unit/" + folder + "/")}
        folder = os.path.dirname(folder)
    return ":".join(sorted(set().union(*(suites_in(name) for name in own | named))))


# One of equal shares of a program's tests: of those near a fault, or of those that a filter lets through.
Task = collections.namedtuple("Task", "program tests share shares")
NEAR = "near"


def name_of(task):
    return "%s %s %d/%d" % (task.program, task.tests, task.share + 1, task.shares)


def tasks_of(program, tests, shares):
    return [Task(program, tests, share, shares) for share in range(shares)]


# ---- Judging ---------------------------------------------------------------------------------

class Judged:
    """One fault on its way through the tests."""

    def __init__(self, name, entry=None, library=None):
        self.name = name
        self.entry = entry
        self.library = library
        self.caught_by = None
        self.passed = set()  # names of tasks
        self.waiting = 0  # tasks of the present stage that have not ended
        self.stage = 0


class Judge:
    def __init__(self, options, report):
        self.options = options
        self.report = report  # called with each fault once its verdict is known
        self.lock = threading.Lock()
        self.tasks = queue.PriorityQueue()
        self.failing = set()  # tests that fail without any fault
        self.log = None
        self.known = collections.defaultdict(dict)  # of a log: what came of the tasks of each fault
        self.children = {}  # that run now: whose fault each has
        self.is_over = False

    # ---- The log ----

    def open_log(self, name):
        if name is None:
            return
        if os.path.exists(name):
            with open(name, encoding="utf-8") as file:
                for line in file:
                    fault, task, outcome = line.rstrip("\n").split("\t")
                    self.known[fault][task] = outcome
        self.log = open(name, "a", encoding="utf-8")

    def note(self, fault, task, outcome):
        if self.log:
            print("\t".join((fault.name, name_of(task), outcome)), file=self.log, flush=True)

    # ---- One run of tests ----

    def run(self, fault, task, cpu):
        """'passed', or the name of what failed; of tests as they are, all that failed."""
        tests = task.tests
        if tests == NEAR:
            tests = tests_near(task.program, fault.entry.file)
            if not tests:
                return "passed"
        words = ["./%s_tests" % task.program, "--gtest_brief=1",
                 "--gtest_filter=%s-%s" % (tests, ":".join(sorted(self.failing)))]
        environment = dict(os.environ, PLIANT_TEST_CPU_SECONDS="1e9")
        environment["LD_LIBRARY_PATH"] = os.pathsep.join(
            filter(None, (LIBRARIES, os.environ.get("LD_LIBRARY_PATH"))))
        environment.update(GTEST_TOTAL_SHARDS=str(task.shares), GTEST_SHARD_INDEX=str(task.share))
        if fault.library:
            words.append("--gtest_fail_fast")
            environment["LD_PRELOAD"] = fault.library
        # As many threads as the processor's share of this run.
        code, text = self.child(fault, ["taskset", "-c", str(cpu)] + words, environment)
        failed = re.findall(r"^\[  FAILED  \] ([\w/.]+)", text, re.M)
        if not fault.library:
            if code not in (0, 1) and not self.is_over:
                fail("%s ends with %d without any fault:\n%s" % (name_of(task), code, text[-1000:]))
            return " ".join(sorted(set(failed))) or "passed"
        return "passed" if code == 0 else "a hang" if code == 124 else failed[0] if failed else "a crash"

    def child(self, fault, words, environment):
        child = subprocess.Popen(words, cwd=path("build"), stdout=subprocess.PIPE, env=environment,
                                 stderr=subprocess.STDOUT, text=True, errors="replace",
                                 start_new_session=True)
        with self.lock:
            self.children[child] = fault
            if self.is_over:
                kill(child)
        try:
            text, _ = child.communicate(timeout=self.options.seconds)
            return child.returncode, text
        except subprocess.TimeoutExpired:
            kill(child)
            child.communicate()
            return 124, ""
        finally:
            with self.lock:
                del self.children[child]

    # ---- Many of them ----

    def stages(self):
        """Lists of tasks, each only for what came through those before it."""
        programs = self.options.programs
        stages = [tasks_of(program, NEAR, NEAR_SHARES) for program in programs]
        if self.options.all:
            stages += [tasks_of(program, self.options.tests, self.options.shares)
                       for program in programs]
        return stages

    def put(self, fault, number):
        """The tasks of a fault's present stage; what a log knows of is not run again."""
        while fault.stage < len(self.all_stages):
            stage = self.all_stages[fault.stage]
            outcomes = [self.known[fault.name].get(name_of(task)) for task in stage]
            caught = [outcome for outcome in outcomes if outcome not in (None, "passed")]
            if caught:
                fault.caught_by = caught[0]
                break
            to_run = [task for task, outcome in zip(stage, outcomes) if outcome is None]
            if to_run:
                fault.waiting = len(to_run)
                for task in to_run:
                    self.tasks.put((fault.stage, task.share, number, task))
                return
            fault.stage += 1
        self.open_faults -= 1
        self.report(fault)

    def ended(self, fault, number, task, outcome):
        with self.lock:
            if fault.caught_by is not None or self.is_over:
                return
            self.note(fault, task, outcome)
            if outcome != "passed":
                fault.caught_by = outcome
                for child, whose in self.children.items():
                    if whose is fault:
                        kill(child)
                self.open_faults -= 1
                self.report(fault)
                return
            fault.waiting -= 1
            if fault.waiting == 0:
                fault.stage += 1
                self.put(fault, number)

    def work(self, faults, cpu):
        while self.open_faults > 0 and not self.is_over:
            try:
                _, _, number, task = self.tasks.get(timeout=0.2)
            except queue.Empty:
                continue
            fault = faults[number]
            if fault.caught_by is None:
                self.ended(fault, number, task, self.run(fault, task, cpu))

    def pristine_runs(self, faults):
        """What has to be run without a fault: (a name for the log and whose tests are near, task)."""
        programs = self.options.programs
        one_a_file = {fault.entry.file: fault.entry for fault in faults}
        if self.options.all or len(one_a_file) > MANY_FILES:
            return [(Judged(PRISTINE), task) for program in programs
                    for task in tasks_of(program, self.options.tests, self.options.shares)]
        return [(Judged("%s %s" % (PRISTINE, name), entry), task)
                for name, entry in sorted(one_a_file.items()) for program in programs
                for task in tasks_of(program, NEAR, NEAR_SHARES)]

    def find_failing(self, faults, jobs):
        """Tests that fail as they are say nothing of faults: they are left out."""
        cpus = queue.Queue()
        for cpu in processors(jobs):
            cpus.put(cpu)

        def try_one(pristine, task):
            outcome = self.known[pristine.name].get(name_of(task))
            if outcome is None and not self.is_over:
                cpu = cpus.get()
                outcome = self.run(pristine, task, cpu)
                cpus.put(cpu)
                with self.lock:
                    self.note(pristine, task, outcome)
            return [] if outcome in ("passed", None) else outcome.split()

        with ThreadPoolExecutor(jobs) as pool:
            try:
                for failed in pool.map(lambda run: try_one(*run), self.pristine_runs(faults)):
                    self.failing.update(failed)
            except BaseException:
                self.stop()
                raise

    def judge(self, faults, jobs):
        """Gives each a verdict: caught_by is None for what survived."""
        self.all_stages = self.stages()
        self.find_failing(faults, jobs)
        self.open_faults = len(faults)
        with self.lock:
            for number, fault in enumerate(faults):
                self.put(fault, number)
        threads = [threading.Thread(target=self.work, args=(faults, cpu)) for cpu in processors(jobs)]
        for thread in threads:
            thread.start()
        try:
            while any(thread.is_alive() for thread in threads):
                for thread in threads:
                    thread.join(0.2)
        finally:
            self.stop()

    def stop(self):
        with self.lock:
            self.is_over = True
            for child in self.children:
                kill(child)


def processors(jobs):
    own = sorted(os.sched_getaffinity(0))
    return [own[k % len(own)] for k in range(jobs)]


def kill(child):
    try:
        os.killpg(child.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass
