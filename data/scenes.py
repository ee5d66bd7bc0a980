"""Writes the scenes with lamps of data/scenes, which are built into the library: python data/scenes.py

Python's own library is enough. Metres, +Y up. Numbers are rounded so that every machine writes the same bytes.
"""

import json
import math
import struct
import sys
import zlib
from pathlib import Path

HERE = Path(__file__).parent / "scenes"


# Vectors and triangles


def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def scaled(a, s):
    return tuple(x * s for x in a)


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    length = math.sqrt(dot(a, a))
    return scaled(a, 1.0 / length) if length > 0.0 else a


def rounded(x):
    """To a tenth of a millimetre, so that the last bits of a platform's sine do not show."""
    return round(x * 8192.0) / 8192.0 + 0.0


class Mesh:
    """Triangles by material; corners that lie at one place and are marked smooth share a normal."""

    def __init__(self):
        self.faces = {}

    def triangle(self, material, corners, uvs=None, smooth=False):
        a, b, c = corners
        if math.sqrt(dot(cross(sub(b, a), sub(c, a)), cross(sub(b, a), sub(c, a)))) > 1e-9:
            self.faces.setdefault(material, []).append((corners, uvs or [(0.0, 0.0)] * 3, smooth))

    def quad(self, material, a, b, c, d, uvs=None, smooth=False):
        """Counter-clockwise seen from the front."""
        t = uvs or [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)]
        self.triangle(material, [a, b, c], [t[0], t[1], t[2]], smooth)
        self.triangle(material, [a, c, d], [t[0], t[2], t[3]], smooth)

    def block(self, material, low, high):
        at = lambda i: tuple((high if i >> k & 1 else low)[k] for k in range(3))
        for side in [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]:
            self.quad(material, *(at(i) for i in side))

    def grid(self, material, rows, closed=False):
        """A smooth surface through rows of points; its front is where a row turns to the next counter-clockwise."""
        for low, high in zip(rows, rows[1:]):
            count = len(low)
            for i in range(count if closed else count - 1):
                j = (i + 1) % count
                self.quad(material, low[i], low[j], high[j], high[i], smooth=True)

    def lathe(self, material, foot, profile, segments=32):
        """A surface of revolution about the vertical through `foot`; `profile` is radius and height, from below."""
        rows = []
        for radius, height in profile:
            turn = [2.0 * math.pi * i / segments for i in range(segments)]
            rows.append([add(foot, (radius * math.cos(t), height, -radius * math.sin(t))) for t in turn])
        self.grid(material, rows, closed=True)

    def tube(self, material, path, radii, across, segments=12):
        """A tube along a path in a plane to which `across` is normal."""
        rows = []
        for i, (point, radius) in enumerate(zip(path, radii)):
            ahead = unit(sub(path[min(i + 1, len(path) - 1)], path[max(i - 1, 0)]))
            side = cross(across, ahead)
            turn = [2.0 * math.pi * k / segments for k in range(segments)]
            rows.append(
                [add(point, add(scaled(side, radius * math.cos(t)), scaled(across, -radius * math.sin(t)))) for t in turn]
            )
        self.grid(material, rows, closed=True)


# Files


def png(width, height, texel):
    """A picture of what `texel` gives of x and y: sRGB, 0 to 255."""
    rows = b"".join(
        b"\0" + bytes(max(0, min(255, round(c))) for x in range(width) for c in texel(x, y)) for y in range(height)
    )
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    # Stored, not compressed: what zlib makes of data differs from version to version.
    stored = b"\x78\x01"
    blocks = [rows[i : i + 65535] for i in range(0, len(rows), 65535)]
    for i, block in enumerate(blocks):
        stored += struct.pack("<BHH", i == len(blocks) - 1, len(block), len(block) ^ 0xFFFF) + block
    stored += struct.pack(">I", zlib.adler32(rows))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", stored) + chunk(b"IEND", b"")


def material(name, color, **rest):
    """A Lambertian material of glTF; `rest` are further properties."""
    pbr = {"baseColorFactor": [*color, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0}
    return {"name": name, "pbrMetallicRoughness": pbr, **rest}


def glb(mesh, materials, images=()):
    """A GLB of one mesh. Materials that name a texture get texture coordinates."""
    data, views, accessors = bytearray(), [], []

    def view(content):
        data.extend(b"\0" * (-len(data) % 4))
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(content)})
        data.extend(content)
        return len(views) - 1

    def accessor(content, count, component, kind, **rest):
        accessors.append(
            {"bufferView": view(content), "componentType": component, "count": count, "type": kind, **rest}
        )
        return len(accessors) - 1

    primitives = []
    for number, entry in enumerate(materials):
        faces = mesh.faces.get(entry["name"], [])
        key = lambda p: tuple(rounded(x) for x in p)
        around = {}
        for corners, _, smooth in faces:
            a, b, c = corners
            if smooth:
                for p in corners:
                    around[key(p)] = add(around.get(key(p), (0.0,) * 3), cross(sub(b, a), sub(c, a)))
        textured = "Texture" in json.dumps(entry) or entry.get("extras", {}).get("textured", False)
        known, positions, normals, uvs, indices = {}, [], [], [], []
        for corners, coordinates, smooth in faces:
            a, b, c = corners
            own = unit(cross(sub(b, a), sub(c, a)))
            for p, uv in zip(corners, coordinates):
                normal = tuple(rounded(x) for x in (unit(around[key(p)]) if smooth else own))
                vertex = (key(p), normal, uv if textured else None)
                if vertex not in known:
                    known[vertex] = len(positions)
                    positions.append(key(p))
                    normals.append(normal)
                    uvs.append(uv)
                indices.append(known[vertex])
        floats = lambda rows: b"".join(struct.pack(f"<{len(r)}f", *r) for r in rows)
        low = [min(p[k] for p in positions) for k in range(3)]
        high = [max(p[k] for p in positions) for k in range(3)]
        count = len(positions)
        attributes = {
            "POSITION": accessor(floats(positions), count, 5126, "VEC3", min=low, max=high),
            "NORMAL": accessor(floats(normals), count, 5126, "VEC3"),
        }
        if textured:
            attributes["TEXCOORD_0"] = accessor(floats(uvs), count, 5126, "VEC2")
        wide = count > 65535
        packed = struct.pack(f"<{len(indices)}{'I' if wide else 'H'}", *indices)
        indices = accessor(packed, len(indices), 5125 if wide else 5123, "SCALAR")
        primitives.append({"attributes": attributes, "indices": indices, "material": number})
    extensions = sorted({name for entry in materials for name in entry.get("extensions", {})})
    document = {
        "asset": {"version": "2.0", "generator": "tyndall, data/scenes.py"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": primitives}],
        "materials": materials,
    }
    if images:
        document["images"] = [{"bufferView": view(image), "mimeType": "image/png"} for image in images]
        document["textures"] = [{"source": i} for i in range(len(images))]
    if extensions:
        document["extensionsUsed"] = extensions
    document |= {"accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(data)}]}
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    data.extend(b"\0" * (-len(data) % 4))
    body = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + bytes(data)
    return b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body


def ies(name, lumens, planes, angles, candela):
    """An IES LM-63 file, type C, of candela by plane and angle, made to have that flux."""
    lines = [
        "IESNA:LM-63-2002",
        "[TEST] none: made by a formula",
        "[MANUFAC] tyndall",
        f"[LUMINAIRE] {name}",
        "TILT=NONE",
    ]
    flux = 0.0
    for i, c in enumerate(planes):
        width = (planes[1] - planes[0]) if len(planes) > 1 else 360.0
        share = width * (0.5 if i in (0, len(planes) - 1) and len(planes) > 1 else 1.0)
        share *= 360.0 / (planes[-1] - planes[0]) if len(planes) > 1 else 1.0
        fine = 2000
        for k in range(fine):
            t = angles[0] + (angles[-1] - angles[0]) * (k + 0.5) / fine
            step = math.radians((angles[-1] - angles[0]) / fine)
            j = max(0, min(len(angles) - 2, next((m for m, a in enumerate(angles) if a > t), len(angles) - 1) - 1))
            f = (t - angles[j]) / (angles[j + 1] - angles[j])
            value = (1.0 - f) * candela(c, angles[j]) + f * candela(c, angles[j + 1])
            flux += value * math.sin(math.radians(t)) * step * math.radians(share)
    factor = lumens / flux
    lines.append(f"1 {lumens:.0f} 1 {len(angles)} {len(planes)} 1 2 0.3 0.3 0.1")
    lines.append("1 1 60")
    lines.append(" ".join(f"{a:g}" for a in angles))
    lines.append(" ".join(f"{c:g}" for c in planes))
    for c in planes:
        lines.append(" ".join(f"{factor * candela(c, a):.1f}" for a in angles))
    return ("\r\n".join(lines) + "\r\n").encode()


# Scenes


def teapot(mesh, name, foot, size):
    """A pot of revolution with lid, spout and handle; `size` is its greatest radius."""
    s = size
    body = [
        (0.0, 0.0), (0.55, 0.0), (0.62, 0.02), (0.64, 0.06), (0.80, 0.16), (0.93, 0.30), (0.99, 0.46), (1.0, 0.62),
        (0.95, 0.80), (0.84, 0.96), (0.70, 1.09), (0.60, 1.16), (0.57, 1.20), (0.60, 1.23), (0.585, 1.25), (0.52, 1.25),
    ]
    lid = [
        (0.54, 1.245), (0.52, 1.28), (0.44, 1.34), (0.30, 1.39), (0.14, 1.42), (0.075, 1.44), (0.065, 1.48),
        (0.11, 1.54), (0.135, 1.60), (0.11, 1.66), (0.05, 1.695), (0.0, 1.70),
    ]
    for profile in (body, lid):
        mesh.lathe(name, foot, [(s * r, s * h) for r, h in profile], 40)
    curve = lambda points: [add(foot, (s * x, s * y, 0.0)) for x, y in points]
    spout = [(0.80, 0.42), (1.06, 0.50), (1.27, 0.66), (1.41, 0.88), (1.53, 1.09), (1.70, 1.22)]
    mesh.tube(name, curve(spout), [s * r for r in (0.26, 0.21, 0.165, 0.13, 0.105, 0.11)], (0.0, 0.0, 1.0), 16)
    bow = [math.radians(a) for a in range(66, 291, 14)]
    handle = [(-0.93 + 0.52 * math.cos(a), 0.69 + 0.37 * math.sin(a)) for a in bow]
    mesh.tube(name, curve(handle), [s * 0.075] * len(handle), (0.0, 0.0, 1.0), 12)


def teapot_scene():
    mesh = Mesh()
    mesh.quad("floor", (-8.0, 0.0, 5.0), (8.0, 0.0, 5.0), (8.0, 0.0, -8.0), (-8.0, 0.0, -8.0))
    mesh.quad("wall", (-8.0, 0.0, -5.0), (8.0, 0.0, -5.0), (8.0, 6.0, -5.0), (-8.0, 6.0, -5.0))
    table = [(0.0, 0.0), (0.55, 0.0), (0.55, 0.05), (0.12, 0.12), (0.10, 0.70), (0.14, 0.74), (1.15, 0.76), (1.18, 0.78), (1.18, 0.82), (1.15, 0.84), (0.0, 0.84)]
    mesh.lathe("table", (0.0, 0.0, 0.0), table, 48)
    teapot(mesh, "pot", (-0.08, 0.84, 0.0), 0.46)
    materials = [
        material("floor", (0.30, 0.26, 0.23)),
        material("wall", (0.22, 0.22, 0.25)),
        material("table", (0.32, 0.18, 0.10)),
        material("pot", (0.82, 0.80, 0.74)),
    ]
    scene = """\
# A spotlight on a teapot in fog, after Nishita, Miyawaki & Nakamae 1987.
# Made, with its geometry, by data/scenes.py.
mesh = "teapot.glb"

[camera]
eye = [0.9, 1.7, 3.9]
target = [-0.3, 1.62, 0.0]
fov_y = 42.0

[[light]]
name = "spot"
position = [-2.3, 3.9, -1.1]
toward = [2.25, -2.75, 1.1]
intensity = [5200.0, 4600.0, 3700.0]     # cd
distribution = { kind = "nishita-spot", spread = 12.5, sharpness = 0.35 }

[[light]]
name = "room"                            # what little comes from elsewhere
position = [4.0, 3.6, 3.0]
intensity = [40.0, 50.0, 70.0]

[[medium]]
shape = "box"
min = [-8.0, 0.0, -5.0]
max = [8.0, 6.0, 5.0]
scattering = 0.075
absorption = 0.005
phase = { kind = "henyey-greenstein", g = 0.45 }

[picture]
size = [640, 400]
exposure = 3.7
"""
    return {"teapot.toml": scene.encode(), "teapot.glb": glb(mesh, materials)}


def stage_scene():
    mesh = Mesh()
    mesh.quad("boards", (-7.0, 0.0, 4.0), (7.0, 0.0, 4.0), (7.0, 0.0, -5.0), (-7.0, 0.0, -5.0))
    mesh.block("front", (-7.0, -0.9, 3.9), (7.0, -0.001, 4.0))
    # A curtain in folds.
    rows = []
    for k in range(2):
        row = []
        for i in range(169):
            x = -7.0 + 14.0 * i / 168
            row.append((x, 6.5 * k, -4.6 + 0.16 * math.sin(2.0 * math.pi * x / 0.62) + 0.05 * math.sin(4.1 * x)))
        rows.append(row)
    mesh.grid("curtain", rows)
    for i, (radius, height) in enumerate([(1.5, 0.2), (1.15, 0.4), (0.8, 0.6)]):
        low = 0.2 * i
        mesh.lathe("steps", (0.0, 0.0, -1.6), [(radius, low), (radius, height - 0.02), (radius - 0.02, height), (0.0, height)], 48)
    figure = [
        (0.0, 0.60), (0.34, 0.60), (0.33, 0.75), (0.25, 1.10), (0.185, 1.45), (0.17, 1.58), (0.20, 1.70), (0.225, 1.86),
        (0.20, 1.98), (0.09, 2.05), (0.07, 2.10), (0.105, 2.17), (0.118, 2.26), (0.095, 2.35), (0.05, 2.39), (0.0, 2.40),
    ]
    mesh.lathe("figure", (0.0, 0.0, -1.6), figure, 32)
    for x in (-4.4, 4.4):
        mesh.lathe("steps", (x, 0.0, -2.6), [(0.0, 0.0), (0.42, 0.0), (0.42, 0.12), (0.27, 0.2), (0.24, 3.2), (0.36, 3.32), (0.36, 3.45), (0.0, 3.45)], 32)
        mesh.lathe("figure", (x, 3.45, -2.6), [(0.0, 0.0), (0.2, 0.04), (0.3, 0.14), (0.36, 0.32), (0.33, 0.5), (0.2, 0.64), (0.0, 0.68)], 28)
    mesh.block("front", (-7.0, 6.1, 0.1), (7.0, 6.22, 0.22))
    materials = [
        material("boards", (0.36, 0.25, 0.17)),
        material("front", (0.05, 0.05, 0.06)),
        material("curtain", (0.50, 0.09, 0.09)),
        material("steps", (0.55, 0.53, 0.50)),
        material("figure", (0.85, 0.82, 0.76)),
    ]
    scene = """\
# Five lamps over a stage in haze: a daisy on the figure, dots on the curtain, three coloured spots.
# Made, with its geometry, by data/scenes.py.
mesh = "stage.glb"

[camera]
eye = [0.0, 1.9, 11.0]
target = [0.0, 2.6, 0.0]
fov_y = 34.0

[ground]
enabled = false

[[light]]
name = "daisy"
position = [0.0, 6.0, 0.6]
toward = [0.0, -5.2, -2.1]
around = [0.0, 0.0, -1.0]
intensity = [9000.0, 8200.0, 6600.0]
distribution = { kind = "daisy", spread = 25.0, sharpness = 0.3, petals = 9, ratio = -0.3 }

[[light]]
name = "dots"
position = [0.0, 5.6, 3.4]
toward = [0.0, -1.55, -8.0]
around = [1.0, 0.0, 0.0]
intensity = [4200.0, 4600.0, 5600.0]
distribution = { kind = "polka-dots", spread = 27.0, sharpness = 0.5, petals = 10, ratio = -0.2, rings = 4 }

[[light]]
name = "left"
position = [-5.6, 6.0, 0.4]
toward = [5.6, -4.6, -2.0]
intensity = [900.0, 2900.0, 11000.0]
distribution = { kind = "nishita-spot", spread = 7.0, sharpness = 0.2 }

[[light]]
name = "right"
position = [5.6, 6.0, 0.4]
toward = [-5.6, -4.6, -2.0]
intensity = [10500.0, 1500.0, 4200.0]
distribution = { kind = "nishita-spot", spread = 7.0, sharpness = 0.2 }

[[light]]
name = "side"
position = [-5.0, 6.0, 0.6]
toward = [0.6, -2.5, -3.2]
intensity = [7200.0, 4700.0, 1100.0]
distribution = { kind = "nishita-spot", spread = 8.0, sharpness = 0.2 }

[[medium]]
shape = "box"
min = [-7.0, 0.0, -4.4]
max = [7.0, 6.5, 4.0]
scattering = 0.045
absorption = 0.002
phase = { kind = "henyey-greenstein", g = 0.3 }

[picture]
size = [640, 400]
exposure = 3.2
"""
    return {"stage.toml": scene.encode(), "stage.glb": glb(mesh, materials)}


FONT = {
    "C": "01110 10001 10000 10000 10000 10001 01110",
    "A": "01110 10001 10001 11111 10001 10001 10001",
    "F": "11111 10000 10000 11110 10000 10000 10000",
    "E": "11111 10000 10000 11110 10000 10000 11111",
}


def sign():
    """CAFE in letters of light within a frame: 29 x 13 texels, each 4 x 4."""

    def lit(x, y):
        if x in (1, 27) and 1 <= y <= 11 or y in (1, 11) and 1 <= x <= 27:
            return (40, 90, 255)
        letter, column = divmod(x - 3, 6)
        if 0 <= letter < 4 and column < 5 and 3 <= y < 10:
            if FONT["CAFE"[letter]].split()[y - 3][column] == "1":
                return (255, 96, 48)
        return (0, 0, 0)

    return png(116, 52, lambda x, y: lit(x // 4, y // 4))


def street_scene():
    mesh = Mesh()
    mesh.quad("asphalt", (-4.0, 0.0, 14.0), (4.0, 0.0, 14.0), (4.0, 0.0, -60.0), (-4.0, 0.0, -60.0))
    for side in (-1.0, 1.0):
        low, high = sorted((side * 4.0, side * 7.0))
        mesh.block("pavement", (low, -0.2, -60.0), (high, 0.14, 14.0))
    # Houses, with windows as dark recesses.
    z, k = 14.0, 0
    while z > -60.0:
        depth = (9.0, 7.0, 11.0, 8.0)[k % 4]
        for side in (-1.0, 1.0):
            height = (9.5, 12.0, 8.0, 10.5, 13.0)[(k + (side > 0.0) * 2) % 5]
            wall = ("brick", "plaster")[(k + (side > 0.0)) % 2]
            near, far = side * 7.0, side * 12.0
            mesh.block(wall, (min(near, far), -0.2, z - depth), (max(near, far), height, z))
            for floor in range(int(height / 3.2)):
                for column in range(int(depth / 2.4)):
                    mid = z - depth * (column + 0.5) / int(depth / 2.4)
                    low = 1.0 + 3.1 * floor
                    x, ends = near - side * 0.02, (mid - side * 0.5, mid + side * 0.5)
                    mesh.quad("window", (x, low, ends[0]), (x, low, ends[1]), (x, low + 1.6, ends[1]), (x, low + 1.6, ends[0]))
        z -= depth
        k += 1
    for i in range(3):
        for side in (-1.0, 1.0):
            x, z = side * 4.5, 4.0 - 16.0 * i - (8.0 if side > 0.0 else 0.0)
            mesh.lathe("iron", (x, 0.14, z), [(0.0, 0.0), (0.13, 0.0), (0.11, 0.5), (0.06, 0.7), (0.045, 5.0), (0.0, 5.0)], 10)
            mesh.block("iron", (min(x, x - side * 1.1), 5.05, z - 0.04), (max(x, x - side * 1.1), 5.13, z + 0.04))
            mesh.block("iron", (x - side * 1.1 - 0.2, 5.02, z - 0.14), (x - side * 1.1 + 0.2, 5.16, z + 0.14))
    # A car that comes toward the eye.
    cx, cz = -1.7, -13.0
    mesh.block("car", (cx - 0.88, 0.35, cz - 4.2), (cx + 0.88, 0.95, cz))
    mesh.block("car", (cx - 0.76, 0.95, cz - 3.6), (cx + 0.76, 1.45, cz - 1.3))
    mesh.block("window", (cx - 0.7, 1.0, cz - 1.3), (cx + 0.7, 1.4, cz - 1.28))
    for x in (cx - 0.75, cx + 0.75):
        for z in (cz - 0.8, cz - 3.4):
            mesh.block("asphalt", (x - 0.12, 0.0, z - 0.32), (x + 0.12, 0.62, z + 0.32))
    # Somebody on the pavement.
    walker = [(0.0, 0.0), (0.14, 0.0), (0.16, 0.5), (0.21, 0.85), (0.2, 1.1), (0.24, 1.38), (0.2, 1.48), (0.07, 1.54), (0.1, 1.62), (0.11, 1.7), (0.07, 1.79), (0.0, 1.8)]
    mesh.lathe("cloth", (5.3, 0.14, -4.6), walker, 20)
    # The sign stands out from the right-hand houses, lit on both sides, on a bracket.
    sx, sy, sz = 5.55, 3.2, -3.0
    mesh.block("iron", (sx - 0.02, sy + 1.12, sz - 0.03), (7.0, sy + 1.18, sz + 0.03))
    mesh.quad("sign", (sx - 1.25, sy, sz + 0.05), (sx + 1.25, sy, sz + 0.05), (sx + 1.25, sy + 1.12, sz + 0.05), (sx - 1.25, sy + 1.12, sz + 0.05))
    mesh.block("iron", (sx - 1.25, sy, sz - 0.05), (sx + 1.25, sy + 1.12, sz + 0.04))
    materials = [
        material("asphalt", (0.075, 0.075, 0.08)),
        material("pavement", (0.22, 0.21, 0.20)),
        material("brick", (0.30, 0.15, 0.11)),
        material("plaster", (0.42, 0.38, 0.32)),
        material("window", (0.03, 0.035, 0.04)),
        material("iron", (0.05, 0.05, 0.055)),
        material("car", (0.06, 0.10, 0.14)),
        material("cloth", (0.10, 0.09, 0.09)),
        material(
            "sign",
            (0.05, 0.05, 0.05),
            emissiveFactor=[1.0, 1.0, 1.0],
            emissiveTexture={"index": 0},
            extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 260.0}},
        ),
    ]
    angles = [0, 10, 20, 30, 40, 50, 55, 60, 65, 70, 75, 80, 90]
    # A street lamp: most along the road (C0 and C180), at 65 degrees from straight down.
    along = lambda c: 0.5 + 0.5 * math.cos(math.radians(2.0 * c))
    lantern = lambda c, a: (
        0.0 if a >= 90 else 90.0 * math.cos(math.radians(a)) ** 0.5 + 210.0 * (0.25 + along(c)) * math.exp(-(((a - 62.0) / 13.0) ** 2))
    )
    files = {"lantern.ies": ies("lantern", 3400.0, [0, 15, 30, 45, 60, 75, 90], angles, lantern)}
    wall = lambda c, a: 100.0 * math.cos(math.radians(a)) ** 3 if a < 90 else 0.0
    files["wall.ies"] = ies("wall light", 900.0, [0], [0, 10, 20, 30, 40, 50, 60, 70, 80, 90], wall)
    lights = ""
    for i in range(3):
        for side in (-1.0, 1.0):
            x, z = side * 4.5 - side * 1.1, 4.0 - 16.0 * i - (8.0 if side > 0.0 else 0.0)
            lights += f"""
[[light]]
name = "lantern {2 * i + (side > 0.0) + 1}"
position = [{x:.1f}, 5.0, {z:.1f}]
around = [0.0, 0.0, 1.0]                 # C0 along the road
intensity = [1.25, 0.98, 0.55]           # times the file's candela
distribution = {{ kind = "file", path = "lantern.ies" }}
"""
    for i, x in enumerate((cx - 0.62, cx + 0.62)):
        lights += f"""
[[light]]
name = "headlight {i + 1}"
position = [{x:.2f}, 0.72, {cz + 0.02:.2f}]
toward = [-0.10, -0.075, 1.0]
around = [1.0, 0.0, 0.0]
intensity = [3600.0, 3800.0, 4200.0]
distribution = {{ kind = "elliptical", spread = [20.0, 8.0], sharpness = 0.7 }}
"""
    scene = f"""\
# A foggy street at night: lanterns and a wall light by IES files, headlights, a glowing sign.
# Made, with its geometry and its photometric files, by data/scenes.py.
mesh = "street.glb"

[camera]
eye = [2.3, 1.65, 10.0]
target = [0.9, 2.55, -10.0]
fov_y = 46.0
{lights}
[[light]]
name = "wall light"
position = [-6.85, 3.4, -2.5]
toward = [0.35, -1.0, 0.0]
distribution = {{ kind = "file", path = "wall.ies" }}

[[medium]]
shape = "box"
min = [-7.0, 0.0, -60.0]
max = [7.0, 14.0, 14.0]
scattering = 0.022
absorption = 0.0005
phase = {{ kind = "henyey-greenstein", g = 0.65 }}

[picture]
size = [640, 400]
exposure = 4.1
"""
    files |= {"street.toml": scene.encode(), "street.glb": glb(mesh, materials, [sign()])}
    return files


def dry_ice_scene():
    mesh = Mesh()
    mesh.quad("floor", (-5.0, 0.0, 5.0), (5.0, 0.0, 5.0), (5.0, 0.0, -5.0), (-5.0, 0.0, -5.0))
    mesh.quad("wall", (-5.0, 0.0, -4.0), (5.0, 0.0, -4.0), (5.0, 5.0, -4.0), (-5.0, 5.0, -4.0))
    for x, z, h in ((-1.5, -1.2, 0.9), (0.3, -0.4, 0.6), (1.9, -1.7, 1.3)):
        mesh.block("stone", (x - 0.3, 0.0, z - 0.3), (x + 0.3, h, z + 0.3))
        ball = [(0.28 * math.sin(math.pi * k / 16), 0.28 - 0.28 * math.cos(math.pi * k / 16)) for k in range(17)]
        mesh.lathe("ball", (x, h, z), ball, 32)
    materials = [
        material("floor", (0.20, 0.20, 0.22)),
        material("wall", (0.13, 0.13, 0.17)),
        material("stone", (0.45, 0.44, 0.42)),
        material("ball", (0.85, 0.80, 0.70)),
    ]
    scene = """\
# Dry ice: a wavy layer of dense fog on a floor, under two spots.
# Made, with its geometry, by data/scenes.py.
mesh = "dry-ice.glb"

[camera]
eye = [0.0, 1.55, 5.6]
target = [0.1, 0.62, 0.0]
fov_y = 38.0

[[light]]
name = "warm"
position = [-3.2, 3.8, -2.4]
toward = [3.0, -3.6, 2.3]
intensity = [3400.0, 2400.0, 1200.0]
distribution = { kind = "nishita-spot", spread = 33.0, sharpness = 0.05 }

[[light]]
name = "cold"
position = [3.6, 3.6, 1.9]
toward = [-3.0, -3.3, -2.5]
intensity = [420.0, 900.0, 2200.0]
distribution = { kind = "nishita-spot", spread = 30.0, sharpness = 0.05 }

[[medium]]
shape = "layer"
top = 0.34
bottom = 0.0
waves = [
    { amplitude = 0.075, wavelength = 2.3, direction = 25.0, phase = 0.0 },
    { amplitude = 0.045, wavelength = 1.27, direction = -48.0, phase = 60.0 },
]
scattering = 2.2
absorption = 0.02
phase = { kind = "henyey-greenstein", g = 0.2 }

[picture]
size = [640, 400]
exposure = 4.5
"""
    return {"dry-ice.toml": scene.encode(), "dry-ice.glb": glb(mesh, materials)}


def smoke_scene():
    mesh = Mesh()
    mesh.quad("floor", (-6.0, 0.0, 5.0), (6.0, 0.0, 5.0), (6.0, 0.0, -5.0), (-6.0, 0.0, -5.0))
    mesh.quad("wall", (-6.0, 0.0, -3.6), (6.0, 0.0, -3.6), (6.0, 6.0, -3.6), (-6.0, 6.0, -3.6))
    bowl = [(0.0, 0.0), (0.3, 0.0), (0.3, 0.06), (0.09, 0.14), (0.08, 0.5), (0.2, 0.62), (0.42, 0.74), (0.5, 0.9), (0.47, 0.9), (0.38, 0.78), (0.0, 0.7)]
    mesh.lathe("bronze", (-0.4, 0.0, 0.0), bowl, 40)
    materials = [
        material("floor", (0.24, 0.22, 0.20)),
        material("wall", (0.16, 0.16, 0.17)),
        material("bronze", (0.42, 0.27, 0.12)),
    ]
    # A plume that leans and widens; what is far from the bowl is thin.
    puffs = []
    for k in range(9):
        t = k / 8.0
        rise = 1.02 + 2.1 * t**0.9
        x, z = -0.40 + 1.75 * t**1.9 + 0.07 * math.sin(5.0 * t), 0.10 * math.sin(7.0 * t)
        radius = 0.19 + 0.50 * t**1.2
        puffs.append(
            ((x, rise, z), (1.12 * radius, (1.3 - 0.55 * t) * radius, radius), (0.0, 14.0 * k, -30.0 * t), 2.6 * 0.2 ** t)
        )
    puffs.append(((1.95, 2.78, -0.35), (0.42, 0.22, 0.35), (0.0, 20.0, -8.0), 0.55))
    puffs.append(((0.62, 2.08, 0.30), (0.30, 0.17, 0.24), (12.0, 0.0, 22.0), 0.6))
    media = "".join(
        f"""
[[medium]]
shape = "ellipsoid"
center = [{", ".join(f"{x:.3f}" for x in center)}]
radii = [{", ".join(f"{x:.3f}" for x in radii)}]
rotation = [{", ".join(f"{x:.1f}" for x in turn)}]
edge = "soft"
scattering = {density:.3f}
absorption = {density * 0.05:.3f}
phase = {{ kind = "henyey-greenstein", g = 0.3 }}
"""
        for center, radii, turn, density in puffs
    )
    scene = f"""\
# Smoke from a bowl, soft ellipsoids, in two beams.
# Made, with its geometry, by data/scenes.py.
mesh = "smoke.glb"

[camera]
eye = [0.5, 1.7, 6.2]
target = [0.35, 1.78, 0.0]
fov_y = 38.0

[[light]]
name = "warm"
position = [-3.4, 3.6, 0.8]
toward = [3.8, -1.7, -0.8]
intensity = [6200.0, 4800.0, 3000.0]
distribution = {{ kind = "nishita-spot", spread = 21.0, sharpness = 0.02 }}

[[light]]
name = "cold"
position = [3.2, 5.2, -1.8]
toward = [-2.9, -3.2, 1.8]
intensity = [1000.0, 1700.0, 3400.0]
distribution = {{ kind = "nishita-spot", spread = 24.0, sharpness = 0.02 }}

[[medium]]
shape = "box"
min = [-6.0, 0.0, -3.6]
max = [6.0, 6.0, 5.0]
scattering = 0.006
absorption = 0.0
phase = {{ kind = "henyey-greenstein", g = 0.5 }}
{media}
[picture]
size = [640, 400]
exposure = 4.1
"""
    return {"smoke.toml": scene.encode(), "smoke.glb": glb(mesh, materials)}


def window_picture():
    """A lancet of stained glass: a rose of twelve petals over two panels, leaded. sRGB, dark where the lead is."""
    width, height = 96, 192
    glass = [(30, 60, 200), (200, 26, 36), (24, 140, 70), (236, 176, 30), (120, 40, 160), (40, 150, 210)]

    def texel(x, y):
        u, v = (x + 0.5) / width - 0.5, (y + 0.5) / height * 2.0
        r = math.hypot(u, v - 0.52)
        turn = math.atan2(v - 0.52, u) / (2.0 * math.pi) % 1.0
        lead = (12, 12, 14)
        if r < 0.40:
            ring = int(r / 0.1)
            if abs(r / 0.1 - round(r / 0.1)) * 0.1 < 0.009 and r > 0.05:
                return lead
            petals = (1, 6, 12, 12)[ring]
            at = turn * petals + (0.5 if ring == 3 else 0.0)
            if ring > 0 and abs(at - round(at)) * 2.0 * math.pi * r / petals < 0.009:
                return lead
            return glass[(int(at) * (2 if ring == 2 else 1) + 2 * ring + (3 if ring == 0 else 0)) % 6]
        if v > 1.02:
            s, t = (u + 0.5) * 4.0, (v - 1.02) * 4.0
            a, b = s + t, s - t
            if min(abs(a - round(a)), abs(b - round(b))) < 0.05 or v < 1.04:
                return lead
            return glass[(int(math.floor(a)) * 2 + int(math.floor(b)) * 3) % 6]
        s, t = (u + 0.5) * 6.0, v * 6.0
        if min(abs(s - round(s)), abs(t - round(t))) < 0.07:
            return lead
        return (70, 110, 215) if (int(s) + int(t)) % 2 else (40, 74, 180)

    return png(width, height, texel)


def window_scene():
    mesh = Mesh()
    w, d, h = 4.0, 9.0, 5.5
    floor = [(-w, 0.0, d), (w, 0.0, d), (w, 0.0, 0.0), (-w, 0.0, 0.0)]
    mesh.quad("floor", *floor)
    mesh.quad("stone", (-w, h, 0.0), (w, h, 0.0), (w, h, d), (-w, h, d))
    mesh.quad("stone", (-w, 0.0, 0.0), (-w, h, 0.0), (-w, h, d), (-w, 0.0, d))
    mesh.quad("stone", (w, 0.0, d), (w, h, d), (w, h, 0.0), (w, 0.0, 0.0))
    mesh.quad("stone", (-w, 0.0, d), (-w, h, d), (w, h, d), (w, 0.0, d))
    # The wall with the window, 0.5 m thick: four blocks around the opening; and a roof and walls outside against stray light.
    a, low, high = 0.8, 1.5, 4.7
    mesh.block("stone", (-w, 0.0, -0.5), (-a, h, 0.0))
    mesh.block("stone", (a, 0.0, -0.5), (w, h, 0.0))
    mesh.block("stone", (-a, 0.0, -0.5), (a, low, 0.0))
    mesh.block("stone", (-a, high, -0.5), (a, h, 0.0))
    mesh.quad("glass", (-a, low, -0.3), (a, low, -0.3), (a, high, -0.3), (-a, high, -0.3))
    for x, z in ((-2.1, 3.2), (1.9, 4.6)):
        mesh.block("oak", (x - 0.9, 0.0, z - 0.22), (x + 0.9, 0.46, z + 0.22))
    materials = [
        material("floor", (0.62, 0.58, 0.52)),
        material("stone", (0.50, 0.47, 0.43)),
        material("oak", (0.20, 0.12, 0.07)),
        material("glass", (1.0, 1.0, 1.0), extras={"textured": True}),
    ]
    scene = """\
# Sunlight through stained glass into a dark, hazy room.
# Made, with its geometry and the picture of its glass, by data/scenes.py.
mesh = "window.glb"

[camera]
eye = [3.1, 1.7, 8.2]
target = [-0.9, 1.75, 0.8]
fov_y = 52.0

[sun]
azimuth = 12.0
elevation = 33.0
illuminance = 90000.0

[sky]
model = "perez"

[ground]
height = -0.5

[[pane]]
material = "glass"
transmittance = 0.9
image = "window.png"

[[medium]]
shape = "box"
min = [-4.0, 0.0, 0.0]
max = [4.0, 5.5, 9.0]
scattering = 0.03
absorption = 0.001
phase = { kind = "henyey-greenstein", g = 0.5 }

[picture]
size = [640, 400]
exposure = 8.2
"""
    return {"window.toml": scene.encode(), "window.glb": glb(mesh, materials), "window.png": window_picture()}


SCENES = {
    "teapot": teapot_scene,
    "stage": stage_scene,
    "street": street_scene,
    "dry-ice": dry_ice_scene,
    "smoke": smoke_scene,
    "window": window_scene,
}

if __name__ == "__main__":
    # Into another folder, if one is named.
    into = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE
    for name, make in SCENES.items():
        for file, content in make().items():
            path = into / name / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
            print(f"{path} ({len(content)} bytes)")
