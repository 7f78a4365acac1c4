#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Stands in for `sheaf`: the same command line and the same lines on standard output, but the scene says how to behave.

A .gltf's `extras.fake` may hold: `frames` (how many, where the command line names none), `gates` ({frame: FIFO to wait
for before it}), `exit` ({code, message} in place of an end), `signal` (to die by, before frame `at`), `stubborn`
(ignores SIGTERM), `child` (leaves one behind that holds the pipes), `lines` (printed first, as they are), `flood` (MiB
of noise on standard error), `warnings`, `silent_frames` (said to be done, but not there), `no_start`, `padding` (bytes
in each frame), `pace` (seconds each frame takes), `mute` (frames that are made and not reported), `until` (a file:
`exit`, `signal` and `mute` are for as long as it is there), `holds` (what `inspect` says of the scene), `inspect_exit`
(its exit code), `inspect_gate` (FIFO that it waits for), `wall_ms` (of a frame, in the stats). Every frame begun is
noted in a file `ledger` in the job's folder.
"""

import argparse
import json
import os
import pathlib
import signal
import struct
import sys
import time
import zlib

DEVICE = {"name": "a fake one", "driver": "none"}


def parse() -> argparse.Namespace:
    """Takes any option; of those that come as `--name=value` nobody needs a list."""
    parser = argparse.ArgumentParser()
    parser.add_argument("command", choices=["render", "devices", "inspect"])
    parser.add_argument("scene", nargs="?")
    for name in ("json", "preview", "opaque", "resume"):
        parser.add_argument("--" + name, action="store_true")
    for name in ("out", "stats", "progress", "camera", "frames", "name"):
        parser.add_argument("--" + name)
    known, others = parser.parse_known_args()
    for option in others:
        name, given, _ = option.partition("=")
        if not (name.startswith("--") and given):
            parser.error(f"{option}: not --name=value")
    return known


def say(**event: object) -> None:
    print(json.dumps(event), flush=True)


def behaviour(scene: str) -> dict:
    data = pathlib.Path(scene).read_bytes()
    if data[:4] == b"glTF":
        data = data[20 : 20 + struct.unpack_from("<I", data, 12)[0]]
    return json.loads(data).get("extras", {}).get("fake", {})


def numbers(text: str | None, count: int) -> list[int]:
    if text is None:
        return list(range(count))
    found: list[int] = []
    for item in text.split(","):
        span, _, step = item.partition(":")
        first, dash, last = span.partition("-") if not span.startswith("-") else (span, "", "")
        found += range(int(first), int(last) + 1, int(step or 1)) if dash else [int(first)]
    return found


def png(value: int) -> bytes:
    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", 1, 1, 8, 0, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(bytes([0, value % 256])))
        + chunk(b"IEND", b"")
    )


def put(path: pathlib.Path, data: bytes) -> None:
    part = path.with_name("." + path.name + ".part")
    part.write_bytes(data)
    part.rename(path)


def stop_at_signal() -> None:
    def leave(number: int, _: object) -> None:
        os._exit(128 + number)

    signal.signal(signal.SIGTERM, leave)
    signal.signal(signal.SIGINT, leave)


def misbehave(fake: dict, frame: int | None) -> None:
    """What goes wrong before `frame`, or in place of an end."""
    if fake.get("at") == frame and "signal" in fake:
        os.kill(os.getpid(), fake["signal"])
    if fake.get("at") == frame and "exit" in fake:
        say(event="error", code=fake["exit"]["code"], message=fake["exit"]["message"])
        print("sheaf: " + fake["exit"]["message"], file=sys.stderr)
        sys.exit(fake["exit"]["code"])


def prepare(fake: dict) -> None:
    if "until" in fake and not pathlib.Path(fake["until"]).exists():
        for key in ("exit", "signal", "mute"):
            fake.pop(key, None)
    if fake.get("stubborn"):
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
    else:
        stop_at_signal()
    if fake.get("child") and os.fork() == 0:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        signal.pause()
    for line in fake.get("lines", []):
        print(line, flush=True)
    for _ in range(fake.get("flood", 0)):
        sys.stderr.write(("noise " * 20 + "\n") * 8666)


def stem_of(options: argparse.Namespace, frame: int) -> str:
    default = pathlib.Path(options.scene).stem + ".####.exr"
    return (options.name or default).removesuffix(".exr").replace("####", f"{frame:04d}")


def begin(fake: dict, out: pathlib.Path, frame: int) -> None:
    """Waits for the frame's gate, notes it down, and takes its time."""
    if str(frame) in fake.get("gates", {}):
        pathlib.Path(fake["gates"][str(frame)]).read_bytes()
    with (out.parent / "ledger").open("a") as ledger:
        ledger.write(f"{frame}\n")
    time.sleep(fake.get("pace", 0))


def render(options: argparse.Namespace) -> None:
    fake = behaviour(options.scene)
    prepare(fake)
    out = pathlib.Path(options.out)
    wanted = numbers(options.frames, fake.get("frames", 3))
    if options.resume:
        wanted = [frame for frame in wanted if not (out / (stem_of(options, frame) + ".exr")).exists()]
    if not fake.get("no_start"):
        say(event="start", frames=len(wanted))
    print(f"rendering {options.scene}", file=sys.stderr, flush=True)
    for message in fake.get("warnings", []):
        say(event="warning", message=message)
    stats = []
    for done, frame in enumerate(wanted, 1):
        begin(fake, out, frame)
        misbehave(fake, frame)
        stem = stem_of(options, frame)
        if frame not in fake.get("silent_frames", []):
            body = json.dumps({"frame": frame, "arguments": sys.argv[1:]}).encode() + b"\0" * fake.get("padding", 0)
            if options.preview:
                put(out / (stem + ".png"), png(frame))
            put(out / (stem + ".exr"), b"v/1\x01" + body)
        stats.append(
            {
                "frame": frame,
                "time_s": frame / 24,
                "wall_ms": fake.get("wall_ms", 1.5),
                "stages": {"raster": 0.5, "shade": 1},
                "counted": True,
                "rays": {"primary": 4},
                "tests": {
                    "brute_force": 8,
                    "node_object_by_level": {"primary": [1, 1]},
                    "ray_triangle": {"primary": 2},
                },
            }
        )
        if frame in fake.get("mute", []):
            continue
        say(
            event="frame",
            frame=frame,
            done=done,
            total=len(wanted),
            wall_ms=1.5,
            eta_s=0.0,
            file=str(out / (stem + ".exr")),
        )
    misbehave(fake, None)
    put(pathlib.Path(options.stats), json.dumps({"schema": 1, "device": DEVICE, "frames": stats}).encode())
    say(event="done", frames=len(wanted))


def inspect(scene: str) -> None:
    try:
        fake = behaviour(scene)
    except ValueError:
        sys.exit(3)
    if "inspect_gate" in fake:
        pathlib.Path(fake["inspect_gate"]).read_bytes()
    if fake.get("inspect_exit"):
        print(f"sheaf: {scene}: too much of it", file=sys.stderr)
        sys.exit(fake["inspect_exit"])
    print(json.dumps(fake.get("holds", {"triangles": 1, "texture_bytes": 0}), indent=2))


if __name__ == "__main__":
    given = parse()
    if given.command == "inspect":
        inspect(given.scene)
        sys.exit(0)
    if given.command == "devices":
        print("[]")
        gone = os.environ.get("FAKE_DEVICES_GONE")  # a file: there is no device as long as it is there
        sys.exit(4 if gone and pathlib.Path(gone).exists() else int(os.environ.get("FAKE_DEVICES_EXIT", "0")))
    try:
        render(given)
    except OSError as error:
        say(event="error", code=6, message=str(error))
        sys.exit(6)
