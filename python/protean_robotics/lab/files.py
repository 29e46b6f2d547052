"""Files that are replaced as a whole."""

import os
from pathlib import Path


def save(path: Path, data: bytes) -> None:
    """Writes a file and its folder; after a kill it is the file before or the new one."""
    path.parent.mkdir(parents=True, exist_ok=True)
    made = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        made.write_bytes(data)
        made.replace(path)
    finally:
        made.unlink(missing_ok=True)
