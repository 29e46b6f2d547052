"""Opens a page in headless Chromium and asks it questions, with Python's own library alone.

usage: browse.py CHROMIUM PAGE < JSON list of steps

A step is {"eval": JavaScript} (a JavaScript Promise is awaited), {"until": JavaScript} (tried until it gives
something true), {"key": name}, {"shot": file.png}, {"colours": JavaScript} (what the function makes of the
red, green, blue and alpha bytes of a screenshot), {"until_colours": JavaScript, "least": {key: n}} (until
these numbers of it are that large), {"drag": JavaScript} (the pointer pressed from a point to another: four numbers, px), {"screen": [width, height]} (px) or {"dark": true}. PAGE is a file or an address. Prints {"answers": [...], "errors": [...], "requests": [...]}: what the scripts gave,
the errors of the console, and every address that was asked for.
"""

import base64
import fcntl
import json
import os
import subprocess
import sys
import tempfile
import time

DEADLINE = time.monotonic() + 150
KEY_CODES = {" ": ("Space", 32), "ArrowLeft": ("ArrowLeft", 37), "ArrowRight": ("ArrowRight", 39)}


# Becomes a program whose descriptors 3 and 4 are these two. (No shell does this: that of Debian knows no
# descriptor past 9, and how many of its own a parent leaves open here is not known.)
AS_3_AND_4 = """
import os, sys
for given, wanted in zip(sys.argv[1:3], (3, 4)):
    os.dup2(int(given), wanted)
    os.close(int(given))
os.execvp(sys.argv[3], sys.argv[3:])
"""


def past_4(descriptor):
    """The same pipe at a descriptor that is neither 3 nor 4 nor below."""
    moved = fcntl.fcntl(descriptor, fcntl.F_DUPFD_CLOEXEC, 5)
    os.close(descriptor)
    return moved


class Ended(SystemExit):
    """The browser has ended by itself."""


class Browser:
    """Chromium, spoken to over a pair of pipes (its descriptors 3 and 4)."""

    def __init__(self, program, profile, graphics=("--disable-gpu",)):
        to_browser, self.to = os.pipe()
        self.fro, from_browser = os.pipe()
        to_browser, from_browser = past_4(to_browser), past_4(from_browser)
        words = [
            program, "--headless=new", "--no-sandbox", *graphics, "--no-first-run",
            "--disable-dev-shm-usage", "--disable-extensions", "--disable-background-networking",
            "--hide-scrollbars", f"--user-data-dir={profile}", "--remote-debugging-pipe",
            "--window-size=1500,1000", "about:blank",
        ]
        self.process = subprocess.Popen(
            [sys.executable, "-c", AS_3_AND_4, str(to_browser), str(from_browser), *words],
            pass_fds=(to_browser, from_browser),
            # What it makes for itself beside the profile goes with it.
            env=os.environ | {"TMPDIR": profile},
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        )
        os.close(to_browser)
        os.close(from_browser)
        self.next = 0
        self.rest = b""
        self.session = None
        self.errors = []
        self.requests = []

    def end(self):
        """Lets go of it, and waits for all its processes (they hold its standard error), so that none writes on
        into the profile while that is removed."""
        os.close(self.to)
        os.close(self.fro)
        try:
            self.process.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()

    def receive(self):
        while b"\0" not in self.rest:
            if time.monotonic() > DEADLINE:
                raise SystemExit("the browser does not answer")
            part = os.read(self.fro, 1 << 16)
            if not part:
                raise Ended(f"the browser ended: {self.process.stderr.read().decode(errors='replace')}")
            self.rest += part
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, **params):
        self.next += 1
        message = {"id": self.next, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.next:
                if "error" in answer:
                    raise SystemExit(f"{method}: {answer['error']}")
                return answer["result"]
            self.event(answer)

    def event(self, event):
        params = event.get("params", {})
        if event.get("method") == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))
        elif event.get("method") == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning", "assert"):
            self.errors.append(" ".join(str(a.get("value", a.get("description"))) for a in params["args"]))
        elif event.get("method") == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
            self.errors.append(params["entry"]["text"])
        elif event.get("method") == "Network.requestWillBeSent":
            self.requests.append(params["request"]["url"][:200])

    def evaluate(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            details = result["exceptionDetails"]
            raise SystemExit(f"{expression}: {details.get('exception', {}).get('description', details['text'])}")
        return result["result"].get("value")

    def key(self, key):
        code, number = KEY_CODES.get(key, (key, ord(key[0].upper())))
        common = {"key": key, "code": code, "windowsVirtualKeyCode": number}
        self.call("Input.dispatchKeyEvent", type="keyDown", **common)
        self.call("Input.dispatchKeyEvent", type="keyUp", **common)


def start(program, profile, graphics):
    """Starts the browser with a page; a second time if it crashes before it has one, which is not the fault of any page."""
    for is_last in (False, True):
        browser = Browser(program, profile, graphics)
        try:
            target = browser.call("Target.createTarget", url="about:blank")["targetId"]
            session = browser.call("Target.attachToTarget", targetId=target, flatten=True)
        except (Ended, BrokenPipeError):
            browser.end()
            if is_last:
                raise
        else:
            browser.session = session["sessionId"]
            return browser


def look(program, address, steps, graphics=("--disable-gpu",)):
    """Opens a page, waits until it says that it is ready, and takes the steps."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = start(program, profile, graphics)
        try:
            for domain in ("Runtime", "Log", "Network", "Page"):
                browser.call(f"{domain}.enable")
            browser.call("Emulation.setDeviceMetricsOverride", width=1500, height=1000, deviceScaleFactor=1, mobile=False)
            browser.call("Page.navigate", url=address)
            while browser.evaluate("document.documentElement?.dataset.ready") != "yes":
                if browser.errors or time.monotonic() > DEADLINE:
                    raise SystemExit(f"the page does not come up: {browser.errors}")
                time.sleep(0.05)
            answers = [answer for step in steps for answer in take(browser, step)]
            return {"answers": answers, "errors": browser.errors, "requests": browser.requests}
        finally:
            browser.end()


def take(browser, step):
    """Takes a step; gives its answer, if it has one."""
    if "eval" in step:
        yield browser.evaluate(step["eval"])
    elif "until" in step:
        while not (answer := browser.evaluate(step["until"])):
            if time.monotonic() > DEADLINE:
                shows = browser.evaluate("document.body.innerText")
                raise SystemExit(f"{step['until']} stays {answer}: {browser.errors}\n{shows}")
            time.sleep(0.05)
        yield answer
    elif "screen" in step:
        width, height = step["screen"]
        browser.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=True)
        # Laid out and drawn for it.
        browser.evaluate("new Promise((done) => setTimeout(() => requestAnimationFrame(done), 200))")
    elif "drag" in step:
        x, y, to_x, to_y = browser.evaluate(step["drag"])
        for kind, px, py in (("mousePressed", x, y), ("mouseMoved", to_x, to_y), ("mouseReleased", to_x, to_y)):
            browser.call("Input.dispatchMouseEvent", type=kind, x=px, y=py, button="left", buttons=1, clickCount=1)
    elif "key" in step:
        browser.key(step["key"])
    elif "colours" in step:
        yield colours(browser, step["colours"])
    elif "until_colours" in step:
        while True:
            found = colours(browser, step["until_colours"])
            if all(found[key] >= least for key, least in step["least"].items()):
                break
            if time.monotonic() > DEADLINE:
                raise SystemExit(f"only {found} is drawn: {browser.errors}")
            time.sleep(0.2)
        yield found
    elif "dark" in step:
        scheme = "dark" if step["dark"] else "light"
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        browser.call("Emulation.setEmulatedMedia", features=features)
    elif "shot" in step:
        size = browser.call("Page.getLayoutMetrics")["cssContentSize"]
        clip = {"x": 0, "y": 0, "width": size["width"], "height": min(size["height"], 4000), "scale": 1}
        shot = browser.call("Page.captureScreenshot", captureBeyondViewport=True, clip=clip if step.get("whole") else
                            {"x": 0, "y": 0, "width": 1500, "height": 1000, "scale": 1})
        with open(step["shot"], "wb") as file:
            file.write(base64.b64decode(shot["data"]))


def colours(browser, function):
    """What a function makes of the pixels of a screenshot."""
    shot = browser.call("Page.captureScreenshot")["data"]
    return browser.evaluate(f"""(async () => {{
        const image = new Image();
        image.src = "data:image/png;base64,{shot}";
        await image.decode();
        const canvas = new OffscreenCanvas(image.width, image.height);
        const context = canvas.getContext("2d");
        context.drawImage(image, 0, 0);
        return ({function})(context.getImageData(0, 0, image.width, image.height).data);
    }})()""")


if __name__ == "__main__":
    page = sys.argv[2] if "://" in sys.argv[2] else f"file://{os.path.abspath(sys.argv[2])}"
    json.dump(look(sys.argv[1], page, json.load(sys.stdin)), sys.stdout)
