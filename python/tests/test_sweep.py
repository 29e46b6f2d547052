"""Sweeps: the same table from the command, threads, other processes and executors, with any faults."""

import csv
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import pytest

import protean_robotics as pr

EXPERIMENT = """
scenario = "builtin:hello"
seeds = { first = 1, count = 3 }

[[cases]]
name = "plain"

[[cases]]
name = "shy"
set.defaults.robot.start_jitter = { x = 0.1, y = 0.1 }

[parameters.limit]
set = "rules.time_limit"

[grid]
limit = [0.5, 1]
"""
MISSIONS = 12

PLANNERS = """
import os
import signal
from pathlib import Path

import protean_robotics as pr


@pr.planner
def ahead(robot, rng):
    return 0.5 * robot.v_max, rng.normal(scale=0.2)


@pr.planner
def fatal(robot, world, rng):
    # The process ends once, in the middle of a mission: that of the worker that removes the file.
    fuse = Path(__file__).with_name("fuse")
    if world.time > 0.3 and fuse.exists():
        try:
            fuse.unlink()
        except FileNotFoundError:
            pass
        else:
            os.kill(os.getpid(), signal.SIGKILL)
    return 0.5 * robot.v_max, rng.normal(scale=0.2)
"""


@pytest.fixture(autouse=True)
def _experiment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    Path("limits.toml").write_text(EXPERIMENT)
    Path("planners_of_the_sweep.py").write_text(PLANNERS)
    monkeypatch.syspath_prepend(tmp_path)
    # Workers of an executor import it too.
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")]))
    sys.modules.pop("planners_of_the_sweep", None)


def table(sweep: pr.Sweep) -> bytes:
    return (sweep.directory / "results.csv").read_bytes()


def rows(sweep: pr.Sweep) -> list[dict[str, str]]:
    with (sweep.directory / "results.csv").open() as file:
        return list(csv.DictReader(file))


def planner(name: str) -> pr.Planner:
    found = getattr(__import__("planners_of_the_sweep"), name)
    assert isinstance(found, pr.Planner)
    return found


def by_command() -> bytes:
    command = [str(pr.program()), "sweep", "limits.toml", "--out=by-command", "--quiet"]
    subprocess.run(command, check=True, capture_output=True)
    return Path("by-command/results.csv").read_bytes()


def processes(workers: int) -> ProcessPoolExecutor:
    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"))


def test_the_table_is_that_of_the_command_from_threads_processes_and_executors() -> None:
    whole = by_command()
    done = pr.sweep("limits.toml", in_process=True, quiet=True)
    assert done.directory == Path("results/limits")
    assert done.summary["carried_out"] == MISSIONS
    assert table(done) == whole
    assert done.table.exists()
    with ThreadPoolExecutor(2) as threads:
        there = pr.sweep("limits.toml", out="threads", executor=threads, shards=5, quiet=True)
    assert table(there) == whole
    # Nothing is left to run.
    again = pr.sweep("limits.toml", out="threads", executor=ThreadPoolExecutor(1), quiet=True)
    assert (again.summary["carried_out"], again.summary["known"]) == (0, MISSIONS)


def test_planners_in_python_have_the_same_results_here_and_on_an_executor() -> None:
    ahead = planner("ahead")
    here = pr.sweep("limits.toml", out="here", in_process=True, planners={"robot": ahead}, quiet=True)
    assert here.summary["carried_out"] == MISSIONS
    for row in rows(here)[:2]:
        values = {"rules.time_limit": float(row["limit"])}
        run = pr.run("hello", seed=int(row["seed"]), in_process=True, planners={"robot": ahead}, set=values)
        assert run.digest == row["digest"]
    with processes(2) as pool:
        there = pr.sweep(
            "limits.toml", out="there", in_process=True, planners={"robot": ahead}, executor=pool, shards=3, quiet=True
        )
    assert table(there) == table(here)
    # They are not the results of the planners of the scenario.
    with pytest.raises(pr.InvalidInput, match="another experiment"):
        pr.sweep("limits.toml", out="here", in_process=True, quiet=True)


@contextmanager
def pool() -> Iterator[pr.Executor]:
    with processes(2) as executor:
        yield executor


@contextmanager
def dask() -> Iterator[pr.Executor]:
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client.get_executor()


@contextmanager
def ray() -> Iterator[pr.Executor]:
    ray = pytest.importorskip("ray")
    environment = {"PYTHONPATH": os.pathsep.join(sys.path)}
    ray.init(num_cpus=2, include_dashboard=False, logging_level="error", runtime_env={"env_vars": environment})
    try:
        yield pr.executors.Ray()
    finally:
        ray.shutdown()


@contextmanager
def hyperqueue() -> Iterator[pr.Executor]:
    hyperqueue = pytest.importorskip("hyperqueue")
    cluster = __import__("hyperqueue.cluster", fromlist=["WorkerConfig"])
    function = __import__("hyperqueue.task.function", fromlist=["PythonEnv"])
    with hyperqueue.LocalCluster() as local:
        local.start_worker(cluster.WorkerConfig(cores=2))
        client = local.client(python_env=function.PythonEnv(python_bin=sys.executable))
        yield pr.executors.HyperQueue(client, "parts")


@pytest.mark.parametrize("engine", [pool, dask, ray, hyperqueue])
def test_the_table_is_the_same_after_a_worker_is_killed(engine: Callable[[], AbstractContextManager[pr.Executor]]) -> None:
    fatal = {"robot": planner("fatal")}
    whole = table(pr.sweep("limits.toml", out="whole", in_process=True, planners=fatal, quiet=True))

    def run() -> pr.Sweep:
        with engine() as executor:
            return pr.sweep(
                "limits.toml", out="killed", in_process=True, planners=fatal, executor=executor, shards=4, quiet=True
            )

    Path("fuse").touch()
    try:
        done = run()
    except pr.Error as error:
        # An executor that does not run a call again.
        assert "the same call runs the missing missions" in str(error)
        done = run()
    assert not Path("fuse").exists()
    assert table(done) == whole


def test_the_table_is_the_same_after_a_process_of_mpi_is_killed() -> None:
    pytest.importorskip("mpi4py")
    mpiexec = Path(sys.executable).with_name("mpiexec")
    if not mpiexec.exists():
        pytest.skip(f"no {mpiexec}: expected that of pip install mpich")
    fatal = {"robot": planner("fatal")}
    whole = table(pr.sweep("limits.toml", out="whole", in_process=True, planners=fatal, quiet=True))
    script = """
from mpi4py.futures import MPIPoolExecutor
from planners_of_the_sweep import fatal
import protean_robotics as pr
if __name__ == "__main__":
    with MPIPoolExecutor() as pool:
        done = pr.sweep(
            "limits.toml", out="mpi", in_process=True, planners={"robot": fatal}, executor=pool, shards=4, quiet=True
        )
        print(pool.num_workers, done.directory)
"""
    Path("script.py").write_text(script)

    def run() -> "subprocess.CompletedProcess[str]":
        command = [mpiexec, "-n", "3", sys.executable, "-m", "mpi4py.futures", "script.py"]
        return subprocess.run(command, check=False, capture_output=True, text=True, timeout=60)

    def memory() -> set[Path]:
        return set(Path("/dev/shm").glob("mpich_shm_*"))

    Path("fuse").touch()
    before = memory()
    # MPI ends all processes with the one that is lost, and leaves their memory.
    killed = run()
    for left in memory() - before:
        left.unlink()
    assert killed.returncode != 0
    assert not Path("fuse").exists()
    again = run()
    assert again.stdout == "2 mpi\n", again
    assert Path("mpi/results.csv").read_bytes() == whole


def test_the_results_of_the_other_parts_are_kept_when_one_fails() -> None:
    class Faulty(ThreadPoolExecutor):
        def submit(self, call, task, shard):  # type: ignore[no-untyped-def]
            return super().submit((lambda: 1 / 0) if shard == "2/4" else (lambda: call(task, shard)))

    whole = by_command()
    with Faulty(2) as executor, pytest.raises(pr.Error, match="1 of 4 parts failed: ZeroDivisionError"):
        pr.sweep("limits.toml", out="faulty", in_process=True, executor=executor, shards=4, quiet=True)
    kept = Path("faulty/results.csv").read_bytes().splitlines()
    assert len(kept) == 1 + MISSIONS * 3 // 4
    done = pr.sweep("limits.toml", out="faulty", in_process=True, quiet=True)
    assert done.summary["carried_out"] == MISSIONS // 4
    assert table(done) == whole


def test_planners_travel_to_other_processes() -> None:
    ahead = planner("ahead")
    assert pickle.loads(pickle.dumps(ahead)) is ahead

    @pr.planner
    def local(robot: pr.Robot) -> tuple[float, float]:
        return 0.1 * robot.v_max, 0.0

    pytest.importorskip("cloudpickle")
    copy = pickle.loads(pickle.dumps(local))
    values = {"rules.time_limit": 0.5}
    digests = {
        pr.run("hello", in_process=True, planners={"robot": steer}, set=values).digest for steer in (local, copy)
    }
    assert len(digests) == 1


def test_optuna_searches_parameters_with_digests_of_every_trial() -> None:
    optuna = pytest.importorskip("optuna")
    optuna.logging.set_verbosity(optuna.logging.ERROR)

    def objective(seeds: range) -> Callable[[object], float]:
        return pr.objective(
            "hello",
            lambda trial: {"rules.time_limit": trial.suggest_float("limit", 0.5, 2.0)},
            lambda run: run.time,
            seeds=seeds,
        )

    study = optuna.create_study(direction="minimize", sampler=optuna.samplers.RandomSampler(seed=1))
    study.optimize(objective(range(1, 3)), n_trials=5)
    best = study.best_trial
    assert best.value == min(trial.value for trial in study.trials)
    values = {"rules.time_limit": best.params["limit"]}
    runs = [pr.run("hello", seed=seed, in_process=True, set=values) for seed in (1, 2)]
    assert best.user_attrs["digests"] == [run.digest for run in runs]
    assert best.value == sum(run.time for run in runs) / 2
    with pytest.raises(pr.InvalidInput, match="seeds = .*at least one"):
        objective(range(0))


def test_invalid_experiments_and_arguments_are_refused() -> None:
    with pytest.raises(pr.InvalidInput, match="expected in_process=True"):
        pr.sweep("limits.toml", planners={"robot": planner("ahead")})
    with pytest.raises(pr.InvalidInput, match="nowhere"):
        pr.sweep("limits.toml", in_process=True, planners={"nowhere": planner("ahead")})
    with pytest.raises(pr.InvalidInput, match=r"rules\.time_limt"):
        pr.sweep("limits.toml", set={"rules.time_limt": 3})
    with pytest.raises(pr.InvalidInput, match="seeds = .*consecutive"):
        pr.sweep("limits.toml", seeds=range(1, 9, 2))
    with pytest.raises(pr.InvalidInput, match="jobs = 0: expected a whole number from 1"):
        pr.sweep("limits.toml", jobs=0)
    with pytest.raises(pr.InvalidInput, match="absent.toml"):
        pr.sweep("absent.toml", executor=ThreadPoolExecutor(1))
    assert not Path("results").exists()


def test_ctrl_c_keeps_finished_missions() -> None:
    script = """
import protean_robotics as pr
from planners_of_the_sweep import ahead
try:
    pr.sweep("limits.toml", in_process=True, planners={"robot": ahead}, seeds=range(1, 100000), quiet=True)
except KeyboardInterrupt:
    print("interrupted")
"""
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True) as process:
        journal = Path("results/limits/journal.jsonl")
        while not journal.exists() or journal.stat().st_size == 0:
            assert process.poll() is None
        os.kill(process.pid, signal.SIGINT)
        output, _ = process.communicate(timeout=60)
    assert output == "interrupted\n"
    assert len(Path("results/limits/results.csv").read_text().splitlines()) > 1
