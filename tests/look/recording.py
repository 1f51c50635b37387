"""Checks what the Rerun viewer shows of a recording, or of a run while it computes, without a display.

    python3 tests/look/recording.py --viewer PROGRAM --recording runs/drop/1008/recording.rrd --picture shot.png
    python3 tests/look/recording.py --viewer PROGRAM --picture shot.png --live target/release/droptower scenarios/drop/1008.toml

With --live, droptower runs a scenario and sends it to the viewer, which then has to hold all that a recording holds.
Options of the run follow the scenario.

Needs Python 3 and a Vulkan driver (Debian: mesa-vulkan-drivers), and the viewer's own binary, which
`pip install --no-deps --target DIR rerun-sdk==0.36.3` puts at DIR/rerun_sdk/rerun_cli/rerun. The picture is that of
the last of the times, in seconds.
"""

import argparse
import json
import os
import socket
import struct
import subprocess
import sys
import tempfile
import time
import zlib

WINDOW = (1400, 900)
# The viewer's panels, as shares of the window: the film, and the charts beside it.
PICTURE = (0.0, 0.10, 0.52, 0.74)
CHARTS = (0.62, 0.06, 1.0, 0.95)
# Least numbers of pixels, of 1400 x 900.
STRAINED, CHANGED, DRAWN = 20_000, 10_000, 800
TIMEOUT = 400.0
LAVAPIPE = "/usr/share/vulkan/icd.d/lvp_icd.x86_64.json"


def main():
    args = arguments()
    environment = dict(os.environ)
    if os.path.exists(LAVAPIPE):
        environment.setdefault("VK_ICD_FILENAMES", LAVAPIPE)
    port = free_port()
    command = [args.viewer, *([args.recording] if args.recording else [])]
    command += ["--headless", "--bind", "127.0.0.1", "--port", str(port)]
    command += ["--window-size", "x".join(map(str, WINDOW)), "--hide-welcome-screen"]
    viewer = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        pictures = screenshots(args, port)
    finally:
        viewer.terminate()
        viewer.wait()
    found = faults(pictures)
    for fault in found:
        print(f"{shown(args)}: {fault}", file=sys.stderr)
    print(f"{shown(args)}: {len(pictures)} pictures, the last is {args.picture}")
    return 1 if found else 0


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--viewer", required=True, help="the viewer's binary")
    shown = parser.add_mutually_exclusive_group(required=True)
    shown.add_argument("--recording")
    shown.add_argument("--live", nargs=argparse.REMAINDER, help="droptower, a scenario and options of its run; comes last")
    parser.add_argument("--picture", required=True, help="where to put the PNG")
    parser.add_argument("--at", nargs="+", type=float, default=[0.005, 0.055])
    return parser.parse_args()


def shown(args):
    return args.recording or f"{args.live[1]}, live"


def run_live(args, port):
    """Runs a scenario that the viewer shows while it computes. Snapshots that a slow viewer misses are no fault."""
    droptower, *scenario = args.live
    with tempfile.TemporaryDirectory() as folder:
        live = f"--live=rerun+http://127.0.0.1:{port}/proxy"
        command = [droptower, "run", "--quiet", *scenario, live, "--out", os.path.join(folder, "run")]
        run = subprocess.run(command, stderr=subprocess.PIPE, text=True, timeout=4 * TIMEOUT)
    warnings = [line for line in run.stderr.splitlines() if "--live" in line and "snapshots were left out" not in line]
    if run.returncode or warnings:
        sys.exit(f"{shown(args)}: {run.stderr}")


def free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


def screenshots(args, port):
    """Pictures at all the times, as rows of RGB."""
    control = Control(args.viewer, port)
    try:
        if args.live:
            run_live(args, port)
        deadline = time.monotonic() + TIMEOUT
        while not has_timeline(control):
            if time.monotonic() > deadline:
                sys.exit(f"{shown(args)}: the viewer shows no timeline `time`")
            time.sleep(0.5)
        return [screenshot(control, args, at) for at in args.at]
    finally:
        control.close()


def has_timeline(control):
    recordings = control.call("viewer_state").get("recordings", [])
    return any(line["timeline"] == "time" for recording in recordings for line in recording["timelines"])


def screenshot(control, args, at):
    control.call("set_time", timeline="time", time=round(at * 1e9))
    # Notices at the start disappear, and the view is drawn.
    time.sleep(2.0)
    control.call("screenshot", save_path=os.path.abspath(args.picture), pixels_per_point=1.0)
    return pixels(args.picture)


class Control:
    """The remote control of the viewer: JSON-RPC over standard input and output."""

    def __init__(self, viewer, port):
        pipes = dict(stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.process = subprocess.Popen([viewer, "viewer-mcp"], **pipes)
        self.requests = 0
        client = {"name": "droptower", "version": "1"}
        self.ask("initialize", {"protocolVersion": "2025-03-26", "capabilities": {}, "clientInfo": client})
        self.send({"method": "notifications/initialized"})
        self.connect(f"http://127.0.0.1:{port}")

    def connect(self, endpoint):
        deadline = time.monotonic() + TIMEOUT
        while not self.call("connect", endpoint=endpoint).get("ok"):
            if time.monotonic() > deadline:
                sys.exit("the viewer does not start")
            time.sleep(0.5)

    def call(self, tool, **arguments):
        """The response of a tool; empty where it has none."""
        response = self.ask("tools/call", {"name": tool, "arguments": arguments})
        content = response.get("result", {}).get("content", [])
        text = next((part["text"] for part in content if part.get("type") == "text"), "{}")
        try:
            return json.loads(text)
        except ValueError:
            return {}

    def ask(self, method, params):
        self.requests += 1
        self.send({"method": method, "params": params, "id": self.requests})
        for line in self.process.stdout:
            response = json.loads(line)
            if response.get("id") == self.requests:
                return response
        sys.exit("the viewer's remote control has ended")

    def send(self, message):
        self.process.stdin.write(json.dumps({"jsonrpc": "2.0", **message}) + "\n")
        self.process.stdin.flush()

    def close(self):
        self.process.terminate()
        self.process.wait()


def pixels(path):
    """Rows of (red, green, blue) of a PNG with eight bits a channel and no interlacing."""
    with open(path, "rb") as file:
        data = file.read()
    place, compressed, header = 8, b"", None
    while place < len(data):
        length, kind = struct.unpack(">I4s", data[place : place + 8])
        body = data[place + 8 : place + 8 + length]
        header = struct.unpack(">IIBBBBB", body) if kind == b"IHDR" else header
        compressed += body if kind == b"IDAT" else b""
        place += length + 12
    width, height, depth, colour, _, _, interlaced = header
    if depth != 8 or colour not in (2, 6) or interlaced:
        sys.exit(f"{path}: expected a PNG of 8-bit RGB or RGBA without interlacing")
    step = 3 if colour == 2 else 4
    raw, rows, above = zlib.decompress(compressed), [], bytes(width * step)
    for row in range(height):
        start = row * (width * step + 1)
        above = unfiltered(raw[start], bytearray(raw[start + 1 : start + 1 + width * step]), above, step)
        rows.append([tuple(above[i : i + 3]) for i in range(0, len(above), step)])
    return rows


def unfiltered(kind, line, above, step):
    for i in range(len(line)):
        left = line[i - step] if i >= step else 0
        corner = above[i - step] if i >= step else 0
        if kind == 1:
            line[i] = (line[i] + left) & 255
        elif kind == 2:
            line[i] = (line[i] + above[i]) & 255
        elif kind == 3:
            line[i] = (line[i] + (left + above[i]) // 2) & 255
        elif kind == 4:
            near = left + above[i] - corner
            ways = abs(near - left), abs(near - above[i]), abs(near - corner)
            guess = left if ways[0] <= min(ways[1:]) else above[i] if ways[1] <= ways[2] else corner
            line[i] = (line[i] + guess) & 255
    return line


def faults(pictures):
    last = pictures[-1]
    found = []
    strained = count(last, PICTURE, is_viridis)
    if strained < STRAINED:
        found.append(f"{strained} pixels have the colours of strain, of {STRAINED} at least")
    changed = sum(a != b for a, b in zip(part(pictures[0], PICTURE), part(last, PICTURE)))
    if changed < CHANGED:
        found.append(f"{changed} pixels of the film change between the times, of {CHANGED} at least")
    drawn = count(last, CHARTS, is_bright_colour)
    if drawn < DRAWN:
        found.append(f"{drawn} pixels of coloured lines are in the charts, of {DRAWN} at least")
    return found


def part(rows, share):
    left, top, right, bottom = share
    height, width = len(rows), len(rows[0])
    for row in rows[int(top * height) : int(bottom * height)]:
        yield from row[int(left * width) : int(right * width)]


def count(rows, share, test):
    return sum(map(test, part(rows, share)))


def is_viridis(pixel):
    """Purple over blue to green and yellow, in light and shade: neither grey nor red."""
    red, green, blue = pixel
    purple = blue > green + 25 and blue >= red
    green_or_yellow = green > red + 15 or (green > blue + 40 and red <= green + 25)
    return max(pixel) > 45 and (purple or green_or_yellow)


def is_bright_colour(pixel):
    return max(pixel) > 90 and max(pixel) - min(pixel) > 60


if __name__ == "__main__":
    sys.exit(main())
