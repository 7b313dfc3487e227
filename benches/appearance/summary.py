"""Figures of the page: errors of variants by material, and their means with intervals."""

import numpy as np

from intervals import mean_interval

PLAIN = "plain mips"
MEASURES = ("suns", "environment", "flip")


def error(material, variant, measure, filters=("trilinear", "anisotropic"), view=""):
    """Returns the mean of a measure over filters and over the views whose names contain `view`."""
    scores = material["variants"][variant]
    values = [s[measure] for name in filters for key, s in scores[name].items() if view in key]
    return float(np.mean(values))


def picture_error(material, variant, **chosen):
    """Returns the mean of relative L1 under suns and under the environment."""
    return (error(material, variant, "suns", **chosen) + error(material, variant, "environment", **chosen)) / 2.0


def flicker(material, variant):
    """Returns the mean flicker in thousandths of the display's brightest value."""
    return 1000.0 * float(np.mean(list(material["variants"][variant]["flicker"].values())))


def closer(material, variant, **chosen):
    """Returns how many times closer to the truth than plain mips a variant is."""
    return picture_error(material, PLAIN, **chosen) / picture_error(material, variant, **chosen)


def noise(material):
    """Returns the expected picture error of the truth itself."""
    return float(np.mean(list(material["noise"].values())))


def is_ours(variant):
    """Returns whether a variant is a bake of Roughcast that models lost bumps."""
    return variant.startswith(("portable", "pyramid"))


def variants(materials):
    """Returns the names of all variants, in the order of the results."""
    return list(materials[0]["variants"])


def best_peer(material):
    """Returns the name of the peer, plain mips among them, with the smallest picture error on a material."""
    peers = [name for name in material["variants"] if not is_ours(name) and "UASTC" not in name]
    return min(peers, key=lambda name: picture_error(material, name))


def best_peer_error(material):
    """Returns the picture error of the best peer on a material."""
    return picture_error(material, best_peer(material))


def overall(materials):
    """Returns by variant: (mean, low, high) of picture error, of each measure, of flicker, and of times closer."""
    result = {}
    for name in variants(materials):
        of = lambda figure: mean_interval([figure(m) for m in materials])
        row = {"picture": of(lambda m: picture_error(m, name)), "flicker": of(lambda m: flicker(m, name))}
        row |= {measure: of(lambda m: error(m, name, measure)) for measure in MEASURES}
        row["closer"] = mean_interval([closer(m, name) for m in materials], geometric=True)
        result[name] = row
    return result


def losses(materials):
    """Returns (material, measure, times closer by variant) wherever a variant of ours has an error that is more than a
    percent above that of plain mips, the worst first."""
    found = []
    for material in materials:
        ours = list(filter(is_ours, variants(materials)))
        for measure in MEASURES:
            times = {n: error(material, PLAIN, measure) / error(material, n, measure) for n in ours}
            if min(times.values()) < 1.0 / 1.01:
                found.append((material["name"], measure, times))
    return sorted(found, key=lambda row: min(row[2].values()))
