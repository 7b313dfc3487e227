"""Tests of mip levels and of texture filters."""

import numpy as np
import pytest

import encoding
from filtering import Texture, chain, halved


def column(*values):
    """Returns a texture of one row."""
    return np.array(values, float).reshape(1, -1, 1)


def test_even_sides_are_averaged_in_pairs():
    assert halved(column(0, 2, 4, 8)).ravel() == pytest.approx([1, 6])


def test_odd_sides_have_three_taps_weighted_by_area():
    # The second of two texels covers 2.5 to 5 of five texels.
    assert halved(column(0, 0, 1, 0, 0)).ravel() == pytest.approx([0.2, 0.2])
    assert halved(column(5, 0, 0, 0, 0)).ravel() == pytest.approx([2.0, 0.0])


@pytest.mark.parametrize("shape", [(1, 1), (5, 3), (8, 8), (13, 6)])
def test_levels_keep_the_mean_and_end_at_one_texel(shape):
    array = np.random.default_rng(0).random((*shape, 2))
    levels = chain(array)
    assert levels[-1].shape[:2] == (1, 1)
    for level in levels:
        assert level.mean(axis=(0, 1)) == pytest.approx(array.mean(axis=(0, 1)))


def sample(texture, u, across, down, anisotropic=False):
    """Returns the texture's first channel at one point of its first row."""
    one = lambda value: np.array([value])
    return texture.sample(
        (one(u), one(0.5)), tuple(map(one, across)), tuple(map(one, down)), anisotropic
    )[0, 0]


def test_texel_centres_return_texels_and_borders_wrap():
    texture = Texture([column(1, 2, 3, 4)])
    assert sample(texture, 0.375, (0.01, 0), (0, 0.01)) == pytest.approx(2.0)
    assert sample(texture, 0.0, (0.01, 0), (0, 0.01)) == pytest.approx(2.5)


def test_footprints_between_levels_mix_both():
    levels = [np.full((8 >> i, 8 >> i, 1), float(i)) for i in range(4)]
    texture = Texture(levels)
    for level in (0.0, 0.5, 1.25, 2.9):
        width = 2.0**level / 8.0
        assert sample(texture, 0.3, (width, 0), (0, width)) == pytest.approx(level, abs=1e-5)


def test_anisotropic_filters_take_the_level_of_the_shorter_side():
    levels = [np.full((16 >> i, 16 >> i, 1), float(i)) for i in range(5)]
    texture = Texture(levels)
    assert sample(texture, 0.3, (4 / 16, 0), (0, 1 / 16)) == pytest.approx(2.0, abs=1e-5)
    assert sample(texture, 0.3, (4 / 16, 0), (0, 1 / 16), True) == pytest.approx(0.0, abs=1e-5)


def test_anisotropic_samples_average_along_the_longer_side():
    texture = Texture([np.tile(column(0, 1), (4, 2, 1))])
    assert sample(texture, 0.5, (2 / 4, 0), (0, 1 / 4), True) == pytest.approx(0.5)


def test_srgb_goes_both_ways():
    values = np.linspace(0, 1, 17)
    assert encoding.to_linear(encoding.to_srgb(values)) == pytest.approx(values, abs=1e-6)


def test_normals_are_renormalised_before_they_are_rounded():
    stored = encoding.normals_in_8_bits(np.array([[[0.0, 0.0, 0.5]]]))
    assert stored[0, 0] == pytest.approx([0.0, 0.0, 1.0], abs=0.005)
