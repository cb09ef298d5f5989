"""Job files: what is wrong is said in one sentence; what is right comes back the same."""

from dataclasses import fields

import pytest
from faults import BAD_JOBS, FACE

from lce_solver.errors import InputError
from lce_workbench.core import jobfile
from lce_workbench.core.job import Job


@pytest.mark.parametrize("case", BAD_JOBS)
def test_a_bad_job_is_one_sentence_that_names_the_key(case):
    text, words = BAD_JOBS[case]
    with pytest.raises(InputError) as fault:
        jobfile.parse(text, "job.toml")
    assert words in str(fault.value)
    assert "\n" not in str(fault.value).removesuffix("\n")


def test_lambda_one_has_no_director():
    from lce_solver.types import Material

    with pytest.raises(InputError, match="no director"):
        Material(1.0, 0.5)
    with pytest.raises(InputError, match="no director"):
        Material(1.3, -1.0)


def test_missing_and_unreadable_files_are_told(tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        jobfile.load(tmp_path / "none.toml")
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="not UTF-8 text"):
        jobfile.load(tmp_path / "bytes.toml")
    with pytest.raises(InputError, match="cannot be read"):
        jobfile.load(tmp_path)


def test_a_byte_order_mark_does_not_matter(tmp_path):
    (tmp_path / "job.toml").write_bytes(b"\xef\xbb\xbf" + FACE.encode())
    assert jobfile.load(tmp_path / "job.toml") == jobfile.parse(FACE)


@pytest.mark.parametrize("text", ["", FACE + "[material]\nlambda = 0.6\n", FACE + "[domains]\nsize_um = 3\n"])
def test_a_contradiction_names_the_job_file(text):
    with pytest.raises(InputError, match=r"^my/job\.toml: "):
        jobfile.parse(text, "my/job.toml")


def test_a_dumped_job_reads_back_the_same():
    job = jobfile.parse(
        FACE + '[sheet]\nwidth_mm = 12.345678901234567\n[output]\nstep_domains = [3, 1]\nmasks = ["gds"]\n'
    )
    assert jobfile.parse(jobfile.dump(job)) == job
    assert jobfile.parse(jobfile.dump(job, comments=True)) == job


def test_texts_survive_the_dump():
    job = jobfile.parse('[target]\nmesh = "a \\"b\\" \\\\ \\t ü.stl"\n')
    assert jobfile.parse(jobfile.dump(job)).target.mesh == 'a "b" \\ \t ü.stl'


def test_settings_win_over_the_file():
    job = jobfile.parse(FACE, settings=["sheet.gap_um=150", "target.surface=dome", 'output.masks=["gds"]'])
    assert (job.sheet.gap_um, job.target.surface, job.output.masks) == (150.0, "dome", ("gds",))


@pytest.mark.parametrize("setting", ["gap_um=3", "sheet.gap_um", "=3", "sheet.=3"])
def test_a_malformed_setting_is_told(setting):
    with pytest.raises(InputError, match="not of the form"):
        jobfile.parse(FACE, settings=[setting])


def test_every_parameter_is_declared_with_help_and_its_default_is_within_its_limits():
    for part in fields(Job):
        section = getattr(Job(), part.name)
        for f in fields(section):
            assert f.metadata["doc"]
            value = getattr(section, f.name)
            if value not in (None, "", ()):
                plain = list(value) if isinstance(value, tuple) else value
                parsed = jobfile.from_table({part.name: {jobfile.toml_name(f): plain}})
                assert getattr(getattr(parsed, part.name), f.name) == value
