from functools import cache

import pytest
from cad.cad_sample import cell
from cad.readers import products

from lce_workbench.cad.step import write_cad


@pytest.fixture(scope="session")
def sample():
    return cell()


@pytest.fixture(scope="session")
def written(sample, tmp_path_factory):
    """The sample's files, written in this process."""
    folder = tmp_path_factory.mktemp("cad")
    write_cad(sample, folder)
    return folder


@pytest.fixture(scope="session")
def read(written):
    """File name -> its products, read once."""
    return cache(lambda name: products(written / name))
