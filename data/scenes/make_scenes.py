#!/usr/bin/env python3
"""Writes valley.json and inside.json. The settings are chosen by eye; the trees are scattered.

Repeatable: fixed seeds, standard library only. Own work of the wavefog project, MIT licence.
"""
import json
import math
import pathlib
import random

HERE = pathlib.Path(__file__).parent


def tree(rnd, kind, x, z, least, most):
    return {"file": "../meshes/%s.obj" % kind, "translate": [round(x, 1), -0.3, round(z, 1)],
            "scale": round(rnd.uniform(least, most), 2), "rotate_y_deg": rnd.randrange(360),
            "on_terrain": True}


def write(name, scene):
    """One line a key and a line a mesh."""
    lines = []
    for key, value in scene.items():
        if key in ("meshes", "fog"):
            items = ",\n    ".join(json.dumps(item) for item in value)
            lines.append('  "%s": [\n    %s]' % (key, items))
        else:
            lines.append('  "%s": %s' % (key, json.dumps(value)))
    (HERE / name).write_text("{\n" + ",\n".join(lines) + "\n}\n")


def groves(rnd, count, area, clear, kinds, size, group, spread):
    """Trees in loose groups of up to `group`; clear(x, z) is True where none may stand."""
    x0, z0, x1, z1 = area
    trees = []
    while len(trees) < count:
        cx, cz = rnd.uniform(x0, x1), rnd.uniform(z0, z1)
        wide = spread * rnd.uniform(0.5, 1.5)
        for _ in range(rnd.randrange(2, group)):
            x, z = rnd.gauss(cx, wide), rnd.gauss(cz, wide)
            if not clear(x, z) and x0 < x < x1 and z0 < z < z1:
                trees.append(tree(rnd, rnd.choice(kinds), x, z, *size))
    return trees[:count]


def valley():
    rnd = random.Random(4)
    eye, target = (-2900, 400, 1720), (-900, 62, 760)

    def clear(x, z):
        return math.hypot(x - eye[0], z - eye[2]) < 60

    write("valley.json", {
        "size": [1200, 675],
        "camera": {"eye": eye, "target": target, "up": [0, 1, 0], "fov_y_deg": 32, "near": 2,
                   "far": 12000},
        "sky": [0.50, 0.60, 0.76],
        "sun": {"direction": [0.22, 0.26, -0.92], "colour": [1.40, 0.99, 0.65]},
        "terrain": {"heightmap": "../dem_jacksboro_403x344.png", "rect": [-3000, -2560, 3000, 2560],
                    "height": [0, 330]},
        "fog_colour": [0.83, 0.80, 0.79],
        "fog": [
            {"model": "wavelet", "image": "../weather_coverage_512.png", "basis": "linear",
             "rect": [-4200, -4200, 4200, 4200], "extinction": 0.05,
             "height": {"profile": "exponential", "base": 111, "scale": 17}},
            {"model": "wavelet", "image": "../weather_smooth_512.png", "basis": "quadratic",
             "rect": [-9000, -9000, 9000, 9000], "extinction": 0.00045,
             "height": {"profile": "exponential", "base": 120, "scale": 110}}],
        "method": {"name": "exact", "mu": 1.0},
        "meshes": groves(rnd, 900, (-2870, 800, -1800, 1760), clear, ["pine_far"], (0.6, 1.25),
                         50, 45)})


def inside():
    rnd = random.Random(21)
    eye, target = (160, 4.4, 120), (130, 7.5, 60)

    def clear(x, z):
        # A glade that opens ahead of the camera.
        dx, dz = x - eye[0], z - eye[2]
        ahead = -(dx * 0.447 + dz * 0.894)
        aside = dx * 0.894 - dz * 0.447
        return math.hypot(dx, dz) < 15 or math.hypot(x - 124, z - 82) < 8 or (ahead > 0 and abs(aside + 3) < 6 + 0.12 * ahead and ahead < 70)

    write("inside.json", {
        "size": [1200, 675],
        "camera": {"eye": eye, "target": target, "up": [0, 1, 0], "fov_y_deg": 44, "near": 0.2,
                   "far": 2000},
        "sky": [0.60, 0.65, 0.72],
        "sun": {"direction": [-0.28, 0.26, -0.8], "colour": [1.2, 0.92, 0.68]},
        "terrain": {"heightmap": "../dem_jacksboro_403x344.png", "rect": [-400, -341, 400, 341],
                    "height": [0, 26]},
        "fog_colour": [0.76, 0.77, 0.78],
        "fog": [
            {"model": "wavelet", "image": "../weather_coverage_512.png", "basis": "quadratic",
             "rect": [-300, -300, 300, 300], "extinction": 0.07,
             "height": {"profile": "exponential", "base": 6, "scale": 6}}],
        "method": {"name": "exact", "mu": 1.0},
        "meshes": [{"file": "../meshes/hut.obj", "translate": [124, -0.1, 82], "rotate_y_deg": 52,
                    "on_terrain": True}]
        + groves(rnd, 420, (30, -160, 270, 130), clear, ["pine", "pine", "pine_young"],
                 (0.6, 1.25), 9, 8)})


if __name__ == "__main__":
    valley()
    inside()
