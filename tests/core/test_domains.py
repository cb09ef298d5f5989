import numpy as np
from sheets import design, single

from lce_workbench.core.domains import partition, signed_area


def test_the_domains_cover_the_sheet_once():
    domains = partition(design(width=2.0, height=2.2))
    assert np.isclose(domains.area.sum(), 2.0 * 2.2, rtol=1e-12)
    assert (domains.area > 0).all()
    assert np.allclose(domains.area @ domains.centroid / domains.area.sum(), 0, atol=1e-12)


def test_channels_turn_by_half_the_twist_to_each_side():
    domains = single([[0, 0], [1, 0], [0, 1]], theta=0.5, dtheta=0.2)
    assert np.isclose(domains.angle("top"), 0.6)
    assert np.isclose(domains.angle("bottom"), 0.4)
    assert np.isclose(domains.written("bottom"), 0.4)
    assert np.isclose(domains.written("top"), np.pi - 0.6)


def test_directions_stay_lines():
    for theta, dtheta in ((0.0, 0.2), (3.1, 0.3), (0.0, 0.0), (1e-17, 4e-17)):
        domains = single([[0, 0], [1, 0], [0, 1]], theta, dtheta)
        for angles in (domains.angle("top"), domains.angle("bottom"), domains.written("top")):
            assert (angles >= 0).all()
            assert (angles < np.pi).all()


def test_an_area_far_from_the_origin_keeps_its_digits():
    triangle = np.array([[[0, 0], [0.3, 0], [0, 0.4]]])
    assert np.isclose(signed_area(triangle + 1e4), 0.06, rtol=1e-9)
    assert np.isclose(signed_area(triangle[:, ::-1]), -0.06, rtol=1e-12)
