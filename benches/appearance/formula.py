"""The shading formula of glTF 2.0: an anisotropic GGX lobe with Schlick's Fresnel term, and a Lambertian base.

The functions take a module `xp` with `sqrt`, `maximum` and `minimum`: NumPy for baked textures, Dr.Jit for the truth.
Thus both sides of every comparison use one formula. Vectors are tuples (x, y, z) of arrays.
"""

import math

# Filament and three.js clamp perceptual roughness near this value, since narrower lobes overflow half floats.
MIN_ROUGHNESS = 0.045
MIN_ALPHA = MIN_ROUGHNESS**2
# An engine clamps the cosine to the eye, so that normals that face away from the eye do not divide by zero.
MIN_COSINE = 1e-4


def square(a):
    """Returns a * a."""
    return a * a


def dot(a, b):
    """Returns the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def add(a, b):
    """Returns the sum of two vectors."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def scale(a, s):
    """Returns the vector times a number."""
    return (a[0] * s, a[1] * s, a[2] * s)


def cross(a, b):
    """Returns the vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def normalised(xp, a):
    """Returns the vector with length 1."""
    return scale(a, 1.0 / xp.sqrt(xp.maximum(dot(a, a), 1e-20)))


def frame(xp, normal, tangent):
    """Returns (normal, t, b): unit vectors, with t in the plane of normal and tangent, and b = normal x t."""
    n = normalised(xp, normal)
    t = normalised(xp, add(tangent, scale(n, -dot(tangent, n))))
    return (n, t, cross(n, t))


def density(axes, alphas, h):
    """Returns the GGX density of half-vectors (Burley, "Physically based shading at Disney", 2012, eq. 13)."""
    n, t, b = axes
    q = square(dot(t, h) / alphas[0]) + square(dot(b, h) / alphas[1]) + square(dot(n, h))
    return 1.0 / (math.pi * alphas[0] * alphas[1] * q * q)


def visibility(xp, axes, alphas, v, l, nv, nl, correlated=True):
    """Returns G / (4 (n.v) (n.l)) by Smith's masking.

    glTF and engines use the height-correlated form. Mitsuba's `roughconductor` uses the separable form, which exists
    here for the test against it.
    """
    _, t, b = axes
    to_v = xp.sqrt(square(alphas[0] * dot(t, v)) + square(alphas[1] * dot(b, v)) + nv * nv)
    to_l = xp.sqrt(square(alphas[0] * dot(t, l)) + square(alphas[1] * dot(b, l)) + nl * nl)
    if correlated:
        return 0.5 / xp.maximum(nl * to_v + nv * to_l, 1e-9)
    return 1.0 / xp.maximum((nv + to_v) * (nl + to_l), 1e-9)


def fresnel(f0, cosine):
    """Returns Schlick's reflectance for each channel of `f0`."""
    rest = square(square(1.0 - cosine)) * (1.0 - cosine)
    return tuple(f + (1.0 - f) * rest for f in f0)


def reflectances(base, metalness):
    """Returns (F0, albedo) of a glTF material."""
    f0 = tuple(0.04 * (1.0 - metalness) + c * metalness for c in base)
    return f0, tuple(c * (1.0 - metalness) for c in base)


def facing(xp, axes, v):
    """Returns the cosine to the eye as an engine clamps it."""
    return xp.maximum(dot(axes[0], v), MIN_COSINE)


def under_sun(xp, surface, v, l, correlated=True):
    """Returns the radiance towards `v` under a sun from `l` with irradiance pi across its direction.

    `surface` is (axes, alphas, f0, albedo).
    """
    axes, alphas, f0, albedo = surface
    h = normalised(xp, add(v, l))
    nv = facing(xp, axes, v)
    nl = xp.maximum(dot(axes[0], l), 0.0)
    vh = xp.minimum(xp.maximum(dot(v, h), 0.0), 1.0)
    lobe = math.pi * density(axes, alphas, h) * visibility(xp, axes, alphas, v, l, nv, nl, correlated) * nl
    return tuple(lobe * f + a * nl for f, a in zip(fresnel(f0, vh), albedo))


def turned_to(xp, axes, v):
    """Returns axes whose normal does not face away from the eye: at grazing angles, normals of steep bumps are turned
    until they are perpendicular to `v`. Without this step such bumps would reflect nothing and be black, and an engine
    shows them as a grazing mirror."""
    n, t, _ = axes
    lift = xp.maximum(MIN_COSINE - dot(n, v), 0.0)
    return frame(xp, add(n, scale(v, lift)), t)


def reflected(xp, surface, v, points):
    """Returns (direction, share, Fresnel term of each channel) of a reflected ray, by sampling half-vectors.

    The normal must face the eye (`turned_to`). `points` is (s cos phi, s sin phi), where s = sqrt(u / (1 - u)): the
    slopes of a GGX lobe with alpha 1. The expectation of radiance times share times Fresnel term over uniform u and phi
    is the radiance by the lobe.
    """
    axes, alphas, f0, _ = surface
    n, t, b = axes
    h = normalised(xp, add(n, add(scale(t, alphas[0] * points[0]), scale(b, alphas[1] * points[1]))))
    vh = dot(v, h)
    l = add(scale(h, 2.0 * vh), scale(v, -1.0))
    nv = facing(xp, axes, v)
    nl = xp.maximum(dot(n, l), 0.0)
    vh = xp.minimum(xp.maximum(vh, 0.0), 1.0)
    share = 4.0 * visibility(xp, axes, alphas, v, l, nv, nl) * nl * vh / xp.maximum(dot(n, h), 1e-6)
    return l, share, fresnel(f0, vh)


def compensation(xp, f0, albedo):
    """Returns the factor for each channel that gives back what a rough lobe loses: 1 + F0 (1 / E - 1), where E is the
    mean share of its rays. Engines do so under an environment (Filament, "Energy loss in specular reflectance")."""
    lost = 1.0 / xp.minimum(xp.maximum(albedo, 0.1), 1.0) - 1.0
    return tuple(1.0 + f * lost for f in f0)
