#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the scenes and camera paths of this folder. Needs Python 3.10 and NumPy.

make_scenes.py                 write every committed file anew
make_scenes.py --check         say which committed files differ from what would be written; exit 1 if any does
make_scenes.py spheres|soup --out FILE.glb ...   a scene of any size for measurements
"""

import argparse
import sys
from pathlib import Path

sys.dont_write_bytecode = True

import bench_scenes
import camera_paths
import cornell
import geometry_scenes
import material_scenes
import motion_scenes
import odd_scenes
import optics_scenes
import whitted

HERE = Path(__file__).resolve().parent


def committed() -> dict:
    """Path relative to this folder, and what makes its bytes."""
    files = {"whitted.glb": whitted.build, "cornell.glb": cornell.build}
    for module in (geometry_scenes, material_scenes, motion_scenes, odd_scenes, optics_scenes):
        files |= {f"{name}.glb": build for name, build in module.SCENES.items()}
    return files | {f"cameras/{name}.json": build for name, build in camera_paths.PATHS.items()}


def write_all() -> int:
    for name, build in committed().items():
        path = HERE / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(build())
    return 0


def check() -> int:
    files = committed()
    wrong = [
        name for name, build in files.items() if not (HERE / name).is_file() or (HERE / name).read_bytes() != build()
    ]
    strays = [
        path.relative_to(HERE).as_posix() for pattern in ("*.glb", "cameras/*.json") for path in HERE.glob(pattern)
    ]
    wrong += [name for name in strays if name not in files]
    for name in sorted(wrong):
        print(f"{name}: missing, out of date, or made by nothing here", file=sys.stderr)
    return 1 if wrong else 0


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="compare instead of writing")
    kinds = parser.add_subparsers(dest="kind")
    spheres = kinds.add_parser("spheres", help="tessellated spheres over a floor")
    spheres.add_argument("--count", type=int, default=100)
    spheres.add_argument("--frequency", type=int, default=16, help="20·frequency² triangles a sphere")
    spheres.add_argument("--glass", type=float, default=0.1, help="share of glass spheres")
    spheres.add_argument("--mirror", type=float, default=0.25, help="share of mirror spheres")
    spheres.add_argument("--apart", action="store_true", help="a mesh of its own for every sphere")
    spheres.add_argument("--still", action="store_true", help="no animation")
    soup = kinds.add_parser("soup", help="random triangles")
    soup.add_argument("--triangles", type=int, default=10000)
    soup.add_argument("--ratio", type=float, default=100, help="largest size to smallest")
    for each in (spheres, soup):
        each.add_argument("--seed", type=int, default=1)
        each.add_argument("--out", type=Path, required=True)
    return parser.parse_args()


def main() -> int:
    options = dict(vars(arguments()))
    kind, only_check = options.pop("kind"), options.pop("check")
    if kind:
        out = options.pop("out")
        out.write_bytes(getattr(bench_scenes, kind)(**options))
        return 0
    return check() if only_check else write_all()


if __name__ == "__main__":
    sys.exit(main())
