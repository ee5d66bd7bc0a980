"""An environment map of 4096 x 2048, by tyndall and by mitsuba's `sunsky` (both Hosek & Wilkie's sky), in one run.

    cargo build --release && python benches/sky_mitsuba.py [--runs 5]

with a Python that has mitsuba (tests/python/requirements.txt; `cargo xtask test` makes one under target/python). mitsuba's
LLVM backend needs a recent LLVM: name its library in DRJIT_LIBLLVM_PATH where the system's is too old. Times are medians.
"Whole process" is from starting the program to a finished file, mitsuba's kernels being compiled and cached before.
"""

import argparse
import json
import math
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

WIDTH, HEIGHT = 4096, 2048
ELEVATION = 30.0
TYNDALL = Path(__file__).parent.parent / "target" / "release" / "tyndall"


def mitsuba_map():
    """The emitter's radiance in every texel, evaluated but not fetched."""
    import drjit as dr
    import mitsuba as mi

    if not mi.variant():
        mi.set_variant("llvm_ad_rgb")
    height = math.radians(ELEVATION)
    toward_sun = [math.cos(height), 0.0, math.sin(height)]
    emitter = mi.load_dict({"type": "sunsky", "turbidity": 3.0, "albedo": 0.2, "sun_direction": toward_sun})

    def evaluate():
        texel = dr.arange(mi.UInt32, WIDTH * HEIGHT)
        azimuth = ((mi.Float(texel % WIDTH) + 0.5) / WIDTH - 0.5) * 2 * dr.pi
        zenith_angle = (mi.Float(texel // WIDTH) + 0.5) / HEIGHT * dr.pi
        (sin, cos), (sin_a, cos_a) = dr.sincos(zenith_angle), dr.sincos(azimuth)
        seen = dr.zeros(mi.SurfaceInteraction3f, WIDTH * HEIGHT)
        seen.wi = -mi.Vector3f(sin * cos_a, sin * sin_a, cos)
        colours = emitter.eval(seen)
        dr.eval(colours)
        dr.sync_thread()
        return colours

    return evaluate


def mitsuba_once(path):
    import drjit as dr
    import mitsuba as mi

    colours = mitsuba_map()()
    if path:
        mi.Bitmap(mi.TensorXf(dr.ravel(colours), (HEIGHT, WIDTH, 3))).write(path)


def median(runs, work):
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--once", nargs="?", const="")
    arguments = parser.parse_args()
    if arguments.once is not None:
        return mitsuba_once(arguments.once)

    evaluate = mitsuba_map()
    evaluate()
    evaluate()
    rows = []
    study = subprocess.run([TYNDALL, "accuracy", "--effect", "sky", "--json"], capture_output=True, check=True)
    prices = {price["setting"]: price for price in json.loads(study.stdout)}
    rows.append(("evaluation, warm", prices[f"{WIDTH}x{HEIGHT} hosek"]["seconds"], median(arguments.runs, evaluate)))

    def quietly(*command):
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    with tempfile.TemporaryDirectory() as folder:
        sky = [TYNDALL, "sky", "--sky", "hosek", "--sun", f"90,{ELEVATION}", "--size", f"{WIDTH}x{HEIGHT}"]
        for name in ["map.hdr", "map.exr"]:
            path = str(Path(folder) / name)
            ours = median(arguments.runs, lambda: quietly(*sky, "-o", path))
            theirs = median(arguments.runs, lambda: quietly(sys.executable, __file__, "--once", path))
            rows.append((f"whole process, {name[-3:].upper()}", ours, theirs))
        theirs = median(arguments.runs, lambda: quietly(sys.executable, __file__, "--once"))
        rows.append(("whole process, nothing written", None, theirs))

    print(f"{'map of 4096 x 2048':<32}{'tyndall':>10}{'mitsuba':>10}{'ratio':>8}")
    for name, ours, theirs in rows:
        if ours is None:
            print(f"{name:<32}{'':>10}{theirs:>8.3f} s")
        else:
            print(f"{name:<32}{ours:>8.3f} s{theirs:>8.3f} s{theirs / ours:>8.1f}")


if __name__ == "__main__":
    main()
