"""Blender (its Python module, bpy) takes a map and a sun of ours: a post on a plane, lit by either, seen from above.

Arguments: the map with the sun's disc, the map without it; JSON on stdin: azimuth and elevation of the sun [degrees], its illuminance
on a plane that faces it [lx] and its colour (Rec. 709, any level). North is +Y in Blender, east +X. Prints JSON: for `map` and
`lamp` the azimuth of the post's shadow [degrees], and the plane's illuminance beside it [lx].
"""

import json
import math
import sys

import bpy

ALBEDO = 0.5
SIZE = 96
WIDTH = 12.0  # metres across the picture
WHITE_EFFICACY = 179.0


def scene(path):
    """A post of 2 m on a plane under a world of the map, and a camera above that looks down, north on top."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    world = bpy.data.worlds.new("sky")
    bpy.context.scene.world = world
    world.use_nodes = True
    nodes = world.node_tree.nodes
    background = nodes.get("Background") or nodes.new("ShaderNodeBackground")
    out = nodes.get("World Output") or nodes.new("ShaderNodeOutputWorld")
    texture = nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(path)
    texture.image.colorspace_settings.name = "Linear Rec.709"
    world.node_tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    world.node_tree.links.new(background.outputs["Background"], out.inputs["Surface"])
    background.inputs["Strength"].default_value = 1.0

    grey = bpy.data.materials.new("grey")
    grey.use_nodes = True
    shader = grey.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (ALBEDO, ALBEDO, ALBEDO, 1.0)
    shader.inputs["Roughness"].default_value = 1.0
    shader.inputs["Specular IOR Level"].default_value = 0.0
    bpy.ops.mesh.primitive_plane_add(size=200.0)
    bpy.context.object.data.materials.append(grey)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, 1.0))
    bpy.context.object.scale = (0.3, 0.3, 2.0)
    bpy.context.object.data.materials.append(grey)

    camera = bpy.data.cameras.new("above")
    camera.type = "ORTHO"
    camera.ortho_scale = WIDTH
    eye = bpy.data.objects.new("above", camera)
    eye.location = (0.0, 0.0, 50.0)
    bpy.context.collection.objects.link(eye)
    bpy.context.scene.camera = eye


def lamp(sun):
    """The sun as a lamp: its strength is the irradiance of a plane that faces it."""
    light = bpy.data.lights.new("sun", "SUN")
    light.energy = sun["illuminance"] / WHITE_EFFICACY
    rgb = sun["colour"]
    level = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
    light.color = [c / level for c in rgb]
    light.angle = math.radians(0.53)
    it = bpy.data.objects.new("sun", light)
    # A lamp shines along its own -Z.
    it.rotation_euler = (math.radians(90 - sun["elevation"]), 0.0, math.radians(180 - sun["azimuth"]))
    bpy.context.collection.objects.link(it)


def picture(path):
    settings = bpy.context.scene
    settings.render.engine = "CYCLES"
    settings.cycles.device = "CPU"
    settings.cycles.samples = 256
    settings.cycles.max_bounces = 0
    settings.cycles.use_denoising = False
    settings.render.resolution_x = settings.render.resolution_y = SIZE
    settings.view_settings.view_transform = "Raw"
    settings.render.image_settings.file_format = "OPEN_EXR"
    settings.render.image_settings.color_depth = "32"
    settings.render.filepath = path
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(path)
    values = list(image.pixels)
    y = [0.2126 * values[4 * i] + 0.7152 * values[4 * i + 1] + 0.0722 * values[4 * i + 2] for i in range(SIZE * SIZE)]
    return y  # from the lower left corner


def found(y, length):
    """The shadow's azimuth, by the darkest direction at half of its length, and the plane's illuminance beside it."""

    def at(azimuth, distance):
        a = math.radians(azimuth)
        column = SIZE * (0.5 + distance * math.sin(a) / WIDTH)
        row = SIZE * (0.5 + distance * math.cos(a) / WIDTH)
        return y[int(row) * SIZE + int(column)]

    def darkness(azimuth):
        return sum(at(azimuth, share * length) for share in (0.3, 0.4, 0.5, 0.6, 0.7, 0.8))

    azimuths = [0.5 * i for i in range(720)]
    least = min(darkness(a) for a in azimuths)
    most = max(darkness(a) for a in azimuths)
    dark = [a for a in azimuths if darkness(a) < 0.5 * (least + most)]
    x = sum(math.cos(math.radians(a)) for a in dark)
    z = sum(math.sin(math.radians(a)) for a in dark)
    shadow = math.degrees(math.atan2(z, x)) % 360
    beside = sum(at(shadow + 180 + turn, 4.5) for turn in range(-40, 41, 10)) / 9
    return {"shadow": shadow, "illuminance": beside * math.pi / ALBEDO * WHITE_EFFICACY}


with_disc, without_disc, scratch = sys.argv[1:]
sun = json.load(sys.stdin)
length = 2.0 / math.tan(math.radians(sun["elevation"]))
results = {}
scene(with_disc)
results["map"] = found(picture(scratch), length)
scene(without_disc)
lamp(sun)
results["lamp"] = found(picture(scratch), length)
print("RESULT " + json.dumps(results))
