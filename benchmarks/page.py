#!/usr/bin/env python3
"""The page in headless Chromium: the time to the first data of a live chase, and pictures a second of it and of 60 robots.

The time is that from the start of the program, with the browser open, to the first picture of its data. The page of 60 robots is
that of a live replay at its speed, and that of `protean report`, which plays. Standard library only.

usage: page.py PROTEAN
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests/python"))
from browse import Browser

SECONDS = 10


def scenario(robots: int) -> str:
    text = (ROOT / "scenarios/chase_exact.toml").read_text().replace('"maps/', f'"{ROOT}/scenarios/maps/')
    # In the streets of the city, away from the starts of the six.
    places = [(x, -7.0 + 1.25 * row) for x in (-7.5, -4.5, -1.5, 1.5, 4.5) for row in range(12)]
    blocks = [
        f'[[robots]]\nname = "more_{i}"\nteam = "{("police", "evader")[i % 3 == 0]}"\nstart = {{ x = {x}, y = {y}, theta = 0.0 }}\n'
        for i, (x, y) in enumerate(places[: robots - 6])
    ]
    return text.replace("[[processes]]", "\n".join([*blocks, "[[processes]]"]), 1)


def show(browser: Browser, page: str) -> None:
    browser.call("Page.navigate", url=page)
    while browser.evaluate(f"location.href.startsWith({page!r}) && document.documentElement?.dataset.ready") != "yes":
        time.sleep(0.002)


def pictures(browser: Browser) -> float:
    """Returns the pictures a second from now on."""
    drawn, since = browser.evaluate("protean.drawn"), time.monotonic()
    time.sleep(SECONDS)
    return (browser.evaluate("protean.drawn") - drawn) / (time.monotonic() - since)


def main() -> None:
    program = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        browser = Browser("chromium", f"{folder}/profile")
        target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        browser.session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        browser.call("Emulation.setDeviceMetricsOverride", width=1500, height=1000, deviceScaleFactor=1, mobile=False)

        def live(name: str, words: list[object]) -> None:
            began = time.monotonic()
            words = [program, *words, "--live", "0", "--quiet"]
            child = subprocess.Popen(words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            try:
                show(browser, next(line for line in child.stderr if "http://" in line).split()[1])
                print(f"{name}: first data after {time.monotonic() - began:.2f} s, then {pictures(browser):.1f} pictures a second")
            finally:
                child.kill()
                child.wait()

        live("chase", ["run", "chase", "--out", f"{folder}/chase.mcap"])
        file, log, page = (Path(folder, f"many.{ending}") for ending in ("toml", "mcap", "html"))
        file.write_text(scenario(60))
        run = [program, "run", file, "--allow-outside", "--in-process", "--quiet", "--set", "rules.time_limit=60", "--out", log]
        for words in (run, [program, "report", log, "--quiet", "--out", page]):
            subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
        live("60 robots, replayed", ["replay", log])
        show(browser, page.as_uri())
        browser.evaluate("protean.seek(0), protean.play()")
        print(f"60 robots: {pictures(browser):.1f} pictures a second")
        browser.end()


main()
