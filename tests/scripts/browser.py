"""A headless Chromium over its pipe: the commands of the DevTools protocol as JSON, each ended by a zero byte. Needs nothing but Python."""

import json
import os
import select
import shutil
import subprocess
import tempfile
import time

FLAGS = [
    "--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--mute-audio", "--no-first-run",
    "--disable-dev-shm-usage", "--disable-extensions", "--disable-background-networking", "--disable-component-update",
    "--remote-debugging-pipe",
]


class Browser:
    """One browser with one page."""

    def __init__(self, program=None):
        program = program or next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
        if program is None:
            raise SystemExit("no Chromium found: install the package `chromium`")
        self.profile = tempfile.mkdtemp(prefix="mbd-browser-")
        to_browser, self.to = os.pipe()
        self.answers, from_browser = os.pipe()
        # The browser reads commands from its descriptor 3 and answers on 4, which the shell sets up.
        command = f'exec "$@" 3<&{to_browser} 4>&{from_browser}'
        self.process = subprocess.Popen(
            ["bash", "-c", command, "browser", program, f"--user-data-dir={self.profile}", *FLAGS, "about:blank"],
            pass_fds=(to_browser, from_browser), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.count, self.rest, self.errors, self.events = 0, b"", [], []
        self.allowed = ("file:", "data:", "about:")
        targets = self.ask("Target.getTargets")["targetInfos"]
        page = next(target for target in targets if target["type"] == "page")
        self.session = self.ask("Target.attachToTarget", targetId=page["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.page(f"{domain}.enable")

    def message(self, limit=30.0):
        """The next message of the browser."""
        until = time.monotonic() + limit
        while b"\0" not in self.rest:
            ready, _, _ = select.select([self.answers], [], [], max(0.0, until - time.monotonic()))
            if not ready:
                raise TimeoutError("the browser does not answer")
            part = os.read(self.answers, 1 << 20)
            if not part:
                raise EOFError("the browser is gone")
            self.rest += part
        text, self.rest = self.rest.split(b"\0", 1)
        return json.loads(text)

    def note(self, message):
        """Keeps what pages complain about."""
        method, params = message.get("method"), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description") or details["text"])
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning"):
            self.errors.append(" ".join(str(argument.get("value", "")) for argument in params["args"]))
        elif method == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
            self.errors.append(params["entry"]["text"])
        elif method == "Network.requestWillBeSent" and not params["request"]["url"].startswith(self.allowed):
            self.errors.append(f"fetches {params['request']['url']}")
        if method:
            self.events.append(method)

    def ask(self, method, session=None, **params):
        """Sends a command and waits for its answer."""
        self.count += 1
        command = {"id": self.count, "method": method, "params": params}
        if session:
            command["sessionId"] = session
        os.write(self.to, json.dumps(command).encode() + b"\0")
        while True:
            message = self.message()
            if message.get("id") == self.count:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return message["result"]
            self.note(message)

    def page(self, method, **params):
        return self.ask(method, session=self.session, **params)

    def open(self, path, width=1280, height=900, scale=1, dark=False, script=True):
        """Loads a file, or the page of a server of this machine, and waits until it is loaded."""
        self.errors, self.events = [], []
        self.size(width, height, scale)
        scheme = "dark" if dark else "light"
        self.page("Emulation.setEmulatedMedia", media="screen", features=[{"name": "prefers-color-scheme", "value": scheme}])
        self.page("Emulation.setScriptExecutionDisabled", value=not script)
        served = path.startswith(("http://127.0.0.1:", "about:"))
        self.allowed = ("file:", "data:", "about:") + ((path,) if served else ())
        self.page("Page.navigate", url=path if served else "file://" + os.path.abspath(path))
        while "Page.loadEventFired" not in self.events:
            self.note(self.message())

    def size(self, width, height, scale=1):
        """The size of the window."""
        self.page("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=width < 600)

    def run(self, expression):
        """The value of an expression in the page; a promise is waited for."""
        answer = self.page("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"].get("exception", {}).get("description", expression))
        return answer["result"].get("value")

    def frames(self, count=1):
        """Waits for so many frames; what was asked for before is drawn in the first."""
        self.run(f"new Promise(done => {{ let k = {count}; const next = () => k-- > 0 ? requestAnimationFrame(next) : done(); next(); }})")

    def mouse(self, kind, x, y, button="none", buttons=0, **more):
        self.page("Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, buttons=buttons, clickCount=1 if button != "none" else 0, **more)

    def close(self):
        self.process.terminate()
        self.process.wait(10)
        shutil.rmtree(self.profile, ignore_errors=True)
