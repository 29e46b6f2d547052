"""The plugin of pytest: the fixture `mission`, what a failing test shows, and the logs that it keeps."""

import re
import shlex
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import protean_robotics as pr
import pytest

pytest_plugins = ["pytester"]

CITY = """
title = "City"
[world.map.vector]
bounds = { min = [0.0, 0.0], max = [6.0, 4.0] }
[rules]
exits = [{ circle = { center = [5.2, 2.0], radius = 0.2 } }]
time_limit = 1.0
[[robots]]
name = "robot"
team = "evader"
start = { x = 1.0, y = 2.0, theta = 0.0 }
start_jitter = { x = 0.2, y = 0.2, theta = 0.5 }
[[processes]]
kind = "evader_potential"
robots = ["robot"]
"""

TWO = """
def test_passes(mission):
    run = mission("city.toml", seed=7, set={"rules.time_limit": 0.5})
    assert run.outcome["robot"] == "timed_out" and run.time == 0.5
    assert run.log_path.exists() and len(run.digest) == 64
    assert run.events[-1]["kind"] == "game_over" and run.metrics["robot"]["contacts"] == 0

def test_fails(mission):
    run = mission("city.toml", seed=7, set={"rules.time_limit": 0.5})
    assert run.outcome["robot"] == "escaped"
"""

#: Commands that a failing test shows, by their labels.
LINE = re.compile(r"^  (picture|open|again) +(.*)$", re.MULTILINE)


@pytest.fixture(autouse=True)
def _files(pytester: pytest.Pytester) -> None:
    folder = pytester.mkdir("missions")
    (folder / "city.toml").write_text(CITY)
    (folder / "test_city.py").write_text(TWO)


def shown(text: str) -> dict[str, str]:
    """The lines of one mission of a failing test."""
    found = LINE.findall(text)
    assert len(found) == len(dict(found)), text
    return dict(found)


def kept(folder: Path) -> list[str]:
    """The files below a folder, without the digests of the tests' names."""
    return sorted(re.sub(r"-[0-9a-f]{8}/", "/", str(p.relative_to(folder))) for p in folder.rglob("*") if p.is_file())


def test_a_test_has_five_lines_and_its_paths_are_those_of_its_file(pytester: pytest.Pytester) -> None:
    (pytester.path / "missions/test_city.py").write_text(
        'def test_city(mission):\n    run = mission("city.toml", seed=7)\n    assert run.outcome["robot"] == "timed_out"\n'
        'def test_built_in(mission):\n    assert mission("hello", seed=1).outcome == {"robot": "escaped"}\n'
    )
    pytester.runpytest_inprocess("missions").assert_outcomes(passed=2)
    result = pytester.runpytest_inprocess("test_city.py", "-p", "no:cacheprovider", "--rootdir=.")
    assert result.ret != 0


def test_a_failure_shows_picture_and_commands_that_work(pytester: pytest.Pytester) -> None:
    result = pytester.runpytest_inprocess("--protean-logs=kept", "--show-capture=no", "--junitxml=report.xml")
    result.assert_outcomes(passed=1, failed=1)
    text = result.stdout.str()
    assert "<Run city, seed 7: robot timed_out; digest" in text
    lines = shown(text)
    picture = Path(lines["picture"])
    assert picture.suffix == ".svg" and "<svg" in (pytester.path / picture).read_text()[:500]
    # The log of the test that passed is removed.
    folder = "missions-test_city.py-test_fails"
    assert kept(pytester.path / "kept") == [f"{folder}/1-city.mcap", f"{folder}/1-city.svg"]
    opened = shlex.split(lines["open"])
    log = pytester.path / opened[2]
    assert opened[:2] == ["protean", "report"] and opened[3:] == ["--open"]
    subprocess.run([str(pr.program()), *opened[1:3]], check=True, capture_output=True)
    again = shlex.split(lines["again"])
    assert again[:3] == ["protean", "run", "missions/city.toml"] and "--seed" in again
    ran = subprocess.run([str(pr.program()), *again[1:], "--json"], check=True, capture_output=True, text=True)
    assert str(pr.Log(log).digest) in ran.stdout
    failure = ElementTree.parse(pytester.path / "report.xml").find(".//failure")
    assert failure is not None and lines["again"] in str(failure.text)


def test_the_next_call_removes_the_log_of_a_test_that_passes_now(pytester: pytest.Pytester) -> None:
    pytester.runpytest_inprocess("--protean-logs=kept").assert_outcomes(passed=1, failed=1)
    test = pytester.path / "missions/test_city.py"
    test.write_text(test.read_text().replace('"escaped"', '"timed_out"'))
    pytester.runpytest_inprocess("--protean-logs=kept").assert_outcomes(passed=2)
    assert kept(pytester.path / "kept") == []


def test_without_the_option_logs_are_in_the_temporary_directory(pytester: pytest.Pytester) -> None:
    result = pytester.runpytest_inprocess("--basetemp=temporary")
    result.assert_outcomes(passed=1, failed=1)
    assert [Path(name).name for name in kept(pytester.path / "temporary")] == ["1-city.mcap", "1-city.svg"]
    assert shown(result.stdout.str())["picture"].startswith("temporary/")


def test_missions_of_functions_run_again_by_pytest(pytester: pytest.Pytester) -> None:
    (pytester.path / "missions/test_city.py").write_text(
        "import pytest\n"
        "@pytest.mark.parametrize('speed', [0.1, 0.2])\n"
        "def test_city(mission, speed):\n"
        "    run = mission('city.toml', planners={'robot': lambda robot: (speed, 0.0)})\n"
        "    assert run.metrics['robot']['distance_m'] > 0.15\n"
        "    mission('city.toml', planners={'robot': lambda robot: 1 / 0})\n"
    )
    result = pytester.runpytest_inprocess("--protean-logs=kept", "-k", "0.1")
    result.assert_outcomes(failed=1, deselected=1)
    again = shlex.split(shown(result.stdout.str())["again"])
    assert again == ["pytest", "missions/test_city.py::test_city[0.1]"]
    pytester.runpytest_inprocess(*again[1:]).assert_outcomes(failed=1)
    # A mission that does not reach its end is shown, too, after the one before it.
    result = pytester.runpytest_inprocess("--protean-logs=kept", "-k", "0.2")
    result.stdout.fnmatch_lines(["*ZeroDivisionError*", "<Run city,*", "missions/city.toml: it did not reach its end"])


def test_failures_outside_of_the_test_itself_count_and_expected_ones_do_not(pytester: pytest.Pytester) -> None:
    (pytester.path / "missions/test_city.py").write_text(
        "import pytest\n"
        "@pytest.fixture\n"
        "def late(mission):\n"
        "    yield mission('city.toml')\n"
        "    assert False\n"
        "def test_late(late):\n"
        "    pass\n"
        "@pytest.fixture\n"
        "def early(mission):\n"
        "    assert mission('city.toml').outcome == {}\n"
        "def test_early(early):\n"
        "    pass\n"
        "@pytest.mark.xfail\n"
        "def test_expected(mission):\n"
        "    assert mission('city.toml').outcome == {}\n"
        "@pytest.mark.xfail(strict=True)\n"
        "def test_unexpected(mission):\n"
        "    mission('city.toml')\n"
    )
    result = pytester.runpytest_inprocess("--protean-logs=kept")
    result.assert_outcomes(passed=1, errors=2, xfailed=1, failed=1)
    names = {Path(name).parts[0] for name in kept(pytester.path / "kept")}
    assert names == {f"missions-test_city.py-test_{name}" for name in ("late", "early", "unexpected")}
    assert len(LINE.findall(result.stdout.str())) == 3 * 3


def test_wrong_arguments_are_named(pytester: pytest.Pytester) -> None:
    (pytester.path / "missions/test_city.py").write_text(
        "import protean_robotics as pr, pytest\n"
        "@pytest.mark.parametrize('arguments, text', [\n"
        "    ({'scenario': 'none.toml'}, 'missions/none.toml'),\n"
        "    ({'scenario': None}, 'scenario = None'),\n"
        "    ({'seed': -1}, 'seed = -1'),\n"
        "    ({'set': {'rules.time_limit': -1}}, 'rules.time_limit'),\n"
        "])\n"
        "def test_city(mission, arguments, text):\n"
        "    with pytest.raises(pr.InvalidInput, match=text):\n"
        "        mission(**{'scenario': 'city.toml', **arguments})\n"
    )
    pytester.runpytest_inprocess("--protean-logs=kept").assert_outcomes(passed=4)
    assert kept(pytester.path / "kept") == []
    (pytester.path / "missions/test_city.py").write_text(
        "import pytest\n"
        "@pytest.mark.parametrize('set', [3, {'rules.time_limit': object()}, {'rules.time_limit': -1}])\n"
        "def test_city(mission, set):\n"
        "    mission('city.toml', set=set)\n"
        "def test_typo(mission):\n"
        "    mission('city.toml', sede=1)\n"
    )
    result = pytester.runpytest_inprocess("--protean-logs=kept")
    result.assert_outcomes(failed=4)
    result.stdout.fnmatch_lines(["*InvalidInput: set = 3: expected*", "*TypeError*sede*"])
    assert "missions ---" not in result.stdout.str() and not list((pytester.path / "kept").iterdir())


def test_tests_at_once_have_logs_of_their_own(pytester: pytest.Pytester) -> None:
    pytest.importorskip("xdist")
    (pytester.path / "missions/test_city.py").write_text(
        "import pytest\n"
        "@pytest.mark.parametrize('name', ['a/b', 'a-b', 'a:b', 'a b'])\n"
        "def test_city(mission, name):\n"
        "    runs = [mission('city.toml', set={'rules.time_limit': 0.1}) for _ in range(2)]\n"
        "    assert runs[0].digest != runs[1].digest\n"
    )
    for options in (["--protean-logs=kept"], ["--basetemp=kept"]):
        result = pytester.runpytest_subprocess("-n2", *options)
        result.assert_outcomes(failed=4)
        logs = [path for path in (pytester.path / "kept").rglob("*.mcap") if "current" not in str(path)]
        assert len({path.parent for path in logs}) == 4
        pictures = [value for label, value in LINE.findall(result.stdout.str()) if label == "picture"]
        assert len(set(pictures)) == 8 and all((pytester.path / picture).exists() for picture in pictures)


def test_the_package_does_not_need_pytest() -> None:
    script = "import sys; sys.modules['pytest'] = None; import protean_robotics as pr; pr.run('hello', in_process=True)"
    subprocess.run([str(Path(pr.program()).with_name("python")), "-c", script], check=True)
