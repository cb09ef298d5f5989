"""The launcher: what it installs, when it asks nobody, and what it says when it cannot.

The real script with the real dash, venv, pip and apt; small packages stand for the pinned ones, and what this machine
must not lose (Debian's packages, root) is hidden or feigned through PATH.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import time
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from processes import Ended, display, environment, make_project, start

TOOLS = "sh env dirname readlink cat cksum awk df grep id mkdir rm flock true touch dpkg-query"
NOWHERE = "https://nowhere.invalid/simple"


def wheel(folder: Path, name: str, version: str) -> None:
    """A package of one module that knows its version."""
    folder.mkdir(exist_ok=True)
    info = f"{name}-{version}.dist-info"
    files = {
        f"{name}.py": f"version = {version!r}\n",
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n",
        f"{info}/WHEEL": "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    record = "".join(f"{file},,\n" for file in [*files, f"{info}/RECORD"])
    with zipfile.ZipFile(folder / f"{name}-{version}-py3-none-any.whl", "w") as archive:
        for file, text in {**files, f"{info}/RECORD": record}.items():
            archive.writestr(file, text)


class Machine:
    """A user's machine: what is on its PATH, and the checkout whose `./lce` he starts."""

    def __init__(self, project: Path, tmp: Path) -> None:
        self.project, self.home, self.bin, self.seen = project, tmp / "home", tmp / "bin", tmp / "seen"
        self.home.mkdir()
        self.bin.mkdir()
        for tool in TOOLS.split():
            (self.bin / tool).symlink_to(shutil.which(tool) or f"/usr/bin/{tool}")
        self.wheels = tmp / "wheels"
        wheel(self.wheels, "tiny", "1.0")
        self.pin("tiny==1.0")
        (project / "requirements-test.txt").write_text("tiny_test==1.0\n")
        kept = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "PIP_"))}
        pip = {"PIP_NO_INDEX": "1", "PIP_FIND_LINKS": self.wheels.as_uri()}
        self.env = kept | pip | {"PATH": str(self.bin), "HOME": str(self.home), "SEEN": str(self.seen)}

    def pin(self, line: str) -> None:
        (self.project / "requirements.txt").write_text(line + "\n")

    def tool(self, name: str, text: str) -> None:
        """Put a program of ours on the PATH."""
        (self.bin / name).unlink(missing_ok=True)
        (self.bin / name).write_text(f"#!/bin/sh\n{text}\n")
        (self.bin / name).chmod(0o755)

    def lce(self, *argv: str, cwd: Path | None = None, **env: str) -> Ended:
        return start(self.project / "lce", *argv, env=self.env | env, cwd=cwd or self.home)

    def told(self) -> list[Any]:
        return [json.loads(line) for line in self.seen.read_text().splitlines()] if self.seen.exists() else []

    def version(self, name: str) -> str:
        """The version of a package in .venv, empty without it."""
        words = [self.project / ".venv/bin/python", "-c", f"import {name}; print({name}.version)"]
        return subprocess.run(words, capture_output=True, text=True, check=False).stdout.strip()


@pytest.fixture
def machine(project: Path, tmp_path: Path) -> Machine:
    """A machine where `./lce` was never started."""
    return Machine(project, tmp_path)


@pytest.fixture(scope="module")
def used(tmp_path_factory: pytest.TempPathFactory) -> tuple[Machine, list[Ended]]:
    """A machine where `./lce` was started for the first time, twice at once; and how the two ended."""
    folder = tmp_path_factory.mktemp("used")
    machine = Machine(make_project(folder), folder)
    with ThreadPoolExecutor() as both:
        ended = list(both.map(machine.lce, ["one", "two"]))
    return machine, ended


def one_sentence(ended: Ended, *words: str) -> None:
    """The start ended as an environment fault, told in one last line that has the words."""
    assert ended.code == 4, ended
    *progress, sentence = ended.err.splitlines()
    assert all(line.startswith("lce: Installing ") for line in progress), ended.err
    assert sentence.startswith("lce: ")
    for word in words:
        assert word in sentence


def bare(machine: Machine) -> None:
    """Let the machine have none of Debian's packages."""
    machine.tool("dpkg-query", "exit 1")


def user(machine: Machine, number: int) -> None:
    machine.tool("id", f"echo {number}")


def test_two_first_starts_at_once_install_once(used: tuple[Machine, list[Ended]]) -> None:
    machine, ended = used
    assert [end.code for end in ended] == [0, 0], ended
    said = "".join(end.err for end in ended)
    assert said.count("Installing the packages of") == 1
    assert said.count("Another start is installing") == 1
    assert machine.version("tiny") == "1.0"
    assert machine.version("tiny_test") == ""  # test packages are installed by `./lce test` only


def test_next_start_asks_nobody(used: tuple[Machine, list[Ended]]) -> None:
    machine, _ = used
    called = machine.home / "called"
    (pip,) = machine.project.glob(".venv/lib/python3*/site-packages/pip/__init__.py")
    text = pip.read_text()
    pip.write_text(f"open({str(called)!r}, 'a').write('pip')\nraise SystemExit(9)\n")
    for name in ("apt-get", "sudo", "dpkg"):
        machine.tool(name, f"echo {name} >>'{called}'; exit 9")
    ended = machine.lce("end", "0")
    pip.write_text(text)
    assert (ended.code, ended.err) == (0, "")
    assert not called.exists()


def test_hands_over_as_it_was_called(used: tuple[Machine, list[Ended]], tmp_path: Path) -> None:
    machine, _ = used
    (tmp_path / "my lce").symlink_to(machine.project / "lce")
    elsewhere = tmp_path / "else where"
    elsewhere.mkdir()
    (elsewhere / "json.py").write_text("raise SystemExit('a module of the user')\n")
    words = ["end", "3", "--set", "a b=c", ""]
    ended = start(tmp_path / "my lce", *words, env=machine.env | {"PYTHONPATH": str(elsewhere)}, cwd=elsewhere)
    assert ended.code == 3, ended.err
    told = machine.told()[-1]
    assert (told["argv"], told["cwd"]) == (words, str(elsewhere))
    assert str(elsewhere) not in str(told["path"])


def test_gui_opens_with_the_workbench_chosen(used: tuple[Machine, list[Ended]], tmp_path: Path) -> None:
    machine, _ = used
    macro = tmp_path / "my macro.FCMacro"
    macro.write_text(
        "import FreeCADGui, lce_workbench, os, sys\n"
        "from PySide import QtCore\n"
        "def told():\n"
        "    with open(os.environ['SEEN'], 'a') as seen:\n"
        '        print(\'["%s", "%s"]\' % (FreeCADGui.activeWorkbench().name(), lce_workbench.ROOT), file=seen)\n'
        "    sys.exit(7)\n"
        "QtCore.QTimer.singleShot(500, told)\n"
    )
    path = os.pathsep.join([str(machine.bin), os.environ["PATH"]])
    with display() as screen:
        env = environment(machine.home / "freecad", SEEN=str(machine.seen), DISPLAY=screen, PATH=path)
        ended = start(machine.project / "lce", "gui", macro, env=env, cwd=tmp_path)
    assert ended.code == 7, ended.err
    assert "Traceback" not in ended.out + ended.err
    assert machine.told()[-1] == ["LceWorkbench", str(machine.project)]
    assert not (machine.home / "freecad" / "Mod").exists()  # nothing of ours is left with the user


def test_gui_without_a_screen_is_one_sentence(project: Path, tmp_path: Path) -> None:
    env = environment(tmp_path / "home")
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"):
        env.pop(name, None)
    ended = start(project / "lce", "gui", env=env, cwd=tmp_path)
    assert ended.code == 4
    assert ended.err.startswith("lce: No screen: DISPLAY is not set")
    assert ended.err.count("\n") == 1


def test_new_pins_are_installed_in_place(used: tuple[Machine, list[Ended]]) -> None:
    machine, _ = used
    wheel(machine.wheels, "tiny", "2.0")
    machine.pin("tiny==2.0")
    kept = machine.project / ".venv" / "kept"
    kept.touch()
    assert machine.lce().code == 0
    assert machine.version("tiny") == "2.0"
    assert kept.exists()
    assert len(list(machine.project.glob(".venv/lib/python3*/site-packages/tiny-*"))) == 1


def test_killed_then_no_network_then_repaired(machine: Machine) -> None:
    stamp = machine.project / ".venv" / "run.stamp"
    with subprocess.Popen([machine.project / "lce"], env=machine.env, start_new_session=True) as process:
        while not stamp.exists():
            time.sleep(0.01)
        os.killpg(process.pid, signal.SIGKILL)
    nowhere = {"PIP_NO_INDEX": "0", "PIP_FIND_LINKS": "", "PIP_INDEX_URL": NOWHERE, "PIP_RETRIES": "1"}
    one_sentence(machine.lce(**nowhere), "No network", "PyPI", "pip-run.log")
    assert not machine.told()
    assert stamp.read_text() == "begun\n"
    # A kill while pip writes leaves a package that pip takes for installed, without its module.
    (site,) = machine.project.glob(".venv/lib/python3*/site-packages")
    (site / "tiny-1.0.dist-info").mkdir()
    (site / "tiny-1.0.dist-info" / "METADATA").write_text("Metadata-Version: 2.1\nName: tiny\nVersion: 1.0\n")
    assert machine.lce().code == 0
    assert machine.version("tiny") == "1.0"


def test_no_network_for_apt(machine: Machine, tmp_path: Path) -> None:
    bare(machine)
    user(machine, 0)
    # The real apt-get, whose state, sources and cache are a folder of ours.
    for folder in ("state/lists/partial", "cache/archives/partial", "etc/parts"):
        (tmp_path / "apt" / folder).mkdir(parents=True)
    (tmp_path / "apt/state/status").touch()
    (tmp_path / "apt/etc/sources.list").write_text("deb [trusted=yes] http://nowhere.invalid/debian stable main\n")
    config = tmp_path / "apt.conf"
    config.write_text(
        f'Dir::State "{tmp_path}/apt/state"; Dir::State::status "{tmp_path}/apt/state/status";'
        f'Dir::Cache "{tmp_path}/apt/cache"; Dir::Etc "{tmp_path}/apt/etc"; Dir::Etc::sourceparts "parts";'
        'Debug::NoLocking "1"; APT::Sandbox::User ""; Acquire::Retries "0";\n'
    )
    (machine.bin / "apt-get").symlink_to("/usr/bin/apt-get")
    one_sentence(machine.lce(APT_CONFIG=str(config)), "No network", "Debian's mirror", "apt.log")


def test_no_root(machine: Machine) -> None:
    bare(machine)
    user(machine, 1000)
    machine.tool("apt-get", "exit 9")
    one_sentence(machine.lce(), "No root", "freecad python3-venv", "sudo")


def test_refused_by_sudo(machine: Machine) -> None:
    bare(machine)
    user(machine, 1000)
    machine.tool("apt-get", "exit 9")
    machine.tool("sudo", "exit 1")
    one_sentence(machine.lce(), "No root")


def test_debian_packages_come_through_sudo_without_recommends(machine: Machine) -> None:
    bare(machine)
    user(machine, 1000)
    log = machine.home / "apt"
    machine.tool("sudo", 'exec "$@"')
    machine.tool("dpkg", "exit 0")
    full = "E: You don't have enough free space in /var/cache/apt/archives/."
    machine.tool("apt-get", f'echo "$@" >>"{log}"\ncase "$*" in *install*) echo "{full}"; exit 100 ;; esac')
    one_sentence(machine.lce(), "disk became full", "apt.log")
    update, install = log.read_text().splitlines()
    assert update.endswith("update")
    assert install.endswith("install -y --no-install-recommends freecad python3-venv")


def test_not_debian(machine: Machine) -> None:
    bare(machine)
    one_sentence(machine.lce(), "No apt-get", "Debian 12 or 13")


def test_no_space(machine: Machine) -> None:
    header = "Filesystem 1048576-blocks Used Available Capacity Mounted"
    machine.tool("df", f"echo '{header}'; echo '/dev/full 9000 8500 500 95% /'")
    one_sentence(machine.lce(), "Not enough space", "500 MB are free", str(machine.project))
    assert not (machine.project / ".venv").exists()


def test_folder_that_cannot_be_written(machine: Machine) -> None:
    (machine.project / ".venv").write_text("a file where the folder has to be")
    one_sentence(machine.lce(), "Cannot write", str(machine.project))


@pytest.mark.parametrize("version", ["(3, 10, 9)", "(3, 14, 0)"])
def test_unsupported_python(machine: Machine, version: str) -> None:
    python = machine.bin / "python3"
    machine.tool(
        "python3", f'exec /usr/bin/python3 -c "import sys; sys.version_info = {version}; exec(sys.argv[1])" "$2"'
    )
    text = (machine.project / "lce").read_text()
    (machine.project / "lce").write_text(text.replace("/usr/bin/python3", str(python)))
    one_sentence(machine.lce(), "Unsupported Python", "3.11 to 3.13", "Debian 12 or 13")
