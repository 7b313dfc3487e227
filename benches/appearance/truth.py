"""The truth: level 0, magnified bilinearly, supersampled with Mitsuba 3 (W. Jakob et al., 2022) on its LLVM backend.

Mitsuba intersects the shapes and samples the maps. Every sample evaluates `formula` under all suns, and one reflected
ray of the environment. `tests/test_mitsuba.py` compares these pictures with those of Mitsuba's own materials.
"""

import math

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

import formula  # noqa: E402
import lights  # noqa: E402
from formula import add  # noqa: E402
from shading import albedo_table  # noqa: E402
from views import Camera  # noqa: E402


class Maps:
    """The maps of a material as Mitsuba's textures, which repeat."""

    def __init__(self, source):
        texture = lambda array: mi.Texture2f(mi.TensorXf(np.ascontiguousarray(array, np.float32)))
        self.size = source.size
        self.normal, self.orm, self.colour = (texture(a) for a in (source.normal, source.orm, source.colour))
        table = np.ascontiguousarray(albedo_table()[..., None], np.float32)
        self.albedo = mi.Texture2f(mi.TensorXf(table), wrap_mode=dr.WrapMode.Clamp)

    def surface(self, texel, normal, tangent):
        """Returns what `formula` shades at texel coordinates of level 0."""
        u, v = (t / s for t, s in zip(texel, self.size))
        uv = mi.Point2f(u - dr.floor(u), v - dr.floor(v))
        x, y, z = self.normal.eval(uv)
        _, roughness, metalness = self.orm.eval(uv)
        bitangent = formula.cross(normal, tangent)
        bumped = tuple(x * t + y * b + z * n for t, b, n in zip(tangent, bitangent, normal))
        axes = formula.frame(dr, bumped, tangent)
        alpha = formula.square(dr.clip(roughness, formula.MIN_ROUGHNESS, 1.0))
        return (axes, (alpha, alpha), *formula.reflectances(tuple(self.colour.eval(uv)), metalness))

    def compensation(self, surface, eye):
        """Returns the factor that gives back what a rough lobe loses under an environment."""
        axes, alphas, f0, _ = surface
        (albedo,) = self.albedo.eval(mi.Point2f(formula.facing(dr, axes, eye), alphas[0]))
        return formula.compensation(dr, f0, albedo)


def scene(view):
    """Returns a scene with the shape of a view."""
    if view.is_sphere:
        return mi.load_dict({"type": "scene", "shape": {"type": "sphere"}})
    size = mi.ScalarTransform4f().scale(1000.0)
    return mi.load_dict({"type": "scene", "shape": {"type": "rectangle", "to_world": size}})


def opaque(value):
    """Returns a number that kernels read as data, so that one compiled kernel serves all views of a shape."""
    return dr.opaque(mi.Float, float(value))


def render(view, maps, samples, seed, sun_count, shift=(0.0, 0.0)):
    """Returns pictures (lights, rows, columns, 3): the environment, then one for each of the first suns.

    `samples` is a square number; each sample is drawn at random in a cell of its pixel.
    """
    side = math.isqrt(samples)
    count = view.pixels**2
    index = dr.arange(mi.UInt32, count)
    column, row = mi.Float(index % view.pixels), mi.Float(index // view.pixels)
    random = mi.PCG32(size=count, initstate=seed)
    camera = Camera(view, opaque)
    suns = [tuple(opaque(c) for c in sun) for sun in view.suns[:sun_count]]
    shift = tuple(opaque(s) for s in shift)
    shapes = scene(view)

    def sample(i, random, sums):
        x = column + (mi.Float(i % side) + random.next_float32()) / side
        y = row + (mi.Float(i // side) + random.next_float32()) / side
        slope = dr.minimum(random.next_float32(), 1.0 - 1e-6)
        angle = 2.0 * math.pi * random.next_float32()
        parts = shade(camera, shapes, maps, suns, x, y, slope, angle, shift)
        return i + 1, random, [add(total, part) for total, part in zip(sums, parts)]

    zeros = [tuple(mi.Float(0.0) for _ in range(3)) for _ in range(1 + len(suns))]
    start = (mi.UInt32(0), random, zeros)
    _, _, sums = dr.while_loop(start, lambda i, random, sums: i < side * side, sample)
    dr.eval(sums)
    pictures = np.array([[np.array(channel) for channel in picture] for picture in sums])
    return pictures.transpose(0, 2, 1).reshape(len(pictures), view.pixels, view.pixels, 3) / side**2


def shade(camera, shapes, maps, suns, x, y, slope, angle, shift):
    """Returns the radiance of one sample under each light."""
    origin = mi.Point3f(*camera.origin)
    hit = shapes.ray_intersect(mi.Ray3f(origin, mi.Vector3f(*camera.ray(dr, x, y))))
    texel, normal, tangent = camera.surface(dr, tuple(hit.p))
    texel = tuple(t + s for t, s in zip(texel, shift))
    eye = tuple(dr.normalize(origin - hit.p))
    surface = maps.surface(texel, normal, tangent)
    distance = dr.sqrt(slope / (1.0 - slope))
    seen = (formula.turned_to(dr, surface[0], eye), *surface[1:])
    ray, share, fresnel = formula.reflected(dr, seen, eye, (distance * dr.cos(angle), distance * dr.sin(angle)))
    factor = maps.compensation(surface, eye)
    light, diffuse = lights.environment(dr, ray), lights.diffuse(dr, surface[0][0])
    pictures = [tuple(share * f * c * l + a * d for f, c, l, a, d in zip(fresnel, factor, light, surface[3], diffuse))]
    pictures += [formula.under_sun(dr, surface, eye, sun) for sun in suns]
    return [tuple(dr.select(hit.is_valid(), channel, 0.0) for channel in picture) for picture in pictures]
