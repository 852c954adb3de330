"""Engines of a sweep: who runs its shards. Each is a context: run() may be called several times within it.

run(task, shards, note, elsewhere): note(done) is called for each shard that is finished. elsewhere: {first row:
worker} of shards that another worker shall run than that, where there is one.
"""

import concurrent.futures
import os
import shlex
import shutil
import subprocess
import sys
import time

import sweep_shard
import whole_file
from sweep_shard import SweepError, run_shard

TOLD_AFTER = 60.0  # [s] without a worker


class LocalEngine:
    """Processes of this machine."""

    def __init__(self, options):
        self.workers = options.workers

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def run(self, task, shards, note, elsewhere=None):
        children, executor = [], concurrent.futures.ThreadPoolExecutor(self.workers)
        futures = [executor.submit(run_shard, task, *shard, children) for shard in shards]
        try:
            for future in concurrent.futures.as_completed(futures):
                note(future.result())
        except BaseException:
            executor.shutdown(wait=False, cancel_futures=True)
            for child in list(children):
                child.kill()
            raise
        executor.shutdown()


class DaskEngine:
    """A scheduler that is there already (--address), or one of this process with workers of this machine."""

    def __init__(self, options):
        self.options, self.client, self.cluster = options, None, None

    def __enter__(self):
        try:
            import cloudpickle
            import dask
            from dask.distributed import Client
        except ImportError as error:
            raise SweepError(f"--engine {self.options.engine}: {error} (Debian: python3-distributed); --engine local "
                             "needs nothing")
        # Workers need not have these files.
        for module in (sweep_shard, whole_file):
            cloudpickle.register_pickle_by_value(module)
        # Of a worker that is lost the shards go to others; a shard that ends its workers is not the rule here: rows
        # that crash end a child of the worker alone.
        dask.config.set({"distributed.scheduler.allowed-failures": 100})
        try:
            self.client = self.connect(Client)
        except OSError as error:
            raise SweepError(f"--address {self.options.address}: no scheduler answers there: {error}")
        print(f"dashboard: {self.client.dashboard_link}", file=sys.stderr)
        return self

    def connect(self, client):
        if self.options.address:
            return client(self.options.address, timeout=30)
        from dask.distributed import LocalCluster

        self.cluster = LocalCluster(n_workers=self.options.workers, threads_per_worker=1, dashboard_address=":0")
        return client(self.cluster)

    def __exit__(self, *_):
        self.client.close()
        if self.cluster is not None:
            self.cluster.close()

    def run(self, task, shards, note, elsewhere=None):
        from dask.distributed import as_completed

        self.wait_for_a_worker()
        others = self.others(elsewhere or {})
        futures = [self.client.submit(run_shard, task, *shard, pure=False, retries=2, workers=others.get(shard[0]),
                                      allow_other_workers=others.get(shard[0]) is not None) for shard in shards]
        for future in as_completed(futures):
            note(future.result())

    def others(self, elsewhere):
        """Of each of these rows the addresses of all workers but one, where there are others."""
        if not elsewhere:
            return {}
        names = self.client.run(sweep_shard.worker_name)
        return {row: [address for address, name in names.items() if name != worker] or None
                for row, worker in elsewhere.items()}

    def wait_for_a_worker(self):
        start, told = time.time(), False
        while not self.client.scheduler_info()["workers"]:
            if not told and time.time() - start > TOLD_AFTER:
                print(f"no worker has come in {TOLD_AFTER:g} s: {self.advice()}", file=sys.stderr)
                told = True
            self.check()
            time.sleep(0.2)

    def advice(self):
        return "start `dask-worker` with this scheduler's address"

    def check(self):
        pass


class SlurmEngine(DaskEngine):
    """A scheduler of this process, whose workers are the tasks of a job array of Slurm."""

    job = None

    def __enter__(self):
        if shutil.which("sbatch") is None:
            raise SweepError("--engine slurm: there is no program 'sbatch' on PATH: call this on a machine of the cluster")
        return super().__enter__()

    def connect(self, client):
        from dask.distributed import LocalCluster
        from distributed.utils import get_ip

        host = self.options.host or get_ip()
        self.cluster = LocalCluster(n_workers=0, host=host, dashboard_address=":0")
        try:
            self.job = self.submit(self.cluster.scheduler_address)
        except BaseException:
            self.cluster.close()
            raise
        print(f"Slurm: job {self.job}, {self.options.workers} workers of {self.cluster.scheduler_address}",
              file=sys.stderr)
        return client(self.cluster)

    def submit(self, address):
        worker = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-dashboard",
                  "--death-timeout", "60"]
        log = os.path.join(os.path.abspath(self.options.out), "slurm-%A_%a.log")
        command = ["sbatch", "--parsable", f"--array=1-{self.options.workers}", "--job-name=pliant-sweep",
                   f"--output={log}", *shlex.split(self.options.sbatch), f"--wrap=exec {shlex.join(worker)}"]
        answer = subprocess.run(command, capture_output=True, text=True)
        if answer.returncode != 0:
            raise SweepError(f"sbatch: {answer.stderr.strip() or f'exit code {answer.returncode}'}")
        return answer.stdout.strip().split(";")[0]

    def advice(self):
        return f"`squeue -j {self.job}` says what job {self.job} waits for"

    def check(self):
        """Throws where the job has ended before a worker came."""
        queue = subprocess.run(["squeue", "-h", "-j", self.job], capture_output=True, text=True)
        if queue.returncode != 0 or not queue.stdout.strip():
            log = os.path.join(self.options.out, f"slurm-{self.job}_1.log")
            raise SweepError(f"Slurm's job {self.job} ended before a worker came: {log} tells why")

    def __exit__(self, *_):
        super().__exit__()
        subprocess.run(["scancel", self.job], capture_output=True)


ENGINES = {"local": LocalEngine, "dask": DaskEngine, "slurm": SlurmEngine}
