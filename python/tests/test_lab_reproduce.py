"""`protean reproduce`: its reports agree, it resumes, and the same seeds give the same bytes."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

for module in ("jinja2", "matplotlib", "scipy"):
    pytest.importorskip(module)

import protean_robotics as pr
from protean_robotics.lab import duration, plans, reproduce
from protean_robotics.lab.experiments import EXPERIMENTS, PLAN_SEED_S, Experiment

#: The paper whose missions are shortest.
PAPER = "vmc-lp"
#: Keys of a claim, on which other programs rely.
KEYS = {"claim", "details", "id", "ours", "paper", "published", "rule", "timed", "verdict"}
#: Names of the reports.
REPORTS = ("reproduce.md", "reproduce.json", "reproduce.html")


def command(out: str, seeds: str, *more: str) -> list[str]:
    """The command as users call it."""
    return [str(pr.program()), "reproduce", "--paper", PAPER, "--seeds", seeds, "--out", out, "--quiet", *more]


def called(out: str, seeds: str, *more: str) -> tuple[int, str, str]:
    ended = subprocess.run(command(out, seeds, *more), capture_output=True, text=True, check=False)
    return ended.returncode, ended.stdout, ended.stderr


def main(out: str, seeds: str) -> int:
    """The same within this process."""
    return reproduce.main(command(out, seeds)[2:])


def recorded(out: str) -> dict[str, int]:
    """Experiments and the numbers of records in their journals."""
    journals = {name: Path(out, name, "journal.jsonl") for name in ("vmc_lp_sensitivity", "vmc_lp_tables_3_4")}
    return {name: len(path.read_text().splitlines()) if path.exists() else 0 for name, path in journals.items()}


def untimed(out: str) -> tuple[list[str], Any]:
    """A report without the rows about CPU times."""
    lines = Path(out, "reproduce.md").read_text().splitlines()
    data = json.loads(Path(out, "reproduce.json").read_text())
    # Their verdicts are counted there.
    del data["papers"]
    data["claims"] = [claim for claim in data["claims"] if not claim["timed"]]
    return [line for line in lines if " † |" not in line and not line.startswith(f"| {PAPER} | Report")], data


def test_reports_agree_and_an_interrupted_reproduction_gives_the_same_bytes() -> None:
    code, printed, errors = called("whole", "1..2", "--json")
    assert code == 0, errors
    # Printed, written, and in the table.
    written = json.loads(Path("whole/reproduce.json").read_text())
    assert json.loads(printed) == written
    lines = Path("whole/reproduce.md").read_text().splitlines()
    rows = [line.strip("|").split(" | ") for line in lines]
    rows = [[cell.strip() for cell in row] for row in rows if len(row) == 7 and row[0].strip() == PAPER]
    page = Path("whole/reproduce.html").read_text()
    assert len(rows) == len(written["claims"]) > 40
    for row, claim in zip(rows, written["claims"], strict=True):
        assert claim.keys() == KEYS
        texts = [claim["published"]["text"], claim["ours"]["text"], claim["ours"]["interval_text"]]
        assert row[2:5] == texts and row[6].strip("*") == claim["verdict"].replace("_", " ")
        assert page.count(f'id="{claim["id"]}"') == 1
    assert page.count("data:image/svg+xml") == 2 and Path("whole/pages/vmc-lp.md").exists()

    # Fewer seeds first, then killed.
    missions = recorded("whole")
    assert main("parts", "1..1") == 0
    known = recorded("parts")["vmc_lp_sensitivity"]
    assert 2 * known == missions["vmc_lp_sensitivity"]
    with subprocess.Popen(command("parts", "1..2", "--jobs", "1"), stdout=subprocess.DEVNULL) as running:
        while recorded("parts")["vmc_lp_sensitivity"] == known:
            assert running.poll() is None
            time.sleep(0.001)
        running.send_signal(signal.SIGKILL)
    assert main("parts", "1..2") == 0
    assert recorded("parts") == missions and untimed("parts") == untimed("whole")

    # Again from the same results: every byte.
    before = [Path("parts", name).read_bytes() for name in REPORTS]
    assert main("parts", "1..2") == 0
    assert [Path("parts", name).read_bytes() for name in REPORTS] == before


def test_ctrl_c_keeps_what_is_finished() -> None:
    with subprocess.Popen(command("out", "1..50"), stderr=subprocess.PIPE, text=True) as running:
        while not recorded("out")["vmc_lp_sensitivity"]:
            assert running.poll() is None
            time.sleep(0.001)
        running.send_signal(signal.SIGINT)
        _, errors = running.communicate()
    assert running.returncode == 3 and "the same command continues" in errors
    assert recorded("out")["vmc_lp_sensitivity"] and not Path("out/reproduce.md").exists()


def test_verdicts_are_written_after_each_experiment(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    first, second = "vmc_lp_sensitivity", "vmc_lp_tables_3_4"
    sweep = reproduce._sweep

    def until_the_second(directory: Path, experiment: Experiment, options: reproduce.Options) -> None:
        if experiment.name == second:
            raise KeyboardInterrupt
        sweep(directory, experiment, options)

    monkeypatch.setattr(reproduce, "_sweep", until_the_second)
    arguments = ["--paper", PAPER, "--seeds", "1..2", "--out", "out"]
    assert reproduce.main(arguments) == 3
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("experiment")]
    assert [line.split(";")[0] for line in lines] == [f"experiment 1 of 2: {first}", f"experiment 2 of 2: {second}"]
    assert all("; about " in line and line.endswith(" left") for line in lines)
    data = json.loads(Path("out/reproduce.json").read_text())
    verdicts = {claim["verdict"] for claim in data["claims"]}
    assert data["missing"] == [second] and "no_data" in verdicts and len(verdicts) > 1
    assert f"**Not finished**: `{second}`." in Path("out/reproduce.md").read_text()
    assert not Path("out/reproduce.html").exists()

    # The second half of four seeds is still to do.
    experiment = next(experiment for experiment in EXPERIMENTS if experiment.name == first)
    whole = duration.work_s(experiment, range(1, 5), Path("nothing"))
    assert duration.work_s(experiment, range(1, 5), Path("out", first)) == whole / 2 > 0

    monkeypatch.undo()
    assert reproduce.main([*arguments, "--quiet"]) == 0
    data = json.loads(Path("out/reproduce.json").read_text())
    assert data["missing"] == [] and recorded("out")[second]
    assert "Not finished" not in Path("out/reproduce.md").read_text() and not capsys.readouterr().err


def test_the_time_left_follows_the_pace(monkeypatch: pytest.MonkeyPatch) -> None:
    now = iter([0.0, 2.0, 2.0, 62.0])
    monkeypatch.setattr(duration, "monotonic", lambda: next(now))
    monkeypatch.setattr(plans, "make", lambda _: [])
    estimate = duration.Estimate([20.0, 60.0, 0.0], 2)
    # Measured: twice as long as expected. Then the first part took 60 s in place of 10 s.
    assert estimate.left_s(0) == 80.0 * 2.0 / 2 / PLAN_SEED_S
    assert estimate.left_s(1) == 60.0 * 6.0 / 2 and estimate.left_s(3) == 0.0
    texts = [duration.text(seconds) for seconds in (0.0, 44.0, 89.0, 100.0, 3600.0)]
    assert texts == ["about 10 s", "about 40 s", "about 90 s", "about 2 min", "about 60 min"]


def test_other_files_are_refused_and_kept() -> None:
    Path("taken").mkdir()
    Path("taken/reproduce.md").write_text("mine")
    code, _, errors = called("taken", "1")
    assert code == 2 and "taken/reproduce.md" in errors and "no results of a reproduction" in errors
    assert [path.read_text() for path in Path("taken").iterdir()] == ["mine"]
    Path("other/vmc_lp_sensitivity").mkdir(parents=True)
    Path("other/vmc_lp_sensitivity/results.csv").write_text("mine")
    code, _, errors = called("other", "1")
    assert code == 2 and "vmc_lp_sensitivity" in errors and "manifest.json" in errors


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--seeds", "2..1"], "--seeds: '2..1': expected A..B"),
        (["--seeds", "-1"], "--seeds"),
        (["--seeds", "1..9999999"], "expected A..B"),
        (["--jobs", "0"], "expected a number from 1 to 4096"),
        (["--paper", "none"], "--paper"),
        (["--quick", "--seeds", "1"], "not allowed with"),
        (["--nothing"], "--nothing"),
    ],
)
def test_wrong_usage_is_refused(arguments: list[str], expected: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        reproduce.main([*arguments, "--out=new"])
    assert ended.value.code == 2 and expected in capsys.readouterr().err
    assert not Path("new").exists()


def test_a_missing_package_is_named_with_its_extra() -> None:
    script = "import sys; sys.modules['jinja2'] = None; from protean_robotics.lab import page; page.environment()"
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert "jinja2 is missing: pip install 'protean-robotics[lab]'" in ended.stderr
    # The package itself needs none of them.
    blocked = "import sys; sys.modules |= dict.fromkeys(['jinja2', 'matplotlib', 'scipy']); import protean_robotics"
    subprocess.run([sys.executable, "-c", blocked], check=True, env=os.environ)
