"""``python -m protean_robotics.lab``: the commands that `protean` leaves to this package."""

import signal
import sys

from . import beliefs, figures, maps, reproduce, worlds

#: Commands by their names.
_COMMANDS = {"beliefs": beliefs.main, "figures": figures.main, "maps": maps.main, "reproduce": reproduce.main, "worlds": worlds.main}


def _main() -> int:
    name, *arguments = sys.argv[1:] or [""]
    if name not in _COMMANDS:
        print(f"error: {name!r}: expected one of {', '.join(_COMMANDS)}", file=sys.stderr)
        return 2
    # As Ctrl-C.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    return _COMMANDS[name](arguments)


if __name__ == "__main__":
    sys.exit(_main())
