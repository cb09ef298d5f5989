"""The texts of the window in other languages: finds them, keeps what is translated, compiles with Qt's lrelease.

.venv/bin/python resources/translations/update.py          # needs Debian's qttools5-dev-tools for lrelease
"""

from __future__ import annotations

import ast
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import fields
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "solver")]

from lce_workbench.app.properties import label, properties  # noqa: E402
from lce_workbench.core.job import Job  # noqa: E402

LANGUAGES = ("de",)
CONTEXT = "LceMold"
"""Of all texts of the panels and commands; the preferences have their form's name."""


NAMED = ("HEADS", "TITLES")
"""Tables whose values are shown."""


def window_texts() -> list[str]:
    """What commands, panels and legends say: arguments of `tr`, and the words of tables and pictures."""
    found = []
    code = ROOT / "lce_workbench"
    for path in (*sorted((code / "gui").glob("*.py")), code / "app" / "pictures.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                words = [arg.value for arg in node.args if isinstance(arg, ast.Constant) and isinstance(arg.value, str)]
                if node.func.id == "tr":
                    found += words[:1]
                if node.func.id == "Step" and len(words) > 5:
                    found += [words[2], words[3], words[5]]
                if node.func.id == "Look":
                    found += words[2:4]
                if node.func.id in {"Picture", "Scale"}:
                    found += words[:1]
            if isinstance(node, ast.AnnAssign) and ast.unparse(node.target) in NAMED:
                found += list(ast.literal_eval(node.value).values())
    tree = ast.parse((ROOT / "lce_workbench" / "app" / "session.py").read_text(encoding="utf-8"))
    tables = {node.target.id: node.value for node in tree.body if isinstance(node, ast.AnnAssign)}
    found += [key.value for key in tables["EXAMPLES"].keys]
    return list(dict.fromkeys(found))


def parameter_texts() -> list[str]:
    """Labels and tooltips of all parameters."""
    found = [section.name.capitalize() for section in fields(Job)]
    for section in fields(Job):
        for prop in properties(type(getattr(Job(), section.name))):
            found += [label(section.name, prop.name), prop.doc]
    return list(dict.fromkeys(found))


def form_texts() -> dict[str, list[str]]:
    """Name of a form -> its texts."""
    tree = ET.parse(ROOT / "resources" / "preferences.ui")
    return {tree.findtext("class", ""): [node.text for node in tree.iter("string") if node.text]}


def texts() -> dict[str, list[str]]:
    """Context -> texts."""
    return {CONTEXT: list(dict.fromkeys([*window_texts(), *parameter_texts()])), **form_texts()}


def known(language: str) -> dict[tuple[str, str], str]:
    """(context, text) -> translation, of those that are translated."""
    path = HERE / f"LceMold_{language}.ts"
    if not path.exists():
        return {}
    return {
        (context.findtext("name", ""), message.findtext("source", "")): message.findtext("translation", "")
        for context in ET.parse(path).iter("context")
        for message in context.iter("message")
        if message.findtext("translation")
    }


def write(language: str) -> list[str]:
    """Write the catalogue of a language; returns what is not translated."""
    former, missing = known(language), []
    root = ET.Element("TS", version="2.1", language=language, sourcelanguage="en")
    for name, words in texts().items():
        context = ET.SubElement(root, "context")
        ET.SubElement(context, "name").text = name
        for word in words:
            message = ET.SubElement(context, "message")
            ET.SubElement(message, "source").text = word
            translation = ET.SubElement(message, "translation")
            translation.text = former.get((name, word))
            if translation.text is None:
                translation.set("type", "unfinished")
                missing.append(word)
    ET.indent(root, " ")
    text = '<?xml version="1.0" encoding="utf-8"?>\n<!DOCTYPE TS>\n' + ET.tostring(root, encoding="unicode") + "\n"
    (HERE / f"LceMold_{language}.ts").write_text(text, encoding="utf-8")
    return missing


def compile_catalogue(language: str) -> None:
    """Compile for Qt."""
    source = HERE / f"LceMold_{language}.ts"
    subprocess.run(["/usr/lib/qt5/bin/lrelease", "-silent", source, "-qm", source.with_suffix(".qm")], check=True)


if __name__ == "__main__":
    for one in LANGUAGES:
        lost = write(one)
        compile_catalogue(one)
        sys.stderr.write("".join(f"{one}: not translated: {word}\n" for word in lost))
