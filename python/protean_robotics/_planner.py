"""Planners: functions and classes that steer robots."""

import inspect
import io
import os
import pickle
import signal
import sys
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NoReturn, overload

from ._arguments import refused, texts
from ._core import Function
from ._core import serve as _serve
from ._errors import InvalidInput

#: Environment variable with the path of a process's configuration.
_CONFIG = "PROTEAN_CONFIG"
#: Environment variable of a program that shall print its declaration.
_DECLARE = "PROTEAN_DECLARE"
#: Refusal of planners for processes.
ONLY_IN_PROCESS = (
    "planners: expected in_process=True; a planner that is a process is a program of the scenario"
    ' (command = ["python3", "FILE"])'
)


class Planner:
    """A function or class that steers a robot; :func:`planner` makes it.

    Called, it is the function or class itself, so that tests can use it.
    """

    steer: Callable[..., Any]
    _function: Function
    # Its program, if it were a process.
    _file: Path
    __name__: str

    _what = "planner"

    def __init__(self, steer: Callable[..., Any], reads: Sequence[str] = (), writes: str | None = None) -> None:
        reads = texts("reads", reads)
        self.steer = steer
        self._file = _source(steer)
        if inspect.isclass(steer):
            call = getattr(steer, "__call__", None)
            if call is None or call is type.__call__:
                raise InvalidInput(f"{self._what} {steer.__name__}: expected a class with __call__(self, ...)")
            setup = None if steer.__init__ is object.__init__ else _arguments(steer.__init__)[1:]
            self._function = Function(steer, _arguments(call)[1:], setup or [], [*reads], writes)
        elif callable(steer):
            self._function = Function(steer, _arguments(steer), None, [*reads], writes)
        else:
            raise refused(self._what, steer, "a function or a class")
        self._declared = ([*reads], writes)
        self.__doc__ = steer.__doc__
        self.__name__ = getattr(steer, "__name__", self._what)

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        return self.steer(*args, **kwargs)

    def __repr__(self) -> str:
        return f"<{self._what} {self.__name__}>"

    def __reduce__(self) -> tuple[Callable[..., "Planner"], tuple[Any, ...]]:
        # Other processes import a planner of a module by its name. One of a script or a function, which they cannot
        # import, travels as its code, if the package `cloudpickle` is there, which Dask and Ray use.
        module, name = self.steer.__module__, self.steer.__qualname__
        if module == "__main__" or "<locals>" in name:
            if find_spec("cloudpickle") is not None:
                code = import_module("cloudpickle").dumps(self.steer)
                return _of_code, (type(self), code, self._file, *self._declared)
        return _of_module, (module, name)


@overload
def planner(steer: Callable[..., Any]) -> Planner: ...


@overload
def planner(steer: None = None, *, reads: Sequence[str] = ()) -> Callable[[Callable[..., Any]], Planner]: ...


def planner(
    steer: Callable[..., Any] | None = None, *, reads: Sequence[str] = ()
) -> Planner | Callable[[Callable[..., Any]], Planner]:
    """Makes a planner from a function or a class.

    A function is called once per tick and robot. Its arguments name its inputs, in any order:

    ========== =============================================================================
    ``robot``  its :class:`Robot`
    ``world``  the :class:`World`: all robots, exits, time
    ``map``    the :class:`Map`, obstacles that have appeared included
    ``scan``   the :class:`Scan` of its robot; None before the first
    ``belief`` dict of the :class:`Belief` about each opponent, by name (the scenario needs a
               process of kind ``perception``)
    ``params`` dict of ``params`` in the scenario
    ``rng``    :class:`numpy.random.Generator`, seeded by run and robot
    ``inputs`` dict of the messages of this tick, by the name of the topic: a list of
               (header, elements) for each topic in `reads`
    ========== =============================================================================

    A class is for planners with a memory: it is called once per robot with ``robot``, ``world``, ``params`` and ``rng``,
    as far as its ``__init__`` names them; its object is called once per tick.

    Parameters
    ----------
    steer
        Function or class. In a tick it returns forward speed (m/s) and turning rate (rad/s), or a :class:`Steering`;
        values beyond the limits of the robot are clipped.
    reads
        Names of topics, also of other programs, whose messages ``inputs`` has. ``@pr.planner(reads=["sonar/track"])``

    Returns
    -------
    Planner
        For :func:`serve`, and for ``planners`` of :func:`run`.

    Examples
    --------
    >>> import protean_robotics as pr
    >>> @pr.planner
    ... def ahead(robot: pr.Robot) -> tuple[float, float]:
    ...     return 0.5 * robot.v_max, 0.0
    >>> run = pr.run("hello", in_process=True, planners={"robot": ahead}, set={"rules.time_limit": 1})
    >>> run.outcome
    {'robot': 'timed_out'}
    """
    return Planner(steer, reads) if steer is not None else lambda steer: Planner(steer, reads)


def _of_module(module: str, name: str) -> Planner:
    """Planner of a module."""
    found: Any = import_module(module)
    for part in name.split("."):
        found = getattr(found, part)
    return found if isinstance(found, Planner) else Planner(found)


def _of_code(
    kind: type[Planner], code: bytes, file: Path, reads: Sequence[str] = (), writes: str | None = None
) -> Planner:
    """Planner of the code of its function or class, and the file that it comes from."""
    planner = kind(pickle.loads(code), reads, writes)
    planner._file = file
    return planner


def serve(*steers: Callable[..., Any]) -> NoReturn:
    """Runs a planner or a process as a process of a run: the main function of its program.

    A scenario names the program with ``command = ["python3", "planner.py"]``; a run starts it.

    Parameters
    ----------
    steers
        The planner or process; a function or a class becomes a planner. Of several ones, the first argument of the program
        is the name: ``command = ["python3", "planner.py", "NAME"]``.

    Raises
    ------
    InvalidInput
        It is none.
    SystemExit
        Always: 0 at the end of the run, 1 after a failure, 2 if no run has started the program.
    """
    own = {steer.__name__: steer for steer in (s if isinstance(s, Planner) else Planner(s) for s in steers)}
    name = next(iter(own), "") if len(own) == 1 else "".join(sys.argv[1:2])
    if name not in own:
        raise InvalidInput(f"serve: {name!r}: expected the first argument of the program to be one of {', '.join(own)}")
    steer = own[name]
    if os.environ.get(_DECLARE):
        if not steer._function.is_process:
            print(f"{name}: a planner has no declaration: remove it from the scenario", file=sys.stderr)
            raise SystemExit(2)
        print(steer._function.declaration, flush=True)
        raise SystemExit(0)
    config = os.environ.get(_CONFIG)
    if config is None:
        print(
            f"{steer.__name__}: a run of protean starts this program, a {steer._what}: name it in a scenario,"
            ' command = ["python3", "FILE"] in [[processes]].',
            file=sys.stderr,
        )
        raise SystemExit(2)
    # Ctrl-C reaches all processes of a terminal; the run decides then.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Lines that it prints are in the log at once.
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(line_buffering=True)
    raise SystemExit(0 if _serve(steer._function, Path(config)) else 1)


def _source(steer: Callable[..., Any]) -> Path:
    """File of a function or class, which need not exist."""
    name = getattr(steer, "__name__", "planner")
    try:
        return Path(inspect.getsourcefile(steer) or name).absolute()
    except TypeError:
        return Path(name).absolute()


def _arguments(function: Callable[..., Any]) -> list[str]:
    """Names of the arguments of a function; those with a default that are no inputs are left out."""
    names = []
    try:
        parameters = inspect.signature(function).parameters
    except (TypeError, ValueError):
        raise refused("planner", function, "a function whose arguments are known") from None
    for name, parameter in parameters.items():
        if parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD, parameter.KEYWORD_ONLY):
            break
        if parameter.default is not parameter.empty:
            break
        names.append(name)
    return names


def planners_of(planners: Mapping[str, Callable[..., Any]] | None) -> dict[str, Planner]:
    """Planners by the names that they are for; functions and classes become planners."""
    given = (planners or {}).items()
    return {name: steer if isinstance(steer, Planner) else Planner(steer) for name, steer in given}


def placed(planners: Mapping[str, Callable[..., Any]] | None) -> list[SimpleNamespace]:
    """Planners with the names that they are for, and the commands that would start them as processes."""
    return [
        SimpleNamespace(
            name=name,
            function=planner._function,
            command=["python3", planner._file.name],
            folder=str(planner._file.parent),
        )
        for name, planner in planners_of(planners).items()
    ]
