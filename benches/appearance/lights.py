"""The lights: eight suns for each view, one at a time, and a smooth environment of soft lobes."""

import functools
import math

import numpy as np

from formula import dot

# Direction, sharpness and colour of the spherical Gaussians exp(sharpness (cos - 1)) that make the environment: a sky,
# a bright window, a warm lamp, a strip near the horizon, and light from the ground. z points up from the plane.
ENVIRONMENT = [
    ((0.0, 0.0, 1.0), 1.5, (0.55, 0.65, 0.80)),
    ((-0.6, 0.35, 0.72), 24.0, (5.0, 5.0, 4.8)),
    ((0.5, 0.6, 0.62), 60.0, (9.0, 6.8, 4.6)),
    ((0.1, 0.95, 0.28), 12.0, (1.6, 1.7, 2.0)),
    ((0.7, -0.6, 0.4), 16.0, (1.5, 1.7, 2.2)),
    ((0.0, 0.0, -1.0), 1.0, (0.10, 0.09, 0.08)),
]


def environment(xp, direction):
    """Returns the radiance (red, green, blue) that comes from a direction."""
    total = [0.0, 0.0, 0.0]
    for axis, sharpness, colour in ENVIRONMENT:
        length = math.sqrt(sum(a * a for a in axis))
        weight = xp.exp(sharpness * (dot(tuple(a / length for a in axis), direction) - 1.0))
        total = [t + weight * c for t, c in zip(total, colour)]
    return tuple(total)


def harmonics(n):
    """Returns the nine spherical harmonics of degree 0 to 2 as a list."""
    x, y, z = n
    return [
        x * 0.0 + 0.282095,
        0.488603 * y,
        0.488603 * z,
        0.488603 * x,
        1.092548 * x * y,
        1.092548 * y * z,
        0.315392 * (3.0 * z * z - 1.0),
        1.092548 * x * z,
        0.546274 * (x * x - y * y),
    ]


@functools.cache
def irradiance_coefficients():
    """Returns nine coefficients for each channel: irradiance / pi by R. Ramamoorthi, P. Hanrahan, "An efficient
    representation for irradiance environment maps", 2001. Engines light diffuse surfaces in this way."""
    steps = 128
    z = (np.arange(steps) + 0.5) / steps * 2.0 - 1.0
    phi = (np.arange(2 * steps) + 0.5) / steps * math.pi
    z, phi = np.meshgrid(z, phi)
    across = np.sqrt(1.0 - z * z)
    directions = (across * np.cos(phi), across * np.sin(phi), z)
    radiance = environment(np, directions)
    cosine = [1.0] + [2.0 / 3.0] * 3 + [0.25] * 5
    solid_angle = 4.0 * math.pi / z.size
    return tuple(
        tuple(float(np.sum(basis * channel) * solid_angle * c) for basis, c in zip(harmonics(directions), cosine))
        for channel in radiance
    )


def diffuse(xp, n):
    """Returns irradiance / pi for each channel on a surface with the normal `n`."""
    basis = harmonics(n)
    return tuple(
        xp.maximum(sum(b * c for b, c in zip(basis, channel)), 0.0) for channel in irradiance_coefficients()
    )


def suns(eye, surround):
    """Returns eight unit vectors to suns.

    On a plane (`surround` False), four are up to 14 degrees from the mirror direction of `eye`, so that the picture
    shows their highlights, and four are spread over the sky. On a sphere, every sun in front makes a highlight, and
    all eight are spread around the eye.
    """
    eye = np.asarray(eye, float)
    golden = math.pi * (3.0 - math.sqrt(5.0))
    if surround:
        cosines = [math.cos(math.radians(10 + 14 * i)) for i in range(8)]
        return [around(eye, cosine, golden * i + 0.4) for i, cosine in enumerate(cosines)]
    mirror = eye * [-1.0, -1.0, 1.0]
    near = [around(mirror, math.cos(math.radians(2 + 4 * i)), golden * i + 0.7) for i in range(4)]
    up = np.array([0.0, 0.0, 1.0])
    far = [around(up, math.cos(math.radians(15 + 17 * i)), golden * i + 1.9) for i in range(4)]
    return near + far


def around(axis, cosine, angle):
    """Returns the unit vector at an angle from `axis`, turned about the axis."""
    side = np.cross(axis, [0.31, 0.87, 0.11])
    side /= np.linalg.norm(side)
    other = np.cross(axis, side)
    sine = math.sqrt(1.0 - cosine * cosine)
    return cosine * axis + sine * (math.cos(angle) * side + math.sin(angle) * other)
