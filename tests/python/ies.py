"""Illuminances by RADIANCE's ies2rad and rtrace (through pyradiance) under IES files: a JSON object in, a list of lists out.

In, axes with +Y up and in metres: files: texts of IES files of lamps at the origin, which hang straight down with C0 at +X; points: places whose
planes face the lamp. Out: for each file, the illuminances at the points [lx].
"""

import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pyradiance

ROOT = Path(pyradiance.__file__).parent
os.environ["RAYPATH"] = f".{os.pathsep}{ROOT / 'lib'}"
# What ies2rad divides by to come from lumens to watts.
EFFICACY = 179.0


def turned(x, y, z):
    return x, -z, y


def ray(point):
    x, y, z = turned(*point)
    length = math.sqrt(x * x + y * y + z * z)
    return f"{x:.12g} {y:.12g} {z:.12g} {-x / length:.12g} {-y / length:.12g} {-z / length:.12g}\n"


def illuminances(text, points):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        (folder / "lamp.ies").write_text(text)
        # White: the default lamp, not one that the file's words may name.
        subprocess.run([ROOT / "bin/ies2rad", "-t", "default", "lamp.ies"], check=True, cwd=folder)
        octree = folder / "lamp.oct"
        with octree.open("wb") as out:
            subprocess.run([ROOT / "bin/oconv", "lamp.rad"], check=True, stdout=out, cwd=folder)
        options = "-I -h -w- -fad -ab 0 -dt 0 -dc 1 -dj 0 -ds 0".split()
        rays = "".join(map(ray, points)).encode()
        out = subprocess.run(
            [ROOT / "bin/rtrace", *options, octree.name], check=True, stdout=subprocess.PIPE, cwd=folder, input=rays
        ).stdout
    return (EFFICACY * np.frombuffer(out).reshape(-1, 3).mean(axis=1)).tolist()


given = json.load(sys.stdin)
json.dump([illuminances(text, given["points"]) for text in given["files"]], sys.stdout)
