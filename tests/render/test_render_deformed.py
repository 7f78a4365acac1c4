# SPDX-License-Identifier: MIT
"""What morphs and skins do to normals, sides, texture coordinates and colours: answers worked out by hand."""

import numpy as np
import pytest

from geometry_scenes import watched
from glb import Glb
from physics import box_of, close, reflected
from png import rgba
from shapes import Shape, box, facing_z, turn
from test_render_motion import check

WAYS = [("bvh", "copied"), ("bvh", "shared"), ("reference", "copied")]
HALF = np.sqrt(0.5)
SLOPE = (0, HALF, HALF)  # the normal of the plane z = -y


def write(folder, data: bytes):
    path = folder / "scene.glb"
    path.write_bytes(data)
    return path


def sloped(glb: Glb, material, normals=False, uvs=None) -> int:
    """A square of 1 m, 2 × 2 cells, whose morph target turns it into the plane z = -y; gives its mesh."""
    shape = facing_z(1, 1, cells=(2, 2))
    shape = Shape(
        shape.positions,
        shape.triangles,
        shape.normals if normals else None,
        None if uvs is None else np.asarray(uvs(shape.positions)),
    )
    item = glb.primitive(shape, material)
    item["targets"] = [{"POSITION": glb.attribute(shape.positions[:, 1:2] * [(0, 0, -1)], bounds=True)}]
    return glb.mesh(item, weights=[0])


def middle(picture, name, x=0.0):
    """The layer's mean over a few pixels round (x, 0)."""
    values = picture.layer(name)
    height, width = values.shape[:2]
    column = round((x / 2 + 1) / 2 * width)
    return values[height // 2 - 3 : height // 2 + 3, column - 3 : column + 3].reshape(-1, values.shape[-1]).mean(0)


@pytest.mark.parametrize(("strategy", "instances"), WAYS)
def test_flat_normals_follow_morphs(sheaf, tmp_path, strategy, instances):
    """The same mesh at rest, and moving; and one with normals of its own, which positions alone do not change."""
    glb = Glb()
    material = glb.material("white", (1, 1, 1))
    flat, smooth = sloped(glb, material), sloped(glb, material, normals=True)
    nodes = [
        glb.node("rest", (-1.2, 0, 0), mesh=flat),
        glb.node("moving", mesh=flat),
        glb.node("smooth", (1.2, 0, 0), mesh=smooth, weights=[1]),
    ]
    glb.animation("morph", [(nodes[1], "weights", [0, 1], [0, 1], "LINEAR")])
    run = sheaf.render(
        write(tmp_path, watched(glb, nodes)),
        "--instances", instances, "--aov", "N", "--frames", "0,24", size="96x48", strategy=strategy,
    )  # fmt: skip
    for frame, normal in ((0, (0, 0, 1)), (24, SLOPE)):
        picture = run.frame(frame)
        close(middle(picture, "N", -1.2), (0, 0, 1))
        close(middle(picture, "N"), normal)
        close(middle(picture, "N", 1.2), (0, 0, 1))


@pytest.mark.parametrize(("strategy", "instances"), WAYS)
def test_flat_tangents_follow_morphs(sheaf, tmp_path, strategy, instances):
    """u runs along +y; the normal map says 0.6 of the tangent and 0.8 of the normal everywhere."""
    glb = Glb()
    texture = glb.texture(rgba([[(204, 128, 230, 255)]]))
    mesh = sloped(
        glb,
        glb.material("mapped", (1, 1, 1), normalTexture={"index": texture}),
        uvs=lambda p: np.stack([p[:, 1], p[:, 0]], 1),
    )
    nodes = [glb.node("rest", (-1.2, 0, 0), mesh=mesh), glb.node("morphed", mesh=mesh, weights=[1])]
    picture = sheaf.render(
        write(tmp_path, watched(glb, nodes)), "--instances", instances, "--aov", "N", size="96x48", strategy=strategy
    ).frame()
    close(middle(picture, "N", -1.2), (0, 0.6, 0.8), absolute=0.01)
    along, normal = np.array((0, HALF, -HALF)), np.array(SLOPE)
    close(middle(picture, "N"), 0.6 * along + 0.8 * normal, absolute=0.01)


def skinned(glb: Glb, shape, joints, material) -> dict:
    """A primitive whose vertices follow one joint each."""
    joints = np.stack([np.asarray(joints)] + [np.zeros(len(shape.positions))] * 3, 1)
    return glb.primitive(
        shape,
        material,
        JOINTS_0=glb.attribute(joints, "u8"),
        WEIGHTS_0=glb.attribute(np.tile((1.0, 0, 0, 0), (len(joints), 1))),
    )


@pytest.mark.parametrize(("strategy", "instances"), WAYS)
def test_flat_normals_follow_skins(sheaf, tmp_path, strategy, instances):
    """The upper row of vertices follows a joint that moves back by the square's height within 1 s."""
    glb = Glb()
    shape = facing_z(1, 1)
    shape = Shape(shape.positions, shape.triangles)
    joints = [glb.node("lower"), glb.node("upper")]
    mesh = glb.mesh(skinned(glb, shape, shape.positions[:, 1] > 0, glb.material("white", (1, 1, 1))))
    square = glb.node("square", mesh=mesh, skin=glb.skin(joints, [np.eye(4)] * 2))
    glb.animation("lean", [(joints[1], "translation", [0, 1], [(0, 0, 0), (0, 0, -1)], "LINEAR")])
    run = sheaf.render(
        write(tmp_path, watched(glb, [*joints, square])),
        "--instances", instances, "--aov", "N", "--frames", "0,24", size="96x48", strategy=strategy,
    )  # fmt: skip
    close(middle(run.frame(0), "N"), (0, 0, 1))
    close(middle(run.frame(24), "N"), SLOPE)


MIRROR = np.diag([-1.0, 1, 1, 1])
PLACES = [
    "joint under the mirror",
    "joint beside the mirror",
    "mirroring joint",
    "both",
    "joint with a matrix",
    "mirroring bind matrix",
    "animated",
]


def lit_square(place: str, normals: bool) -> bytes:
    """A white square that faces the camera and a lamp behind it, whatever mirrors it in x on the way."""
    glb = Glb()
    shape = facing_z(1, 1)
    shape = shape if normals else Shape(shape.positions, shape.triangles)
    joint = glb.node(
        "joint",
        **({"scale": (-1, 1, 1)} if place in ("mirroring joint", "both") else {}),
        **({"matrix": MIRROR.T.ravel().tolist()} if place == "joint with a matrix" else {}),
    )
    mesh = glb.mesh(skinned(glb, shape, np.zeros(4), glb.material("white", (1, 1, 1))))
    bind = MIRROR if place == "mirroring bind matrix" else np.eye(4)
    square = glb.node("square", mesh=mesh, skin=glb.skin([joint], [bind]))
    nodes = [joint, square]
    if place in ("joint under the mirror", "both"):
        nodes = [glb.node("mirror", scale=(-1, 1, 1), children=nodes)]
    elif place == "joint beside the mirror":
        nodes = [joint, glb.node("mirror", scale=(-1, 1, 1), children=[square])]
    elif place == "animated":
        glb.animation("turn over", [(joint, "scale", [0, 0.5], [(1, 1, 1), (-1, 1, 1)], "LINEAR")])
    nodes.append(glb.light("sun", "directional", np.pi))
    return watched(glb, nodes)


@pytest.mark.parametrize("normals", [True, False], ids=["smooth", "flat"])
@pytest.mark.parametrize("place", PLACES)
def test_mirrored_skins_keep_their_outside(sheaf, tmp_path, place, normals):
    scene = write(tmp_path, lit_square(place, normals))
    facing = (0, 0, 1)
    wanted = reflected((1, 1, 1), facing, facing, facing) * np.pi
    for strategy, instances in WAYS:
        run = sheaf.render(
            scene, "--instances", instances, "--aov", "N", "--environment", "0,0,0", "--frames", "0,24",
            strategy=strategy,
        )  # fmt: skip
        for frame in (0, 24):
            close(middle(run.frame(frame), "N"), facing)
            close(run.frame(frame).rgb[18, 32], wanted)


def test_skin_of_which_one_joint_mirrors(sheaf, tmp_path):
    """Two squares of one mesh: each triangle has the side of its own joint."""
    glb = Glb()
    left, right = facing_z(1, 1, centre=(-1, 0)), facing_z(1, 1, centre=(-1, 0))
    shape = Shape(
        np.concatenate([left.positions, right.positions]), np.concatenate([left.triangles, right.triangles + 4])
    )
    joints = [glb.node("plain"), glb.node("mirroring", scale=(-1, 1, 1))]
    mesh = glb.mesh(skinned(glb, shape, [0] * 4 + [1] * 4, glb.material("white", (1, 1, 1))))
    squares = glb.node("squares", mesh=mesh, skin=glb.skin(joints, [np.eye(4)] * 2))
    scene = write(tmp_path, watched(glb, [*joints, squares, glb.light("sun", "directional", np.pi)]))
    for strategy, instances in WAYS:
        picture = sheaf.render(
            scene, "--instances", instances, "--aov", "N", "--environment", "0,0,0", strategy=strategy
        ).frame()
        for x in (-1, 1):
            close(middle(picture, "N", x), (0, 0, 1))
        assert (picture.rgb[18, [16, 48]] > 0.9).all()


def tinted_box(as_skin: bool) -> bytes:
    """A box of coloured glass before a white wall, under a node that mirrors it in z."""
    glb = Glb()
    glass = glb.glass("glass", colour=(0.5, 0.25, 1), distance=2)
    shape = box((1.5, 1.5, 1))
    if as_skin:
        joint = glb.node("joint")
        primitive = skinned(glb, shape, np.zeros(len(shape.positions)), glass)
        inner = [joint, glb.node("box", mesh=glb.mesh(primitive), skin=glb.skin([joint], [np.eye(4)]))]
    else:
        inner = [glb.node("box", mesh=glb.mesh(glb.primitive(shape, glass)))]
    wall = glb.node("wall", (0, 0, -2), mesh=glb.mesh(glb.primitive(facing_z(8, 8), glb.material("wall", (1, 1, 1)))))
    return watched(
        glb,
        [
            glb.node("mirror", scale=(1, 1, -1), children=inner),
            wall,
            glb.light("sun", "directional", 1, placed={"rotation": turn((0, 1, 0), 25)}),
        ],
    )


def test_glass_on_a_mirrored_skin(sheaf, tmp_path):
    """What it refracts, absorbs and throws as a shadow is what the same box without a skin does."""
    plain, skin = tmp_path / "plain.glb", tmp_path / "skin.glb"
    plain.write_bytes(tinted_box(False))
    skin.write_bytes(tinted_box(True))
    for strategy in ("bvh", "reference"):
        wanted = sheaf.render(plain, strategy=strategy).frame().rgb
        assert wanted[18, 32, 2] > 1.5 * wanted[18, 32, 1], "no glass in sight"
        close(sheaf.render(skin, strategy=strategy).frame().rgb, wanted, relative=0.01, absolute=0.002)


def square_on_joint(place_joint) -> tuple[Glb, int]:
    """A square of 0.25 m that follows the joint which `place_joint` makes; gives its node."""
    glb = Glb()
    joint = place_joint(glb)
    mesh = glb.mesh(skinned(glb, facing_z(0.25, 0.25), np.zeros(4), glb.unlit("square", (1, 0.5, 0.25))))
    return glb, glb.node("square", mesh=mesh, skin=glb.skin([joint], [np.eye(4)]))


@pytest.mark.parametrize("strategy", ["bvh", "reference"])
def test_joints_outside_the_scene_move(sheaf, tmp_path, strategy):
    """The scene lists the square alone: its joint hangs from a parent that is not in the scene either."""

    def hanging(glb):
        joint = glb.node("joint", (0.5, 0, 0))
        parent = glb.node("parent", (0, 0.5, 0), children=[joint])
        glb.animation(
            "move",
            [
                (joint, "translation", [0, 1], [(0.5, 0, 0), (-0.5, 0, 0)], "LINEAR"),
                (parent, "translation", [0, 1], [(0, 0.5, 0), (0, -0.25, 0)], "LINEAR"),
            ],
        )
        return joint

    glb, square = square_on_joint(hanging)
    run = sheaf.render(
        write(tmp_path, watched(glb, [square])), "--frames", "0,12,24", size="96x48", strategy=strategy, stats=True
    )
    for frame, (x, y) in ((0, (0.5, 0.5)), (12, (0, 0.125)), (24, (-0.5, -0.25))):
        check(run.frame(frame), box_of(x - 0.125, x + 0.125, y - 0.125, y + 0.125))
    assert any("nodes[2]: joint 0 of skins[0] is not in the scene" in w for w in run.stats()["scene"]["warnings"])


def test_instances_of_a_skinned_node_are_told_of(sheaf, tmp_path):
    """Its joints say where it is: it is drawn once, as what shines through half of it shows, and a warning names it."""
    glb, square = square_on_joint(lambda glb: glb.node("joint"))
    glb.json["materials"][0] |= {"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}}
    places = {"TRANSLATION": glb.accessor([(-1, 0, 0), (1, 0, 0)])}
    glb.json["nodes"][square]["extensions"] = {glb.uses("EXT_mesh_gpu_instancing"): {"attributes": places}}
    run = sheaf.render(write(tmp_path, watched(glb, [0, square])), size="96x48", stats=True)
    picture = run.frame()
    check(picture, box_of(-0.125, 0.125, -0.125, 0.125))
    assert picture.alpha[24, 48] == 0.5
    assert any("nodes[1].EXT_mesh_gpu_instancing: is ignored" in w for w in run.stats()["scene"]["warnings"])


@pytest.mark.parametrize(("strategy", "instances"), WAYS)
def test_texture_coordinates_and_colours_are_morphed(sheaf, tmp_path, strategy, instances):
    """Two nodes of one mesh. The target moves u from the red texel into the green one, halves the red of the vertices'
    colours, adds 1 to their blue, which is clamped, and takes 0.25 off their alpha."""
    glb = Glb()
    texture = glb.texture(rgba([[(255, 0, 255, 255), (0, 255, 255, 255)]]))
    material = glb.unlit("texels", (1, 1, 1), texture=texture, alphaMode="BLEND")
    shape = facing_z(0.5, 0.5, uv_scale=0.25)
    item = glb.primitive(shape, material, COLOR_0=glb.attribute([(1, 1, 0.5, 1)] * 4))
    item["targets"] = [
        {"TEXCOORD_0": glb.attribute([(0.5, 0)] * 4), "COLOR_0": glb.attribute([(-0.5, -0.5, 1, -0.25)] * 4)},
        {"COLOR_0": glb.attribute([(-1, 0, 0)] * 4)},
    ]
    mesh = glb.mesh(item, weights=[0, 0])
    nodes = [
        glb.node(str(x), (x, 0, 0), mesh=mesh, weights=weights)
        for x, weights in ((-1, [0, 0]), (0, [1, 0]), (1, [0, 1]))
    ]
    glb.animation("swap", [(nodes[0], "weights", [0, 1], [(0, 0), (1, 0)], "STEP")])
    run = sheaf.render(
        write(tmp_path, watched(glb, nodes)),
        "--instances", instances, "--frames", "0,24", size="96x48", strategy=strategy, stats=True,
    )  # fmt: skip
    rest, moved = (1, 0, 0.5, 1), (0, 0.5 * 0.75, 0.75, 0.75)
    for frame, first in ((0, rest), (24, moved)):
        found = run.frame(frame).rgba
        for x, wanted in ((-1, first), (0, moved), (1, (0, 0, 0.5, 1))):
            close(found[24, round(48 + 24 * x)], wanted)
    assert not run.stats()["scene"]["warnings"]


def test_targets_that_change_nothing_are_told_of(sheaf, tmp_path):
    """A target's colours and second texture coordinates, where the primitive has none."""
    glb = Glb()
    item = glb.primitive(facing_z(1, 1), glb.unlit("square", (1, 0, 0)))
    item["targets"] = [{"COLOR_0": glb.attribute([(1, 1, 1)] * 4), "TEXCOORD_2": glb.attribute([(1, 1)] * 4)}] * 2
    node = glb.node("square", mesh=glb.mesh(item, weights=[1, 1]))
    warnings = sheaf.render(write(tmp_path, watched(glb, [node])), stats=True).stats()["scene"]["warnings"]
    assert len(warnings) == 2
    assert any("meshes[0].primitives[0].targets[0].COLOR_0" in w for w in warnings)
    assert any("meshes[0].primitives[0].targets[0].TEXCOORD_2" in w for w in warnings)


def test_deformed_scenes_are_the_same_by_every_strategy(sheaf, tmp_path):
    plain, glass = write(tmp_path, lit_square("both", False)), tmp_path / "glass.glb"
    glass.write_bytes(tinted_box(True))
    for scene in (plain, glass):
        runs = sheaf.all(
            [{"scene": scene, "strategy": s, "options": ("--aov", "N")} for s in ("bvh", "hybrid", "crsh", "brute")]
        )
        first = runs[0].frame()
        for run in runs[1:]:
            for name, values in run.frame().channels.items():
                assert np.array_equal(values, first.channels[name], equal_nan=True), name
