"""Generated materials: normal maps of many kinds of surface, some with roughness, metalness and colour.

Each function takes a number of texels N and returns a dictionary with `slopes` (rows, columns, 2: change of height to
the right and down the image), and where they vary `roughness`, `metalness` and `colour` (sRGB). All repeat, and a fixed
seed makes them equal on every machine.
"""

import numpy as np


def grid(n):
    """Returns coordinates (x, y) of texel centres, from 0 to 1."""
    y, x = np.mgrid[0:n, 0:n]
    return (x + 0.5) / n, (y + 0.5) / n


def noise(n, seed, wide=1.0, high=1.0, distribution="normal"):
    """Returns periodic noise with variance 1 whose features are `wide` x `high` texels."""
    random = np.random.default_rng(seed)
    values = random.standard_t(2.2, (n, n)) if distribution == "heavy" else random.standard_normal((n, n))
    u, v = np.fft.rfftfreq(n), np.fft.fftfreq(n)[:, None]
    smooth = np.exp(-2.0 * np.pi**2 * ((u * wide / 2.0) ** 2 + (v * high / 2.0) ** 2))
    result = np.fft.irfft2(np.fft.rfft2(values) * smooth, s=(n, n))
    return (result - result.mean()) / result.std()


def slopes_of(height):
    """Returns slopes of a periodic height in texels."""
    right = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) / 2.0
    down = (np.roll(height, -1, 0) - np.roll(height, 1, 0)) / 2.0
    return np.stack([right, down], axis=-1)


def with_deviation(slopes, deviation):
    """Returns slopes scaled to a standard deviation, over both axes together."""
    return slopes * (deviation / np.sqrt((slopes**2).sum(axis=-1).mean() / 2.0))


def mix(mask, one, other):
    """Returns `one` where the mask is 1 and `other` where it is 0, as colours."""
    return mask[..., None] * np.asarray(one) + (1.0 - mask[..., None]) * np.asarray(other)


def mirror_tiles(n):
    """Returns two populations: mirrors with alpha 0.01 that lean slightly, beside rough grout with alpha 0.49."""
    count = 16
    x, y = grid(n)
    fx, fy = (x * count) % 1.0, (y * count) % 1.0
    grout = (np.minimum(np.minimum(fx, 1.0 - fx), np.minimum(fy, 1.0 - fy)) < 0.09).astype(float)
    lean = np.random.default_rng(1).normal(0.0, 0.03, (count, count, 2))
    leaning = lean[(y * count).astype(int), (x * count).astype(int)]
    rough = with_deviation(slopes_of(noise(n, 2, 2, 2)), 0.25)
    slopes = np.where(grout[..., None] > 0, rough, leaning)
    return {"slopes": slopes, "roughness": 0.7 * grout + 0.1 * (1.0 - grout)}


def brushed(n):
    """Returns brushed steel: fine grooves along one direction."""
    return {"slopes": with_deviation(slopes_of(noise(n, 3, 160, 1.2)), 0.18)}


def scratched(n):
    """Returns polished metal with low relief and fine straight scratches in all directions."""
    random = np.random.default_rng(4)
    height = 0.6 * noise(n, 5, 40, 40)
    for _ in range(260):
        x, y, angle = random.uniform(0, n), random.uniform(0, n), random.uniform(0, np.pi)
        steps = np.arange(int(random.uniform(0.1, 0.6) * n))
        columns, rows = (x + steps * np.cos(angle)).astype(int) % n, (y + steps * np.sin(angle)).astype(int) % n
        height[rows, columns] -= random.uniform(0.02, 0.12)
    return {"slopes": slopes_of(height)}


def heavy_tails(n):
    """Returns noise whose slopes have heavy tails."""
    height = noise(n, 6, 2.5, 2.5, "heavy")
    return {"slopes": with_deviation(slopes_of(height), 0.22)}


def bricks(n):
    """Returns rough, bevelled bricks at a period of 64 x 32 texels."""
    x, y = grid(n)
    row = np.floor(y * n / 32)
    fx, fy = ((x * n + 32 * (row % 2)) % 64) / 64, (y * n % 32) / 32
    edge = np.minimum(np.minimum(fx, 1 - fx) * 64, np.minimum(fy, 1 - fy) * 32)
    height = np.clip(edge - 2.0, 0.0, 4.0) * 0.9 + 0.25 * noise(n, 7, 3, 3)
    mortar = (edge < 3.0).astype(float)
    tone = np.clip(0.9 + 0.1 * noise(n, 8, 24, 12), 0.5, 1.2)[..., None]
    return {
        "slopes": slopes_of(height),
        "roughness": 0.8 * mortar + 0.55 * (1 - mortar),
        "colour": np.clip(mix(mortar, [0.72, 0.70, 0.66], [0.62, 0.28, 0.20]) * tone, 0, 1),
    }


def weave(n):
    """Returns a weave of anisotropic threads: each cell has grooves along one of two directions."""
    x, y = grid(n)
    cell = 16
    across = ((x * n // cell + y * n // cell) % 2).astype(float)
    bulge = np.where(across > 0, np.sin(np.pi * (y * n % cell) / cell), np.sin(np.pi * (x * n % cell) / cell))
    fibres = np.where(across > 0, noise(n, 9, 24, 1.3), noise(n, 10, 1.3, 24))
    return {"slopes": with_deviation(slopes_of(2.2 * bulge + 0.25 * fibres), 0.3)}


def hammered(n):
    """Returns hammered copper: smooth dents."""
    return {"slopes": with_deviation(slopes_of(noise(n, 11, 18, 18)), 0.25)}


def ripples(n):
    """Returns waves that run mostly in one direction."""
    random = np.random.default_rng(12)
    x, y = grid(n)
    height = np.zeros((n, n))
    for _ in range(24):
        u, v = random.integers(6, 40), random.integers(-10, 11)
        height += np.sin(2 * np.pi * (u * x + v * y) + random.uniform(0, 6.3)) / np.hypot(u, v)
    return {"slopes": with_deviation(slopes_of(height), 0.2)}


def knurled(n):
    """Returns knurled metal: pyramids, so that all normals have one of four directions."""
    x, y = grid(n)
    u, v = (x * 32) % 1.0, (y * 32) % 1.0
    height = np.minimum(np.minimum(u, 1 - u), np.minimum(v, 1 - v)) * n / 32 * 0.5
    return {"slopes": slopes_of(height)}


def cells(n, count, seed):
    """Returns distances in texels to the nearest and to the second nearest of random points."""
    random = np.random.default_rng(seed)
    points = random.uniform(0, n, (count, 2))
    y, x = np.mgrid[0:n, 0:n]
    nearest, second = np.full((n, n), 1e9), np.full((n, n), 1e9)
    for px, py in points:
        dx, dy = np.abs(x - px), np.abs(y - py)
        distance = np.hypot(np.minimum(dx, n - dx), np.minimum(dy, n - dy))
        second = np.minimum(second, np.maximum(nearest, distance))
        nearest = np.minimum(nearest, distance)
    return nearest, second


def leather(n):
    """Returns leather: a dielectric of smooth cells with creases."""
    nearest, second = cells(n, 700 * n // 512, 13)
    height = 2.2 * np.tanh((second - nearest) / 4.0) + 0.15 * noise(n, 14, 2, 2)
    return {"slopes": slopes_of(height), "colour": np.broadcast_to([0.36, 0.20, 0.13], (n, n, 3))}


def painted_rust(n):
    """Returns bare metal, smooth and bright, beside pitted rust, which is a rough dielectric."""
    rust = 1.0 / (1.0 + np.exp(-6.0 * (noise(n, 15, 30, 30) + 0.3 * noise(n, 16, 4, 4))))
    pits = with_deviation(slopes_of(noise(n, 17, 2.5, 2.5)), 0.5)
    steel = with_deviation(slopes_of(noise(n, 18, 90, 1.5)), 0.06)
    return {
        "slopes": pits * rust[..., None] + steel * (1 - rust[..., None]),
        "roughness": 0.75 * rust + 0.25 * (1 - rust),
        "metalness": 1.0 - rust,
        "colour": mix(rust, [0.45, 0.22, 0.10], [0.78, 0.77, 0.75]),
    }


def gravel(n):
    """Returns gravel: dielectric stones with strong relief, whose gaps are darker."""
    nearest, second = cells(n, 500 * n // 512, 19)
    round_ = np.sqrt(np.clip((second - nearest) / 14.0, 0.0, 1.0))
    tone = np.clip(0.55 + 0.12 * noise(n, 20, 14, 14), 0.2, 0.9)
    return {
        "slopes": slopes_of(8.0 * round_ + 0.3 * noise(n, 21, 2, 2)),
        "roughness": 0.85 - 0.25 * round_,
        "colour": (tone * (0.35 + 0.65 * round_))[..., None] * np.array([1.0, 0.96, 0.90]),
    }


def orange_peel(n):
    """Returns smooth metal with low relief, where a bake has little to win."""
    return {"slopes": with_deviation(slopes_of(noise(n, 22, 12, 12)), 0.02)}


def corduroy(n):
    """Returns corduroy: a rough dielectric with wide ribs and fine fibres."""
    x, _ = grid(n)
    height = 2.0 * np.abs(np.sin(np.pi * x * 32)) + 0.3 * noise(n, 23, 1.5, 5)
    colour = mix(np.abs(np.sin(np.pi * x * 32)), [0.30, 0.33, 0.48], [0.16, 0.17, 0.27])
    return {"slopes": slopes_of(height), "colour": colour}


def flakes(n):
    """Returns glitter: a few steep flakes in a smooth metal."""
    random = np.random.default_rng(24)
    rows, columns = random.integers(0, n // 4, 900), random.integers(0, n // 4, 900)
    slopes = np.zeros((n // 4, n // 4, 2))
    slopes[rows % (n // 4), columns % (n // 4)] = random.normal(0.0, 0.5, (900, 2))
    return {"slopes": np.repeat(np.repeat(slopes, 4, 0), 4, 1) + with_deviation(slopes_of(noise(n, 25, 20, 20)), 0.03)}


# Function, perceptual roughness where there is no map of it, and metalness where there is none.
GENERATED = {
    "mirror_tiles": (mirror_tiles, 1.0, 1.0),
    "brushed": (brushed, 0.3, 1.0),
    "scratched": (scratched, 0.2, 1.0),
    "heavy_tails": (heavy_tails, 0.25, 1.0),
    "bricks": (bricks, 1.0, 0.0),
    "weave": (weave, 0.35, 1.0),
    "hammered": (hammered, 0.25, 1.0),
    "ripples": (ripples, 0.15, 1.0),
    "knurled": (knurled, 0.3, 1.0),
    "leather": (leather, 0.4, 0.0),
    "painted_rust": (painted_rust, 1.0, 1.0),
    "gravel": (gravel, 1.0, 0.0),
    "orange_peel": (orange_peel, 0.2, 1.0),
    "corduroy": (corduroy, 0.6, 0.0),
    "flakes": (flakes, 0.3, 1.0),
}


def normals(slopes):
    """Returns normals of slopes as glTF has them (y up the image), encoded from 0 to 1."""
    n = np.dstack([-slopes[..., 0], slopes[..., 1], np.ones(slopes.shape[:2])])
    return n / np.linalg.norm(n, axis=-1, keepdims=True) * 0.5 + 0.5
