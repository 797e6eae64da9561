"""The page in a headless Chromium, driven by mouse and keyboard as a user drives it.

`PAGE` is the folder that web/build writes, `BRDF_PROGRAM` the program `brdf`. Screenshots go to `PAGE_PICTURES`. Without
Playwright, Chromium or the page, the tests are skipped and say so.
"""

import functools
import http.server
import json
import os
import pathlib
import shutil
import threading
import time

import pytest

ROOT = pathlib.Path(__file__).parents[2]
PICTURES = pathlib.Path(os.environ.get("PAGE_PICTURES", ROOT / "target" / "page-pictures"))
# Without a graphics card.
ARGUMENTS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
# Nothing here is measured by it: a busy machine takes long.
PATIENCE_S = 90
LONG_TASKS = """
window.longTasks = [];
new PerformanceObserver((list) => list.getEntries().forEach((entry) => longTasks.push(entry.duration)))
  .observe({ entryTypes: ["longtask"] });
"""


class Quiet(http.server.SimpleHTTPRequestHandler):
    """A web server that says nothing."""

    def log_message(self, *_):
        pass


@pytest.fixture(scope="session")
def address():
    folder = os.environ.get("PAGE")
    if not folder or not pathlib.Path(folder, "viewer_bg.wasm").is_file():
        pytest.skip("no page: expected PAGE to be the folder that web/build writes")
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/index.html"
    server.shutdown()


@pytest.fixture(scope="session")
def browser():
    api = pytest.importorskip("playwright.sync_api", reason="no Playwright")
    program = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")
    if program is None:
        pytest.skip("no Chromium")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=ARGUMENTS)
        yield browser
        browser.close()


@pytest.fixture
def viewer(browser, address):
    """Opens the page: viewer(), or viewer("#sample=...", width=390, height=844)."""
    opened = []

    def start(suffix="", width=1280, height=800, context=None, **options):
        if context is None:
            context = browser.new_context(viewport={"width": width, "height": height}, **options)
            context.add_init_script(LONG_TASKS)
        page = context.new_page()
        opened.append(context)
        return Viewer(page, f"{address}?places{suffix}")

    yield start
    for context in opened:
        context.close()


class Viewer:
    """The viewer in a tab."""

    def __init__(self, page, url):
        self.page = page
        self.complaints = []
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("console", self._listen)
        started = time.monotonic()
        page.goto(url)
        self.until("a first frame", lambda: self.attribute("status") is not None)
        self.first_frame_s = time.monotonic() - started

    def _listen(self, message):
        if message.type == "error":
            self.complaints.append(message.text)

    def attribute(self, name):
        return self.page.evaluate("name => document.getElementById('viewer').getAttribute('data-' + name)", name)

    def until(self, what, test):
        """Waits for a condition, whatever the time that it takes."""
        deadline = time.monotonic() + PATIENCE_S
        while not (result := test()):
            assert time.monotonic() < deadline, (
                f"{what}: not within {PATIENCE_S} s; status {self.attribute('status')!r}, "
                f"errors {self.attribute('errors')!r}, console {self.complaints}"
            )
            time.sleep(0.01)
        return result

    def until_status(self, part):
        def has():
            return part in (self.attribute("status") or "") and self.attribute("busy") == "false"

        self.until(f"the status {part!r}", has)
        return self.attribute("status")

    def frames(self, count=2):
        """egui finds what is under the pointer in the frame after a move."""
        script = "async n => { for (; n > 0; n--) await new Promise((drawn) => requestAnimationFrame(drawn)); }"
        self.page.evaluate(script, count)

    def places(self, name, role=None):
        places = json.loads(self.attribute("places") or "[]")
        return [place for place in places if place["name"] == name and role in (None, place["role"])]

    def place(self, name, role=None):
        return self.until(f"a control {name!r}", lambda: self.places(name, role))[0]

    def entry(self, name):
        """The name of an entry of an open menu, which its key follows."""
        def find():
            places = json.loads(self.attribute("places") or "[]")
            return [place["name"] for place in places if place["name"].startswith(name)]

        return self.until(f"an entry {name!r}", find)[0]

    def parameter(self, role, number):
        """The bounds and the value of a control of a parameter: they have no names of their own."""
        places = json.loads(self.attribute("places") or "[]")
        places = [place for place in places if place["role"] == role and not place["name"]]
        return sorted(places, key=lambda place: place["bounds"][1])[number]

    def middle(self, name, role=None):
        left, top, right, bottom = self.place(name, role)["bounds"]
        return (left + right) / 2, (top + bottom) / 2

    def point(self, name, role=None):
        self.frames()
        at = self.middle(name, role)
        self.page.mouse.move(*at)
        self.frames()
        return at

    def click(self, name, role=None):
        self.page.mouse.click(*self.point(name, role))
        self.frames()

    def press(self, keys):
        self.page.keyboard.press(keys)
        self.frames()

    def drag(self, start, end):
        self.page.mouse.move(*start)
        self.frames()
        self.page.mouse.down()
        for part in range(1, 11):
            at = [a + (b - a) * part / 10 for a, b in zip(start, end)]
            self.page.mouse.move(*at)
            self.frames(1)
        self.page.mouse.up()
        self.frames()

    def drop(self, *files):
        script = """files => {
          const data = new DataTransfer();
          for (const [name, bytes] of files) data.items.add(new File([new Uint8Array(bytes)], name));
          const place = { dataTransfer: data, bubbles: true, cancelable: true, clientX: 500, clientY: 300 };
          const canvas = document.getElementById("viewer");
          for (const kind of ["dragenter", "dragover", "drop"]) canvas.dispatchEvent(new DragEvent(kind, place));
        }"""
        self.page.evaluate(script, [[pathlib.Path(file).name, list(pathlib.Path(file).read_bytes())] for file in files])
        self.frames()

    def choose(self, *files):
        with self.page.expect_file_chooser() as chooser:
            self.press("Control+o")
        chooser.value.set_files([str(file) for file in files])
        self.frames()

    def download(self, act, folder):
        with self.page.expect_download(timeout=1000 * PATIENCE_S) as download:
            act()
        path = pathlib.Path(folder) / download.value.suggested_filename
        download.value.save_as(path)
        return path

    def long_tasks(self):
        """The tasks of the thread of the page above 50 ms since the last call, in ms."""
        return self.page.evaluate("longTasks.splice(0)")

    def message(self):
        return self.page.evaluate("message.hidden ? null : message.textContent")

    def picture(self, name):
        PICTURES.mkdir(parents=True, exist_ok=True)
        self.frames(3)
        self.page.screenshot(path=PICTURES / f"{name}.png")
