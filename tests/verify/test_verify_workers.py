"""Processes that read: what they answer, that they die alone, and that an interruption ends them."""

import math
import os
import signal
import subprocess
import sys
import time
from multiprocessing import active_children
from pathlib import Path

import pytest

from lce_workbench import ROOT
from lce_workbench.verify import workers
from lce_workbench.verify.finding import Unreadable

SOON = 5.0
"""Generous for a busy machine; each of the tasks takes minutes [s]."""


class Stop(Exception):
    pass


def test_answers_faults_and_deaths_belong_to_their_tasks():
    tasks = {"root": (math.sqrt, (4.0,)), "dies": (os._exit, (3,)), "fails": (int, ("x",)), "after": (abs, (-1,))}
    told = []
    found = workers.run(tasks, told.append)
    assert sorted(told) == sorted(tasks)
    assert (workers.value(found["root"]), workers.value(found["after"])) == (2.0, 1)
    with pytest.raises(ValueError, match="invalid literal"):
        workers.value(found["fails"])
    with pytest.raises(Unreadable, match="its reader died"):
        workers.value(found["dies"])
    assert active_children() == []


def is_running(state):
    """Whether a process, by its file in /proc, is more than an ended one that nobody asked for."""
    try:
        return state.read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def test_a_program_that_a_worker_started_ends_with_it(tmp_path):
    marker = tmp_path / "pid"
    script = f"echo $$ > {marker}; exec sleep 300"

    def told(name):
        if name == "third":
            while not (marker.is_file() and marker.read_text().strip()):
                time.sleep(0.05)
            raise Stop

    tasks = {"first": (subprocess.run, (["sh", "-c", script],)), "second": (abs, (1,)), "third": (abs, (2,))}
    with pytest.raises(Stop):
        workers.run(tasks, told)
    state = Path(f"/proc/{marker.read_text().strip()}/stat")
    until = time.monotonic() + 5
    while is_running(state) and time.monotonic() < until:
        time.sleep(0.05)
    assert not is_running(state)


def test_an_interruption_ends_even_those_that_hear_nothing():
    """The factorial is one call of a library."""
    began = []

    def told(name):
        if name == "third":
            began.append(time.monotonic())
            raise Stop

    tasks = {"first": (math.factorial, (10**7,)), "second": (abs, (1,)), "third": (abs, (2,))}
    with pytest.raises(Stop):
        workers.run(tasks, told)
    assert time.monotonic() - began[0] < SOON
    assert active_children() == []


def test_ctrl_c_ends_verify_at_once(masked):
    """As a terminal sends it: to everything that runs."""
    command = [sys.executable, "-P", "-m", "lce_workbench", "verify", str(masked)]
    place = {**os.environ, "PYTHONPATH": f"{ROOT}:{ROOT / 'solver'}"}
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True, env=place) as running:
        lines = [next(line for line in running.stderr if "verify: mask/top" in line)]
        began = time.monotonic()
        os.killpg(running.pid, signal.SIGINT)
        lines += running.stderr.readlines()
        code = running.wait(60)
    assert time.monotonic() - began < SOON
    assert code == 130
    assert lines[1:] == ["lce: interrupted; nothing was changed\n"]
