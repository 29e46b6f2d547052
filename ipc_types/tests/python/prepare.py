"""Makes a virtual environment with the packages of requirements.txt and prints its interpreter.

usage: prepare.py DIRECTORY [NAME PACKAGE==VERSION...]

The environment is kept in DIRECTORY and made anew when requirements.txt, or the list, changes. Several tests may
ask at the same time: one makes it, the others wait.
"""

import fcntl
import hashlib
import pathlib
import shutil
import subprocess
import sys
import venv

directory = pathlib.Path(sys.argv[1])
directory.mkdir(parents=True, exist_ok=True)
requirements = pathlib.Path(__file__).with_name("requirements.txt")
name, *packages = sys.argv[2:] or ["python-mcap"]
content = " ".join(packages).encode() or requirements.read_bytes()
wanted = hashlib.sha256(content + sys.version.encode()).hexdigest()
environment = directory / name
done = environment / "done"

with open(directory / f"{name}.lock", "w") as lock:
    fcntl.flock(lock, fcntl.LOCK_EX)
    if not done.exists() or done.read_text() != wanted:
        shutil.rmtree(environment, ignore_errors=True)
        install = ["install", "--quiet", "--disable-pip-version-check",
                   *(packages or ["--requirement", requirements])]
        # The pip that is here, if it can: unpacking one into the environment takes longer than all
        # packages.
        venv.create(environment, with_pip=False)
        outside = [sys.executable, "-m", "pip", "--python", environment / "bin/python"]
        if subprocess.run(outside + install, stdout=sys.stderr).returncode != 0:
            venv.create(environment, with_pip=True)
            inside = [environment / "bin/python", "-m", "pip"]
            subprocess.run(inside + install, check=True, stdout=sys.stderr)
        done.write_text(wanted)
print(environment / "bin/python")
