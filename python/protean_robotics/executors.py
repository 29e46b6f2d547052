"""Executors of :func:`sweep` for Ray and HyperQueue, which have none of their own."""

import os
import pickle
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any
from uuid import uuid4

from ._sweep import Future

__all__ = ["HyperQueue", "Ray"]


class Ray:
    """Tasks of Ray, after ``ray.init()``. Ray runs a task again when its worker is lost."""

    def submit(self, call: Callable[..., Any], /, *arguments: Any) -> Future:
        """Begins a call."""
        task = import_module("ray").remote(max_retries=3)(call)
        future: Future = task.remote(*arguments).future()
        return future


class HyperQueue:
    """Tasks of HyperQueue. It runs a task again when its worker is lost.

    Parameters
    ----------
    client
        ``hyperqueue.Client``; its ``python_env`` is an environment with this package.
    folder
        Folder for results on their way, which workers see at the same path.
    """

    def __init__(self, client: Any, folder: str | os.PathLike[str]) -> None:
        self._client = client
        self._folder = Path(folder).absolute()
        self._folder.mkdir(parents=True, exist_ok=True)

    def submit(self, call: Callable[..., Any], /, *arguments: Any) -> Future:
        """Begins a call."""
        file = self._folder / f"{uuid4()}.result"
        job = import_module("hyperqueue").Job()
        job.function(_store, args=(file, call, arguments))
        return _Result(self._client, self._client.submit(job), file)


class _Result:
    """Result of a task of HyperQueue, which appears as a file."""

    def __init__(self, client: Any, job: Any, file: Path) -> None:
        self._client, self._job, self._file = client, job, file

    def done(self) -> bool:
        return self._file.exists() or bool(self._failures())

    def result(self) -> Any:
        if not self._file.exists():
            raise RuntimeError("; ".join(self._failures()))
        value = pickle.loads(self._file.read_bytes())
        self._file.unlink()
        if isinstance(value, Exception):
            raise value
        return value

    def _failures(self) -> list[str]:
        return [failure.error for failure in self._client.get_failed_tasks(self._job).values()]


def _store(file: Path, call: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    """Carries out a call and writes what it returns or raises, on a worker."""
    try:
        value = call(*arguments)
    except Exception as error:
        value = error
    new = file.with_suffix(".new")
    new.write_bytes(pickle.dumps(value))
    new.rename(file)
