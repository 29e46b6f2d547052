"""Opens a log or a live run in Foxglove Studio, in headless Chromium, and takes steps there.

usage: studio.py CHROMIUM DIRECTORY LAYOUT SOURCE [TIME] < JSON list of steps (see browse.py)

SOURCE is a log, to be opened at TIME [s], or the ws:// address of a live server. Studio comes from npm (`npm pack`, exact
versions whose contents are checked) and is kept in DIRECTORY; everything is served on the loopback
address. Prints what browse.py prints. Exits with 75 if Studio cannot be had here.
"""

import base64
import datetime
import fcntl
import hashlib
import http.server
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile
import threading
import time
import urllib.parse

import browse

HERE = pathlib.Path(__file__).parent
CANNOT = 75
# The last open version of Studio, and the React that it wants from outside.
PACKAGES = {
    "studio-base": ("@foxglove/studio-base@1.48.0",
                    "EY8cYoHUm6VyTSVZBdfn5EJK2bRwTfAjH92H5wgAEcnKyeCUyKkxjgwbqO2jKwRJGa+7VPaEHHF167BzFh+N4A=="),
    "react": ("react@17.0.2",
              "gnhPt75i/dq/z3/6q/0asP78D0u592D5L1pd7M8P+dck6Fu/jJeL6iVVK23fptSUZj8Vjf++7wXA8UNclGQcbA=="),
    "react-dom": ("react-dom@17.0.2",
                  "s4h96KtLDUQlsENhMn1ar8t2bEa+q/YAtj8pPPdIjPDGBDIVNsrD9aXNWqspUe6AzKCIG0C1HZZLqLV7qpOBGA=="),
}
# Without a graphics card.
GRAPHICS = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")


def cannot(reason):
    print(reason, file=sys.stderr)
    sys.exit(CANNOT)


def prepare(directory):
    """Fetches what is not there yet. Several tests may ask at the same time: the others wait."""
    directory.mkdir(parents=True, exist_ok=True)
    with open(directory / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        for name, (package, integrity) in PACKAGES.items():
            folder = directory / name
            done = folder / "done"
            if not done.exists() or done.read_text() != integrity:
                shutil.rmtree(folder, ignore_errors=True)
                fetch(directory, folder, package, integrity)
                done.write_text(integrity)


def fetch(directory, folder, package, integrity):
    try:
        packed = subprocess.run(["npm", "pack", "--silent", package], cwd=directory, capture_output=True, text=True,
                                timeout=300)
    except (OSError, subprocess.TimeoutExpired) as error:
        cannot(f"npm: {error}")
    if packed.returncode != 0:
        cannot(f"npm pack {package}: {packed.stderr.strip()}")
    archive = directory / packed.stdout.strip().splitlines()[-1]
    digest = base64.b64encode(hashlib.sha512(archive.read_bytes()).digest()).decode()
    if digest != integrity:
        raise SystemExit(f"{package} is not what it was: sha512-{digest}")
    with tarfile.open(archive) as tar:
        wanted = [m for m in tar.getmembers() if m.isfile() and re.match(r"package/(assets|umd)/", m.name)]
        for member in wanted:
            member.name = member.name.removeprefix("package/")
        tar.extractall(folder, wanted, filter="data")
    archive.unlink()


def serve(directory, files):
    """Serves the packages, and the files by these names, with ranges; returns the address."""

    class Handler(http.server.BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def handle(self):
            try:
                super().handle()
            except ConnectionError:
                pass  # The browser has gone.

        def log_message(self, *_):
            pass

        def find(self):
            path = urllib.parse.unquote(urllib.parse.urlsplit(self.path).path)
            if path in files:
                return files[path]
            # The bundle loads its parts from beside the page.
            for root in (directory, directory / "studio-base/assets"):
                file = (root / path.lstrip("/")).resolve()
                if file.is_file() and file.is_relative_to(directory.resolve()):
                    return file
            return None

        def do_HEAD(self):
            self.do_GET()

        def do_GET(self):
            file = self.find()
            if file is None:
                # The page's icon, for instance: not worth an error in the console.
                self.send_response(204)
                self.send_header("Content-Length", "0")
                self.end_headers()
                return
            size = file.stat().st_size
            first, last, status = 0, size - 1, 200
            if wanted := re.fullmatch(r"bytes=(\d+)-(\d*)", self.headers.get("Range", "")):
                first, status = int(wanted[1]), 206
                last = min(int(wanted[2] or last), last)
            kinds = {".html": "text/html", ".js": "text/javascript", ".json": "application/json",
                     ".wasm": "application/wasm", ".css": "text/css"}
            self.send_response(status)
            self.send_header("Content-Type", kinds.get(file.suffix, "application/octet-stream"))
            self.send_header("Content-Length", str(max(last - first + 1, 0)))
            self.send_header("Accept-Ranges", "bytes")
            if status == 206:
                self.send_header("Content-Range", f"bytes {first}-{last}/{size}")
            self.end_headers()
            if self.command == "GET":
                with open(file, "rb") as content:
                    content.seek(first)
                    self.wfile.write(content.read(last - first + 1))

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = True
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_port}"


def main():
    program, directory, layout, source = sys.argv[1:5]
    directory = pathlib.Path(directory)
    prepare(directory)
    files = {"/": HERE / "studio.html", "/layout.json": pathlib.Path(layout)}
    is_live = source.startswith("ws:")
    if not is_live:
        files["/log.mcap"] = pathlib.Path(source)
    address = serve(directory, files)
    query = {"ds": "foxglove-websocket", "ds.url": source} if is_live else {
        "ds": "remote-file", "ds.url": f"{address}/log.mcap"}
    if len(sys.argv) > 5:
        moment = datetime.datetime.fromtimestamp(float(sys.argv[5]), datetime.timezone.utc)
        query["time"] = moment.isoformat().replace("+00:00", "Z")
    # Tens of megabytes of script, and no graphics card.
    browse.DEADLINE = time.monotonic() + 400
    page = f"{address}/?{urllib.parse.urlencode(query)}"
    json.dump(browse.look(program, page, json.load(sys.stdin), GRAPHICS), sys.stdout)


if __name__ == "__main__":
    main()
