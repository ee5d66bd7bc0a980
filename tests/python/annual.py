"""Illuminances of points hour by hour by RADIANCE's rfluxmtx, rcontrib and dctimestep (through pyradiance): a JSON object in, one out.

In, all axes with +Y up and in metres, one channel of light:
triangles: rows of nine coordinates and the number of a material; materials: reflectances (Lambertian on both sides);
ground: height, albedo and extent [m]; points: rows of a place and a normal; factor: Reinhart's, of the sky's patches;
patches: unit vectors toward the middles of the patches; skies: a row an hour, the luminance of each patch;
suns: a row an hour, the unit vector toward a sun that is a point, and its illuminance (0: none);
sky, sun: bounces and divisions of a hemisphere for the light of either; n: processes.

Out: illuminances, a row an hour; straight, what comes straight from the sun; coefficients of patches and suns, a row a point; seconds of
the runs (processor time of all their processes in `cpu`); their command lines.

The two-phase method: a matrix of all patches by rfluxmtx, times the skies by dctimestep. The suns have a run of their own at their true
places (rcontrib, one modifier a sun), and one without bounces. Which of rfluxmtx's columns a patch is, is found by a ray toward it.
"""

import json
import math
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pyradiance

ROOT = Path(pyradiance.__file__).parent
os.environ["RAYPATH"] = f".{os.pathsep}{ROOT / 'lib'}"
os.environ["PATH"] = f"{ROOT / 'bin'}{os.pathsep}{os.environ['PATH']}"
# Half the angle under which a point sun is seen [degrees].
SUN = 0.0005


def turned(x, y, z):
    return x, -z, y


def row(values):
    return " ".join(f"{v:.9g}" for v in values)


def description(given):
    parts = []
    for i, reflectance in enumerate(given["materials"]):
        parts.append(f"void plastic m{i} 0 0 5 {row([reflectance] * 3)} 0 0")
    for i, triangle in enumerate(given["triangles"]):
        corners = [turned(*triangle[k : k + 3]) for k in (0, 3, 6)]
        numbers = " ".join(f"{v:.12g}" for corner in corners for v in corner)
        parts.append(f"m{int(triangle[9])} polygon t{i} 0 0 9 {numbers}")
    height, albedo, extent = given["ground"]
    parts.append(f"void plastic earth 0 0 5 {row([albedo] * 3)} 0 0")
    parts.append(f"earth ring plain 0 0 8 0 0 {height} 0 0 1 0 {extent}")
    return "\n".join(parts) + "\n"


def lit(options):
    """Options of a tracing without a cache, with every division alive."""
    bounces, divisions = options
    return [
        *("-ab", bounces, "-ad", divisions, "-as", 0, "-aa", 0, "-lr", -2 * bounces, "-lw", 0.4 / divisions),
        *("-dt", 0, "-dc", 1, "-dj", 0, "-ds", 0, "-dr", 0),
    ]


class Runs:
    def __init__(self, folder):
        self.folder = Path(folder)
        self.commands = []
        self.seconds = {}

    def run(self, name, command, rays=None):
        command = [str(part) for part in command]
        begin = time.perf_counter()
        done = subprocess.run(command, check=True, stdout=subprocess.PIPE, cwd=self.folder, input=rays)
        if name:
            self.seconds[name] = time.perf_counter() - begin
            self.commands.append(" ".join(command))
        return done.stdout

    def file(self, name, text):
        (self.folder / name).write_text(text)


def matrix(output, rows):
    """The first channel of a matrix of three."""
    return np.frombuffer(output, dtype=np.float32).reshape(rows, -1, 3)[:, :, 0].astype(float)


def computed(given, runs):
    points = given["points"]
    rays = "".join(f"{row(turned(*p[:3]))} {row(turned(*p[3:6]))}\n" for p in points).encode()
    runs.file("scene.rad", description(given))
    runs.file("empty.rad", "void plastic none 0 0 5 0 0 0 0 0\nnone sphere far 0 0 4 0 0 -1e5 1\n")
    runs.file(
        "sky.rad",
        f"#@rfluxmtx h=r{given['factor']} u=+Y\nvoid glow sky 0 0 4 1 1 1 0\nsky source dome 0 0 4 0 0 1 180\n",
    )
    # A ray toward the middle of each patch meets one column.
    patches = given["patches"]
    toward = "".join(f"0 0 0 {row(turned(*p))}\n" for p in patches).encode()
    flux = ["rfluxmtx", "-h", "-faf", "-y", len(patches), "-ab", 0, "-", "sky.rad", "empty.rad"]
    columns = matrix(runs.run(None, flux, toward), len(patches)).argmax(axis=1)
    assert len(set(columns.tolist())) == len(patches), "every patch has a column"

    flux = ["rfluxmtx", "-h", "-faf", "-n", given["n"], "-I+", "-y", len(points), *lit(given["sky"])]
    by_patch = matrix(runs.run("sky", [*flux, "-", "sky.rad", "scene.rad"], rays), len(points))
    skies = np.array(given["skies"])
    vectors = np.zeros((by_patch.shape[1], len(skies)))
    vectors[columns] = skies.T
    header = "#?RADIANCE\nNCOMP=3\nFORMAT={}\nNROWS={}\nNCOLS={}\n\n"
    for name, values in [("coefficients.mtx", by_patch), ("skies.mtx", vectors)]:
        text = header.format("float", *values.shape)
        numbers = np.repeat(values[:, :, None], 3, axis=2).astype("<f4").tobytes()
        head = text.replace("\n\n", "\nBigEndian=0\n\n").encode()
        (runs.folder / name).write_bytes(head + numbers)
    product = runs.run("product", ["dctimestep", "-h", "-of", "coefficients.mtx", "skies.mtx"])
    total = matrix(product, len(points)).T

    suns = [(hour, sun) for hour, sun in enumerate(given["suns"]) if sun[3] > 0]
    solid_angle = 2 * math.pi * (1 - math.cos(math.radians(SUN)))
    lines = [
        f"void light s{hour} 0 0 3 {row([1 / solid_angle] * 3)}\n"
        f"s{hour} source sun{hour} 0 0 4 {row(turned(*sun[:3]))} {2 * SUN}\n"
        for hour, sun in suns
    ]
    runs.file("suns.rad", "".join(lines))
    runs.file("suns.txt", "".join(f"s{hour}\n" for hour, _ in suns))
    with (runs.folder / "suns.oct").open("wb") as out:
        subprocess.run(["oconv", "-n", "30", "scene.rad", "suns.rad"], check=True, stdout=out, cwd=runs.folder)
    straight = np.zeros_like(total)
    by_sun = {}
    for name, options, onto in [("sun", lit(given["sun"]), total), ("straight", lit([0, 1]), straight)]:
        command = ["rcontrib", "-h", "-faf", "-n", given["n"], "-I+", "-V+", *options, "-M", "suns.txt", "suns.oct"]
        found = np.frombuffer(runs.run(name, command, rays), dtype=np.float32)
        found = found.reshape(len(points), len(suns), 3)[:, :, 0]
        by_sun[name] = found.tolist()
        for column, (hour, sun) in enumerate(suns):
            onto[hour] += sun[3] * found[:, column]
    return {
        "illuminances": total.tolist(),
        "straight": straight.tolist(),
        "sky_coefficients": by_patch[:, columns].tolist(),
        "sun_coefficients": by_sun["sun"],
        "straight_coefficients": by_sun["straight"],
        "seconds": runs.seconds,
        "cpu": sum(os.times()[2:4]),
        "commands": runs.commands,
    }


with tempfile.TemporaryDirectory() as folder:
    json.dump(computed(json.load(sys.stdin), Runs(folder)), sys.stdout)
