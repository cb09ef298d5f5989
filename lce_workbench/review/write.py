"""Write the review's three files, all from the same record."""

from __future__ import annotations

import json
from pathlib import Path

from lce_solver.types import Progress, silent
from lce_workbench.review.data import Review
from lce_workbench.review.figures import drawn, polarised
from lce_workbench.review.html import as_html
from lce_workbench.review.pdf import write_pdf
from lce_workbench.review.record import as_record


def write_review(review: Review, folder: Path, progress: Progress = silent) -> None:
    """Write `report.json`, `report.html` and `report.pdf` into ``folder``.

    Raises
    ------
    OSError
        A file cannot be written.
    """
    progress("review: figures", 0.0)
    record = as_record(review)
    (folder / "report.json").write_text(json.dumps(record, ensure_ascii=False, indent=1) + "\n", encoding="utf-8")
    figures, pictures = drawn(review, record), polarised(review.domains)
    progress("review: report.html", 0.5)
    (folder / "report.html").write_text(as_html(review, record, figures, pictures), encoding="utf-8")
    progress("review: report.pdf", 0.6)
    write_pdf(review, record, figures, pictures, folder / "report.pdf")
    progress("review", 1.0)
