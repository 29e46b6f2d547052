"""`protean plan` on one instance."""

import json
import pathlib
import subprocess
import tempfile

from . import check


def run(program, method, raw, repeat):
    """The plan of one instance as `protean plan` prints it."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "instance.json"
        path.write_text(json.dumps([raw]), encoding="utf-8")
        command = [program, "plan", str(path), "--method", method, "--json", "--samples", "--jobs", "1"]
        done = subprocess.run([*command, "--repeat", str(repeat)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        answer = json.loads(done.stdout)
    except json.JSONDecodeError:
        return {"status": done.stderr.strip() or f"ended with {done.returncode}", "honest": False}
    return answer


def judged(problem, answer):
    """A plan of `protean plan` in the form of `plan.solve`, its samples looked at by this baseline."""
    kept = {key: value for key, value in answer.items() if key not in ("samples", "id")}
    if kept.get("t_s") is None:
        return kept | {"honest": False, "reasons": [str(kept.get("error") or kept["status"])]}
    finding = check.look_at_samples(problem, answer)
    return kept | {"honest": finding.honest, "reasons": finding.reasons}
