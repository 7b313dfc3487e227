"""Tests of the shading formula."""

import math

import numpy as np
import pytest

import formula
import shading


def hemisphere(count=1200):
    """Returns directions (three arrays) on a grid of the hemisphere, and their solid angles."""
    z = (np.arange(count) + 0.5) / count
    phi = (np.arange(2 * count) + 0.5) / count * math.pi
    z, phi = np.meshgrid(z, phi)
    across = np.sqrt(1.0 - z * z)
    return (across * np.cos(phi), across * np.sin(phi), z), 2.0 * math.pi / z.size


UPRIGHT = ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


@pytest.mark.parametrize("alphas", [(0.1, 0.1), (0.5, 0.5), (0.6, 0.15), (1.0, 1.0)])
def test_density_of_projected_half_vectors_integrates_to_one(alphas):
    h, solid_angle = hemisphere()
    total = np.sum(formula.density(UPRIGHT, alphas, h) * h[2]) * solid_angle
    assert total == pytest.approx(1.0, abs=0.01)


def test_density_at_the_normal_is_that_of_the_paper():
    assert formula.density(UPRIGHT, (0.2, 0.5), (0.0, 0.0, 1.0)) == pytest.approx(1.0 / (math.pi * 0.1))


@pytest.mark.parametrize("correlated", [True, False])
def test_visibility_of_a_smooth_surface_has_no_masking(correlated):
    v, l = (0.6, 0.0, 0.8), (-0.8, 0.0, 0.6)
    value = formula.visibility(np, UPRIGHT, (1e-6, 1e-6), v, l, 0.8, 0.6, correlated)
    assert value == pytest.approx(1.0 / (4.0 * 0.8 * 0.6), rel=1e-5)


def test_fresnel_rises_to_one_at_grazing_angles():
    assert formula.fresnel((0.04, 0.5), 1.0) == pytest.approx((0.04, 0.5))
    assert formula.fresnel((0.04, 0.5), 0.0) == pytest.approx((1.0, 1.0))


def test_sampled_half_vectors_integrate_the_formula():
    """A white environment, by sampling and by a grid of directions."""
    alphas, eye = (0.45, 0.3), (0.5, 0.3, math.sqrt(1.0 - 0.34))
    surface = (UPRIGHT, alphas, (0.7,), (0.0,))
    sampled = 0.0
    for points, weight in shading.half_vector_points(4096):
        _, share, (fresnel,) = formula.reflected(np, surface, eye, points)
        sampled += share * fresnel * weight
    l, solid_angle = hemisphere()
    # A sun has irradiance pi across its direction.
    (radiance,) = formula.under_sun(np, surface, eye, l)
    assert sampled == pytest.approx(np.sum(radiance) * solid_angle / math.pi, rel=0.01)


def test_compensation_gives_white_metal_all_light_back():
    (factor,) = formula.compensation(np, (1.0,), 0.8)
    assert factor * 0.8 == pytest.approx(1.0)


@pytest.mark.parametrize("alphas", [(0.05, 0.05), (0.3, 0.3), (0.6, 0.2), (0.5, 0.1), (0.8, 0.8)])
def test_half_vectors_are_enough(alphas):
    random = np.random.default_rng(0)
    z, phi = random.uniform(0.15, 1.0, 200), random.uniform(0.0, 2.0 * math.pi, 200)
    eye = (np.sqrt(1.0 - z * z) * np.cos(phi), np.sqrt(1.0 - z * z) * np.sin(phi), z)
    surface = (UPRIGHT, alphas, (1.0, 1.0, 1.0), (0.0, 0.0, 0.0))
    few, many = (np.array(shading.environment(surface, eye, n)) for n in (shading.HALF_VECTORS, 4096))
    assert np.abs(few - many).sum() / many.sum() < 0.025


def test_normals_that_face_away_are_turned_to_the_eye():
    axes, eye = formula.frame(np, (0.9, 0.0, 0.4), (0.0, 1.0, 0.0)), (-0.8, 0.0, 0.6)
    turned = formula.turned_to(np, axes, eye)
    assert formula.dot(turned[0], eye) == pytest.approx(formula.MIN_COSINE, rel=0.2)
    assert formula.turned_to(np, axes, (0.6, 0.0, 0.8))[0] == pytest.approx(axes[0])


def test_frames_are_orthonormal():
    axes = formula.frame(np, (0.3, -0.2, 0.9), (1.0, 0.1, 0.0))
    for i, a in enumerate(axes):
        for j, b in enumerate(axes):
            assert formula.dot(a, b) == pytest.approx(float(i == j), abs=1e-12)
