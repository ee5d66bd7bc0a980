"""Skies by RADIANCE's gendaylit and gensky (through pyradiance) and by pvlib: a JSON object of tasks in, the same keys with results out.

gendaylit: rows of direct-normal and diffuse-horizontal irradiance [W/m2] and solar altitude [degrees]; back come clearness,
brightness, a to e, the factor of its luminances [cd/m2], the direct-normal illuminance [lx], and the extraterrestrial factor of the
day that `-ang` takes.
clear: rows of apparent solar elevation [degrees], air mass at the site's pressure, Linke turbidity, height of the site [m] and
extraterrestrial irradiance [W/m2]; back come direct-normal and diffuse-horizontal irradiance by Ineichen & Perez, as in pvlib.
gensky: the zenith's luminance for a horizontal illuminance of 100, and the luminance of a direction over it.
"""

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import pyradiance
from pvlib import clearsky

ROOT = Path(pyradiance.__file__).parent
os.environ["RAYPATH"] = str(ROOT / "lib")


def run(program, *arguments):
    return subprocess.run(
        [ROOT / "bin" / program, *map(str, arguments)], check=True, capture_output=True, text=True
    ).stdout


def gendaylit(rows):
    day = 0  # what gendaylit takes with -ang
    g = 2 * math.pi * (day - 1) / 365
    eccentricity = (
        1.00011 + 0.034221 * math.cos(g) + 0.00128 * math.sin(g) + 0.000719 * math.cos(2 * g) + 0.000077 * math.sin(2 * g)
    )
    results = []
    for direct, diffuse, altitude in rows:
        # Azimuth 0 is south; output in candela per square metre.
        lines = run("gendaylit", "-ang", altitude, 0, "-W", direct, diffuse, "-O", 2).splitlines()
        state = [line for line in lines if "epsilon, delta" in line]
        if not state:  # its "error sky"
            results.append(None)
            continue
        state = state[0].split(":")[1].split()
        numbers = next(line for line in lines if line.startswith("10 ")).split()[1:]
        # The sun's luminance, and the width of its disc [degrees].
        sun = [next((l.split()[1:] for l in lines[i:] if l.startswith(n)), None) for n, i in (("3 ", 0), ("4 ", 0))]
        lux = 0.0
        if sun[0] and sun[1]:
            lux = float(sun[0][0]) * 2 * math.pi * (1 - math.cos(math.radians(float(sun[1][3]) / 2)))
        results.append(
            {
                "clearness": float(state[0]),
                "brightness": float(state[1]),
                "factor": float(numbers[0]),
                "direct": lux,
                "coefficients": [float(v) for v in numbers[2:7]],
                "eccentricity": eccentricity,
            }
        )
    return results


def gensky(rows):
    """Rows of flag (-c overcast, -u uniform, +s clear), solar altitude, view azimuth from the sun's and elevation [degrees]."""
    results = []
    for flag, altitude, azimuth, elevation in rows:
        lines = run("gensky", "-ang", altitude, 0, flag, "-B", 100).splitlines()
        kind, zenith, _, *rest = map(float, [n for n in lines if n[:2] in ("3 ", "7 ")][-1].split()[1:])
        dz = math.sin(math.radians(elevation))
        if kind == 1:
            sun = math.radians(altitude)
            cos_gamma = math.sin(sun) * dz + math.cos(sun) * math.cos(math.radians(elevation)) * math.cos(
                math.radians(azimuth)
            )
            # sunnysky of skybright.cal, normalised by its own argument.
            shape = 0.91 + 10 * math.exp(-3 * math.acos(cos_gamma)) + 0.45 * cos_gamma**2
            ratio = shape * (1 - math.exp(-0.32 / dz)) / rest[0]
        else:
            ratio = {2: (1 + 2 * dz) / 3, 3: 1.0}[kind]
        results.append([zenith, ratio])
    return results


def clear(rows):
    """Rows of elevation, absolute air mass, Linke turbidity, altitude, extraterrestrial irradiance."""
    results = []
    for elevation, mass, linke, altitude, extraterrestrial in rows:
        sky = clearsky.ineichen(90 - elevation, mass, linke, altitude=altitude, dni_extra=extraterrestrial)
        results.append([float(sky["dni"]), float(sky["dhi"])])
    return results


TASKS = {"gendaylit": gendaylit, "gensky": gensky, "clear": clear}
given = json.load(sys.stdin)
json.dump({name: TASKS[name](task) for name, task in given.items()}, sys.stdout)
