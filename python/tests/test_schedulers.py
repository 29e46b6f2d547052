"""Sweeps through real schedulers, with the commands of `docs/how-to/sweeps.md`: the table is that of one sweep."""

import os
import re
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing
from pathlib import Path

import protean_robotics as pr
import pytest

EXPERIMENT = """
scenario = "builtin:hello"
seeds = { first = 1, count = 8 }

[parameters.limit]
set = "rules.time_limit"

[grid]
limit = [0.5, 1]
"""

#: One node, this machine, that runs all jobs of a test at once, as the user of the test.
SLURM = """
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
AuthInfo=socket={folder}/munge
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/pgid
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
MailProg=/bin/true
SlurmdParameters=config_overrides
NodeName={host} NodeAddr=127.0.0.1 CPUs=8
PartitionName=all Nodes={host} Default=YES
"""


@pytest.fixture(autouse=True)
def _experiment(monkeypatch: pytest.MonkeyPatch) -> None:
    Path("speeds.toml").write_text(EXPERIMENT)
    monkeypatch.setenv("PATH", os.pathsep.join([str(pr.program().parent), os.environ.get("PATH", os.defpath)]))


def needed(*names: str) -> list[str]:
    """Paths of programs; without one the test is skipped."""
    # Daemons are installed for the administrator.
    path = os.pathsep.join([os.environ.get("PATH", os.defpath), "/usr/sbin", "/sbin"])
    found = {name: shutil.which(name, path=path) for name in names}
    missing = [name for name, program in found.items() if program is None]
    if missing:
        pytest.skip(f"{', '.join(missing)}: not installed")
    return [program for program in found.values() if program is not None]


def until_idle(daemons: dict[str, "subprocess.Popen[bytes]"], folder: Path) -> None:
    """Waits until Slurm accepts jobs."""
    for _ in range(200):
        nodes = subprocess.run(["sinfo", "--noheader", "--format=%T"], check=False, capture_output=True, text=True)
        if nodes.stdout.strip() == "idle":
            return
        if any(daemon.poll() is not None for daemon in daemons.values()):
            break
        time.sleep(0.1)
    logs = "\n".join(f"{name}: {(folder / f'{name}.log').read_text()}" for name in daemons)
    raise AssertionError(f"Slurm did not start: {nodes}\n{logs}")


@pytest.fixture
def slurm(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Daemons of Slurm of this test's own, in a folder of their own."""
    munged, slurmctld, slurmd, *_ = needed("munged", "slurmctld", "slurmd", "sbatch", "srun", "sinfo", "scancel")
    with ExitStack() as stack:
        # Munge wants a folder that all users can enter.
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="protean-", ignore_cleanup_errors=True)))
        folder.chmod(0o755)
        for name in ("state", "spool"):
            (folder / name).mkdir()
        key = folder / "key"
        key.touch(mode=0o600)
        key.write_bytes(os.urandom(128))
        with closing(socket.socket()) as first, closing(socket.socket()) as second:
            for free in (first, second):
                free.bind(("127.0.0.1", 0))
            ports = [free.getsockname()[1] for free in (first, second)]
        host = socket.gethostname().split(".")[0]
        user = subprocess.run(["id", "-un"], check=True, capture_output=True, text=True).stdout.strip()
        configuration = folder / "slurm.conf"
        configuration.write_text(SLURM.format(host=host, ports=ports, folder=folder, user=user))
        monkeypatch.setenv("SLURM_CONF", str(configuration))
        files = {"socket": "munge", "key-file": "key", "pid-file": "pid", "log-file": "log", "seed-file": "seed"}
        commands = {
            "munged": [munged, "--foreground", *(f"--{option}={folder / file}" for option, file in files.items())],
            "slurmctld": [slurmctld, "-D"],
            "slurmd": [slurmd, "-D"],
        }
        daemons: dict[str, subprocess.Popen[bytes]] = {}
        for name, command in commands.items():
            log = stack.enter_context((folder / f"{name}.log").open("wb"))
            daemon = subprocess.Popen(command, stdout=log, stderr=log)
            daemons[name] = daemon
            stack.callback(daemon.wait)
            stack.callback(daemon.terminate)
            while name == "munged" and daemon.poll() is None and not (folder / "munge").exists():
                time.sleep(0.01)
        stack.callback(subprocess.run, ["scancel", f"--user={user}"], check=False)
        until_idle(daemons, folder)
        yield


def carried_out(scheduler: str) -> None:
    """Runs the commands that the guide has for a scheduler, and compares the table with that of one sweep."""
    guide = (Path(__file__).parents[2] / "docs/how-to/sweeps.md").read_text()
    block = re.search(rf"```sh\n({scheduler} .*?)```", guide, re.DOTALL)
    assert block, f"no commands with {scheduler} in the guide"
    subprocess.run(["sh", "-e", "-c", block[1]], check=True, timeout=120)
    whole = pr.sweep("speeds.toml", out="whole", in_process=True, quiet=True)
    for name in ("results.csv", "results.parquet"):
        assert Path("results/speeds", name).read_bytes() == (whole.directory / name).read_bytes()


def test_an_array_job_of_slurm_has_the_table_of_one_sweep(slurm: None) -> None:
    carried_out("sbatch")


def test_gnu_parallel_has_the_table_of_one_sweep() -> None:
    needed("parallel")
    carried_out("parallel")


def test_submitit_has_the_table_of_one_sweep(slurm: None) -> None:
    submitit = pytest.importorskip("submitit")
    executor = submitit.AutoExecutor("jobs")
    assert executor.cluster == "slurm"
    executor.update_parameters(timeout_min=5)
    done = pr.sweep("speeds.toml", out="jobs", in_process=True, executor=executor, shards=2, quiet=True)
    whole = pr.sweep("speeds.toml", out="whole", in_process=True, quiet=True)
    assert (done.directory / "results.csv").read_bytes() == (whole.directory / "results.csv").read_bytes()
