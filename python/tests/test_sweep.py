"""Sweeps: the same table from the command, threads, other processes and executors, with any faults."""

import csv
import io
import json
import multiprocessing
import os
import pickle
import re
import signal
import subprocess
import sys
import zipfile
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

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


def test_logs_and_worst_missions_are_those_of_the_command() -> None:
    options = ["--in-process", "--quiet", "--json", "--keep-logs=all", "--worst=sim_time_s=max"]
    command = [str(pr.program()), "sweep", "limits.toml", "--out=by-command", *options]
    expected = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)["worst"]
    assert len(expected) > 0 and all(Path(mission["log"]).exists() for mission in expected)

    def swept(out: str, **more: Any) -> pr.Sweep:
        done = pr.sweep(
            "limits.toml", out=out, in_process=True, quiet=True, keep_logs="all", worst="sim_time_s=max", **more
        )
        assert len(list((done.directory / "logs").glob("*.mcap"))) == MISSIONS
        return done

    with ThreadPoolExecutor(2) as threads:
        sweeps = [swept("here"), swept("there", executor=threads, shards=3)]
    for done in sweeps:
        assert json.loads(json.dumps(done.summary["worst"]).replace(str(done.directory), "by-command")) == expected
    steered = swept("steered", planners={"robot": planner("ahead")})
    assert [mission["reason"][:13] for mission in steered.summary["worst"]] == ["sim_time_s = "] * len(expected)
    failed = pr.sweep("limits.toml", out="failed", in_process=True, quiet=True, keep_logs="failed")
    assert failed.summary["failures"] == [] and list((failed.directory / "logs").iterdir()) == []


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
def loky() -> Iterator[pr.Executor]:
    loky = pytest.importorskip("joblib.externals.loky")
    executor = loky.get_reusable_executor(max_workers=2)
    yield executor
    executor.shutdown(kill_workers=True)


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


def test_a_pool_of_joblib_whose_worker_is_killed_refuses_calls_and_a_new_one_has_the_table() -> None:
    fatal = {"robot": planner("fatal")}
    options = {"in_process": True, "planners": fatal, "shards": 4, "quiet": True}
    whole = table(pr.sweep("limits.toml", out="whole", **options))  # type: ignore[arg-type]
    Path("fuse").touch()
    with loky() as executor:
        for _ in range(2):
            with pytest.raises(pr.Error, match="(?s)of . parts failed: .*the same call runs the missing missions"):
                pr.sweep("limits.toml", out="killed", executor=executor, **options)  # type: ignore[arg-type]
    with loky() as executor:
        done = pr.sweep("limits.toml", out="killed", executor=executor, **options)  # type: ignore[arg-type]
    assert table(done) == whole


def test_a_part_that_is_something_else_is_an_error_and_the_others_are_kept() -> None:
    whole = by_command()

    class Lying(ThreadPoolExecutor):
        """Returns an archive of something else as the second part, and a damaged one as the third."""

        def submit(self, call, task, shard):  # type: ignore[no-untyped-def]
            def lie() -> bytes:
                archive = bytearray(call(task, shard))
                if shard == "2/4":
                    other = io.BytesIO()
                    with zipfile.ZipFile(other, "w") as files:
                        files.writestr("journal.jsonl", "{}")
                    return other.getvalue()
                if shard == "3/4":
                    archive[100] ^= 255
                return bytes(archive)

            if shard == "4/4":
                raise TypeError("no such argument")
            return super().submit(lie)

    with Lying(2) as executor, pytest.raises(pr.Error, match="3 of 4 parts failed"):
        pr.sweep("limits.toml", out="lying", in_process=True, executor=executor, shards=4, quiet=True)
    kept = Path("lying/results.csv").read_bytes().splitlines()
    assert len(kept) == 1 + MISSIONS // 4
    done = pr.sweep("limits.toml", out="lying", in_process=True, quiet=True)
    assert table(done) == whole


def test_joblib_is_told_what_fits() -> None:
    joblib = pytest.importorskip("joblib")
    with pytest.raises(pr.InvalidInput, match=r"expected joblib\.externals\.loky\.get_reusable_executor\(\)"):
        pr.sweep("limits.toml", executor=joblib.Parallel(n_jobs=2))


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


def test_a_pruner_ends_trials_early() -> None:
    optuna = pytest.importorskip("optuna")
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    sampler = optuna.samplers.GridSampler({"limit": [0.5, 1.0, 1.5]}, seed=1)
    pruner = optuna.pruners.ThresholdPruner(upper=1.2, n_warmup_steps=2)
    study = optuna.create_study(sampler=sampler, pruner=pruner)
    study.optimize(
        pr.objective(
            "hello",
            lambda trial: {"rules.time_limit": trial.suggest_float("limit", 0.5, 1.5)},
            lambda run: run.time,
            seeds=range(1, 5),
        )
    )
    found = {trial.params["limit"]: trial for trial in study.trials}
    for limit, trial in found.items():
        is_pruned = limit > 1.2
        assert (trial.state == optuna.trial.TrialState.PRUNED) == is_pruned
        # The mean after each seed; none after the last one is a reason to prune.
        seeds = 2 if is_pruned else 4
        assert trial.intermediate_values == pytest.approx(dict.fromkeys(range(1, seeds + 1), limit), abs=0.05)
        assert len(trial.user_attrs["digests"]) == seeds
    assert study.best_params == {"limit": 0.5}


def test_the_search_of_the_documentation_is_of_a_parameter_that_matters() -> None:
    page = (Path(__file__).parents[2] / "docs/how-to/sweeps.md").read_text()
    (code,) = re.findall(r"```python\nimport optuna\n(.*?)\nstudy = ", page, re.DOTALL)
    names: dict[str, Any] = {"optuna": pytest.importorskip("optuna")}
    exec(compile(code, "sweeps.md", "exec"), names)

    class Fixed:
        """A trial with this number."""

        def __init__(self, number: float) -> None:
            self.number = number

        def suggest_float(self, name: str, low: float, high: float, *, log: bool) -> float:
            assert low <= self.number <= high
            return self.number

    without, found = (
        sum(names["escapes"](pr.run("chase_exact", seed=seed, in_process=True, set=values)) for seed in range(1, 5))
        for values in ({}, names["suggest"](Fixed(1.5)))
    )
    assert found + 2 <= without, (without, found)


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
    with pytest.raises(pr.InvalidInput, match="keep_logs = 'some': expected one of none, failed, all"):
        pr.sweep("limits.toml", keep_logs="some")  # type: ignore[arg-type]
    with pytest.raises(pr.InvalidInput, match='worst = "contact=max": expected COLUMN=max or COLUMN=min'):
        pr.sweep("limits.toml", worst="contact=max")
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
