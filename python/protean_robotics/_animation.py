"""Films of logs."""

import importlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ._arguments import count, refused
from ._errors import Error, InvalidInput
from ._optional import imported

if TYPE_CHECKING:
    from ._log import Log

#: Maximum number of pictures of a film: for each, the log is read up to its time.
_MAX_FRAMES = 20_000


def frames(log: "Log", fps: float, speed: float, size: tuple[int, int] | None) -> Iterator[NDArray[np.uint8]]:
    """Checks the arguments; returns the pictures of a log."""
    for name, value in (("fps", fps), ("speed", speed)):
        if not 0 < value < float("inf"):
            raise refused(name, value, "a number above 0")
    if size is not None and (not isinstance(size, (tuple, list)) or len(size) != 2):
        raise refused("size", size, "width and height (px)")
    limits = None if size is None else (count("size", size[0]), count("size", size[1]))
    # The last state; later messages are not of the world.
    end = float(log["world/state"]["log_time_ns"][-1]) * 1e-9
    number = int(end * fps / speed) + 1
    if number > _MAX_FRAMES:
        raise refused("fps", fps, f"at most {_MAX_FRAMES} pictures: fewer for each second, or a higher speed")
    times = [min(i * speed / fps, end) for i in range(number)]
    return _drawn(log, times if times[-1] == end else [*times, end], limits)


def _drawn(log: "Log", times: list[float], size: tuple[int, int] | None) -> Iterator[NDArray[np.uint8]]:
    for time in times:
        picture = log._file.frame(time, size)
        if size is None:
            # Legends differ; and videos want even numbers of pixels.
            size = picture.shape[1] // 2 * 2, picture.shape[0] // 2 * 2
            picture = log._file.frame(time, size)
        yield picture


def film(log: "Log", out: Path, fps: float, speed: float, size: tuple[int, int] | None, force: bool) -> Path:
    """Writes a film, completely or not at all."""
    writers = {".gif": _write_gif, ".mp4": _write_mp4}
    write = writers.get(out.suffix.lower())
    if write is None:
        raise InvalidInput(f"films are GIF or MP4 files: expected a name that ends in .gif, for example {out.with_suffix('.gif')}")
    if out.exists() and not force:
        raise InvalidInput(f"{out} exists already; choose another name with out=, or overwrite it with force=True")
    pictures = frames(log, fps, speed, size)
    try:
        handle, name = tempfile.mkstemp(suffix=out.suffix.lower(), prefix=f".{out.stem}-", dir=out.parent)
    except OSError as error:
        raise Error(f"{out}: cannot be created: {error.strerror}") from error
    os.close(handle)
    try:
        write(pictures, Path(name), fps)
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(name, 0o666 & ~mask)
        os.replace(name, out)
    finally:
        with suppress(FileNotFoundError):
            os.unlink(name)
    return out


def _write_gif(pictures: Iterator[NDArray[np.uint8]], out: Path, fps: float) -> None:
    image = imported("PIL.Image")
    # The last one shows all colours of the film best; a GIF has whole hundredths of a second.
    images = [image.fromarray(picture) for picture in pictures]
    palette = images[-1].quantize(255, dither=image.Dither.NONE)
    images = [picture.quantize(palette=palette, dither=image.Dither.NONE) for picture in images]
    duration = max(2, round(100 / fps)) * 10
    images[0].save(out, save_all=True, append_images=images[1:], duration=duration, loop=0, optimize=False)


def _write_mp4(pictures: Iterator[NDArray[np.uint8]], out: Path, fps: float) -> None:
    program = shutil.which("ffmpeg")
    if program is None:
        try:
            program = importlib.import_module("imageio_ffmpeg").get_ffmpeg_exe()
        except ImportError as error:
            raise ImportError("ffmpeg is missing: install it, or pip install imageio-ffmpeg", name="imageio_ffmpeg") from error
    first = next(pictures)
    height, width, _ = first.shape
    source = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(fps), "-i", "-"]
    # The sizes of H.264 are even.
    target = ["-vf", "crop=trunc(iw/2)*2:trunc(ih/2)*2", "-pix_fmt", "yuv420p", "-movflags", "+faststart", os.fspath(out)]
    command = [program, "-loglevel", "error", "-y", *source, *target]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as writer:
        assert writer.stdin is not None and writer.stderr is not None
        with suppress(BrokenPipeError):
            writer.stdin.write(first.tobytes())
            for picture in pictures:
                writer.stdin.write(picture.tobytes())
            writer.stdin.close()
        message = writer.stderr.read().decode(errors="replace").strip()
    if writer.returncode:
        raise Error(f"ffmpeg failed: {message}")
