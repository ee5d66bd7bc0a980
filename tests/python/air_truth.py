"""Light of sky and surfaces scattered once by boxes of fog toward a camera, by quasi Monte Carlo over mitsuba's ray caster.

JSON in: `triangles` (9 numbers each), `albedo` (one a triangle), `boxes` (min, max, scattering, extinction, g of Henyey and
Greenstein), `sky` (rows from horizon to zenith, columns by azimuth from +X toward +Z: radiance at nodes; without a ground
nothing comes from below), `camera` (eye, right, up, forward, tangents of half the width and height), `size`, `block`: pixels
along each side of what a mean is taken over, `samples` a block. JSON out: the means of two halves, block by block.

A sample is a pixel of the block, a place of its ray, a direction from there, and a path over diffuse surfaces until it comes to
the sky. Media weaken every leg. The first five numbers of a sample are a Kronecker sequence, shifted by chance in each block
and half; what a path does at surfaces is random.
"""

import json
import sys

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
import drjit as dr  # noqa: E402  (after the variant)

task = json.load(sys.stdin)
corners = np.array(task["triangles"], dtype=np.float32).reshape(-1, 3)
mesh = mi.Mesh("scene", len(corners), len(corners) // 3)
parameters = mi.traverse(mesh)
parameters["vertex_positions"] = mi.Float(corners.ravel())
parameters["faces"] = mi.UInt32(np.arange(len(corners), dtype=np.uint32))
parameters.update()
scene = mi.load_dict({"type": "scene", "mesh": mesh})
albedos = mi.Float(np.array(task["albedo"], dtype=np.float32))
sky = np.array(task["sky"], dtype=np.float32)
rows, columns = sky.shape
table = mi.Float(sky.ravel())
camera = task["camera"]
boxes = task["boxes"]
BOUNCES = 64
BATCH = 1 << 21


# drjit's own minimum, maximum and atan2 need a newer LLVM than many systems have.
def least(a, b):
    return dr.select(a < b, a, b)


def most(a, b):
    return dr.select(a > b, a, b)


def on_sphere(u, v):
    """Directions of even density."""
    z = 2 * u - 1
    level = dr.sqrt(most(0, 1 - z * z))
    return mi.Vector3f(level * dr.cos(2 * dr.pi * v), z, level * dr.sin(2 * dr.pi * v))


def chord(box, origin, direction, end):
    """Where a ray enters and leaves a box, at most `end` away; the same twice where it does not."""
    low, high = mi.Vector3f(*box["min"]), mi.Vector3f(*box["max"])
    enter, leave = mi.Float(0), end
    for axis in range(3):
        along = dr.select(dr.abs(direction[axis]) < 1e-9, 1e-9, direction[axis])
        a, b = (low[axis] - origin[axis]) / along, (high[axis] - origin[axis]) / along
        enter, leave = most(enter, least(a, b)), least(leave, most(a, b))
    return enter, most(enter, leave)


def through(origin, direction, distance):
    """What the media let through."""
    depth = mi.Float(0)
    for box in boxes:
        enter, leave = chord(box, origin, direction, distance)
        depth += box["extinction"] * (leave - enter)
    return dr.exp(-depth)


def phase(g, mu):
    square = 1 + g * g - 2 * g * mu
    return (1 - g * g) / (4 * dr.pi * square * dr.sqrt(square))


def radiance(direction):
    """Of the sky."""
    up = most(0, least(direction.y, 0.9999999))
    y = dr.asin(up) / (dr.pi / 2) * (rows - 1)
    level = dr.sqrt(1 - up * up)
    angle = dr.acos(most(-1, least(1, direction.x / level))) / (2 * dr.pi)
    x = dr.select(direction.z >= 0, angle, 1 - angle) * columns
    i = mi.UInt32(y)
    i = dr.select(i < rows - 2, i, rows - 2)
    j = mi.UInt32(x) % columns
    f, h = y - mi.Float(i), x - dr.floor(x)
    at = lambda i, j: dr.gather(mi.Float, table, i * columns + j % columns)
    low = at(i, j) * (1 - h) + at(i, j + 1) * h
    high = at(i + 1, j) * (1 - h) + at(i + 1, j + 1) * h
    return dr.select(direction.y >= 0, low * (1 - f) + high * f, 0)


def incoming(origin, direction, sampler):
    """Radiance that comes to a place."""
    found, weight = mi.Float(0), mi.Float(1)
    for _ in range(BOUNCES):
        hit = scene.ray_intersect_preliminary(mi.Ray3f(origin, direction), coherent=False)
        met = hit.is_valid()
        distance = dr.select(met, hit.t, 1e6)
        # Paths that have ended lie nowhere: what is found of them is no number.
        weight = dr.select(weight > 0, weight * through(origin, direction, distance), 0)
        found += dr.select(met | (weight <= 0), 0, weight * radiance(direction))
        albedo = dr.gather(mi.Float, albedos, hit.prim_index, met)
        weight = dr.select(met, weight * albedo, 0)
        if not dr.any(weight > 0):
            break
        # Dark paths end by chance.
        going = least(1, weight)
        weight = dr.select(sampler.next_1d() < going, weight / going, 0)
        vertex = lambda k: dr.gather(
            mi.Point3f, parameters["vertex_positions"], 3 * hit.prim_index + k, met
        )
        a = vertex(0)
        normal = dr.normalize(dr.cross(vertex(1) - a, vertex(2) - a))
        normal = dr.select(dr.dot(normal, direction) > 0, -normal, normal)
        origin = origin + distance * direction + 1e-4 * normal
        # A hair less than 1 keeps the sum off zero.
        around = 0.999999 * on_sphere(sampler.next_1d(), sampler.next_1d())
        direction = dr.normalize(normal + around)
        dr.eval(origin, direction, weight, found)
    return found


def sample(block, number, shift, sampler):
    """Light of one sample of each block."""
    eye, right, up, forward = (
        mi.Vector3f(*camera[name]) for name in ["eye", "right", "up", "forward"]
    )
    # Powers of the root of x^6 = x + 1 (Roberts 2018).
    root = 1.1347241384015194
    steps = [int((1 / root ** (k + 1)) * 2**32) for k in range(5)]
    u = [
        mi.Float(number * mi.UInt32(steps[k]) + dr.gather(mi.UInt32, shift[k], block)) * 2.0**-32
        for k in range(5)
    ]
    width, height = task["size"]
    side = task["block"]
    across = width // side
    # The centres of pixels.
    x = (mi.Float(block % across) * side + dr.floor(u[0] * side) + 0.5) / width * 2 - 1
    y = 1 - (mi.Float(block // across) * side + dr.floor(u[1] * side) + 0.5) / height * 2
    direction = dr.normalize(
        forward + right * (x * camera["tan_x"]) + up * (y * camera["tan_y"])
    )
    first = scene.ray_intersect_preliminary(mi.Ray3f(mi.Point3f(eye), direction), coherent=False)
    end = dr.select(first.is_valid(), first.t, 1e6)
    enter, leave = mi.Float(dr.inf), mi.Float(0)
    for box in boxes:
        a, b = chord(box, eye, direction, end)
        enter = dr.select(b > a, least(enter, a), enter)
        leave = dr.select(b > a, most(leave, b), leave)
    length = dr.select(leave > enter, leave - enter, 0)
    t = dr.select(length > 0, enter + u[2] * length, 0)
    place = eye + t * direction
    toward = on_sphere(u[3], u[4])
    mu = dr.dot(direction, toward)
    source = mi.Float(0)
    for box in boxes:
        low, high = mi.Vector3f(*box["min"]), mi.Vector3f(*box["max"])
        inside = dr.all((place >= low) & (place <= high))
        source += dr.select(inside, box["scattering"] * phase(box["g"], mu), 0)
    weight = length * source * through(eye, direction, t) * 4 * dr.pi
    return weight * incoming(mi.Point3f(place), toward, sampler)


def main():
    width, height = task["size"]
    blocks = (width // task["block"]) * (height // task["block"])
    random = np.random.default_rng(7)
    halves = []
    for half in range(2):
        shift = [mi.UInt32(random.integers(0, 2**32, blocks, dtype=np.uint32)) for _ in range(5)]
        total = np.zeros(blocks)
        at_once = max(1, BATCH // blocks)
        done = 0
        while done < task["samples"] // 2:
            count = min(at_once, task["samples"] // 2 - done)
            index = dr.arange(mi.UInt32, blocks * count)
            block = index % blocks
            sampler = mi.load_dict({"type": "independent"})
            sampler.seed(1 + done + half * task["samples"], blocks * count)
            found = sample(block, index // blocks + done, shift, sampler)
            sums = dr.zeros(mi.Float, blocks)
            dr.scatter_reduce(dr.ReduceOp.Add, sums, found, block)
            total += sums.numpy().astype(np.float64)
            done += count
        halves.append((total / done).tolist())
    print(json.dumps(halves))


main()
