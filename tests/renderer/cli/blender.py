"""Renders a small scene through the add-on: usage: blender.py FOLDER; writes FOLDER/still.exr and FOLDER/film_0001.exr …"""

import json
import math
import sys
from pathlib import Path

import bpy

import addon_utils  # bpy brings it along

folder = Path(sys.argv[1])
bpy.ops.wm.read_factory_settings(use_empty=True)
assert addon_utils.enable("sweeplight_blender", default_set=True) is not None
scene = bpy.context.scene


def material(name, colour):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    made.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*colour, 1)
    return made


def add(name, data, location, rotation=(0, 0, 0)):
    made = bpy.data.objects.new(name, data)
    made.location, made.rotation_euler = location, rotation
    scene.collection.objects.link(made)
    return made


def lamp(kind, watts, location, **more):
    light = bpy.data.lights.new(kind, kind)
    light.energy = watts
    for name, value in more.items():
        setattr(light, name, value)
    return add(kind, light, location)


def key(thing, path, *values):
    for frame, value in zip((1, 4), values):
        setattr(thing, path, value)
        thing.keyframe_insert(path, frame=frame)


def build():
    bpy.ops.mesh.primitive_plane_add(size=6)
    bpy.context.object.data.materials.append(material("floor", (0.7, 0.7, 0.7)))
    bpy.ops.mesh.primitive_cube_add(size=1, location=(-1, 0, 0.6))
    box = bpy.context.object
    box.data.materials.append(material("boîte", (0.2, 0.5, 0.2)))
    box.pass_index = 7
    key(box, "location", (-1, 0, 0.6), (0.5, 0, 0.6))
    # A driver turns a ball, a shape key bends a sheet: neither has keys of its own that an exporter would find.
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=6, radius=0.4, location=(1, -1, 0.5))
    bpy.context.object.driver_add("location", 2).driver.expression = "0.5 + frame / 10"
    bpy.ops.mesh.primitive_plane_add(size=1, location=(0, 1, 1.2))
    sheet = bpy.context.object
    sheet.shape_key_add(name="Basis")
    bent = sheet.shape_key_add(name="bent")
    bent.data[0].co.z = 0.5
    key(bent, "value", 0.0, 1.0)
    lamp("AREA", 200, (0, 0, 4), shape="DISK", size=1.0)
    key(lamp("POINT", 60, (2, -2, 2), shadow_soft_size=0.2).data, "energy", 60, 20)
    camera = bpy.data.cameras.new("camera")
    camera.shift_x = 0.1
    scene.camera = add("camera", camera, (0, -8, 3), (math.radians(75), 0, 0))
    key(camera, "lens", 50, 40)
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.05, 0.05, 0.1, 1)


def prepare():
    render, layer = scene.render, bpy.context.view_layer
    render.engine = "SWEEPLIGHT"
    render.resolution_x, render.resolution_y, render.resolution_percentage = 96, 54, 50
    render.use_compositing = render.use_sequencer = False
    scene.frame_start, scene.frame_end = 1, 4
    settings = render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"
    settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGB"
    scene.sweeplight.quality = "DRAFT"
    layer.use_pass_z = layer.use_pass_object_index = layer.use_pass_diffuse_direct = True


def render(name, **how):
    scene.render.filepath = str(folder / name)
    bpy.ops.render.render(**how)


build()
prepare()
scene.frame_set(2)
render("still.exr", write_still=True)
scene.sweeplight.keep = str(folder / "kept ä")
render("film_", animation=True)
scene.sweeplight.keep = ""
told = {}
try:
    bpy.context.preferences.addons["sweeplight_blender"].preferences.binary = str(folder / "nobody")
    render("never.exr", write_still=True)
except RuntimeError as error:
    told["error"] = str(error)
(folder / "told.json").write_text(json.dumps(told))
