"""The views: planes at three elevations and a sphere, each at five distances between mip levels.

The camera stays where it is, and the maps repeat more often with distance. Under suns and an environment that is far
away, this is the picture of a camera that moves away from an endless plane.
"""

import math
from dataclasses import dataclass

import numpy as np

from formula import add, cross, dot, normalised, scale
from lights import suns

# Levels of a footprint at the centre of the picture: half-way between mip levels.
LEVELS = (1.5, 2.5, 3.5, 4.5, 5.5)
# Elevation of the eye above the plane, in degrees. None: a sphere.
SHAPES = {"plane 75": 75.0, "plane 45": 45.0, "plane 20": 20.0, "sphere": None}
FIELD = math.radians(24.0)
DISTANCE = 5.6


@dataclass(frozen=True)
class View:
    """A camera, a shape, and the number of texels that a pixel covers at the centre."""

    shape: str
    level: float
    pixels: int

    @property
    def name(self):
        """Returns the key of the view in results."""
        return f"{self.shape}, level {self.level:g}"

    @property
    def is_sphere(self):
        """Returns whether the shape is the sphere."""
        return SHAPES[self.shape] is None

    @property
    def eye(self):
        """Returns the unit vector from the origin to the camera. x is to the right in the picture."""
        elevation = math.radians(25.0 if self.is_sphere else SHAPES[self.shape])
        return np.array([0.0, -math.cos(elevation), math.sin(elevation)])

    @property
    def suns(self):
        """Returns the directions to the suns of this view."""
        return suns(self.eye, self.is_sphere)


class Camera:
    """The geometry of a view, for NumPy or Dr.Jit.

    `number` wraps each number of the view. Dr.Jit compiles numbers into its kernels, unless they are made opaque.
    """

    def __init__(self, view, number=float):
        vector = lambda v: tuple(number(float(c)) for c in v)
        right = np.array([1.0, 0.0, 0.0])
        self.is_sphere = view.is_sphere
        self.right, self.up, self.back = vector(right), vector(np.cross(view.eye, right)), vector(view.eye)
        self.origin = vector(DISTANCE * view.eye)
        self.middle = 0.5 * view.pixels
        pixel = 2.0 * math.tan(FIELD / 2.0) / view.pixels
        self.pixel = number(pixel)
        # Texels for each unit of the surface, so that a pixel at the centre covers 2^level texels.
        self.density = number(2.0**view.level / (pixel * (DISTANCE - 1.0 if view.is_sphere else DISTANCE)))

    def ray(self, xp, x, y):
        """Returns the direction of the ray through a point of the picture in pixels, from the upper left."""
        px, py = (x - self.middle) * self.pixel, (self.middle - y) * self.pixel
        return normalised(xp, tuple(px * r + py * u - b for r, u, b in zip(self.right, self.up, self.back)))

    def surface(self, xp, point):
        """Returns (texel coordinates, normal, tangent) at a point of the shape.

        Texel coordinates run to the right and, as rows do, down the image. Tangent and normal make glTF's frame, with
        the bitangent normal x tangent up the image.
        """
        if not self.is_sphere:
            zero = point[0] * 0.0
            texel = (point[0] * self.density, point[1] * -self.density)
            return texel, (zero, zero, zero + 1.0), (zero + 1.0, zero, zero)
        x, y, z = point
        # The seam is behind the sphere, since the eye is at negative y.
        longitude = xp.atan2(x, -y)
        latitude = xp.asin(xp.minimum(xp.maximum(z, -1.0), 1.0))
        across = xp.maximum(xp.sqrt(x * x + y * y), 1e-6)
        return (longitude * self.density, latitude * -self.density), (x, y, z), (-y / across, x / across, z * 0.0)

    def hit(self, x, y):
        """Returns (point, whether there is one) where the rays through points of the picture meet the shape."""
        ray = self.ray(np, x, y)
        if not self.is_sphere:
            distance = -self.origin[2] / np.minimum(ray[2], -1e-9)
            return add(self.origin, scale(ray, distance)), ray[2] < -1e-6
        middle = -dot(self.origin, ray)
        under = middle * middle - (DISTANCE * DISTANCE - 1.0)
        return add(self.origin, scale(ray, middle - np.sqrt(np.maximum(under, 0.0)))), under > 0.0

    def derivative(self, point, normal, tangent, x, y):
        """Returns the change of texel coordinates from `point` to a neighbouring pixel, on the tangent plane."""
        ray = self.ray(np, x, y)
        offset = tuple(p - o for p, o in zip(point, self.origin))
        distance = dot(offset, normal) / dot(ray, normal)
        step = tuple(r * distance - o for r, o in zip(ray, offset))
        shrink = np.maximum(np.hypot(point[0], point[1]), 1e-6) if self.is_sphere else 1.0
        return dot(step, tangent) / shrink * self.density, -dot(step, cross(normal, tangent)) * self.density


def pixels(view):
    """Returns the visible pixels of a view as a dictionary of arrays.

    `mask` is the picture of pixels that the shape covers wholly. For those pixels, `texel` has texel coordinates at the
    centre, `across` and `down` the change of those coordinates to the next pixel, and `normal`, `tangent` and `eye`
    unit vectors.
    """
    camera = Camera(view)
    rows, columns = np.mgrid[0 : view.pixels, 0 : view.pixels]
    x, y = columns + 0.5, rows + 0.5
    mask = np.logical_and.reduce([camera.hit(x + dx, y + dy)[1] for dx in (-1.0, 1.0) for dy in (-1.0, 1.0)])
    x, y = x[mask], y[mask]
    point, _ = camera.hit(x, y)
    texel, normal, tangent = camera.surface(np, point)
    across, down = (camera.derivative(point, normal, tangent, x + dx, y + dy) for dx, dy in ((1, 0), (0, 1)))
    return {
        "mask": mask,
        "texel": texel,
        "across": across,
        "down": down,
        "normal": normal,
        "tangent": tangent,
        "eye": normalised(np, tuple(o - p for o, p in zip(camera.origin, point))),
    }
