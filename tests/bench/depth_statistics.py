#!/usr/bin/env python3
"""What depth images look like, so that simulated cameras can be held against real ones.

usage: depth_statistics.py [--every N] NAME=FOLDER[:UNITS_PER_METRE] ...

Prints one column for each folder of 16-bit depth PNGs (FOLDER/depth/*.png, or FOLDER/*depth*.png): the share of valid
pixels; of the holes (4-connected), and of the gaps along
rows, how many have 1, 2-4, 5-16 and more pixels; what is left of planes in inverse depth
over 9 x 9 pixels at several depths, and how alike two residuals a pixel apart are; how many valid pixels have nothing
valid within one pixel in the frame after. Needs python3-numpy and python3-opencv.
"""
import argparse
import pathlib
import re

import cv2
import numpy as np

DEPTHS = (0.5, 1.0, 2.0, 3.0)  # metres
BINS = ((1, 1), (2, 4), (5, 16), (17, 10**9))


def load(folder, units):
    files = list((folder / "depth").glob("*.png")) or list(folder.glob("*depth*.png"))
    files.sort(key=lambda f: [float(n) for n in re.findall(r"\d+(?:\.\d+)?", f.name.removesuffix(".png"))])
    return [lambda f=f: read(f, units) for f in files]


def read(file, units):
    raw = cv2.imread(str(file), cv2.IMREAD_UNCHANGED)
    return np.where(raw == 65535, 0, raw).astype(np.float64) / units


def holes(valid):
    """Numbers of holes by size."""
    _, _, stats, _ = cv2.connectedComponentsWithStats((~valid).astype(np.uint8), connectivity=4)
    areas = stats[1:, cv2.CC_STAT_AREA]
    return np.array([((areas >= low) & (areas <= high)).sum() for low, high in BINS])


def gaps(valid):
    """Numbers of runs of invalid pixels along rows, by length."""
    edges = np.diff(np.pad(~valid, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    lengths = np.nonzero(edges.ravel() == -1)[0] - np.nonzero(edges.ravel() == 1)[0]
    return np.array([((lengths >= low) & (lengths <= high)).sum() for low, high in BINS])


def planes(depth, half=4):
    """(depth, RMS residual in metres, correlation at one pixel) of each window that holds one plane."""
    size = 2 * half + 1
    y, x = (a.ravel() - half for a in np.mgrid[0:size, 0:size])
    basis = np.stack([np.ones(size * size), x, y], 1)
    found = []
    for v in range(half, depth.shape[0] - half, size):
        for u in range(half, depth.shape[1] - half, size):
            z = depth[v - half : v + half + 1, u - half : u + half + 1].ravel()
            ok = z > 0
            if ok.sum() < 0.3 * z.size or not z[ok].any():
                continue
            middle = np.median(z[ok])
            if np.ptp(z[ok]) > 0.12 * middle:  # an edge
                continue
            b = basis[ok]
            plane, *_ = np.linalg.lstsq(b, 1 / z[ok], rcond=None)
            rest = np.zeros(z.size)
            rest[ok] = z[ok] - 1 / (b @ plane)
            rest, ok = rest.reshape(size, size), ok.reshape(size, size)
            both = ok[:, 1:] & ok[:, :-1]
            square = (rest[ok] ** 2).mean()
            product = (rest[:, 1:] * rest[:, :-1])[both].mean() if both.any() else 0
            found.append((middle, np.sqrt(square), product / square if square > 0 else 0))
    return found


def column(frames, every):
    valid, sizes, runs, found, gone = [], np.zeros(len(BINS)), np.zeros(len(BINS)), [], []
    for i in range(0, len(frames), every):
        depth = frames[i]()
        seen = depth > 0
        valid.append(seen.mean())
        sizes += holes(seen)
        runs += gaps(seen)
        found += planes(depth)
        if i + 1 < len(frames) and seen.any():
            after = cv2.dilate((frames[i + 1]() > 0).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
            gone.append((seen & ~after).sum() / seen.sum())
    rows = ["%.1f %%" % (100 * np.mean(valid))]
    rows += ["%.1f %%" % (100 * s / max(1, sizes.sum())) for s in sizes] + ["%.0f" % (sizes.sum() / len(valid))]
    rows += ["%.1f %%" % (100 * s / max(1, runs.sum())) for s in runs] + ["%.0f" % (runs.sum() / len(valid))]
    table = np.array(found).reshape(-1, 3)
    for z in DEPTHS:
        near = table[np.abs(table[:, 0] / z - 1) < 0.15] if len(table) else table
        rows.append("%.1f mm, %.2f" % (1000 * np.median(near[:, 1]), np.median(near[:, 2])) if len(near) >= 30 else "-")
    return rows + ["%.1f %%" % (100 * np.mean(gone)) if gone else "-"]


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n")[2][7:])
    parser.add_argument("--every", type=int, default=10)
    parser.add_argument("folders", nargs="+")
    arguments = parser.parse_args()
    names, columns = [], []
    for word in arguments.folders:
        name, _, rest = word.partition("=")
        folder, _, units = rest.partition(":")
        frames = load(pathlib.Path(folder), float(units or 5000))
        if not frames:
            parser.error(f"{folder}: holds no depth images; give a folder with depth/*.png or *depth*.png.")
        names.append(name)
        columns.append(column(frames, arguments.every))
    labels = ["valid pixels"] + [f"holes of {n} px" for n in ("1", "2-4", "5-16", "17 and more")] + ["holes a frame"]
    labels += [f"gaps along rows of {n} px" for n in ("1", "2-4", "5-16", "17 and more")] + ["gaps a frame"]
    labels += [f"plane residual at {z:g} m, alike at 1 px" for z in DEPTHS] + ["gone in the next frame"]
    print("| | " + " | ".join(names) + " |\n|" + "---|" * (len(names) + 1))
    for i, label in enumerate(labels):
        print(f"| {label} | " + " | ".join(c[i] for c in columns) + " |")


if __name__ == "__main__":
    main()
