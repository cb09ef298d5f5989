"""The review of an output folder: one object, read from its files, feeds report.html, report.pdf and report.json."""
