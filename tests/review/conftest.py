"""One small folder with everything in it, and pages in Chromium."""

import shutil

import pytest
from playwright.sync_api import sync_playwright
from shared import built_once

from lce_workbench.cli import main

JOB = """
[target]
surface = "dome"
[sheet]
width_mm = 4.0
[domains]
size_um = 400.0
[marks]
grating = false
fields = []
[solver]
starts = 4
[output]
masks = ["gds"]
cad = []
pictures = false
freecad = false
drawings = false
"""

ARGUMENTS = ["--no-sandbox", "--enable-unsafe-swiftshader"]
"""WebGL2 on the processor; everything else is drawn by Chromium's own compositor, which is far quicker there."""


@pytest.fixture(scope="session")
def built(tmp_path_factory):
    """An output folder with every stage."""

    def build(folder):
        job = folder.with_suffix(".toml")
        job.write_text(JOB)
        assert main(["build", str(job), "--quiet", "--out", str(folder)]) == 0

    return built_once(tmp_path_factory, "review", build)


@pytest.fixture
def folder(built, tmp_path):
    """A copy that a test may spoil."""
    return shutil.copytree(built, tmp_path / "copy")


@pytest.fixture(scope="session")
def chromium():
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=ARGUMENTS)
        yield browser
        browser.close()


class Watched:
    """A page with what it said on the console and asked of the network."""

    def __init__(self, browser, path, **how):
        self.page = browser.new_context(viewport=how.pop("viewport", {"width": 1600, "height": 1000}), **how).new_page()
        self.said, self.asked = [], []
        self.page.on("console", lambda message: message.type == "error" and self.said.append(message.text))
        self.page.on("pageerror", lambda fault: self.said.append(str(fault)))
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.goto(path.as_uri())


@pytest.fixture
def opened(chromium):
    """Open a file, to be closed at the end of the test."""
    made = []

    def open_page(path, **how):
        made.append(Watched(chromium, path, **how))
        return made[-1]

    yield open_page
    for watched in made:
        watched.page.context.close()
