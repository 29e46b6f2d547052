"""Processes with topics of their own: sensors, trackers, and others that steer no robot."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ._arguments import mapping, texts
from ._errors import InvalidInput
from ._planner import Planner
from ._program import toml


class Message(NamedTuple):
    """A message of a topic.

    Attributes
    ----------
    header
        Its header, a structured scalar: ``header["stamp"]["tick"]`` and others.
    elements
        Its elements, a read-only structured array.
    """

    header: Any
    elements: npt.NDArray[Any]


@dataclass(frozen=True)
class Output:
    """A topic that a process writes: its messages are arrays of a structured type.

    Attributes
    ----------
    dtype
        Type of the elements: named numbers, fixed arrays of numbers, and structures of them. The largest numbers come first,
        and no field needs padding.
    most
        Maximum number of elements of a message.
    later
        True if its messages count in the next tick; False if readers wait for them within the tick.
    sole
        True if only one process of a run may write it.
    may_be_infinite
        Names of fields in which infinity is valid; a message with another number that is not finite is rejected.
    drawing
        Form in reports and viewers, by names of fields: points ``{"x": ..., "y": ...}``, with ``"angle"`` arrows, with
        ``"radius"`` circles.
    """

    dtype: npt.DTypeLike
    most: int = 64
    later: bool = False
    sole: bool = False
    may_be_infinite: Sequence[str] = ()
    drawing: Mapping[str, str] = field(default_factory=dict)

    def _written(self, name: str) -> dict[str, Any]:
        return {
            "name": name,
            "message": _message(name, _dtype(name, self.dtype)),
            "elements": self.most,
            "later": self.later,
            "sole": self.sole,
            "may_be_infinite": [*self.may_be_infinite],
            "drawing": dict(self.drawing),
        }


class Process(Planner):
    """A function or class that reads and writes topics; :func:`process` makes it.

    Called, it is the function or class itself, so that tests can use it.
    """

    _what = "process"


def process(
    *, reads: Sequence[str] = (), writes: Mapping[str, Output | npt.DTypeLike]
) -> Callable[[Callable[..., Any]], Process]:
    """Makes a process from a function or a class, for sensors, trackers and others that steer no robot.

    A function is called once per tick. Its arguments name its inputs, in any order: ``inputs``, ``world``, ``params`` and
    ``rng``, as for :func:`planner`. A class is called once, with ``world``, ``params`` and ``rng`` as far as its ``__init__``
    names them; its object is called once per tick. It returns its messages: a dict of elements by the name of the topic, or
    the elements of its only topic; a topic that is left out has no message in this tick. Elements are a structured array or a
    list of tuples.

    Parameters
    ----------
    reads
        Names of the topics that ``inputs`` has: a dict of lists of :class:`Message`. Those that other processes write within
        the tick are there already.
    writes
        The topics that it writes, each with its :class:`Output` or the type of its elements.

    Returns
    -------
    Callable
        Decorator that makes a :class:`Process`, for :func:`serve`, and for ``processes`` of :func:`run`.

    Raises
    ------
    InvalidInput
        A topic or a field of its messages is invalid.

    Examples
    --------
    >>> import protean_robotics as pr
    >>> @pr.process(writes={"sonar/echo": [("range", "f8"), ("robot", "u4"), ("reserved", "u4")]})
    ... def sonar(world: pr.World) -> list[tuple[float, int, int]]:
    ...     return [(robot.x, robot.index, 0) for robot in world.robots]
    >>> sonar
    <process sonar>
    """
    known = texts("reads", reads)
    outputs = {
        name: output if isinstance(output, Output) else Output(output) for name, output in mapping("writes", writes).items()
    }
    written = json.dumps([output._written(name) for name, output in outputs.items()])
    return lambda function: Process(function, known, written)


def declared(processes: Mapping[str, Process] | None) -> list[str]:
    """Declarations of processes, as values of the scenario."""
    given = {} if processes is None else mapping("processes", processes)
    for name, own in given.items():
        if not isinstance(own, Process):
            raise InvalidInput(f"processes: {name}: expected a process (pr.process)")
    return [
        f"processes.{name}.declaration={toml(name, json.loads(own._function.declaration))}" for name, own in given.items()
    ]


def _dtype(topic: str, given: Any) -> np.dtype[Any]:
    try:
        found: np.dtype[Any] = np.dtype(given)
    except (TypeError, ValueError) as error:
        raise InvalidInput(f"writes: topic {topic}: {error}: expected a structured type, as [('angle', 'f8')]") from None
    return found


def _message(topic: str, dtype: np.dtype[Any]) -> str:
    """Fields of a structured type in the words of ROS 2."""
    package = topic.split("/")[0]
    blocks: list[str] = []

    def fields(dtype: np.dtype[Any], path: str) -> list[str]:
        if dtype.names is None or dtype.fields is None:
            raise InvalidInput(f"topic {topic}: {dtype}: expected a structured type, as [('angle', 'f8')]")
        lines, end = [], 0
        known: dict[Any, Any] = dict(dtype.fields)
        for name in dtype.names:
            kind, offset = known[name][:2]
            where = f"topic {topic}: field {path}{name}"
            if offset != end:
                raise InvalidInput(f"{where}: it begins at byte {offset}: expected {end}, without padding")
            end = offset + kind.itemsize
            base, shape = kind.subdtype or (kind, ())
            if len(shape) > 1:
                raise InvalidInput(f"{where}: {kind}: expected an array of one dimension")
            if base.names is not None and not shape:
                nested = f"{package}/{''.join(word.title() for word in f'{path}{name}'.replace('.', '_').split('_'))}"
                blocks.extend([f"MSG: {nested}", *fields(base, f"{path}{name}.")])
                lines.append(f"{nested} {name}")
            elif base.kind in "fiu" and base.isnative and base.itemsize <= 8 and base != np.float16:
                ros = {"f": "float", "i": "int", "u": "uint"}[base.kind] + str(8 * base.itemsize)
                lines.append(f"{ros}[{shape[0]}] {name}" if shape else f"{ros} {name}")
            else:
                raise InvalidInput(f"{where}: type {kind}: expected f4, f8, i1 to i8, u1 to u8, or fixed arrays of them")
        if end != dtype.itemsize:
            raise InvalidInput(f"topic {topic}: {dtype.itemsize} bytes: expected {end}, without padding at the end")
        return lines

    own = fields(dtype, "")
    return "\n".join([*own, *blocks])
