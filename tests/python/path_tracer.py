"""Radiances along rays by Mitsuba's path tracer: a JSON object in, one out.

In, all axes with +Y up and in metres, all light in three channels that nothing mixes: triangles, materials, sky, suns and ground as
rtrace.py has them, without points; rays: rows of an origin and a direction; samples: paths of each ray in one half; depth: the most
surfaces of a path. The ground is a square plate of `extent` [m] each way, and beyond it what lies below the horizon has the radiance
`far`.

Out: radiances along the rays, from two halves with other random numbers; the seconds that they took.
"""

import json
import sys
import time

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

# The environment's texels: columns at (i + 0.5) / WIDTH of the way round, rows from pole to pole, the middle one on the horizon.
WIDTH, HEIGHT = 2048, 1025


def environment(sky, far):
    """Radiances by elevation and azimuth, and what lies below the horizon, as Mitsuba has them: azimuth from -Z over +X."""
    table = np.array(sky)
    rows, columns = table.shape[0] - 1, table.shape[1] - 1
    elevation = 90 - 180 * np.arange(HEIGHT) / (HEIGHT - 1)
    v = np.clip(elevation, 0, 90) / 90 * rows
    u = (np.arange(WIDTH) + 0.5) / WIDTH * columns
    i, j = np.minimum(v.astype(int), rows - 1), np.minimum(u.astype(int), columns - 1)
    s, t = (v - i)[:, None, None], (u - j)[None, :, None]
    texels = (1 - s) * ((1 - t) * table[i][:, j] + t * table[i][:, j + 1]) + s * (
        (1 - t) * table[i + 1][:, j] + t * table[i + 1][:, j + 1]
    )
    texels[elevation < 0] = far
    return texels.astype(np.float32)


def mesh(name, corners, bsdf):
    props = mi.Properties()
    props["bsdf"] = bsdf
    made = mi.Mesh(name, 3 * len(corners), len(corners), props=props)
    params = mi.traverse(made)
    params["vertex_positions"] = np.array(corners, dtype=np.float32).ravel()
    params["faces"] = np.arange(3 * len(corners), dtype=np.uint32)
    params.update()
    return made


def lambertian(reflectance):
    colour = {"type": "rgb", "value": list(reflectance)}
    return mi.load_dict({"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": colour}})


def world(given):
    scene = {"type": "scene"}
    for k, reflectance in enumerate(given["materials"]):
        corners = [t[:9] for t in given["triangles"] if t[9] == k]
        if corners:
            scene[f"surface{k}"] = mesh(f"surface{k}", corners, lambertian(reflectance))
    ground = given["ground"]
    far = ground["far"] if ground else [0, 0, 0]
    if ground:
        e, y = ground["extent"], ground["height"]
        corners = [[-e, y, -e, -e, y, e, e, y, e], [-e, y, -e, e, y, e, e, y, -e]]
        scene["ground"] = mesh("ground", corners, lambertian(ground["albedo"]))
    for k, sun in enumerate(given["suns"]):
        scene[f"sun{k}"] = {
            "type": "directional",
            "direction": [-v for v in sun[:3]],
            "irradiance": {"type": "rgb", "value": sun[3:6]},
        }
    scene["sky"] = {"type": "envmap", "bitmap": mi.Bitmap(environment(given["sky"], far)), "scale": 1.0}
    return mi.load_dict(scene)


def sensor(rays):
    """One pixel a ray, side by side."""
    film = {"type": "hdrfilm", "width": 1, "height": 1, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    batch = {"type": "batch", "film": {**film, "width": len(rays), "component_format": "float32"}}
    for i, ray in enumerate(rays):
        batch[f"ray{i:06}"] = {
            "type": "radiancemeter",
            "origin": ray[:3],
            "direction": ray[3:6],
            "film": film,
        }
    return mi.load_dict(batch)


def traced(given):
    scene, meters = world(given), sensor(given["rays"])
    integrator = mi.load_dict({"type": "path", "max_depth": given["depth"], "rr_depth": 6})
    begin = time.perf_counter()
    halves = []
    for half in range(2):
        picture = mi.render(scene, sensor=meters, integrator=integrator, spp=given["samples"], seed=half + 1)
        halves.append(np.array(picture).reshape(-1, 3).tolist())
    return {"halves": halves, "seconds": time.perf_counter() - begin}


json.dump(traced(json.load(sys.stdin)), sys.stdout)
