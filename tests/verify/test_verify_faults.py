"""What is damaged is a finding; what is a fault of ours is told as one, whatever the folder holds."""

from __future__ import annotations

import json
import sys
import zipfile

import numpy as np
import pytest
from tampering import errors, rewritten

from lce_workbench.cli import main
from lce_workbench.verify import cells, channels, document, masks, papers
from lce_workbench.verify.finding import Unreadable


@pytest.mark.parametrize("place", [(papers, "angles"), (masks, "both"), (channels, "check")])
def test_a_fault_of_ours_is_no_finding(masked, alone, monkeypatch, capsys, place):
    """Exit code 4, and nothing is said to be well or wrong."""

    def broken(*_):
        raise ZeroDivisionError

    monkeypatch.setattr(*place, broken)
    assert main(["verify", str(masked), "--quiet"]) == 4
    told = capsys.readouterr()
    assert "internal fault (ZeroDivisionError" in told.err
    assert told.out == ""


@pytest.mark.parametrize("part", [0, 1])
def test_every_file_that_is_missing_is_named(copy, part):
    """Every second file, and then the others, although the manifest was made to agree."""
    listed = sorted(entry["path"] for entry in json.loads((copy / "manifest.json").read_text())["files"])
    beside = ("cad/cell.glb", "cad/outlines", "cad/sheet_actuated", ".stl", ".3mf")  # nothing reads them back
    read = [name for name in listed if not any(kind in name for kind in beside)]
    gone = [name for name in read if name not in {"job.toml", "design.npz"}][part::2]
    for name in gone:
        (copy / name).unlink()
    told = " ".join(finding.message for group in errors(copy).values() for finding in group)
    assert [name for name in gone if name not in told] == []


@pytest.mark.parametrize("text", ["nan", "inf", "", "x"])
def test_what_is_no_number_in_the_table(masked, alone, text):
    rewritten(masked / "domains.csv", 4, "channels_top", lambda _: text)
    (finding,) = errors(masked)["verify_table"]
    assert finding.where == "domains.csv"
    if text == "nan":
        assert "channels_top in row 5" in finding.message


def test_a_table_without_a_column_and_a_longer_one(masked, alone):
    path = masked / "domains.csv"
    whole = path.read_text()
    path.write_text(whole.replace("channels_top", "channels"))
    assert "lacks the columns channels_top" in errors(masked)["verify_table"][0].message
    path.write_text(whole + whole.splitlines()[-1] + "\n")
    assert "number of rows" in errors(masked)["verify_table"][0].message


def test_numbers_in_the_design_that_are_none(masked, alone):
    with np.load(masked / "design.npz") as data:
        arrays = {name: data[name] for name in data.files}
    for name, value in (("theta", np.nan), ("stretch", "text"), ("uv", 1j)):
        np.savez(masked / "design.npz", **{**arrays, name: np.full(arrays[name].shape, value)})
        assert f"{name} holds what is no finite number" in errors(masked)["verify_design"][0].message


def test_files_of_every_kind_cut_short_anywhere(copy):
    """Readers die, hang or raise; none of it is a fault of ours, and every file that is read to its end is named."""
    rng = np.random.default_rng(3)
    for _ in range(2):
        names = []
        for path in [*(copy / "mask").glob("*.[god]*"), *(copy / "cad").glob("*.step"), copy / "prediction.json"]:
            data = path.read_bytes()
            path.write_bytes(data[: int(rng.uniform(0.02, 0.98) * len(data))])
            names.append(path.relative_to(copy).as_posix())
        told = " ".join(f.message for group in errors(copy).values() for f in group)
        assert [name for name in names if name not in told] == []


def test_a_document_that_was_tampered_with(tmp_path):
    """The FreeCAD document: a part moved, one taken out, and one cut short; compared with the STEP files."""
    job = tmp_path / "small.toml"
    job.write_text(
        '[target]\nsurface = "dome"\n[sheet]\nwidth_mm = 1.5\n[domains]\nsize_um = 300.0\n[solver]\nstarts = 1\n'
        '[marks]\ngrating = false\nfields = []\n[prediction]\ncorrect = "off"\n[output]\nmasks = ["gds"]\n'
    )
    out = tmp_path / "out"
    assert main(["design", str(job), "--quiet", "--out", str(out)]) == 0
    assert main(["mask", str(out), "--quiet"]) in {0, 1}
    assert main(["cad", str(out), "--quiet"]) in {0, 1}
    assert errors(out) == {}
    path = out / "cad" / "cell.FCStd"
    whole, known = path.read_bytes(), {part.name: part for part in document.parts(path)}
    with zipfile.ZipFile(path) as archive:
        held = {entry: archive.read(entry) for entry in archive.namelist()}
    text = held["Document.xml"].decode()
    with zipfile.ZipFile(path, "w") as archive:
        for entry, data in held.items():
            archive.writestr(entry, text.replace('"Spacer left"', '"Shim left"') if entry == "Document.xml" else data)
    (missing,) = errors(out)["verify_document"]
    assert "spacer_left" in missing.message
    shapes = sorted(entry for entry in held if entry.endswith(".brp"))
    with zipfile.ZipFile(path, "w") as archive:
        for entry, data in held.items():
            archive.writestr(entry, held[shapes[0]] if entry in shapes else data)
    wrong = {
        finding.where for finding in document.check(document.parts(path), known) if finding.severity.value == "error"
    }
    assert {"cad/cell.FCStd, top_glass", "cad/cell.FCStd, sheet"} & wrong
    path.write_bytes(whole[: len(whole) // 2])
    try:
        left = document.parts(path)
    except Unreadable:
        left = []  # FreeCAD refuses it, or opens what is left of it
    assert any(finding.severity.value == "error" for finding in document.check(left, known))


def test_no_kernel_to_read_the_cad_files(solid, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "OCP", None)
    assert main(["verify", str(solid)]) == 4
    assert "the reader OCP is missing, so nothing was verified" in capsys.readouterr().err


def test_the_kernel_repairs_nothing_that_it_reads(solid):
    """A face turned inside out, which the kernel's reader would otherwise turn back."""
    path = solid / "cad" / "spacer.step"
    text = path.read_text()
    at = text.index("ADVANCED_FACE(")
    end = text.index(";", at)
    face = text[at:end]
    path.write_text(text[:at] + (face[:-4] + {".T.": ".F.", ".F.": ".T."}[face[-4:-1]] + ")") + text[end:])
    found = cells.read(solid, "cad/spacer.step")
    assert not all(part.valid for part in found)
