"""report.html with 10 000 domains: size of the file, first paint and frames of the map from Chromium's own trace."""

import json
import shutil
import time
from collections import Counter

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

ARGUMENTS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]

TRACED = ["loading", "blink.user_timing", "devtools.timeline", "disabled-by-default-devtools.timeline",
          "disabled-by-default-devtools.timeline.frame"]  # fmt: skip


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("large")
    plan = design(columns=64, rows=80, width=20.0, height=22.0)
    job = Job(target=Target(surface="face"), sheet=Sheet(width_mm=22.0))
    domains = partition(plan)
    (folder / "job.toml").write_text(jobfile.dump(job))
    write_design(plan, folder / "design.npz")
    counts = [ChannelField(domains, plate, job.channels).counts for plate in PLATES]
    write_table(domains, counts, folder / "domains.csv")
    write_manifest(folder, {"versions": {"lce-molds": "0"}, "inputs": [], "findings": []})
    write_review(assemble(folder), folder)
    return folder / "report.html"


def test_ten_thousand_domains(report, benchmark):
    """The page is opened; then for some seconds the wheel turns over the map, and it is dragged about."""
    assert report.stat().st_size < 15e6
    events, drawn = benchmark.pedantic(lambda: traced(report), rounds=1)
    began = min(event["ts"] for event in named(events, "navigationStart") if "report.html" in address(event))
    painted = min(event["ts"] for event in named(events, "firstContentfulPaint"))
    (begin,), (end,) = ([event["ts"] for event in named(events, mark)] for mark in ("begin", "end"))
    seconds = (end - begin) / 1e6
    frames = {
        name: len([event for event in named(events, name) if begin <= event["ts"] <= end])
        for name in ("DrawFrame", "Commit")
    }
    benchmark.extra_info |= {
        "domains": 10240,
        "megabytes": report.stat().st_size / 1e6,
        "first_paint_s": (painted - began) / 1e6,
        "drawn_per_s": drawn / seconds,
        **{f"{name}_per_s": count / seconds for name, count in frames.items()},
        "processor_ms_per_frame": busiest(events, begin, end) / drawn,
    }
    assert (painted - began) / 1e6 < 2
    assert min(drawn, *frames.values()) / seconds > 20


def named(events, name):
    return [event for event in events if event["name"] == name]


def busiest(events, begin, end):
    """Processor time [ms] of the thread that works most, the page's: what a busy machine does not change much."""
    spent = Counter()
    for event in named(events, "RunTask"):
        if begin <= event["ts"] <= end:
            spent[event["pid"], event["tid"]] += event.get("tdur", 0) / 1e3
    return max(spent.values())


def address(event):
    return event["args"].get("data", {}).get("documentLoaderURL", "")


def traced(report):
    """The events of Chromium's trace, and how often the map itself says that it was drawn."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=ARGUMENTS)
        view = browser.new_page(viewport={"width": 1600, "height": 1000})
        browser.start_tracing(page=view, categories=TRACED)
        view.goto(report.as_uri())
        view.wait_for_selector("#table tbody tr[aria-rowindex]")
        view.locator("#map-canvas").scroll_into_view_if_needed()
        box = view.locator("#map-canvas").bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        view.mouse.move(x, y)
        first = view.evaluate("performance.mark('begin'), review.sheet.drawn()")
        turned(view, SECONDS / 2)
        dragged(view, x, y, SECONDS / 2)
        last = view.evaluate("performance.mark('end'), review.sheet.drawn()")
        events = json.loads(browser.stop_tracing())["traceEvents"]
        browser.close()
    return events, last - first


def turned(view, seconds):
    """The wheel to and fro."""
    end, k = time.monotonic() + seconds, 0
    while time.monotonic() < end:
        view.mouse.wheel(0, -30 if k % 40 < 20 else 30)
        k += 1


def dragged(view, x, y, seconds):
    """The map to and fro."""
    end, k = time.monotonic() + seconds, 0
    view.mouse.down()
    while time.monotonic() < end:
        view.mouse.move(x + 5 * abs(20 - k % 40), y + 3 * abs(20 - k % 40))
        k += 1
    view.mouse.up()
