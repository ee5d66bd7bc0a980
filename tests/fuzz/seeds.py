"""Writes the seeds and the files beside them: `python3 tests/fuzz/seeds.py`."""

import base64
import json
import struct
import zlib
from pathlib import Path

HERE = Path(__file__).parent


def put(name: str, content: bytes | str) -> None:
    path = HERE / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content.encode() if isinstance(content, str) else content)


def png(texels: list[tuple[int, int, int, int]]) -> bytes:
    """One row of texels."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        check = struct.pack(">I", zlib.crc32(kind + body))
        return struct.pack(">I", len(body)) + kind + body + check

    header = struct.pack(">IIBBBBB", len(texels), 1, 8, 6, 0, 0, 0)
    row = b"\0" + b"".join(bytes(texel) for texel in texels)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(row))
        + chunk(b"IEND", b"")
    )


def glb(document: dict, binary: bytes) -> bytes:
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    size = 28 + len(text) + len(binary)
    return (
        b"glTF"
        + struct.pack("<III", 2, size, len(text))
        + b"JSON"
        + text
        + struct.pack("<I", len(binary))
        + b"BIN\0"
        + binary
    )


TEXTURE = png([(255, 0, 0, 255), (0, 0, 255, 255)])
LEAF = png([(255, 0, 0, 255), (0, 0, 255, 0)])
MTL = """newmtl m
Kd 0.5 0.5 0.5
map_Kd -s 2 2 -o 0.5 0 -clamp on tex.png
d 0.9
Ks 1 1 1
newmtl n
Kd xyz 0.2
map_Kd TEX.PNG
map_d -imfchan m leaf.png
Tr 0.1
Ns
d -halo 0.5
Kd spectral f.rfl
illum 2
"""
OBJ = """# a house
mtllib m.mtl
o house
v 0 0 0 1 1 1
v 1 0 0
v 1 1 0 1 0 0 0.5
v 0 1 0
vt 0 0
vt 1 0
vt 1 1
vn 0 0 1
usemtl m
f 1/1/1 2/2/1 3/3/1
f 1 2 \\
3 4
f -1//-1 -2//-1 -3//-1
usemtl N
f 1 3 2 4
l 1 2
s off
"""


def document(buffer: dict, size: int) -> dict:
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"mesh": 0, "scale": [1, 2, 3], "rotation": [0, 0, 0, 1], "children": [1]},
            {"camera": 0, "translation": [0, 0, 5]},
        ],
        "meshes": [
            {
                "primitives": [
                    {
                        "attributes": {"POSITION": 0, "TEXCOORD_0": 1},
                        "indices": 2,
                        "material": 0,
                    }
                ]
            }
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 3, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 24},
            {"buffer": 0, "byteOffset": 60, "byteLength": 6},
            {"buffer": 0, "byteOffset": 68, "byteLength": len(TEXTURE)},
        ],
        "buffers": [{"byteLength": size, **buffer}],
        "materials": [
            {
                "alphaMode": "MASK",
                "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
            }
        ],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"wrapS": 33071}],
        "images": [{"bufferView": 3, "mimeType": "image/png"}],
        "cameras": [
            {"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}
        ],
    }


def place(latitude: float, longitude: float, fold: int, text: str) -> bytes:
    return struct.pack("<ddB", latitude, longitude, fold) + text.encode()


put("beside/tex.png", TEXTURE)
put("beside/leaf.png", LEAF)
put("beside/m.mtl", MTL)
put("beside/m.obj", OBJ)
put("seeds/obj/house", OBJ)
put("seeds/mtl/house", MTL)
BINARY = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
BINARY += struct.pack("<6f", 0, 0, 1, 0, 0, 1)
BINARY += struct.pack("<4H", 0, 1, 2, 0) + TEXTURE
put("seeds/gltf/binary", glb(document({}, len(BINARY)), BINARY))
URI = "data:application/octet-stream;base64," + base64.b64encode(BINARY).decode()
put("seeds/gltf/text", json.dumps(document({"uri": URI}, len(BINARY))))
put(
    "seeds/toml/all",
    """mesh = "m.obj"
scale = 2.0
up = "z"
origin = [0, 1, 0]
north = 10.0
time = "2026-06-21T18:30:00+02:00"
[site]
latitude = 48.8
longitude = 2.3
timezone = "Europe/Paris"
[camera]
eye = [0, 1.6, 5]
target = [0, 1.5, 0]
fov_y = 60
[sun]
azimuth = 120
elevation = 30
[sky]
model = "cie:12"
[ground]
albedo = 0.2
[[medium]]
shape = "box"
min = [-4, 0, -5]
max = [4, 4, 5]
scattering = 0.04
phase = { kind = "henyey-greenstein", g = 0.7 }
[picture]
size = [96, 60]
""",
)
for number, text in enumerate(
    [
        "2026-06-21T18:30:00+02:00",
        "2026-03-29T02:30",
        "2026-10-25T02:30:00.5",
        "Europe/Paris|2026-06-21T18:30",
        "2026-06-21T18:30[Asia/Tokyo]",
        "JD2451545.0",
        "-0044-03-15T12:00Z",
        "2016-12-31T23:59:60Z",
        "+02:00|2026-06-21 18:30",
    ]
):
    put(f"seeds/time/{number}", place(48.8, 2.3, number % 3, text))
put(
    "seeds/ies/tilted",
    """IESNA:LM-63-1995
[TEST] 17
[MANUFAC] nobody
TILT=INCLUDE
1
3
0 45 90
1 0.9 0.8
2 1000 2 5 4 1 2 0.1 0.2 0.3
0.5 1 60
0 30 60 90 120
0 30 60 90
100 90 80 40 5
100 91 82 43 6
100 93 84 45 7
100 95 86 47 8
""",
)
put(
    "seeds/ies/type-b",
    "IESNA91\r\nTILT=NONE\r\n1 -1 1 3 3 2 1 -0.1 0 0\r\n1 0.9 6\r\n-40, 0, 40\r\n-50 0 60\r\n1 2 3\r\n4 5 6\r\n7 8 9\r\n",
)
put("seeds/ies/type-a", "An old lamp\nTILT=NONE\n1 500 1 2 2 3 2 0 0 0\n1 1 6\n-90 90\n0 90\n1 2\n4 5\n")


def eulumdat(symmetry: int, sets: list[str], planes: int, stored: int) -> bytes:
    head = ["Nobody", "3", symmetry, planes, 360 / planes, 3, 45, "17", "A lamp", "4", "a.ldt", "today"]
    head += [100, 100, 50, 80, 0, 0, 0, 0, 0, 100, 50, "1,0", 0, *sets]
    angles = [i * 360 / planes for i in range(planes)] + [0, 45, 90]
    values = [100 + i * 0.5 for i in range(3 * stored)]
    lines = [*head, *[0.5] * 10, *angles, *values]
    return b"\1" + "\r\n".join(str(line) for line in lines).replace(".", ",").encode()


ONE = ["2", "LED", "2000", "white", "80", "25,5"]
put("seeds/ldt/axis", eulumdat(1, ["1", *ONE], 1, 1))
put("seeds/ldt/quadrants", eulumdat(4, ["1", *ONE], 8, 3))
put("seeds/ldt/across", eulumdat(3, ["2", *ONE, "-1", *ONE[1:]], 8, 5))
put("seeds/ldt/all", eulumdat(0, ["1", *ONE], 4, 4))
