#!/usr/bin/env python3
"""Writes an OBJ of a trefoil knot with bumps: knot.py SEGMENTS SIDES > knot.obj

2 SEGMENTS SIDES triangles with normals; relief.md measures impostors with 500 x 150: 150,000.
"""
import math
import sys

segments, sides = int(sys.argv[1]), int(sys.argv[2])


def centre(t):
    return [math.sin(t) + 2 * math.sin(2 * t), math.cos(t) - 2 * math.cos(2 * t), -math.sin(3 * t)]


def unit(v):
    length = math.sqrt(sum(c * c for c in v))
    return [c / length for c in v]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def point(i, j):
    t, s = 2 * math.pi * i / segments, 2 * math.pi * j / sides
    before, here, after = centre(t - 1e-3), centre(t), centre(t + 1e-3)
    along = unit([a - b for a, b in zip(after, before)])
    across = unit(cross(along, here))
    up = cross(across, along)
    radius = 0.45 + 0.04 * math.cos(9 * s) * math.cos(40 * t)
    return [here[k] + radius * (math.cos(s) * across[k] + math.sin(s) * up[k]) for k in range(3)]


grid = [[point(i, j) for j in range(sides)] for i in range(segments)]
for row in grid:
    for p in row:
        print("v %.6f %.6f %.6f" % tuple(p))
for i in range(segments):
    for j in range(sides):
        du = [a - b for a, b in zip(grid[(i + 1) % segments][j], grid[i - 1][j])]
        dv = [a - b for a, b in zip(grid[i][(j + 1) % sides], grid[i][j - 1])]
        print("vn %.5f %.5f %.5f" % tuple(unit(cross(dv, du))))
for i in range(segments):
    for j in range(sides):
        a, b = i * sides + j + 1, i * sides + (j + 1) % sides + 1
        c, d = (i + 1) % segments * sides + j + 1, (i + 1) % segments * sides + (j + 1) % sides + 1
        print(f"f {a}//{a} {b}//{b} {d}//{d} {c}//{c}")
