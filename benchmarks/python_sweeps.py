#!/usr/bin/env python3
"""Time that executors add to each mission of a sweep.

usage: python_sweeps.py [--missions N ...] [--repeats N] [--workers N]

    pip install protean-robotics                        # or target/wheels/*.whl
    pip install distributed ray hyperqueue mpi4py       # those that shall be measured, too
    benchmarks/python_sweeps.py
    mpiexec -n 3 python -m mpi4py.futures benchmarks/python_sweeps.py --workers 2     # MPI alone

The missions are the cheapest: one robot, one simulated second. Each sweep with an executor follows one without it, on the same number of
cores; a figure is the median of (time with executor - time without) / missions. The executor runs before, as on a cluster: its start with
a first small sweep, which imports the package in its workers, is a column of its own. All tables are compared byte for byte.
"""

import argparse
import multiprocessing
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import protean_robotics as pr

EXPERIMENT = """
scenario = "builtin:hello"
seeds = { first = 1, count = 1 }
[parameters.limit]
set = "rules.time_limit"
[grid]
limit = [1.0]
"""


@contextmanager
def pool(workers: int) -> Iterator[pr.Executor]:
    with ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn")) as executor:
        yield executor


@contextmanager
def dask(workers: int) -> Iterator[pr.Executor]:
    import distributed

    with (
        distributed.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client.get_executor()


@contextmanager
def ray(workers: int) -> Iterator[pr.Executor]:
    import ray

    environment = {"PYTHONPATH": os.pathsep.join(sys.path)}
    ray.init(num_cpus=workers, include_dashboard=False, logging_level="error", runtime_env={"env_vars": environment})
    try:
        yield pr.executors.Ray()
    finally:
        ray.shutdown()


@contextmanager
def hyperqueue(workers: int) -> Iterator[pr.Executor]:
    import hyperqueue
    from hyperqueue.cluster import WorkerConfig
    from hyperqueue.task.function import PythonEnv

    with hyperqueue.LocalCluster() as local:
        local.start_worker(WorkerConfig(cores=workers))
        yield pr.executors.HyperQueue(local.client(python_env=PythonEnv(python_bin=sys.executable)), "parts")


@contextmanager
def mpi(workers: int) -> Iterator[pr.Executor]:
    from mpi4py import futures

    with futures.MPIPoolExecutor(workers) as executor:
        yield executor


Engine = Callable[[int], AbstractContextManager[pr.Executor]]
ENGINES: dict[str, Engine] = {"ProcessPoolExecutor": pool, "Dask": dask, "Ray": ray, "HyperQueue": hyperqueue}


def timed(missions: int, workers: int, executor: pr.Executor | None) -> tuple[float, bytes]:
    """Runs a sweep that nothing is known of; returns its time (s) and its table."""
    with tempfile.TemporaryDirectory() as out:
        begin = time.perf_counter()
        done = pr.sweep(
            "cheap.toml",
            out=out,
            in_process=True,
            seeds=range(1, missions + 1),
            executor=executor,
            jobs=workers,
            quiet=True,
        )
        spent = time.perf_counter() - begin
        return spent, (done.directory / "results.csv").read_bytes()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--missions", type=int, nargs="+", default=[400, 1000, 2000])
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()
    os.chdir(tempfile.mkdtemp())
    Path("cheap.toml").write_text(EXPERIMENT)
    under_mpi = "mpi4py.futures" in sys.modules
    columns = "".join(f"{f'{missions} missions':>34}" for missions in arguments.missions)
    print(f"{arguments.workers} workers, median of {arguments.repeats} pairs (smallest … largest)")
    print(f"{'':20} {'start':>7}{columns}")
    for name, engine in ({"mpi4py.futures": mpi} if under_mpi else ENGINES).items():
        try:
            begin = time.perf_counter()
            with engine(arguments.workers) as executor:
                timed(4 * arguments.workers, arguments.workers, executor)
                figures = f"{time.perf_counter() - begin:5.1f} s"
                for missions in arguments.missions:
                    added = []
                    for _ in range(arguments.repeats):
                        without, expected = timed(missions, arguments.workers, None)
                        spent, table = timed(missions, arguments.workers, executor)
                        assert table == expected, f"{name}: another table"
                        added.append(1000 * (spent - without) / missions)
                    median = statistics.median(added)
                    figures += f"{f'{median:.2f} ms ({min(added):.2f} … {max(added):.2f})':>34}"
        except ImportError as error:
            figures = f"{error.name} missing"
        print(f"{name:20} {figures}", flush=True)


if __name__ == "__main__":
    main()
