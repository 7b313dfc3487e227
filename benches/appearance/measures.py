"""How far a picture is from the truth, by measures of others: relative L1 of radiance, FLIP, and flicker."""

import flip_evaluator
import numpy as np

from encoding import to_srgb


def relative_l1(picture, truth):
    """Returns the sum of absolute differences of radiance by the sum of the truth's radiance."""
    return float(np.abs(picture - truth).sum(dtype=np.float64) / truth.sum(dtype=np.float64))


def displayed(radiance, exposure):
    """Returns sRGB from 0 to 1, by E. Reinhard's operator x / (1 + x) after the exposure."""
    light = np.maximum(radiance, 0.0) * exposure
    return to_srgb(light / (1.0 + light)).astype(np.float32)


def exposure_of(truth):
    """Returns the exposure that shows the mean of the truth at a third of the brightest display."""
    return 0.5 / max(float(truth.mean()), 1e-9)


def flip(picture, truth, mask):
    """Returns the mean of FLIP (P. Andersson et al., "FLIP: A difference evaluator for alternating images", 2020) over
    a mask. Both pictures are displayed pixels of the mask."""
    images = [np.zeros((*mask.shape, 3), np.float32) for _ in range(2)]
    for image, values in zip(images, (truth, picture)):
        image[mask] = values
    errors, _, _ = flip_evaluator.evaluate(*images, "LDR", applyMagma=False)
    return float(np.asarray(errors)[mask].mean())


def flicker(frames, truth):
    """Returns the mean absolute change from frame to frame, as displayed, beyond that of the truth: pixels that change
    less than the truth does count as 0."""
    change, right = (np.abs(np.diff(sequence, axis=0)) for sequence in (frames, truth))
    return float(np.maximum(change - right, 0.0).mean())
