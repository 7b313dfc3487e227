"""The score of one material: pictures of all variants against the truth, and the measures of their differences."""

import shutil
from dataclasses import dataclass

import numpy as np

import baked
import measures
import peers
import shading
import source
import truth
from views import LEVELS, SHAPES, View, pixels

FILTERS = {"trilinear": False, "anisotropic": True}
SUNS = 8
# Views of the slow camera, and by how many pixels the surface moves from frame to frame.
MOVING = (("plane 20", 2.5), ("sphere", 2.5))
STEP = (0.31, 0.17)


@dataclass(frozen=True)
class Settings:
    """Size of the pictures, samples for each pixel of the truth, and levels of distances."""

    pixels: int = 64
    samples: int = 1024
    levels: tuple = LEVELS
    frames: int = 6

    def views(self):
        """Returns all still views."""
        return [View(shape, level, self.pixels) for shape in SHAPES for level in self.levels]

    def moving(self):
        """Returns (view, shifts in texels) of the slow camera."""
        for shape, level in MOVING:
            step = tuple(s * 2.0**level for s in STEP)
            yield View(shape, level, self.pixels), [tuple(s * i for s in step) for i in range(self.frames)]


def truths(material_source, settings):
    """Returns arrays by name: pictures of all views, their noise, and the frames of the slow camera.

    Both halves of the samples are drawn apart. Half of the mean difference between them is the expected error of the
    picture, which is the mean of both.
    """
    maps = truth.Maps(material_source)
    result = {}
    half = settings.samples // 2
    for number, view in enumerate(settings.views()):
        one, other = (truth.render(view, maps, half, 2 * number + i, SUNS) for i in (1, 2))
        result[view.name] = ((one + other) / 2.0).astype(np.float32)
        mask = pixels(view)["mask"]
        error, light = np.abs(one - other)[:, mask] / 2.0, result[view.name][:, mask]
        result[f"noise, {view.name}"] = np.array([error[0].sum() / light[0].sum(), error[1:].sum() / light[1:].sum()])
    for view, shifts in settings.moving():
        frames = [lit(truth.render(view, maps, settings.samples, 7, 1, shift)) for shift in shifts]
        result[f"frames, {view.name}"] = np.array(frames, np.float32)
    return result


def lit(pictures):
    """Returns the picture under the environment and the first sun together."""
    return pictures[0] + 0.3 * pictures[1]


def variants(material, material_source, roughcast, folder):
    """Returns all variants of a material: peers, and fresh bakes in `folder`."""
    shutil.rmtree(folder, ignore_errors=True)
    built = [build(material_source) for build in peers.PEERS]
    for number, name in enumerate(baked.BAKES):
        built.append(baked.bake(roughcast, material.path, folder / str(number), name))
    return built


def still(variant, size, settings, reference):
    """Returns measures by filter and view: L1 under the environment, L1 under suns, weighed by light, and FLIP."""
    scores = {name: {} for name in FILTERS}
    for view in settings.views():
        view_pixels = pixels(view)
        mask = view_pixels["mask"]
        right = reference[view.name][:, mask]
        exposure = measures.exposure_of(lit(right))
        for name, anisotropic in FILTERS.items():
            picture = shading.render(view_pixels, variant.surface(view_pixels, size, anisotropic), view.suns)
            shown = [measures.displayed(lit(p), exposure) for p in (picture, right)]
            scores[name][view.name] = {
                "environment": measures.relative_l1(picture[0], right[0]),
                "suns": measures.relative_l1(picture[1:], right[1:]),
                "flip": measures.flip(*shown, mask),
            }
    return scores


def moving(variant, size, settings, reference):
    """Returns the flicker of each moving view, with anisotropic filters."""
    scores = {}
    for view, shifts in settings.moving():
        view_pixels = pixels(view)
        right = reference[f"frames, {view.name}"][:, view_pixels["mask"]]
        exposure = measures.exposure_of(right)
        frames = []
        for shift in shifts:
            surface = variant.surface(view_pixels, size, True, shift)
            frames.append(measures.displayed(lit(shading.render(view_pixels, surface, view.suns[:1])), exposure))
        scores[view.name] = measures.flicker(np.array(frames), measures.displayed(right, exposure))
    return scores


def picture(variant, size, view, reference):
    """Returns a displayed picture of a variant, or of the truth if `variant` is None, with the truth's exposure."""
    view_pixels = pixels(view)
    mask = view_pixels["mask"]
    right = lit(reference[view.name])
    exposure = measures.exposure_of(right[mask])
    image = np.zeros((*mask.shape, 3), np.float32)
    if variant is None:
        values = right[mask]
    else:
        surface = variant.surface(view_pixels, size, True)
        values = lit(shading.render(view_pixels, surface, view.suns[:1]))
    image[mask] = measures.displayed(values, exposure)
    return image
