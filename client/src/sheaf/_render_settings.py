# SPDX-License-Identifier: MIT
# Written by engine/settings/generate.py from the engine's table of settings.
"""The settings that a service takes: their types, and what is known of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Literal, NamedTuple, TypedDict


class RenderSettings(TypedDict, total=False):
    """What `Client.submit` takes beside scene and camera; what is not given is the service's default.

    `None` counts as not given. The service checks all values and answers `InvalidRequest` with the reason.
    """

    camera_node: str | int | None
    """A camera of the scene; default the first, else the scene is framed whole."""
    scene_name: str | int | None
    """Which scene of the file; default the file's own."""
    variant: str | int | None
    """Which of the materials' variants that the file has (KHR_materials_variants); default none."""
    frames: str | int | Iterable[int] | None
    """Which frames are rendered."""
    fps: float | str | None
    """Frame f shows the time f / fps; default the camera path's, else 24 (above 0, at most 1000000 frames per
    second).
    """
    animation: str | int | None
    """Which animation, or all; default the first."""
    size: str | tuple[int, int] | None
    """Width and height of the picture (1 to 16384 pixels)."""
    quality: Literal["draft", "production", "exact"] | None
    """Named settings, which others given beside it change."""
    spp: int | str | None
    """Samples per pixel, or as many as ERROR asks for, at most MOST, else 256 (1 to 65536)."""
    filter: Literal["box", "triangle", "gaussian"] | None
    """How samples make up a pixel."""
    depth: int | None
    """Generations of reflection and refraction (0 to 4096)."""
    cutoff: float | None
    """Least weight of a ray worth following (0 to 1)."""
    glass_alpha: Literal["opaque", "transparent"] | None
    """Transparent: the background shows through transmission, alpha is what glass holds back."""
    back_faces: Literal["hide", "show"] | None
    """Hide: the backs of single-sided surfaces are passed through, as glTF says."""
    opaque: bool | None
    """Every surface opaque and two-sided."""
    environment: str | tuple[float, float, float] | None
    """Radiance of what rays that miss everything see; default 0, or 0.4 in a scene without lights (0 to 1000000)."""
    aov: str | Sequence[str] | None
    """Further layers in the frames (Z, N, P, albedo, UV, id, tests, all)."""
    z_background: float | str | None
    """Layer Z where nothing is hit (metres)."""
    compression: Literal["none", "rle", "zips", "zip", "piz", "dwaa"] | None
    """How the frames are compressed; dwaa loses colour, and ffmpeg reads no layers beside it."""
    strategy: (
        Literal[
            "auto",
            "hybrid",
            "crsh",
            "rsh",
            "frustum",
            "classify",
            "bvh",
            "brute",
            "rayquery",
            "reference",
        ]
        | None
    )
    """How rays find triangles."""
    sort: Literal["auto", "on", "off"] | None
    """Whether rays are sorted; auto: where the strategy needs it."""
    primary: Literal["auto", "raster", "trace"] | None
    """First hits by the raster pass or traced; auto: raster, but where a pixel has more than eight triangles."""
    instances: Literal["auto", "copied", "shared"] | None
    """Copied: triangles of each (fast); shared: transformed when read (small); auto: shared from 8 million on."""
    memory: int | None
    """Memory for rays and what else scales with the picture (16 to 1048576 MiB)."""
    device: str | int | None
    """Vulkan device, by index or part of its name."""
    name: str | None
    """File names, # for the frame number; default <scene>.####.exr."""
    preview: bool | None
    """A tone-mapped PNG beside each frame."""
    count: Literal["auto", "on", "off"] | None
    """Whether intersection tests are counted; auto: where --stats or the layer tests ask."""


class Setting(NamedTuple):
    """What is known of a setting.

    Attributes:
        kind: of its value, as `sheaf options` names it.
        syntax: on a command line; empty for a switch.
        choices: where there is a list of them.
        default: of the engine; None where that depends on the scene.
        help: what it is.
    """

    kind: str
    syntax: str
    choices: tuple[str, ...]
    default: str | int | float | bool | None
    help: str


SETTINGS: Mapping[str, Setting] = {
    "camera-node": Setting(
        "name-or-index",
        "NAME|INDEX",
        (),
        None,
        "a camera of the scene; default the first, else the scene is framed whole",
    ),
    "scene-name": Setting("name-or-index", "NAME|INDEX", (), None, "which scene of the file; default the file's own"),
    "variant": Setting(
        "name-or-index",
        "NAME|INDEX",
        (),
        None,
        "which of the materials' variants that the file has (KHR_materials_variants); default none",
    ),
    "frames": Setting("frames", "A-B[:STEP]|N,M,...", (), "0", "which frames are rendered"),
    "fps": Setting("rate", "N|N/M", (), None, "frame f shows the time f / fps; default the camera path's, else 24"),
    "animation": Setting("name-or-index", "NAME|INDEX|all", (), None, "which animation, or all; default the first"),
    "size": Setting("size", "WxH", (), "1280x720", "width and height of the picture"),
    "quality": Setting(
        "choice", "NAME", ("draft", "production", "exact"), None, "named settings, which others given beside it change"
    ),
    "spp": Setting(
        "samples",
        "N|adaptive:ERROR[:MOST]",
        (),
        1,
        "samples per pixel, or as many as ERROR asks for, at most MOST, else 256",
    ),
    "filter": Setting("choice", "NAME", ("box", "triangle", "gaussian"), "gaussian", "how samples make up a pixel"),
    "depth": Setting("integer", "N", (), 4, "generations of reflection and refraction"),
    "cutoff": Setting("number", "W", (), 0.002, "least weight of a ray worth following"),
    "glass-alpha": Setting(
        "choice",
        "NAME",
        ("opaque", "transparent"),
        "opaque",
        "transparent: the background shows through transmission, alpha is what glass holds back",
    ),
    "back-faces": Setting(
        "choice",
        "NAME",
        ("hide", "show"),
        "hide",
        "hide: the backs of single-sided surfaces are passed through, as glTF says",
    ),
    "opaque": Setting("flag", "", (), False, "every surface opaque and two-sided"),
    "environment": Setting(
        "color",
        "R,G,B",
        (),
        None,
        "radiance of what rays that miss everything see; default 0, or 0.4 in a scene without lights",
    ),
    "aov": Setting(
        "layers", "LIST", ("Z", "N", "P", "albedo", "UV", "id", "tests", "all"), None, "further layers in the frames"
    ),
    "z-background": Setting("number-or-inf", "X|inf", (), 10000000000.0, "layer Z where nothing is hit"),
    "compression": Setting(
        "choice",
        "NAME",
        ("none", "rle", "zips", "zip", "piz", "dwaa"),
        "zip",
        "how the frames are compressed; dwaa loses colour, and ffmpeg reads no layers beside it",
    ),
    "strategy": Setting(
        "choice",
        "NAME",
        ("auto", "hybrid", "crsh", "rsh", "frustum", "classify", "bvh", "brute", "rayquery", "reference"),
        "auto",
        "how rays find triangles",
    ),
    "sort": Setting(
        "choice", "NAME", ("auto", "on", "off"), "auto", "whether rays are sorted; auto: where the strategy needs it"
    ),
    "primary": Setting(
        "choice",
        "NAME",
        ("auto", "raster", "trace"),
        "auto",
        "first hits by the raster pass or traced; auto: raster, but where a pixel has more than eight triangles",
    ),
    "instances": Setting(
        "choice",
        "NAME",
        ("auto", "copied", "shared"),
        "auto",
        "copied: triangles of each (fast); shared: transformed when read (small); auto: shared from 8 million on",
    ),
    "memory": Setting("integer", "MIB", (), 1024, "memory for rays and what else scales with the picture"),
    "device": Setting("name-or-index", "NAME|INDEX", (), None, "Vulkan device, by index or part of its name"),
    "name": Setting("text", "PATTERN", (), None, "file names, # for the frame number; default <scene>.####.exr"),
    "preview": Setting("flag", "", (), False, "a tone-mapped PNG beside each frame"),
    "count": Setting(
        "choice",
        "NAME",
        ("auto", "on", "off"),
        "auto",
        "whether intersection tests are counted; auto: where --stats or the layer tests ask",
    ),
}

PRESETS: Mapping[str, Mapping[str, str | int | float]] = {
    "draft": {"spp": 1, "depth": 2, "cutoff": 0.02},
    "production": {"spp": "adaptive:0.02:256", "depth": 6, "cutoff": 0.002},
    "exact": {"spp": "adaptive:0.005:1024", "depth": 32, "cutoff": 0.0},
}
