"""Tests of exact footprints, of the pictures of parts, and of the markers of the page."""

import numpy as np
import pytest

import footprints
import limits_page
import parts
import peers
import truth
from source import Source
from views import View, pixels


def flat(colour, metalness, roughness=0.6):
    """Returns a material that is the same everywhere, and leans."""
    normal = np.broadcast_to(np.array([0.2, -0.1, 0.97]), (32, 32, 3))
    orm = np.broadcast_to(np.array([1.0, roughness, metalness]), (32, 32, 3))
    return Source(normal, orm, np.broadcast_to(np.array(colour), (32, 32, 3)))


def footprint_of(source, view, anisotropic, f0=None, samples=1024):
    """Returns the pixels of a view, and the means over their footprints."""
    view_pixels = pixels(view)
    f0 = np.full((3, view_pixels["mask"].sum()), 0.04) if f0 is None else f0
    maps = truth.Maps(source)
    return view_pixels, footprints.means(view_pixels, maps, view.suns, anisotropic, f0, samples)


def test_footprints_of_a_flat_material_have_the_light_of_one_lobe():
    view, source = View("plane 45", 2.5, 12), flat([0.8, 0.5, 0.3], 0.4)
    view_pixels, exact = footprint_of(source, view, True)
    surface = peers.plain(source).surface(view_pixels, source.size, True)
    specular, diffuse = parts.light(view_pixels, surface, view.suns)
    assert np.abs(exact.specular - specular)[0].sum() < 0.03 * specular[0].sum()
    # Eight bits of normals and roughness.
    assert np.abs(exact.specular - specular)[1:].sum() < 0.05 * specular[1:].sum()
    assert np.abs(exact.diffuse - diffuse).sum() < 0.02 * diffuse.sum()
    assert exact.f0 == pytest.approx(np.array(surface[2]).T, abs=0.005)
    white = parts.white(view_pixels, surface)
    assert np.abs(exact.white - white).sum() < 0.03 * white.sum()


@pytest.mark.parametrize("size", [(32, 32), (27, 20)])
@pytest.mark.parametrize("anisotropic", [False, True])
def test_footprints_have_the_weights_of_the_filter(size, anisotropic):
    """Means of an exact footprint are those of box mips under the same filter."""
    random = np.random.default_rng(1)
    source = flat([1.0, 1.0, 1.0], 0.0)
    source.colour = np.repeat(np.repeat(random.uniform(0.0, 1.0, (size[1] // 4 + 1, size[0] // 4 + 1, 3)), 4, 0), 4, 1)
    source.colour = source.colour[: size[1], : size[0]]
    source.normal, source.orm = (np.broadcast_to(a[:1, :1], (size[1], size[0], 3)) for a in (source.normal, source.orm))
    for shape in ("plane 20", "sphere"):
        view_pixels, exact = footprint_of(source, View(shape, 2.5, 16), anisotropic, samples=4096)
        surface = peers.plain(source).surface(view_pixels, source.size, anisotropic)
        filtered = np.array(surface[3]).T
        # Levels are means of texels, and the truth interpolates between texels: that is a third of a texel at most.
        assert np.abs(exact.albedo - filtered).mean() < 0.1 * filtered.std()


def test_one_f0_changes_only_the_reflectance():
    view, source = View("plane 75", 1.5, 8), flat([0.9, 0.9, 0.9], 1.0)
    count = pixels(view)["mask"].sum()
    _, exact = footprint_of(source, view, False, np.full((3, count), 0.9))
    assert exact.specular_of_one_f0 == pytest.approx(exact.specular, rel=1e-4)
    _, dark = footprint_of(source, view, False, np.full((3, count), 0.45))
    assert 0.45 < dark.specular_of_one_f0.sum() / dark.specular.sum() < 0.6


def test_metalness_by_colour_keeps_the_mean_of_both_colours():
    colour = np.array([[[0.8] * 3, [0.2] * 3], [[0.8] * 3, [0.2] * 3]])
    orm = np.array([[[1, 1, 1], [1, 1, 0]], [[1, 1, 1], [1, 1, 0]]], float)
    level = parts.metalness_by_colour(Source(np.zeros((2, 2, 3)), orm, colour)).levels[-1]
    # The mean colour 0.5 is split into 0.4 of metal and 0.1 of dielectric, and not into halves.
    assert float(level[0, 0, 0]) * 0.5 == pytest.approx(0.4, abs=0.002)


def test_errors_are_small_where_filters_have_nothing_to_lose():
    """A flat material: every part is as exact as 8 bits and sampling allow."""
    view, source = View("plane 45", 2.5, 12), flat([0.8, 0.5, 0.3], 0.4)
    plain = peers.plain(source)
    view_pixels = pixels(view)
    right = truth.render(view, truth.Maps(source), 1024, 1, 8)[:, view_pixels["mask"]]
    material = parts.Material(source, truth.Maps(source), plain, plain, plain)
    for row, error in parts.errors(material, view, view_pixels, True, right, 1024).items():
        if row != "light of exact lobes":
            assert error["suns"] < 0.04 and error["environment"] < 0.04, row


def test_lengths_of_opposite_slopes_darken_diffuse_light():
    normal = np.tile(np.array([[[0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]]]), (16, 8, 1))
    orm = np.broadcast_to(np.array([1.0, 0.6, 0.0]), (1, 1, 3))
    source = Source(normal, orm, np.ones((1, 1, 3)))
    plain = peers.plain(source)
    material = parts.Material(source, None, plain, plain, plain)
    assert float(material.length.levels[-1][0, 0, 0]) == pytest.approx(0.8, abs=0.003)


def test_ratios_of_black_are_one():
    assert parts.ratio(np.array([0.0, 1.0]), np.array([0.0, 2.0])).tolist() == [1.0, 0.5]


def test_blocks_replace_what_is_between_markers():
    page = "a\n<!-- x: begin -->\nold\n<!-- x: end -->\nb\n"
    assert limits_page.replaced(page, "x", "new") == "a\n<!-- x: begin -->\n\nnew\n\n<!-- x: end -->\nb\n"
    with pytest.raises(ValueError, match="once each"):
        limits_page.replaced(page, "y", "new")
