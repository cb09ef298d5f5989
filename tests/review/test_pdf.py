"""report.pdf by readers that are not ours."""

import csv
import json
import re
import subprocess

import numpy as np
import pypdf
import pytest
from PIL import Image


@pytest.fixture(scope="module")
def text(built):
    """Text of every page, in columns, by Poppler."""
    done = subprocess.run(
        ["pdftotext", "-layout", built / "report.pdf", "-"], capture_output=True, text=True, check=True
    )
    return done.stdout.rstrip("\f").split("\f")


def test_pages_are_numbered_and_fonts_embedded(built, text):
    reader = pypdf.PdfReader(built / "report.pdf")
    assert len(text) == len(reader.pages)
    for number, page in enumerate(text, 1):
        assert re.search(rf"\b{number} / {len(text)}\s*$", page), page[-80:]
    told = subprocess.run(["pdffonts", built / "report.pdf"], capture_output=True, text=True, check=True).stdout
    fonts = told.splitlines()[2:]
    assert fonts
    assert all(re.search(r"\byes +(yes|no) +(yes|no) +\d+ +\d+$", line) for line in fonts)


def test_its_numbers_are_those_of_report_json(built, text):
    record = json.loads((built / "report.json").read_text(encoding="utf-8"))
    first = " ".join(text[0].split())
    for row in record["numbers"]:
        assert f"{row['name']} {row['shown']}" in first
    whole = " ".join(" ".join(text).split())
    for q in record["questions"]:
        assert q["question"] in whole
    for step in record["process"]:
        assert step["name"] in whole


def test_its_appendix_lists_every_domain(built, text):
    with (built / "domains.csv").open() as file:
        table = list(csv.DictReader(file))
    start = next(k for k, page in enumerate(text) if "Appendix: all domains" in page)
    lines = [line.split() for page in text[start:] for line in page.splitlines()]
    told = {int(line[0]): line for line in lines if len(line) == 14 and line[0].isdigit()}
    assert sorted(told) == list(range(len(table)))
    for row in table:
        line = told[int(row["domain"])]
        assert float(line[4]) == pytest.approx(float(row["theta_deg"]), abs=6e-4)
        assert float(line[5]) == pytest.approx(float(row["dtheta_deg"]), abs=6e-4)
        assert float(line[8]) == pytest.approx(float(row["written_top_deg"]), abs=6e-4)
        assert [int(n) for n in line[12:]] == [int(row["channels_top"]), int(row["channels_bottom"])]
    assert all("theta" in page and "w_bottom" in page for page in text[start:])


def test_nothing_reaches_the_edge_of_a_page(built, tmp_path):
    subprocess.run(["pdftoppm", "-r", "40", "-gray", built / "report.pdf", tmp_path / "page"], check=True)
    pages = sorted(tmp_path.glob("page*"))
    assert pages
    for path in pages:
        grey = np.asarray(Image.open(path))
        rim = round(10 / 25.4 * 40)  # 10 mm
        inner = np.zeros(grey.shape, dtype=bool)
        inner[rim:-rim, rim:-rim] = True
        assert (grey[inner] < 200).sum() > 50
        assert grey[~inner].min() > 200
