# SPDX-License-Identifier: MIT
"""Camera paths: where the eye is at a time, what the lens shows, through the file's own matrices and layers."""

import json
import math

import numpy as np
import pytest

from physics import box_of, inside, pixels
from rendering import SCENES
from whitted import AIM

CAMERAS = SCENES / "cameras"


def eye(picture) -> np.ndarray:
    return np.linalg.inv(picture.header["worldToCamera"].astype(float))[3, :3]


def look(picture) -> np.ndarray:
    """Unit vector along the view axis: the point one metre before the camera projects onto the middle."""
    axes = picture.header["worldToCamera"].astype(float)[:3, 2]
    return axes if axes @ (np.array(AIM) - eye(picture)) > 0 else -axes


def rates(picture) -> float:
    return float(picture.header["framesPerSecond"])


def test_turntable(sheaf):
    run = sheaf.render(
        "whitted", "--camera", CAMERAS / "whitted_turntable.json", "--frames", "0,24,48,96", size="32x18"
    )
    for frame, place in ((0, (0.05, 2.1, 7.2)), (24, (7.25, 2.1, 0)), (48, (0.05, 2.1, -7.2)), (96, (0.05, 2.1, 7.2))):
        picture = run.frame(frame)
        np.testing.assert_allclose(eye(picture), place, atol=2e-3)
        aim = (np.array(AIM) - place) / np.linalg.norm(np.array(AIM) - place)
        np.testing.assert_allclose(look(picture), aim, atol=2e-3)
    # The path loops; so does the animation: the very same picture.
    assert np.array_equal(run.frame(0).rgba, run.frame(96).rgba)


def test_look_at_with_focal_lengths(sheaf):
    """24000/1001 frames per second; half way between keys at 0 and 2 s; 35 mm and 28 mm over a sensor 20.25 mm high."""
    run = sheaf.render(
        "whitted", "--camera", CAMERAS / "whitted_look_at.json", "--fps", 1, "--frames", "0,1,2", size="32x18"
    )
    for frame, place, focal in ((0, (-3, 2.5, 9), 35), (1, (-1.25, 2.15, 7.5), None), (2, (0.5, 1.8, 6), 28)):
        picture = run.frame(frame)
        np.testing.assert_allclose(eye(picture), place, atol=1e-4)
        if focal:
            up = np.linalg.norm(
                picture.header["worldToNDC"].astype(float)[:3, 1]
                - 0.5 * picture.header["worldToNDC"].astype(float)[:3, 3]
            )
            assert 0.5 / up == pytest.approx(20.25 / 2 / focal, rel=1e-4)  # tangent of half the field of view
    own = sheaf.render("whitted", "--camera", CAMERAS / "whitted_look_at.json", "--frames", "24", size="16x9").frame()
    assert rates(own) == pytest.approx(24000 / 1001)
    assert float(own.header["sheaf:time"][0]) == pytest.approx(1.001)


def test_matrices_cut_hard_and_field_of_view_across(sheaf):
    run = sheaf.render(
        "whitted", "--camera", CAMERAS / "whitted_matrices.json", "--frames", "0,23,24,47,48", size="32x18"
    )
    for frame, angle in ((0, 0), (23, 0), (24, 0.4), (47, 0.4), (48, -0.4)):
        place = (AIM[0] + 7.2 * math.sin(angle), 2.1, AIM[2] + 7.2 * math.cos(angle))
        np.testing.assert_allclose(eye(run.frame(frame)), place, atol=1e-4)
    matrix = run.frame(0).header["worldToNDC"].astype(float)
    across = np.linalg.norm(matrix[:3, 0] - 0.5 * matrix[:3, 3])
    assert 0.5 / across == pytest.approx(math.tan(math.radians(32)), rel=1e-4)


def test_plan_is_flat_and_clipped(sheaf):
    """Orthographic from 10 m above, 6 m high: a metre is a metre wherever it is, and Z is 10 - y."""
    picture = sheaf.render(
        "whitted", "--camera", CAMERAS / "whitted_plan.json",
        "--frames", 48, "--fps", 24, "--aov", "P,Z", size="64x36",
    ).frame()  # fmt: skip
    np.testing.assert_allclose(eye(picture), (0, 10, 0), atol=1e-4)  # half way from x = -1 to 1
    x, up = pixels(64, 36, 3 * 64 / 36, 3)
    hit = picture.alpha == 1
    assert hit.mean() > 0.5
    position = picture.layer("P")
    np.testing.assert_allclose(position[..., 0][hit], x[hit], atol=1e-4)
    np.testing.assert_allclose(position[..., 2][hit], -up[hit], atol=1e-4)
    np.testing.assert_allclose(picture.layer("Z")[hit], 10 - position[..., 1][hit], atol=1e-4)


def test_nerfstudio_path(sheaf):
    run = sheaf.render("whitted", "--camera", CAMERAS / "whitted_nerfstudio.json", "--frames", "0,12", size="32x18")
    for frame, angle in ((0, 0), (12, math.pi / 2)):
        place = (AIM[0] + 7.2 * math.sin(angle), 2.1, AIM[2] + 7.2 * math.cos(angle))
        np.testing.assert_allclose(eye(run.frame(frame)), place, atol=1e-3)


def test_near_and_far_clip(sheaf, tmp_path):
    """alpha_blend.glb has surfaces at 3, 4 and 5 m from z = 5: the range along the view axis decides which are seen."""
    for near, far, colour in (
        (0.1, 10, (0.25, 0.375, 0.375)),
        (3.5, 10, (0, 0.5, 0.5)),
        (4.5, 10, (0, 0, 1)),
        (0.1, 2, None),
    ):
        path = tmp_path / f"{near}-{far}.json"
        path.write_text(
            json.dumps(
                {
                    "version": 1,
                    "keys": [
                        {
                            "time": 0,
                            "position": [0, 0, 5],
                            "rotation": [0, 0, 0, 1],
                            "ortho_height": 2,
                            "near": near,
                            "far": far,
                        }
                    ],
                }
            )
        )
        picture = sheaf.render("alpha_blend", "--camera", path, "--environment", "0,0,0", size="40x20").frame()
        middle = picture.rgba[10, 20]
        np.testing.assert_allclose(middle, (*colour, 1) if colour else (0, 0, 0, 0), rtol=1e-3)


def test_a_moving_camera_over_a_still_scene(sheaf, tmp_path):
    """Linear in position: after half the time, half the way; before the first key and after the last, they hold."""
    path = tmp_path / "slide.json"
    path.write_text(
        json.dumps(
            {
                "version": 1,
                "interpolation": "linear",
                "fov_axis": "vertical",
                "keys": [
                    {"time": t, "position": [x, 0, 5], "rotation": [0, 0, 0, 1], "ortho_height": 2}
                    for t, x in ((1, 0), (2, 1))
                ],
            }
        )
    )
    run = sheaf.render("unlit", "--camera", path, "--fps", 4, "--frames", "0,4,6,8,20", size="96x48", stats=True)
    assert not any(f["repeated"] for f in run.stats()["frames"])
    for frame, moved in ((0, 0), (4, 0), (6, 0.5), (8, 1), (20, 1)):
        picture = run.frame(frame)
        x, y = pixels(96, 48, 2, 1, (moved, 0))
        square, sure = inside(x, y, box_of(-1, 1, -1, 1))
        assert ((picture.alpha == 1) == square)[sure].all()


def test_perspective_sees_by_the_tangent(sheaf, tmp_path):
    """A 2 m square from 4 m with a field of view of 90° upright: its half height is a quarter of the picture's."""
    path = tmp_path / "wide.json"
    path.write_text(
        json.dumps(
            {
                "version": 1,
                "fov_axis": "vertical",
                "keys": [{"time": 0, "eye": [0, 0, 4], "target": [0, 0, 0], "up": [0, 1, 0], "fov_degrees": 90}],
            }
        )
    )
    picture = sheaf.render("unlit", "--camera", path, size="96x48").frame()
    x, y = pixels(96, 48, 8, 4)  # in the square's plane
    square, sure = inside(x, y, box_of(-1, 1, -1, 1))
    assert ((picture.alpha == 1) == square)[sure].all()
