#!/usr/bin/env python3
"""NVIDIA Warp's hash grid on one of our packings: its contact list is judged by `touchstone verify`, then its time is written.

    peers/warp_hash_grid.py build/packings/c4_n140063.balls --touchstone build/gpu/bench/touchstone --out warp.json

The timed region is that of our detectors, in stream launch: positions and radii on the device -> list of pairs i < j complete on
the device, with the grid's arrays kept from run to run. Needs `warp-lang` (pip); docs/peers.md says more.
Exit codes: 0 written; 2 bad input; 3 a list that differs (then nothing is written)."""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

try:
    import numpy as np
    import warp as wp
except ImportError as missing:
    sys.exit(f"warp_hash_grid.py: {missing}: `pip install warp-lang numpy` brings both")

REPETITIONS, SAMPLES = 9, 15  # as of our own cases
WARM_UP_S = 0.05
CELLS = (1.0, 1.5, 2.0, 3.0)  # of rmax, tried by --tune-on
MOST_CELLS = 1 << 27

wp.config.quiet = True

# The same rounding as in include/touchstone/contact.h: no operation may be fused with another.
wp.set_module_options({"fuse_fp": False, "enable_backward": False})


@wp.kernel
def find_kernel(grid: wp.uint64, centre: wp.array(dtype=wp.vec3), radius: wp.array(dtype=float), rmax: float, capacity: wp.int64,
                count: wp.array(dtype=wp.int64), pair: wp.array(dtype=wp.vec2i)):
    """One thread a ball, in the order of cells: its later neighbours that touch it."""
    i = wp.hash_grid_point_id(grid, wp.tid())
    p = centre[i]
    r = radius[i]
    # Larger by more than what the search can lose by rounding.
    slack = 1.0e-6 * (wp.max(wp.max(wp.abs(p[0]), wp.abs(p[1])), wp.abs(p[2])) + 2.0 * rmax)
    query = wp.hash_grid_query(grid, p, r + rmax + slack)
    j = int(0)
    while wp.hash_grid_query_next(query, j):
        if j > i:
            d = p - centre[j]
            reach = r + radius[j]
            if (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2] < reach * reach:
                at = wp.atomic_add(count, 0, wp.int64(1))
                if at < capacity:
                    pair[int(at)] = wp.vec2i(i, j)


class HashGridDetector:
    """Warp's grid with cells of `cell_rmax` times rmax; everything allocated once."""

    def __init__(self, balls, device, cell_rmax):
        self.device = wp.get_device(device)
        self.rmax = float(balls[:, 3].max())
        self.cell = cell_rmax * self.rmax
        box = balls[:, :3].max(axis=0) - balls[:, :3].min(axis=0)
        dims = [int(length / self.cell) + 4 for length in box]  # no two cells of the box share an entry
        while dims[0] * dims[1] * dims[2] > MOST_CELLS:
            dims = [max(4, d // 2) for d in dims]
        self.grid = wp.HashGrid(*dims, device=self.device)
        self.grid.reserve(len(balls))
        self.centre = wp.array(np.ascontiguousarray(balls[:, :3]), dtype=wp.vec3, device=self.device)
        self.radius = wp.array(np.ascontiguousarray(balls[:, 3]), dtype=float, device=self.device)
        self.count = wp.zeros(1, dtype=wp.int64, device=self.device)
        self.capacity = 8 * len(balls)
        while True:  # counts are true past capacity: grow and run again
            self.pair = wp.zeros(self.capacity, dtype=wp.vec2i, device=self.device)
            self.detect()
            found = int(self.count.numpy()[0])
            if found <= self.capacity:
                return
            self.capacity = found

    def detect(self):
        self.count.zero_()
        self.grid.build(self.centre, self.cell)
        wp.launch(find_kernel, dim=len(self.radius), device=self.device,
                  inputs=[self.grid.id, self.centre, self.radius, self.rmax, self.capacity, self.count, self.pair])

    def sample_us(self):
        if not self.device.is_cuda:
            begin = time.perf_counter()
            self.detect()
            return 1e6 * (time.perf_counter() - begin)
        start, stop = (wp.Event(device=self.device, enable_timing=True) for _ in range(2))
        stream = wp.get_stream(self.device)
        stream.record_event(start)
        self.detect()
        stream.record_event(stop)
        wp.synchronize_event(stop)
        return 1e3 * wp.get_event_elapsed_time(start, stop)

    def warm_up(self):
        end = time.perf_counter() + WARM_UP_S
        self.sample_us()
        while time.perf_counter() < end:
            self.sample_us()

    def pairs(self):
        return self.pair.numpy()[: int(self.count.numpy()[0])]


def read_balls(path):
    """n x {x, y, z, r}, float32, metres, little-endian."""
    try:
        data = np.fromfile(path, dtype="<f4")
    except OSError as e:
        sys.exit(bad_input(f"{path}: {e.strerror}"))
    if data.size == 0 or os.path.getsize(path) % 16:
        sys.exit(bad_input(f"{path}: {os.path.getsize(path)} bytes: a .balls file holds 16 a ball"))
    return data.reshape(-1, 4)


def bad_input(message):
    print(f"warp_hash_grid.py: {message}", file=sys.stderr)
    return 2


def judge(touchstone, packing, pairs):
    """The verdict of `touchstone verify`, every pair counting, or an exit code."""
    with tempfile.TemporaryDirectory() as folder:
        contacts, verdict = os.path.join(folder, "list.pairs32"), os.path.join(folder, "verdict.json")
        np.ascontiguousarray(pairs, dtype="<i4").tofile(contacts)
        try:
            done = subprocess.run([touchstone, "verify", "--packing", packing, "--contacts", contacts, "--format", "pairs32",
                                   "--list", "half", "--borderline", "exact", "--json", verdict], capture_output=True, text=True)
        except OSError as e:
            sys.exit(bad_input(f"--touchstone {touchstone}: {e.strerror}; it is the program that judges the list"))
        if done.returncode:
            print(done.stdout + done.stderr, file=sys.stderr, end="")
            sys.exit(done.returncode)
        with open(verdict) as file:
            return json.load(file)


def best_cell(path, device):
    """Of CELLS, the one with the least median on another packing."""
    balls = read_balls(path)
    medians = {}
    for cell in CELLS:
        detector = HashGridDetector(balls, device, cell)
        detector.warm_up()
        medians[cell] = np.median([detector.sample_us() for _ in range(SAMPLES)])
    return min(medians, key=medians.get)


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("packing", help="a .balls file")
    words.add_argument("--touchstone", required=True, help="the program that judges the list")
    words.add_argument("--out", required=True, help="the result, JSON")
    words.add_argument("--device", default=None, help="Warp's name of it: cuda:0, cpu; default: the first GPU, else the CPU")
    words.add_argument("--cell", type=float, default=None, help="edge of a cell over rmax; default 2")
    words.add_argument("--tune-on", help="another .balls file, on which the cell is chosen")
    asked = words.parse_args()
    if asked.cell is not None and (not asked.cell > 0 or asked.tune_on):
        return bad_input(f"--cell {asked.cell:g}: a positive number, and not with --tune-on, which chooses it")

    wp.init()
    try:
        device = wp.get_device(asked.device)
    except ValueError as e:
        return bad_input(f"--device {asked.device}: {e}")
    balls = read_balls(asked.packing)
    cell = best_cell(asked.tune_on, device) if asked.tune_on else asked.cell or 2.0
    detector = HashGridDetector(balls, device, cell)
    judge(asked.touchstone, asked.packing, detector.pairs())  # before any time is taken
    detector.warm_up()
    samples = [round(detector.sample_us(), 3) for _ in range(REPETITIONS * SAMPLES)]
    verdict = judge(asked.touchstone, asked.packing, detector.pairs())  # what the last run wrote

    q1, median, q3 = np.percentile(samples, [25, 50, 75])
    case = {"study": "peers", "detector": "warp", "layout": "hash_grid",
            "packing": os.path.splitext(os.path.basename(asked.packing))[0], "packing_hash": verdict["packing"]["packing_hash"],
            "n": len(balls), "cell_cm": 100 * detector.cell, "launch": "stream" if device.is_cuda else None, "cache": "hot",
            "order": "shuffled", "output": "pairs", "tuned_on": asked.tune_on, "contacts": verdict["reference"]["contacts"],
            "contact_hash": verdict["reference"]["contact_hash"], "verified": True, "verified_by": "touchstone verify, exact",
            "median_us": median, "q1_us": q1, "q3_us": q3, "sample_count": len(samples), "provenance": "measured"}
    result = {"schema": "touchstone-peer/1", "peer": {"name": "warp", "version": wp.config.version},
              "device": {"name": device.name, "cuda": device.is_cuda},
              "timed_region": "centres (3 float32 a ball) and radii resident -> pair list complete; the grid's arrays kept",
              "start": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()), "argv": sys.argv, "case": case, "samples_us": samples}
    temporary = asked.out + ".part"
    try:
        with open(temporary, "w") as file:
            json.dump(result, file, indent=1)
            file.write("\n")
        os.replace(temporary, asked.out)
    except OSError as e:
        return bad_input(f"--out {asked.out}: {e.strerror}")
    print(f"{case['packing']}: {len(balls)} balls, {case['contacts']} contacts, verified; warp {wp.config.version} on {device.name}: "
          f"median {median / 1e3:.4f} ms ({q1 / 1e3:.4f} to {q3 / 1e3:.4f}), cell {cell:g} rmax")
    return 0


if __name__ == "__main__":
    sys.exit(main())
