"""Means over materials with intervals by the bootstrap."""

import numpy as np

RESAMPLES = 4000


def mean_interval(values, geometric=False):
    """Returns (mean, low, high): the mean over materials and its 95 % interval, by resampling materials.

    B. Efron, R. Tibshirani, "An introduction to the bootstrap", 1993, chapter 13 (percentile interval).
    """
    values = np.log(values) if geometric else np.asarray(values, float)
    drawn = np.random.default_rng(0).integers(0, len(values), (RESAMPLES, len(values)))
    result = np.array([values.mean(), *np.percentile(values[drawn].mean(axis=1), [2.5, 97.5])])
    return tuple(float(v) for v in (np.exp(result) if geometric else result))
