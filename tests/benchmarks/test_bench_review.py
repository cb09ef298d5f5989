"""report.html with 10 000 domains: size of the file, first paint, frames per second and processor time of the map."""

import shutil

import psutil
import pytest
from playwright.sync_api import sync_playwright
from sheets import design

from lce_workbench.core import jobfile
from lce_workbench.core.channels import ChannelField
from lce_workbench.core.domains import PLATES, partition
from lce_workbench.core.job import Job, Sheet, Target
from lce_workbench.export.table import write_table
from lce_workbench.outputs import write_design, write_manifest
from lce_workbench.review.data import assemble
from lce_workbench.review.write import write_review

SECONDS = 6


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("large")
    plan, job = (
        design(columns=64, rows=80, width=20.0, height=22.0),
        Job(target=Target(surface="face"), sheet=Sheet(width_mm=22.0)),
    )
    domains = partition(plan)
    (folder / "job.toml").write_text(jobfile.dump(job))
    write_design(plan, folder / "design.npz")
    write_table(
        domains, [ChannelField(domains, plate, job.channels).counts for plate in PLATES], folder / "domains.csv"
    )
    write_manifest(folder, {"versions": {"lce-molds": "0"}, "inputs": [], "findings": []})
    write_review(assemble(folder), folder)
    return folder / "report.html"


def test_ten_thousand_domains(page, benchmark):
    """Wheel over the map for some seconds; what is counted are finished frames."""
    assert page.stat().st_size < 15e6
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        view = browser.new_page(viewport={"width": 1600, "height": 1000})
        view.goto(page.as_uri())
        view.wait_for_selector("#table tbody tr[aria-rowindex]")
        painted = view.evaluate("performance.getEntriesByName('first-contentful-paint')[0].startTime")
        view.locator("#map-canvas").scroll_into_view_if_needed()
        box = view.locator("#map-canvas").bounding_box()
        at = [box["x"] + box["width"] / 2, box["y"] + box["height"] / 2]
        before = spent()
        drawn = benchmark.pedantic(lambda: view.evaluate(WHEEL, [*at, SECONDS * 1000]), rounds=1)
        used = spent() - before
        browser.close()
    benchmark.extra_info |= {
        "domains": 10240, "megabytes": page.stat().st_size / 1e6, "first_paint_s": painted / 1000,
        "frames_per_s": drawn / SECONDS, "processor_ms_per_frame": 1000 * used / drawn,
    }  # fmt: skip
    assert painted < 2000
    assert drawn / SECONDS > 20


WHEEL = """async ([clientX, clientY, time]) => {
  const canvas = document.getElementById("map-canvas"), first = review.sheet.drawn(), end = performance.now() + time;
  for (let k = 0; performance.now() < end; k++) {
    const deltaY = k % 40 < 20 ? -30 : 30;
    canvas.dispatchEvent(new WheelEvent("wheel", { deltaY, clientX, clientY, cancelable: true }));
    await new Promise(requestAnimationFrame);
  }
  return review.sheet.drawn() - first;
}"""


def spent():
    """Processor time of the browser's processes [s]."""
    total = 0.0
    for process in psutil.Process().children(recursive=True):
        times = process.cpu_times()
        total += times.user + times.system
    return total
