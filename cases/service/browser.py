"""A browser goes through the workbench, from the drop of a model to a download: Chromium, led over WebDriver (w3.org/TR/webdriver2)."""

import json
import shutil
import subprocess
import tempfile
import time
import urllib.request
from contextlib import contextmanager
from pathlib import Path

# Seconds that a step on the page may take: the picture is drawn by software.
LIMIT = 120
OPTIONS = ("--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking --disable-dev-shm-usage "
           "--use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader --window-size=1200,800")


class Browser:
    """A page of a browser."""

    def __init__(self, address):
        self.address = address

    def ask(self, method, path, body=None):
        """What the driver answers."""
        content = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.address + path, content, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=LIMIT) as answer:
            return json.load(answer)["value"]

    def script(self, text, *given):
        """What a script on the page returns."""
        return self.ask("POST", "/execute/sync", {"script": text, "args": given})

    def wait(self, condition):
        """Waits until an expression of the page is true."""
        until = time.monotonic() + LIMIT
        while not self.script(f"return Boolean({condition})"):
            if time.monotonic() > until:
                raise TimeoutError(condition)
            time.sleep(0.05)


@contextmanager
def started(downloads):
    """A browser that puts downloads there; it ends with this."""
    driver = subprocess.Popen([shutil.which("chromedriver") or "chromedriver", "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        line = next(line for line in driver.stdout if "successfully on port" in line)
        address = f"http://127.0.0.1:{line.rsplit(' ', 1)[1].strip().rstrip('.')}/session"
        with tempfile.TemporaryDirectory() as profile:
            wanted = {"goog:chromeOptions": {"args": [*OPTIONS.split(), f"--user-data-dir={profile}"]}}
            driven = Browser(address)
            session = driven.ask("POST", "", {"capabilities": {"alwaysMatch": wanted}})
            driven.address += f"/{session['sessionId']}"
            driven.ask("POST", "/goog/cdp/execute", {"cmd": "Browser.setDownloadBehavior",
                                                     "params": {"behavior": "allow", "downloadPath": str(downloads)}})
            try:
                yield driven
            finally:
                driven.ask("DELETE", "")
    finally:
        driver.terminate()
        driver.wait(LIMIT)


def shown(page, name):
    """Waits until the first view shows a file."""
    page.wait(f"document.querySelector('#first h2').textContent === '{name}' && document.getElementById('first').dataset.state === 'ready'")


def through(url, model, size, downloads):
    """Drops a model on the workbench, makes its first mesh, adapts that to a size, looks at it, and downloads it: the file."""
    stem = model.stem
    with started(downloads) as page:
        page.ask("POST", "/url", {"url": url})
        page.wait("document.body.dataset.state === 'ready'")
        page.script("const data = new DataTransfer(); data.items.add(new File([arguments[0]], arguments[1]));"
                    "document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }))",
                    model.read_text(), model.name)
        shown(page, model.name)
        page.script("document.querySelector('#bootstrap [name=start]').click()")
        shown(page, f"{stem}.meshb")
        page.script("const form = document.getElementById('adapt').elements; form.size.value = arguments[0];"
                    "document.getElementById('adapt').dispatchEvent(new Event('input')); form.start.click()", str(size))
        shown(page, f"{stem}-2.meshb")
        page.wait("document.querySelectorAll('#sizes tbody tr').length > 5")
        page.script("const job = document.querySelector('#jobs li'); job.querySelector('details').open = true;"
                    "job.querySelector('select').value = 'vtu';"
                    "job.querySelector('[data-part=convert]').click()")
        made, until = Path(downloads) / f"{stem}-2.vtu", time.monotonic() + LIMIT
        while not made.is_file():
            if time.monotonic() > until:
                raise TimeoutError(f"{made} does not come")
            time.sleep(0.05)
        return made
