"""Programs as their users start them: `./lce` in a small checkout, FreeCAD with and without a window."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BATCH = ROOT / "lce_workbench" / "batch.py"


TELLING_CLI = '''
import json
import os
import sys


def main(argv):
    """Tell what arrives; `end CODE` ends with it, `raise` with a defect, `import NAME` tells where NAME is."""
    with open(os.environ["SEEN"], "a") as seen:
        print(json.dumps({"argv": argv, "cwd": os.getcwd(), "path": sys.path}), file=seen)
    if argv[:1] == ["end"]:
        return int(argv[1])
    if argv[:1] == ["raise"]:
        raise RuntimeError("a defect")
    if argv[:1] == ["import"]:
        print("imported", __import__(argv[1]).__file__)
    return 0
'''


@dataclass(frozen=True)
class Ended:
    """What a process left."""

    code: int
    out: str
    err: str


def make_project(folder: Path) -> Path:
    """A checkout in a folder with a blank in its name: the real launcher and batch entry, a command line that tells."""
    root = folder / "a check out"
    for name in ("solver", "resources", "lce_workbench"):
        shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("lce", "Init.py", "InitGui.py", "package.xml"):
        shutil.copy(ROOT / name, root / name)
    (root / "lce_workbench" / "cli.py").write_text(TELLING_CLI)
    return root


def environment(home: Path, **more: str) -> dict[str, str]:
    """The environment of a user whose FreeCAD settings and addons are those below ``home``."""
    home.mkdir(parents=True, exist_ok=True)
    kept = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "LC_", "LANG"))}
    ours = {"FREECAD_USER_HOME": str(home), "LC_ALL": "C.UTF-8", "QTWEBENGINE_DISABLE_SANDBOX": "1"}
    return kept | ours | more


def start(*words: str | Path, env: dict[str, str], cwd: Path, seconds: float = 120) -> Ended:
    """Run a program to its end."""
    done = subprocess.run(
        [str(word) for word in words],
        env=env,
        cwd=cwd,
        capture_output=True,
        text=True,
        timeout=seconds,
        check=False,
        stdin=subprocess.DEVNULL,
    )
    return Ended(done.returncode, done.stdout, done.stderr)


@contextmanager
def display() -> Iterator[str]:
    """A virtual screen; yields what DISPLAY has to be."""
    read, write = os.pipe()
    words = ["Xvfb", "-displayfd", str(write), "-screen", "0", "1400x900x24", "-nolisten", "tcp"]
    with subprocess.Popen(words, pass_fds=[write], stderr=subprocess.DEVNULL) as server:
        os.close(write)
        try:
            with os.fdopen(read) as told:
                yield f":{told.readline().strip()}"
        finally:
            server.terminate()
