"""Imports a glTF file with Blender's importer, and exports what it imported: blender.py <input> <output.glb>."""

import sys

import bpy

source, target = sys.argv[1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=source)
bpy.ops.export_scene.gltf(filepath=target, export_format="GLB", export_tangents=True)
