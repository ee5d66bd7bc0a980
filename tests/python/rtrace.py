"""Illuminances at points by RADIANCE's rtrace (through pyradiance): a JSON object in, one out.

In, all axes with +Y up and in metres, all light in three channels that nothing mixes:
triangles: rows of nine coordinates and the number of a material; materials: rows of reflectances (Lambertian on both sides);
sky: radiances for elevations 0 to 90 degrees (rows) and azimuths 0 to 360 degrees from -Z over +X (columns), evenly spaced;
suns: rows of a unit vector toward a sun that is a point, and its illuminances;
ground: null, or height, albedo, extent and far: beyond `extent` [m] around the origin, the radiance of the plane where it lies open;
panes: rows of nine coordinates of a triangle and the share of light that the glass leaves on one way along its normal (may be absent);
points: rows of a place and a normal; ab, ad: the bounces and the divisions of a hemisphere; repeats: a list, how many hemispheres
each point has; n: processes.

Out: illuminances, the standard deviation of one hemisphere's, the seconds that rtrace took, and its command line.

Paths are traced without a cache (-aa 0). A weight limit that lets every division live is -lw below 0.8 / ad; below it rtrace
ends paths by Russian roulette, which does not move the mean. It sums in single precision: with a million divisions, each a
millionth of the sum, whole per mille are lost in rounding. So a point has several hemispheres of at most 65536, each with other
random numbers (-u+), and their mean is taken here.
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

# The direction of a ray as elevation and azimuth [degrees] in RADIANCE's axes: X = x, Y = -z, Z = y.
DIRECTIONS = """
elevation = asin(if(Dz - 1, 1, Dz)) * 180 / PI;
azimuth = if(atan2(Dx, Dy), atan2(Dx, Dy), atan2(Dx, Dy) + 2 * PI) * 180 / PI;
red(r, g, b) = r;
green(r, g, b) = g;
blue(r, g, b) = b;
"""
# Half the angle under which a point sun is seen [degrees].
SUN = 0.0005


def turned(x, y, z):
    return x, -z, y


def row(values):
    return " ".join(f"{v:.9g}" for v in values)


def table(sky, channel):
    rows, columns = len(sky), len(sky[0])
    lines = ["2", f"0 90 {rows}", f"0 360 {columns}"]
    lines += [row(value[channel] for value in line) for line in sky]
    return "\n".join(lines) + "\n"


def description(given):
    parts = []
    for i, reflectance in enumerate(given["materials"]):
        parts.append(f"void plastic m{i} 0 0 5 {row(reflectance)} 0 0")
    for i, triangle in enumerate(given["triangles"]):
        corners = [turned(*triangle[k : k + 3]) for k in (0, 3, 6)]
        numbers = " ".join(f"{v:.12g}" for corner in corners for v in corner)
        parts.append(f"m{int(triangle[9])} polygon t{i} 0 0 9 {numbers}")
    for i, pane in enumerate(given.get("panes", [])):
        corners = [turned(*pane[k : k + 3]) for k in (0, 3, 6)]
        numbers = " ".join(f"{v:.12g}" for corner in corners for v in corner)
        parts.append(f"void glass g{i} 0 0 3 {row([pane[9]] * 3)}\ng{i} polygon p{i} 0 0 9 {numbers}")
    for i, sun in enumerate(given["suns"]):
        solid_angle = 2 * math.pi * (1 - math.cos(math.radians(SUN)))
        radiance = [e / solid_angle for e in sun[3:6]]
        parts.append(f"void light l{i} 0 0 3 {row(radiance)}")
        parts.append(f"l{i} source sun{i} 0 0 4 {row(turned(*sun[:3]))} {2 * SUN}")
    parts.append(
        "void colordata pattern 9 red green blue r.dat g.dat b.dat directions.cal elevation azimuth 0 0\n"
        "pattern glow sky 0 0 4 1 1 1 0\nsky source dome 0 0 4 0 0 1 180"
    )
    ground = given["ground"]
    if ground:
        parts.append(f"void plastic earth 0 0 5 {row(ground['albedo'])} 0 0")
        parts.append(f"earth ring plain 0 0 8 0 0 {ground['height']} 0 0 1 0 {ground['extent']}")
        parts.append(f"void glow far 0 0 4 {row(ground['far'])} 0\nfar source beyond 0 0 4 0 0 -1 180")
    return "\n".join(parts) + "\n"


def traced(given):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for channel, name in enumerate(["r.dat", "g.dat", "b.dat"]):
            (folder / name).write_text(table(given["sky"], channel))
        (folder / "directions.cal").write_text(DIRECTIONS)
        (folder / "scene.rad").write_text(description(given))
        octree = folder / "scene.oct"
        with octree.open("wb") as out:
            subprocess.run([ROOT / "bin/oconv", "-n", "30", "scene.rad"], check=True, stdout=out, cwd=folder)
        rays = "".join(
            f"{row(turned(*point[:3]))} {row(turned(*point[3:6]))}\n" * repeats
            for point, repeats in zip(given["points"], given["repeats"], strict=True)
        )
        ab, ad = given["ab"], given["ad"]
        options = [
            *("-I", "-h", "-w-", "-fad", "-u+", "-n", given.get("n", 1)),
            *("-ab", ab, "-ad", ad, "-aa", 0, "-as", 0, "-lr", -2 * ab, "-lw", 0.4 / ad),
            *("-dt", 0, "-dc", 1, "-dj", 0, "-ds", 0, "-dr", 0),
        ]
        command = ["rtrace", *map(str, options)]
        begin = time.perf_counter()
        out = subprocess.run(
            [ROOT / "bin" / command[0], *command[1:], octree.name],
            check=True,
            stdout=subprocess.PIPE,
            cwd=folder,
            input=rays.encode(),
        ).stdout
        seconds = time.perf_counter() - begin
    each = np.split(np.frombuffer(out).reshape(-1, 3), np.cumsum(given["repeats"])[:-1])
    return {
        "illuminances": [rows.mean(axis=0).tolist() for rows in each],
        "spread": [rows.std(axis=0, ddof=min(1, len(rows) - 1)).tolist() for rows in each],
        "seconds": seconds,
        "command": " ".join(command),
    }


json.dump(traced(json.load(sys.stdin)), sys.stdout)
