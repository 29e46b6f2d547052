"""The project that `protean new --python` writes."""

import subprocess
import sys

import protean_robotics as pr


def test_a_new_project_passes_its_own_tests() -> None:
    made = subprocess.run(
        [str(pr.program()), "new", "my_planner", "--python"], capture_output=True, text=True, check=True
    )
    assert "cd my_planner" in made.stderr
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    tested = subprocess.run(command, cwd="my_planner", capture_output=True, text=True, check=False)
    assert tested.returncode == 0, tested.stdout + tested.stderr
    assert "2 passed" in tested.stdout
