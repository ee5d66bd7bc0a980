"""Colour by colour-science from the same inputs as tests/colour.rs: a JSON object of tasks in, the same keys with results out."""

import json
import math
import sys
import warnings
from pathlib import Path

warnings.filterwarnings("ignore")
del sys.path[0]  # This folder, where this file would stand for the package `colour`.
import colour  # noqa: E402
import numpy as np  # noqa: E402

# Derived matrices, not the standards' rounded ones (the sRGB matrix of IEC 61966-2-1 differs by 1.6e-4).
SPACES = {}
for ours, theirs in {"rec709": "ITU-R BT.709", "rec2020": "ITU-R BT.2020", "acescg": "ACEScg"}.items():
    SPACES[ours] = colour.RGB_COLOURSPACES[theirs].copy()
    SPACES[ours].use_derived_transformation_matrices(True)


def xyz_to_rgb(task):
    """`adapt` is a pair of white chromaticities or absent."""
    space = SPACES[task["space"]]
    if task.get("adapt"):
        return colour.XYZ_to_RGB(
            task["xyz"], space, illuminant=space_white(task["adapt"]), chromatic_adaptation_transform="Bradford"
        )
    return colour.XYZ_to_RGB(task["xyz"], space, chromatic_adaptation_transform=None)


def space_white(name):
    return SPACES[name].whitepoint


def bradford(pairs):
    to_xyz = lambda xy: colour.xyY_to_XYZ([*xy, 1.0])
    return [
        colour.adaptation.matrix_chromatic_adaptation_VonKries(to_xyz(a), to_xyz(b), transform="Bradford")
        for a, b in pairs
    ]


def spectra(rows):
    """Power per nm at 360 to 830 nm in steps of 5, to absolute XYZ."""
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    domain = np.arange(360, 831, 5)
    shape = colour.SpectralShape(360, 830, 5)
    cmfs = cmfs.copy().align(shape)
    return [
        colour.colorimetry.sd_to_XYZ_integration(
            colour.SpectralDistribution(row, domain), cmfs, illuminant=None, k=683.002, shape=shape
        )
        for row in rows
    ]


def preetham(rows):
    """x, y, Y [cd/m2] of Preetham 1999 from the data file: turbidity, sun elevation, view azimuth from the sun's, view elevation."""
    data = json.loads((Path(__file__).parents[2] / "data" / "preetham1999.json").read_text())

    def perez(c, theta, gamma):
        a, b, c, d, e = c
        return (1 + a * math.exp(b / math.cos(theta))) * (1 + c * math.exp(d * gamma) + e * math.cos(gamma) ** 2)

    result = []
    for t, sun, azimuth, elevation in rows:
        s, theta = math.radians(90 - sun), math.radians(90 - elevation)
        gamma = math.acos(
            math.cos(theta) * math.cos(s) + math.sin(theta) * math.sin(s) * math.cos(math.radians(azimuth))
        )
        powers = np.array([s**3, s**2, s, 1.0])
        turbidities = np.array([t * t, t, 1.0])
        chi = (4 / 9 - t / 120) * (math.pi - 2 * s)
        zenith = {
            "Y": 1000 * ((4.0453 * t - 4.9710) * math.tan(chi) - 0.2155 * t + 2.4192),
            "x": float(turbidities @ np.array(data["zenith_x"]) @ powers),
            "y": float(turbidities @ np.array(data["zenith_y"]) @ powers),
        }
        value = {}
        for name, table in data["distribution_AT_plus_B"].items():
            coefficients = [table[k][0] * t + table[k][1] for k in "ABCDE"]
            value[name] = zenith[name] * perez(coefficients, theta, gamma) / perez(coefficients, 0.0, s)
        result.append([value["x"], value["y"], value["Y"]])
    return result


def temperature(xyz):
    """CCT [K] and Duv by Ohno 2013."""
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(colour.SpectralShape(360, 830, 5))
    uv = [colour.UCS_to_uv(colour.XYZ_to_UCS(np.array(v) / v[1])) for v in xyz]
    return [
        colour.temperature.uv_to_CCT_Ohno2013(one, cmfs=cmfs, start=1000, end=100000, spacing=1.001) for one in uv
    ]


def delta_e(pairs):
    """Delta E 2000 of pairs of 8-bit sRGB codes (whole or not)."""

    def lab(codes):
        linear = colour.models.eotf_sRGB(np.array(codes) / 255)
        xyz = colour.RGB_to_XYZ(linear, SPACES["rec709"], chromatic_adaptation_transform=None)
        return colour.XYZ_to_Lab(xyz, SPACES["rec709"].whitepoint)

    return colour.delta_E(lab([a for a, _ in pairs]), lab([b for _, b in pairs]), method="CIE 2000")


TASKS = {
    "delta_e": delta_e,
    "temperature": temperature,
    "xyy_to_xyz": colour.xyY_to_XYZ,
    "xyz_to_rgb": lambda tasks: [xyz_to_rgb(task) for task in tasks],
    "srgb_encode": lambda v: colour.models.eotf_inverse_sRGB(v),
    "bradford": bradford,
    "spectra": spectra,
    "preetham": preetham,
}

given = json.load(sys.stdin)


def plain(value):
    return np.asarray(value).tolist()


json.dump({name: plain(TASKS[name](task)) for name, task in given.items()}, sys.stdout)
