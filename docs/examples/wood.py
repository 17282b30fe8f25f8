#!/usr/bin/env python3
"""Writes a wood, through which a camera walks: wood.py FOLDER [TREES [DETAIL]]

FOLDER gets wood.toml and its models, five trees of about 50,000 DETAIL^2 triangles. By default they
are 200 trees of 100,000, twenty million triangles in all; docs/impostors.md measures that.
"""
import math
import os
import random
import sys

folder = sys.argv[1]
trees = int(sys.argv[2]) if len(sys.argv) > 2 else 200
detail = float(sys.argv[3]) if len(sys.argv) > 3 else 1.42
os.makedirs(folder, exist_ok=True)


class Model:
    def __init__(self):
        self.parts = {"bark": [], "leaves": []}

    def surface(self, material, across, along, point):
        """A grid of point(u, v), u and v in 0..1; it is closed in u."""
        self.parts[material].append(
            (across, along, [[point(i / across, j / along) for i in range(across)]
                             for j in range(along + 1)]))

    def write(self, name, colours):
        with open(os.path.join(folder, name + ".mtl"), "w") as out:
            for material, colour in colours.items():
                out.write("newmtl %s\nKd %.3f %.3f %.3f\n" % (material, *colour))
        with open(os.path.join(folder, name + ".obj"), "w") as out:
            out.write(f"mtllib {name}.mtl\n")
            first = 1
            for material, grids in self.parts.items():
                out.write(f"usemtl {material}\n")
                for across, along, grid in grids:
                    for row in grid:
                        for p in row:
                            out.write("v %.5f %.5f %.5f\n" % p)
                    for j in range(along):
                        for i in range(across):
                            a, b = first + j * across + i, first + j * across + (i + 1) % across
                            out.write(f"f {a} {b} {b + across} {a + across}\n")
                    first += across * (along + 1)


def bumps(rng, count, height):
    """A sum of waves over the directions."""
    waves = [([rng.gauss(0, 1) for _ in range(3)], rng.uniform(0, 6.28)) for _ in range(count)]

    def at(d, frequency):
        return height * sum(math.sin(frequency * sum(a * b for a, b in zip(w, d)) + p)
                            for w, p in waves) / math.sqrt(count)
    return at


def ball(model, rng, centre, radii, across, along):
    coarse, fine = bumps(rng, 5, 0.07), bumps(rng, 6, 0.035)

    def point(u, v):
        s, t = 2 * math.pi * u, math.pi * v
        d = (math.sin(t) * math.cos(s), math.cos(t), -math.sin(t) * math.sin(s))
        r = 1 + coarse(d, 3.0) + fine(d, 11.0)
        return tuple(c + r * size * k for c, size, k in zip(centre, radii, d))
    model.surface("leaves", across, along, point)


def limb(model, begin, end, radius, across, along):
    way = [b - a for a, b in zip(begin, end)]

    def point(u, v):
        s, r = 2 * math.pi * u, radius * (1 - 0.6 * v) * (1 + 0.08 * math.sin(14 * math.pi * u))
        return (begin[0] + way[0] * v + r * math.cos(s), begin[1] + way[1] * v,
                begin[2] + way[2] * v - r * math.sin(s))
    model.surface("bark", across, along, point)


def broad_tree(rng):
    model = Model()
    across, along = int(90 * detail), int(45 * detail)
    top = rng.uniform(3.6, 4.6)
    limb(model, (0, 0, 0), (0, top, 0), 0.28, across // 2, along)
    for i in range(5):
        turn, out = 2 * math.pi * (i + rng.random() / 2) / 5, rng.uniform(0.9, 1.4)
        centre = (out * math.cos(turn), top + rng.uniform(-0.7, 0.4), out * math.sin(turn))
        limb(model, (0, top - 1.6, 0), centre, 0.12, across // 4, along // 2)
        size = rng.uniform(0.9, 1.3)
        ball(model, rng, centre, (size, 0.8 * size, size), across, along)
    ball(model, rng, (0, top + 0.9, 0), (1.4, 1.1, 1.4), across, along)
    return model


def fir_tree(rng):
    model = Model()
    across, along = int(150 * detail), int(20 * detail)
    height = rng.uniform(6.0, 8.0)
    limb(model, (0, 0, 0), (0, height, 0), 0.2, across // 3, along)
    for tier in range(7):
        low = 0.9 + tier * (height - 1.4) / 7
        wide, tall = 1.6 * (1 - tier / 8), 1.9 - 0.15 * tier
        turn = rng.uniform(0, 6.28)

        def point(u, v):
            # Down the cone's outside, and back under it.
            s, down = 2 * math.pi * u, min(v / 0.7, 1.0)
            out = wide * down * (1 + 0.12 * math.sin(23 * s + turn) * down)
            y = low + tall * (1 - down) + 0.1 * math.sin(9 * s + turn) * down
            if v > 0.7:
                out *= 1 - 0.9 * (v - 0.7) / 0.3
                y += 0.35 * (v - 0.7) / 0.3
            return (out * math.cos(s), y, -out * math.sin(s))
        model.surface("leaves", across, along, point)
    return model


rng = random.Random(7)
greens = [(0.16, 0.33, 0.08), (0.24, 0.36, 0.07), (0.36, 0.27, 0.05), (0.07, 0.21, 0.09),
          (0.09, 0.25, 0.12)]
for kind, green in enumerate(greens):
    (broad_tree if kind < 3 else fir_tree)(rng).write(
        f"tree-{kind}", {"bark": (0.2, 0.13, 0.08), "leaves": green})

# The path winds along z; trees keep away from it and from each other.
def path(z):
    return 3.0 * math.sin(z / 9.0)


places = []
while len(places) < trees:
    x, z = rng.uniform(-45, 45), rng.uniform(-75, 15)
    room = 3.2 if len(places) < 200 else 2.4
    if abs(x - path(z)) > 4.5 and all((x - a) ** 2 + (z - b) ** 2 > room ** 2 for a, b in places):
        places.append((x, z))

with open(os.path.join(folder, "wood.toml"), "w") as out:
    frames = range(0, 601, 20)
    eyes = ", ".join("[%d, %.3f, 1.7, %.3f]" % (f, path(8 - f * 0.05), 8 - f * 0.05)
                     for f in frames)
    aims = ", ".join("[%d, %.3f, 1.9, %.3f]" % (f, path(0 - f * 0.05), 0 - f * 0.05)
                     for f in frames)
    out.write(f"""# A walk through a wood; written by docs/examples/wood.py.
title = "A wood of {trees} trees"
background = [0.42, 0.55, 0.72]
ambient_light = [0.42, 0.45, 0.5]

[camera]
position = [{eyes}]
target = [{aims}]
keyframes = "smooth"
fov_degrees = 50.0
near_m = 0.1
far_m = 150.0

[impostors]
tolerance_px = 2.0

[lens]
focal_length_mm = 50.0
f_number = 2.0
focus_m = 8.0

[[light]]
kind = "directional"
direction = [0.5, 1.0, 0.4]
colour = [0.95, 0.9, 0.78]

[material.ground]
diffuse = [0.22, 0.2, 0.1]

[[object]]
shape = "plane"
material = "ground"
width = 160.0
depth = 160.0
""")
    for x, z in places:
        out.write(f"""
[[object]]
shape = "model"
file = "tree-{rng.randrange(5)}.obj"
position = [{x:.2f}, 0.0, {z:.2f}]
rotation_degrees = [0.0, {rng.uniform(0, 360):.1f}, 0.0]
scale = {rng.uniform(0.8, 1.25):.3f}
impostor = "auto"
""")
