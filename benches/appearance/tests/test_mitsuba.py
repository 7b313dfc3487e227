"""Tests of both renderers against Mitsuba's own plugins: shapes, camera, normal maps, materials and lights."""

import numpy as np
import pytest

import formula
import score
import shading
import truth
from source import Source
from truth import mi
from views import DISTANCE, FIELD, Camera, View, pixels
from peers import plain

PIXELS = 32
REPEATS = 20


def bumps(size=64):
    """Returns smooth bumps of a white metal with alpha 0.3, whose maps are larger than the pictures' pixels."""
    y, x = np.mgrid[0:size, 0:size] / size * 2.0 * np.pi
    normal = np.dstack([0.15 * np.sin(x), 0.1 * np.sin(y + 1.0), np.ones((size, size))])
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    orm = np.broadcast_to(np.array([1.0, np.sqrt(0.3), 1.0]), (1, 1, 3))
    return Source(normal, orm, np.ones((1, 1, 3)))


def scene(view, source, sun):
    """Returns a scene of Mitsuba's own plugins, with one sun."""
    # The rectangle shows the maps REPEATS times from side to side, so that a corner of a map is at its centre.
    density = Camera(view).density
    half = REPEATS / 2.0 * source.size[0] / density
    bitmap = mi.Bitmap(np.ascontiguousarray(source.normal * 0.5 + 0.5, np.float32))
    place = mi.ScalarTransform3f().scale([REPEATS, -REPEATS])
    metal = {"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha": 0.3}
    normals = {"type": "bitmap", "bitmap": bitmap, "raw": True, "filter_type": "bilinear", "to_uv": place}
    look = mi.ScalarTransform4f().look_at(list(DISTANCE * view.eye), [0, 0, 0], [0, 0, 1])
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "direct", "hide_emitters": True},
        "shape": {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f().scale(half),
            "bsdf": {"type": "normalmap", "normalmap": normals, "bsdf": metal},
        },
        "sun": {"type": "directional", "direction": [-c for c in sun], "irradiance": {"type": "rgb", "value": np.pi}},
        "sensor": {
            "type": "perspective",
            "fov": float(np.degrees(FIELD)),
            "to_world": look,
            "film": {"type": "hdrfilm", "width": view.pixels, "height": view.pixels, "rfilter": {"type": "box"}},
        },
    })  # fmt: skip


@pytest.fixture
def separable(monkeypatch):
    """Shades with the masking of Mitsuba's `roughconductor`."""
    correlated = formula.visibility
    monkeypatch.setattr(formula, "visibility", lambda *args: correlated(*args[:7], False))


@pytest.mark.parametrize("shape", ["plane 75", "plane 45"])
def test_the_truth_is_mitsubas_picture_within_noise(separable, shape):
    view, source = View(shape, 1.0, PIXELS), bumps()
    ours = truth.render(view, truth.Maps(source), 256, 1, 4)[1:]
    for picture, sun in zip(ours, view.suns[:4]):
        right = np.array(mi.render(scene(view, source, sun), spp=256))
        assert np.abs(picture - right).sum() / right.sum() < 0.01


def test_textures_filtered_at_level_0_show_the_truth(separable):
    """Where pixels are smaller than texels, filters have nothing to lose."""
    for shape in ("plane 75", "plane 20", "sphere"):
        view, source = View(shape, -2.0, PIXELS), bumps()
        view_pixels = pixels(view)
        right = truth.render(view, truth.Maps(source), 1024, 1, 4)[:, view_pixels["mask"]]
        variant = plain(source)
        ours = shading.render(view_pixels, variant.surface(view_pixels, source.size, True), view.suns[:4])
        # Eight bits of normals and roughness, and pixels of finite size at the limb of the sphere.
        assert np.abs(ours - right)[1:].sum() / right[1:].sum() < 0.02
        assert np.abs(ours - right)[0].sum() / right[0].sum() < 0.04


def test_the_noise_of_truths_falls_with_samples():
    settings = score.Settings(pixels=16, samples=128, levels=(2.5,), frames=2)
    few = score.truths(bumps(), settings)
    many = score.truths(bumps(), score.Settings(pixels=16, samples=2048, levels=(2.5,), frames=2))
    name = "noise, plane 45, level 2.5"
    assert (many[name] < 0.5 * few[name]).all()
