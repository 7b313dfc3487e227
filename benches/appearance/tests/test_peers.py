"""Tests of the peers' formulas against values by hand."""

import math

import numpy as np
import pytest

import peers
from source import Source
from variants import ellipse


def test_toksvig_scales_the_blinn_phong_exponent():
    # alpha 0.5: s = 2 / 0.25 - 2 = 6; |N| = 0.9: s' = 6 * 0.9 / (0.9 + 0.6) = 3.6; alpha'^2 = 2 / 5.6.
    assert peers.toksvig_roughness(math.sqrt(0.5), 0.9) == pytest.approx((2.0 / 5.6) ** 0.25)


def test_filament_adds_the_spread_to_roughness():
    # |N| = 0.9: 1 / kappa = 0.19 / (0.9 * 2.19) = 0.0963978.
    assert peers.vmf_spread(0.9) == pytest.approx(0.0963978, rel=1e-5)
    assert peers.filament_roughness(0.3, 0.9) == pytest.approx(math.sqrt(0.09 + 2.0 * 0.0963978), rel=1e-5)


def test_godot_clamps_the_spread():
    assert peers.godot_roughness(0.3, 0.9) == pytest.approx(math.sqrt(0.09 + 0.75 * 0.0963978), rel=1e-5)
    assert peers.godot_roughness(0.3, 0.2) == pytest.approx(math.sqrt(0.09 + 0.16))


@pytest.mark.parametrize("formula", [peers.toksvig_roughness, peers.filament_roughness, peers.godot_roughness])
def test_unit_length_leaves_roughness(formula):
    assert formula(0.4, 1.0) == pytest.approx(0.4)


def test_lengths_are_means_of_ggx_half_vectors():
    cosine = (np.arange(200000) + 0.5) / 200000
    for alpha in (0.1, 0.5, 0.9):
        density = alpha**2 / (math.pi * (1.0 + (alpha**2 - 1.0) * cosine**2) ** 2)
        mean = np.mean(2.0 * math.pi * density * cosine**2)
        assert peers.length_of_alpha(alpha) == pytest.approx(mean, rel=1e-3)
        assert peers.alpha_of_length(peers.length_of_alpha(alpha)) == pytest.approx(alpha, rel=1e-3)


def test_lengths_of_mirrors_are_finite_in_single_precision():
    assert peers.length_of_alpha(np.float32(0.0)) == pytest.approx(1.0, abs=1e-4)


def waves(u, v):
    """Returns a source whose slopes are -u, u in turns along rows and -v, v along columns."""
    y, x = np.mgrid[0:4, 0:4]
    normal = np.dstack([np.where(x % 2, u, -u), np.where(y % 2, v, -v), np.ones((4, 4))])
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    orm = np.broadcast_to(np.array([1.0, math.sqrt(0.1), 1.0]), (4, 4, 3))
    return Source(normal, orm, np.ones((1, 1, 3)))


def coarse(variant):
    """Returns the lobes of the last level of a variant."""
    return variant.decode({name: t.levels[-1].reshape(1, -1) for name, t in variant.textures.items()})


def test_lean_adds_twice_the_covariance():
    lobes = coarse(peers.lean(waves(0.4, 0.2)))
    base = (round(math.sqrt(0.1) * 255) / 255) ** 4
    expected = [math.sqrt(base + 2.0 * 0.16), math.sqrt(base + 2.0 * 0.04)]
    assert [float(a[0]) for a in lobes.alphas] == pytest.approx(expected, rel=2e-3)
    assert abs(float(lobes.axis[0][0])) == pytest.approx(1.0, abs=1e-3)


def test_plain_mips_keep_roughness_and_lose_bumps():
    lobes = coarse(peers.plain(waves(0.4, 0.2)))
    assert float(lobes.alphas[0][0]) == pytest.approx(0.1, abs=2e-3)
    assert [float(c[0]) for c in lobes.normal] == pytest.approx([0.0, 0.0, 1.0], abs=0.01)


def test_ellipses_have_eigenvalues_and_the_longer_axis():
    # Eigenvalues 0.4 along (1, 1) and 0.2 across.
    alphas, axis = ellipse(np.array([0.3]), np.array([0.1]), np.array([0.3]))
    assert [float(a[0]) for a in alphas] == pytest.approx([math.sqrt(0.4), math.sqrt(0.2)])
    assert [float(c[0]) for c in axis] == pytest.approx([math.sqrt(0.5)] * 2)
