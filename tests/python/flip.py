"""FLIP by its authors' own program: a JSON list of pairs in, their means, maps and exposures out.

A pair is two pictures in linear Rec. 709 (`reference` and `test`, rows of pixels of channels), `hdr`, and `parameters` as they are
called there. `null` comes out where the package is not to be had: it is built for some systems only.
"""

import json
import sys

import numpy as np

try:
    import flip_evaluator
except ImportError:
    flip_evaluator = None


def evaluate(pair):
    pictures = [np.array(pair[name], np.float32) for name in ("reference", "test")]
    error, mean, used = flip_evaluator.evaluate(
        *pictures,
        "HDR" if pair["hdr"] else "LDR",
        inputsRGB=False,
        applyMagma=False,
        parameters=pair["parameters"],
    )
    exposures = [used["startExposure"], used["stopExposure"], used["numExposures"]] if pair["hdr"] else None
    return {"map": error.ravel().tolist(), "mean": mean, "exposures": exposures}


given = json.load(sys.stdin)
json.dump(flip_evaluator and [evaluate(pair) for pair in given], sys.stdout)
