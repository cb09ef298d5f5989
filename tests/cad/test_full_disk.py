import json
import subprocess
import sys

FULL = """
import json, pathlib, sys
from cad.cad_sample import cell, domains, hatched, job
from lce_solver.errors import EnvironmentFault
from lce_workbench.cad import step
from lce_workbench.outputs import staged, write_manifest
step.FILES.clear()
out = pathlib.Path(sys.argv[1]) / "out"
with staged(out) as folder:
    (folder / "channels_bottom.step").write_text("former")
    write_manifest(folder, {})
try:
    with staged(out) as folder:
        (folder / "channels_bottom.step").unlink(missing_ok=True)
        step.write_cad(None, {plate: [part] for plate, part in hatched(domains(), job()).items()}, job(), folder)
except EnvironmentFault as fault:
    names = [p.name for p in out.parent.iterdir()]
    print(json.dumps([str(fault), fault.exit_code, (out / "channels_bottom.step").read_text(), names]))
"""


def test_a_disk_that_fills_in_the_middle_of_the_channels_leaves_the_former_files(tmp_path):
    """A real small file system, in which the channels of the first plate do not find room."""
    script = f'mount -t tmpfs -o size=300k none "{tmp_path}" && exec "$0" -c "$1" "{tmp_path}"'
    done = subprocess.run(
        ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", script, sys.executable, FULL],
        capture_output=True,
        text=True,
        check=True,
        env={"PYTHONPATH": ":".join(sys.path)},
    )
    sentence, code, kept, names = json.loads(done.stdout)
    assert "channels_bottom.step could not be written; see that the disk has room" in sentence
    assert (code, kept, names) == (4, "former", ["out"])
