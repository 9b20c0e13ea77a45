"""Makes tests/scene/data: eleven frames of samples of data/, exported by Blender (PyPI's bpy 4.5.0).

    python3 tests/scene/make_exported_files.py
"""

import pathlib
import tempfile

import bpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
OUT = ROOT / "tests" / "scene" / "data"
FRAMES = 11
FIRST = {"walk": 60, "squat": 40, "wave": 30}


def cut(name, folder):
    """Some frames of a sample as a BVH file."""
    head, motion = (ROOT / "data" / f"{name}.bvh").read_text().split("MOTION\n")
    rows = motion.splitlines()[2:][FIRST[name]:FIRST[name] + FRAMES]
    path = pathlib.Path(folder) / f"{name}.bvh"
    path.write_text(f"{head}MOTION\nFrames: {FRAMES}\nFrame Time: 0.033333\n" + "\n".join(rows) + "\n")
    return path


def load(name, empty=True):
    """The armature of a sample, in metres, in a scene of 30 fps."""
    if empty:
        bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps, scene.frame_start, scene.frame_end = 30, 1, FRAMES
    with tempfile.TemporaryDirectory() as folder:
        bpy.ops.import_anim.bvh(filepath=str(cut(name, folder)), global_scale=0.01, rotate_mode="QUATERNION",
                                axis_forward="-Z", axis_up="Y", frame_start=0)
    return bpy.context.object


def add_skin(armature):
    """A triangle for each bone, bound to it."""
    corners, faces = [], []
    for bone in armature.data.bones:
        x, y, z = bone.head_local
        faces.append(tuple(range(len(corners), len(corners) + 3)))
        corners += [(x, y, z), (x + 0.03, y, z), (x, y + 0.03, z)]
    mesh = bpy.data.meshes.new("body")
    mesh.from_pydata(corners, [], faces)
    body = bpy.data.objects.new("body", mesh)
    bpy.context.collection.objects.link(body)
    body.parent = armature
    for bone, face in zip(armature.data.bones, faces):
        body.vertex_groups.new(name=bone.name).add(face, 1.0, "REPLACE")
    body.modifiers.new("skin", "ARMATURE").object = armature


def export_fbx(name, **options):
    """Every frame a key."""
    bpy.ops.export_scene.fbx(filepath=str(OUT / name), **{
        "add_leaf_bones": False, "bake_anim_use_all_actions": False, "bake_anim_use_nla_strips": False,
        "bake_anim_simplify_factor": 0.0, **options})


def export_glb(name, **options):
    bpy.ops.export_scene.gltf(filepath=str(OUT / name), export_format="GLB", export_frame_range=False,
                              export_optimize_animation_size=False, **options)


def export_takes():
    """One armature, two actions; FBX in metres."""
    armature = load("wave")
    wave = armature.animation_data.action
    other = load("squat", empty=False)
    squat = other.animation_data.action
    for action, name in ((wave, "Wave"), (squat, "Squat")):
        action.name, action.use_fake_user = name, True
    # The second action belongs to the other armature until its slot has this one's name.
    squat.slots[0].identifier = wave.slots[0].identifier
    bpy.data.objects.remove(other)
    bpy.context.view_layer.objects.active = armature
    export_fbx("takes.fbx", bake_anim_use_all_actions=True, apply_scale_options="FBX_SCALE_ALL")
    for action in (wave, squat):
        track = armature.animation_data.nla_tracks.new()
        track.name = action.name
        track.strips.new(action.name, 0, action).action_slot = action.slots[0]
    armature.animation_data.action = None
    export_glb("takes.glb", export_animation_mode="NLA_TRACKS")


if __name__ == "__main__":
    OUT.mkdir(exist_ok=True)
    load("walk")
    export_fbx("walk.fbx")
    add_skin(load("walk"))
    export_glb("walk.glb")
    add_skin(load("wave"))
    export_fbx("wave_z_up.fbx", axis_forward="Y", axis_up="Z", add_leaf_bones=True)
    export_takes()
