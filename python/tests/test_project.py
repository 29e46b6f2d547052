"""The projects that `protean new` writes with a language."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import protean_robotics as pr
import pytest

#: Files for CI, and the schemas of their services.
PIPELINES = {".github/workflows/tests.yml": "vendor.github-workflows", ".gitlab-ci.yml": "vendor.gitlab-ci"}


def new(language: str) -> Path:
    made = subprocess.run(
        [str(pr.program()), "new", "my_planner", language], capture_output=True, text=True, check=True
    )
    assert "cd my_planner" in made.stderr
    return Path("my_planner")


def module(name: str, *arguments: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs a module of Python in a project; without it the test is skipped."""
    pytest.importorskip(name)
    scripts = Path(sys.executable).parent
    environment = os.environ | {"PATH": f"{scripts}:{os.environ['PATH']}", "PRE_COMMIT_HOME": str(Path("cache").absolute())}
    command = [sys.executable, "-m", name, *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, env=environment)


def test_a_new_project_passes_its_own_tests() -> None:
    tested = module("pytest", "-q", "-p", "no:cacheprovider", folder=new("--python"))
    assert tested.returncode == 0, tested.stdout + tested.stderr
    assert "2 passed" in tested.stdout


@pytest.mark.parametrize("language", ["--python", "--rust", "--cpp"])
def test_files_for_ci_fit_the_published_schemas(language: str) -> None:
    project = new(language)
    for file, schema in PIPELINES.items():
        check = ("--builtin-schema", schema, file)
        checked = module("check_jsonschema", *check, folder=project)
        assert checked.returncode == 0, checked.stdout + checked.stderr
        text = (project / file).read_text()
        assert "protean test " in text
        (project / file).write_text(text.replace("script:", "scripts:").replace("runs-on", "runs_on"))
        assert module("check_jsonschema", *check, folder=project).returncode == 1, "a wrong key is found"
    hooks = module("pre_commit", "validate-config", folder=project)
    assert hooks.returncode == 0, hooks.stdout + hooks.stderr


@pytest.mark.parametrize("language", ["--python", "--rust", "--cpp"])
def test_the_mission_test_names_the_scenario_and_its_robot_in_three_lines(language: str) -> None:
    file = new(language) / "tests/hall.toml"
    text = file.read_text()
    test = tomllib.loads(text)
    scenario = tomllib.loads((file.parent / test["scenario"]).read_text())
    assert len(text.splitlines()) <= 3
    assert set(test["expect"]["outcome"]) == {robot["name"] for robot in scenario["robots"]}


def test_the_hook_before_commits_runs_the_tests() -> None:
    project = new("--python")
    subprocess.run(["git", "init", "-q"], cwd=project, check=True)
    subprocess.run(["git", "add", "."], cwd=project, check=True)
    hook = ("run", "planner", "--all-files", "--verbose")
    passed = module("pre_commit", *hook, folder=project)
    assert passed.returncode == 0, passed.stdout + passed.stderr
    assert "2 passed" in passed.stdout
    readme = project / "README.md"
    readme.write_text(readme.read_text().replace("20c4634f", "00000000"))
    failed = module("pre_commit", *hook, folder=project)
    assert failed.returncode == 1
    assert "2 failed" in failed.stdout and "protean report" in failed.stdout
