"""Makes a virtual environment with the packages of requirements.txt and prints its interpreter.

usage: prepare.py DIRECTORY

The environment is kept in DIRECTORY and made anew when requirements.txt changes. Several tests may
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
wanted = hashlib.sha256(requirements.read_bytes() + sys.version.encode()).hexdigest()
environment = directory / "python-mcap"
done = environment / "done"

with open(directory / "python-mcap.lock", "w") as lock:
    fcntl.flock(lock, fcntl.LOCK_EX)
    if not done.exists() or done.read_text() != wanted:
        shutil.rmtree(environment, ignore_errors=True)
        install = ["install", "--quiet", "--disable-pip-version-check",
                   "--requirement", requirements]
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
