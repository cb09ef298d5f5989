"""report.html in headless Chromium, as a reviewer uses it."""

import csv
import io
import json
import re
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image, ImageDraw

from lce_solver.compare import align, vertex_areas
from lce_workbench.cli import main
from lce_workbench.core.channels import ChannelField
from lce_workbench.core.domains import PLATES
from lce_workbench.review.data import assemble

ROW = "#table tbody tr[aria-rowindex]"
"""There as soon as the scripts are at work."""

WIDTHS = {"phone": 400, "desk": 1600}


def rows(folder):
    with (folder / "domains.csv").open() as file:
        return list(csv.DictReader(file))


@pytest.fixture
def page(opened, built):
    """The page with its scripts at work."""
    watched = opened(built / "report.html")
    watched.page.wait_for_selector(ROW)
    return watched.page


def pixels(locator):
    return np.asarray(Image.open(io.BytesIO(locator.screenshot())).convert("RGB")).astype(int)


def shown_rows(page):
    found = page.locator("#table tbody tr[aria-rowindex]")
    return [re.split(r"\s+", text.strip()) for text in found.all_inner_texts()]


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", WIDTHS.values(), ids=WIDTHS)
def test_no_console_error_no_request_no_overflow_and_every_section(opened, built, width, scheme):
    watched = opened(built / "report.html", viewport={"width": width, "height": 900}, color_scheme=scheme)
    page = watched.page
    page.wait_for_selector(ROW)
    seen = []
    for link in page.locator("nav a").all():
        section = page.locator(link.get_attribute("href"))
        section.scroll_into_view_if_needed()
        box = section.bounding_box()
        assert box["height"] > 60
        seen.append(section.locator("h2").inner_text())
    assert len(seen) == 10
    page.wait_for_timeout(300)  # the 3D views begin when they come into sight
    assert watched.said == []
    assert watched.asked == [(built / "report.html").as_uri()]
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_its_numbers_are_those_of_the_table_and_of_report_json(page, built):
    record, table = json.loads((built / "report.json").read_text(encoding="utf-8")), rows(built)
    told = dict(zip(*(page.locator(f"#summary tbody {cell}").all_inner_texts() for cell in ("th", "td:nth-child(2)")),
                    strict=True))  # fmt: skip
    assert told == {row["name"]: row["shown"] for row in record["numbers"]}
    assert told["Domains"] == str(len(table))
    assert told["Channels on the top plate"] == str(sum(int(row["channels_top"]) for row in table))
    shown = shown_rows(page)
    assert len(shown) > 20
    assert shown == [list(row.values()) for row in table[: len(shown)]]
    page.locator("#table").evaluate("box => { box.scrollTop = box.scrollHeight }")
    page.wait_for_timeout(200)
    assert shown_rows(page)[-1] == list(table[-1].values())
    assert [card.split("\n")[0].split("?")[0] for card in page.locator(".card h3").all_inner_texts()] == [
        q["question"].rstrip("?") for q in record["questions"]
    ]


def test_the_table_sorts_filters_and_downloads(page, built):
    table = rows(built)
    page.click("#table th[data-name=dtheta_deg] button")
    values = sorted(float(row["dtheta_deg"]) for row in table)
    assert [float(row[5]) for row in shown_rows(page)[:10]] == values[:10]
    page.click("#table th[data-name=dtheta_deg] button")
    assert [float(row[5]) for row in shown_rows(page)[:10]] == values[::-1][:10]
    assert page.get_attribute("#table th[data-name=dtheta_deg]", "aria-sort") == "descending"
    low, high = np.round(np.percentile([float(row["theta_deg"]) for row in table], [30, 60]), 3)
    for text, passes in (
        (f">{low}", lambda v: v > low),
        (f"<={high}", lambda v: v <= high),
        (f"{low}..{high}", lambda v: low <= v <= high),
    ):
        page.fill("#table th[data-name=theta_deg] input", text)
        left = sum(passes(float(row["theta_deg"])) for row in table)
        assert 0 < left < len(table)
        assert page.inner_text("#table-count") == f"{left} of {len(table)} domains"
    page.fill("#table th[data-name=theta_deg] input", "nonsense")
    assert page.get_attribute("#table th[data-name=theta_deg] input", "aria-invalid") == "true"
    page.click("#table-clear")
    assert page.inner_text("#table-count") == f"{len(table)} of {len(table)} domains"
    with page.expect_download() as download:
        page.click("#table-csv")
    assert download.value.path().read_bytes() == (built / "domains.csv").read_bytes()


def at_domain(page, domain, folder):
    """Where the centre of a domain is on the map's canvas."""
    row = rows(folder)[domain]
    page.locator("#map-canvas").scroll_into_view_if_needed()
    x, y = page.evaluate(f"review.sheet.toScreen({row['x_mm']}, {row['y_mm']})")
    box = page.locator("#map-canvas").bounding_box()
    return box["x"] + x, box["y"] + y


def test_the_map_tells_a_domain_and_selects_it_in_the_table_and_back(page, built):
    table = rows(built)
    x, y = at_domain(page, 40, built)
    page.mouse.move(x, y)
    tip = dict(line.split(" ") for line in page.inner_text("#map-tip").splitlines())
    assert tip.items() >= table[40].items()
    page.mouse.click(x, y)
    marked = page.locator("#table tr[aria-selected=true]")
    assert marked.get_attribute("data-domain") == "40"
    assert f"domain 40 · x_mm {table[40]['x_mm']}" in page.inner_text("#map-selected")
    page.locator("#table").scroll_into_view_if_needed()
    page.locator("#table").evaluate("box => { box.scrollTop = 0 }")
    page.locator("#table tr[data-domain='3']").click()
    assert f"domain 3 · x_mm {table[3]['x_mm']}" in page.inner_text("#map-selected")
    page.focus("#table")
    page.keyboard.press("ArrowDown")
    assert "domain 4 ·" in page.inner_text("#map-selected")
    page.focus("#map-canvas")
    page.keyboard.press(",")
    assert "domain 3 ·" in page.inner_text("#map-selected")


def test_the_map_zooms_by_wheel_keys_and_drag_and_the_top_plate_is_mirrored(page, built):
    x, y = at_domain(page, 40, built)
    scale = page.evaluate("review.sheet.camera.scale")
    page.mouse.move(x, y)
    page.mouse.wheel(0, -400)
    page.wait_for_timeout(200)
    assert page.evaluate("review.sheet.camera.scale") > 1.5 * scale
    there = at_domain(page, 40, built)
    assert there == pytest.approx((x, y), abs=1.5)  # the pointer's place is whole pixels
    page.mouse.down()
    page.mouse.move(x + 50, y + 20, steps=4)
    page.mouse.up()
    assert at_domain(page, 40, built) == pytest.approx((there[0] + 50, there[1] + 20), abs=1.0)
    page.focus("#map-canvas")
    page.keyboard.press("0")
    page.wait_for_timeout(200)
    assert page.evaluate("review.sheet.camera.scale") == pytest.approx(scale)
    box = page.locator("#map-canvas").bounding_box()
    page.select_option("#map-view", "top-written")
    assert at_domain(page, 40, built) == pytest.approx((2 * box["x"] + box["width"] - x, y), abs=0.5)


def test_the_map_has_the_colour_of_what_it_shows(page, built):
    """The diverging map: orange where the twist is negative, violet where it is positive."""
    page.select_option("#map-quantity", "dtheta")
    page.locator("#map-canvas").scroll_into_view_if_needed()
    page.wait_for_timeout(300)
    seen, table = pixels(page.locator("#map-canvas")), rows(built)
    twist = np.array([float(row["dtheta_deg"]) for row in table])
    at = np.array([page.evaluate(f"review.sheet.toScreen({row['x_mm']}, {row['y_mm']})") for row in table])
    column, row = np.floor(at).astype(int).T
    around = [seen[row + j, column + i] for i in range(-3, 4) for j in range(-3, 4)]  # streaks cross the middle
    red, _, blue = np.median(around, axis=0).T
    assert np.corrcoef(red - blue, twist)[0, 1] < -0.9


def test_the_channels_that_are_drawn_are_those_of_the_masks(page, built):
    """The page computes them itself from the outlines; every one of some domains against the core's."""
    review = assemble(built)
    for plate in PLATES:
        part = next(iter(ChannelField(review.domains, plate, review.job.channels)))
        for domain in (0, 7, 40):
            angle = float(review.domains.angle(plate)[domain])
            drawn = np.array(page.evaluate(f"review.sheet.channels({domain}, {angle!r}, {PLATES.index(plate)})"))
            ours = part.domain == domain
            assert len(drawn) == ours.sum() == review.columns[f"channels_{plate}"][domain]
            assert drawn[:, :2] == pytest.approx(part.centre[ours], abs=1e-9)
            assert np.abs(drawn[:, 2] - part.length[ours]).max() < 1.01e-4


MOVED = """async () => {
  const canvas = document.getElementById("map-canvas"), pen = canvas.getContext("2d");
  const frame = () => new Promise(requestAnimationFrame), rest = () => new Promise(done => setTimeout(done, 500));
  const look = () => new Uint32Array(pen.getImageData(0, 0, canvas.width, canvas.height).data.buffer);
  const view = name => {
    document.getElementById("map-view").value = name;
    document.getElementById("map-view").dispatchEvent(new Event("change"));
  };
  canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));
  await frame(); await frame();
  const moving = look();
  await rest();
  const resting = look();
  for (const name of ["top", "bottom"]) { view(name); await rest(); }
  const anew = look(), strip = k => k % canvas.width < 38, inside = k => k % canvas.width > 42;
  const apart = (v, u) => Math.max(...[0, 8, 16].map(bits => Math.abs((v >> bits & 255) - (u >> bits & 255))));
  const unlike = (one, other, where) => one.filter((v, k) => where(k) && apart(v, other[k]) > 8).length / one.length;
  return { inside: unlike(moving, resting, inside), strip: unlike(moving, resting, strip),
           anew: unlike(resting, anew, () => true), inks: new Set(resting).size };
}"""
"""One step of 40 pixels to the right: shares of pixels that change when the map comes to rest, and when redrawn."""


def test_the_channels_move_with_the_map_and_are_drawn_anew_where_it_rests(page):
    page.select_option("#map-view", "bottom")
    page.click("#map-channels")
    page.wait_for_timeout(500)
    changed = page.evaluate(MOVED)
    assert changed["inside"] < 0.002
    assert changed["strip"] > 0.01  # of which 0.03 are in it: no channels stood there yet
    assert changed["anew"] == 0
    assert changed["inks"] > 30


FINE = 4
"""Pixels of a silhouette for each on the screen, both ways."""


def silhouette(points, faces, scene, shape):
    """Which pixels (h, w) a shape covers, seen by the page's camera from where ``scene`` just fits in."""
    turn, tilt, opening, filled = -0.45, 0.85, 2.4, 0.92
    h, w = shape
    a, b, c, d = np.cos(turn), np.sin(turn), np.cos(tilt), np.sin(tilt)
    axes, middle = (
        np.array([[a, b, 0], [-b * c, a * c, d], [b * d, -a * d, c]]),
        (scene.min(axis=0) + scene.max(axis=0)) / 2,
    )
    lens = opening * min(1.0, w / h)
    x, y, z = axes @ (scene - middle).T
    far = np.max(z + lens / filled * np.maximum(np.abs(x) * h / w, np.abs(y)))
    x, y, z = axes @ (points - middle).T
    places = np.column_stack([w / 2 + lens * h / 2 * x / (far - z), h / 2 - lens * h / 2 * y / (far - z)])
    picture = Image.new("L", (FINE * w, FINE * h))
    pen = ImageDraw.Draw(picture)
    for corners in FINE * places[faces]:
        pen.polygon([tuple(corner) for corner in corners], fill=255)
    return np.asarray(picture.reduce(FINE)) > 127


def overlap(one, other):
    """Intersection over union."""
    return (one & other).sum() / (one | other).sum()


def test_the_slider_shows_the_shape_that_was_predicted_at_each_lambda(page, built):
    """Its outline on the screen against the frames of prediction.npz, seen by the same camera."""
    with np.load(built / "design.npz") as design, np.load(built / "prediction.npz") as found:
        target, faces, flat = design["vertices"], design["faces"], design["uv"]
        frames = np.concatenate([np.pad(flat, ((0, 0), (0, 1)))[None], found["frames"].reshape(-1, *target.shape)])
    lambdas = [1.0, *(step["lambda_"] for step in json.loads((built / "prediction.json").read_text())["heating"])]
    laid = align(frames[-1], target, vertex_areas(target, faces))
    frames = frames @ laid.rotation.T + laid.shift
    scene = np.concatenate([target, frames[0]])
    canvas = page.locator("#shape")
    canvas.scroll_into_view_if_needed()
    page.wait_for_timeout(400)
    for k in (0, len(frames) // 2, len(frames) - 1):
        page.evaluate(f"document.getElementById('shape-heat').value = {k}")
        page.dispatch_event("#shape-heat", "input")
        page.wait_for_timeout(300)
        seen = pixels(canvas)
        assert page.inner_text("#shape-lambda") == (f"λ = {lambdas[k]:.3f}" if k else "λ = 1 (flat)")
        ink = np.abs(seen - seen[2, 2]).sum(axis=2) > 60
        fits = [overlap(ink, silhouette(points, faces, scene, ink.shape)) for points in frames]
        assert not ink[[0, -1]].any()  # the flat sheet is larger than the target
        assert not ink[:, [0, -1]].any()
        assert fits[k] > 0.985
        assert np.argmax(fits) == k


def test_the_shape_is_drawn_and_the_slider_heats_it(page):
    canvas = page.locator("#shape")
    canvas.scroll_into_view_if_needed()
    page.select_option("#shape-show", "prediction")
    page.wait_for_timeout(400)
    hot = pixels(canvas)
    ink = np.ptp(hot, axis=2) > 40
    assert 0.02 < ink.mean() < 0.9
    assert "λ = 0.6" in page.inner_text("#shape-lambda")
    page.focus("#shape-heat")
    page.keyboard.press("Home")
    page.wait_for_timeout(300)
    assert "flat" in page.inner_text("#shape-lambda")
    cold = pixels(canvas)
    assert (np.abs(cold - hot).sum(axis=2) > 30).mean() > 0.02
    page.select_option("#shape-show", "target")
    page.wait_for_timeout(300)
    assert (np.ptp(pixels(canvas), axis=2) > 40).mean() < 0.01  # the target is grey
    canvas.focus()
    before = pixels(canvas)
    page.keyboard.press("ArrowLeft")
    page.wait_for_timeout(300)
    assert (np.abs(pixels(canvas) - before).sum(axis=2) > 10).mean() > 0.005


def test_the_cell_is_drawn_comes_apart_and_its_parts_can_be_hidden(page):
    canvas = page.locator("#cell")
    canvas.scroll_into_view_if_needed()
    page.wait_for_timeout(400)
    seen = [pixels(canvas)]
    assert (np.abs(seen[0] - seen[0][2, 2]).sum(axis=2) > 30).mean() > 0.03
    page.focus("#cell-apart")
    page.keyboard.press("End")
    page.wait_for_timeout(300)
    seen.append(pixels(canvas))
    page.locator("#cell-parts label", has_text="top glass").click()
    page.wait_for_timeout(300)
    seen.append(pixels(canvas))
    for one, two in pairwise(seen):
        assert (np.abs(one - two).sum(axis=2) > 20).mean() > 0.01


def test_everything_can_be_reached_by_keyboard(page):
    page.evaluate("document.activeElement.blur()")
    reached = set()
    for _ in range(120):
        page.keyboard.press("Tab")
        reached.add(page.evaluate("document.activeElement.id || document.activeElement.textContent.slice(0, 12)"))
    assert {"map-quantity", "map-view", "map-canvas", "shape", "shape-heat", "cell", "cell-apart", "table"} <= reached


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_has_the_contrast_of_wcag_aa(opened, built, scheme):
    page = opened(built / "report.html", color_scheme=scheme).page
    pairs = page.evaluate(
        """() => [...document.querySelectorAll('p, th, td, h1, h2, h3, li, a, button, span, summary')]
          .filter(e => e.offsetParent && e.textContent.trim()).map(e => {
            let back = e;
            while (back && getComputedStyle(back).backgroundColor === 'rgba(0, 0, 0, 0)') back = back.parentElement;
            return [getComputedStyle(e).color, getComputedStyle(back || document.body).backgroundColor];
          })"""
    )
    ratios = {pair: contrast(*pair) for pair in {tuple(pair) for pair in pairs}}
    assert len(ratios) > 4
    assert {pair: ratio for pair, ratio in ratios.items() if ratio < 4.5} == {}


def contrast(ink, paper):
    """WCAG 2.2, relative luminance."""

    def luminance(colour):
        share = np.array([int(v) for v in re.findall(r"\d+", colour)[:3]]) / 255
        linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
        return linear @ [0.2126, 0.7152, 0.0722]

    low, high = sorted((luminance(ink), luminance(paper)))
    return (high + 0.05) / (low + 0.05)


def test_strings_of_the_user_are_text_never_markup(opened, tmp_path, folder):
    import trimesh

    review = assemble(folder)
    name = "<img src=x onerror=alert(1)><script>alert(2)<'&.stl"
    surface = review.design.surface
    trimesh.Trimesh(surface.vertices, surface.faces).export(tmp_path / name, file_type="stl")
    (tmp_path / "job.toml").write_text(
        f"[target]\nmesh = {json.dumps(name)}\n[sheet]\nwidth_mm = 4.0\n[domains]\nsize_um = 400.0\n"
    )
    out = tmp_path / "out"
    assert main(["design", str(tmp_path / "job.toml"), "--quiet", "--out", str(out)]) == 0
    assert main(["review", str(out), "--quiet"]) == 0
    watched = opened(out / "report.html")
    alarms = []
    watched.page.on("dialog", lambda dialog: (alarms.append(dialog.message), dialog.dismiss()))
    watched.page.wait_for_selector(ROW)
    assert watched.page.inner_text("h1") == name
    assert watched.page.locator("h1 *").count() == 0
    assert alarms == []
    assert watched.said == []


def test_on_paper_controls_are_gone_and_nothing_is_cut(page):
    page.emulate_media(media="print")
    assert not page.locator("#map-quantity").is_visible()
    assert not page.locator("#table").is_visible()
    assert page.locator("#summary").is_visible()
    assert page.pdf(format="A4").startswith(b"%PDF")
