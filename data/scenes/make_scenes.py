#!/usr/bin/env python3
"""Writes the scenes beside it but bench64.json. The settings are chosen by eye; the trees are scattered.

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


HILLS = {"heightmap": "../dem_jacksboro_403x344.png", "rect": [-400, -341, 400, 341],
         "height": [0, 26]}
HUT = {"file": "../meshes/hut.obj", "translate": [124, -0.1, 82], "rotate_y_deg": 52,
       "on_terrain": True}
MOUNTAINS = {"heightmap": "../dem_jacksboro_403x344.png", "rect": [-3000, -2560, 3000, 2560],
             "height": [0, 330]}


def near_eye(eye, metres):
    return lambda x, z: math.hypot(x - eye[0], z - eye[2]) < metres


def halfspace():
    """A sea of fog, denser with depth, lit by a low sun."""
    rnd = random.Random(7)
    eye = (-1500, 262, 1500)
    write("halfspace.json", {
        "size": [1200, 675],
        "camera": {"eye": eye, "target": (-300, 178, 300), "up": [0, 1, 0], "fov_y_deg": 34,
                   "near": 2, "far": 12000},
        "sky": [0.52, 0.58, 0.74],
        "sun": {"direction": [0.75, 0.16, -0.60], "colour": [1.5, 0.93, 0.55]},
        "terrain": MOUNTAINS,
        "fog_colour": [0.86, 0.79, 0.75],
        "fog": [{"model": "halfspace", "normal": [0, 1, 0], "point": [0, 178, 0],
                 "gradient": 0.00035},
                {"model": "layers", "profile": "exponential", "extinction": 0.00012, "base": 150,
                 "scale": 90}],
        "method": {"name": "exact", "mu": 1.0},
        "meshes": groves(rnd, 700, (-1500, 600, -600, 1500), near_eye(eye, 80), ["pine_far"],
                         (0.7, 1.3), 40, 45)})


def layers():
    """A thin layer that hangs over a clearing: a ramp of four points."""
    rnd = random.Random(33)
    eye, target = (160, 7.6, 120), (118, 7.2, 60)

    def clear(x, z):
        dx, dz = x - eye[0], z - eye[2]
        ahead, aside = -(dx * 0.57 + dz * 0.82), dx * 0.82 - dz * 0.57
        return (math.hypot(dx, dz) < 14 or math.hypot(x - 124, z - 82) < 9 or
                (ahead > 0 and abs(aside) < 7 + 0.12 * ahead and ahead < 60))

    write("layers.json", {
        "size": [1200, 675],
        "camera": {"eye": eye, "target": target, "up": [0, 1, 0], "fov_y_deg": 42, "near": 0.2,
                   "far": 2000},
        "sky": [0.46, 0.56, 0.74],
        "sun": {"direction": [-0.80, 0.22, -0.50], "colour": [1.45, 0.98, 0.62]},
        "terrain": HILLS,
        "fog_colour": [0.80, 0.82, 0.86],
        "fog": [{"model": "layers", "profile": "ramp",
                 "points": [[3.0, 0], [4.4, 0.045], [5.2, 0.045], [6.8, 0]]},
                {"model": "layers", "profile": "exponential", "extinction": 0.0012, "base": 6,
                 "scale": 25}],
        "method": {"name": "exact", "mu": 1.0},
        "meshes": [HUT] + groves(rnd, 420, (-20, -160, 270, 130), clear,
                                 ["pine", "pine", "pine_young"], (0.6, 1.25), 9, 8)})


def cosines():
    """Strata of mist (paper 000, figure 6): its five functions, at this scene's scale."""
    rnd = random.Random(11)
    eye = (-2900, 372, 1720)
    unit, mean = 0.0016, 0.00030  # of the paper's length: 1/m; of its density 1: 1/m

    def wave(share, direction, frequency):
        # Strata part in front of the eye: their least density is at its height.
        turn = frequency * math.pi * unit * sum(d * e for d, e in zip(direction, (0, 345, 0)))
        return {"extinction": round(share * mean, 9), "direction": direction,
                "frequency": round(frequency * math.pi * unit, 7),
                "phase": round((math.pi - turn) % (2 * math.pi), 4)}

    write("cosines.json", {
        "size": [1200, 675],
        "camera": {"eye": eye, "target": (-1100, 190, 560), "up": [0, 1, 0], "fov_y_deg": 30,
                   "near": 2, "far": 5500},
        "sky": [0.60, 0.64, 0.72],
        "sun": {"direction": [0.22, 0.26, -0.92], "colour": [1.55, 1.02, 0.64]},
        "terrain": MOUNTAINS,
        "fog_colour": [0.84, 0.78, 0.74],
        # cos(pi x) cos(pi z / 2) is half the sum of the cosines of their sum and difference.
        "fog": [{"model": "cosines", "extinction": mean,
                 "waves": [wave(0.5, [0, 1, 0], 5), wave(0.2, [0.1, 1, 0], 7),
                           wave(0.2, [-0.05, 1, 0], 5), wave(0.05, [1, 0, 0.5], 1),
                           wave(0.05, [1, 0, -0.5], 1)]}],
        "method": {"name": "exact", "mu": 1.0},
        "meshes": groves(rnd, 700, (-2870, 800, -1800, 1760), near_eye(eye, 60), ["pine_far"],
                         (0.6, 1.25), 50, 45)})


def polynomials():
    """Waves of fog between clear air (paper 000, figure 7): its polynomial, on two axes."""
    rnd = random.Random(21)
    eye = (178, 12, 138)
    paper = [0.8, -1, 0, 0, 0, 1]
    write("polynomials.json", {
        "size": [1200, 675],
        "camera": {"eye": eye, "target": (110, 5, 40), "up": [0, 1, 0], "fov_y_deg": 40,
                   "near": 0.2, "far": 700},
        "sky": [0.58, 0.64, 0.74],
        "sun": {"direction": [-0.55, 0.34, -0.55], "colour": [1.35, 1.05, 0.75]},
        "terrain": HILLS,
        "fog_colour": [0.79, 0.81, 0.84],
        "fog": [{"model": "polynomials", "polynomials": [
            {"extinction": 0.002, "coefficients": paper, "direction": [1, 0, 0],
             "centre": [120, 0, 0], "half_width": 60, "outside": "repeat"},
            {"extinction": 0.002, "coefficients": paper, "direction": [0, 0, 1],
             "centre": [0, 0, 60], "half_width": 60, "outside": "repeat"},
            {"extinction": 0.05, "coefficients": [1, 0, -2, 0, 1], "direction": [0, 1, 0],
             "centre": [0, 3, 0], "half_width": 5, "outside": "zero"}]}],
        "method": {"name": "exact", "mu": 1.0},
        "meshes": [HUT] + groves(rnd, 380, (-40, -160, 270, 130), near_eye(eye, 25),
                                 ["pine", "pine", "pine_young"], (0.6, 1.25), 9, 8)})


def potentials():
    """Mist that gathers round some trees, over a brook and behind the hut."""
    rnd = random.Random(5)
    eye = (168, 10.5, 128)

    def clear(x, z):
        return math.hypot(x - eye[0], z - eye[2]) < 22 or math.hypot(x - 124, z - 82) < 9

    write("potentials.json", {
        "size": [1200, 675],
        "camera": {"eye": eye, "target": (112, 5, 58), "up": [0, 1, 0], "fov_y_deg": 42,
                   "near": 0.2, "far": 1500},
        "sky": [0.34, 0.42, 0.58],
        "sun": {"direction": [-0.7, 0.16, -0.55], "colour": [1.3, 0.82, 0.52]},
        "terrain": HILLS,
        "fog_colour": [0.72, 0.74, 0.80],
        "fog": [{"model": "potentials", "extinction": 0.0004, "objects": [
            {"line": [[150, 1.5, 70], [95, 1.5, 112]], "extinction": 0.12, "reach": 2.5},
            {"point": [96, 5, 52], "extinction": 0.10, "reach": 6},
            {"point": [150, 6, 50], "extinction": 0.10, "reach": 6},
            {"point": [70, 5, 80], "extinction": 0.08, "reach": 7},
            {"sphere": [110, 2, 20], "radius": 10, "extinction": 0.06, "reach": 8}]}],
        "method": {"name": "exact", "mu": 1.0},
        "meshes": [HUT] + groves(rnd, 300, (-20, -120, 260, 130), clear,
                                 ["pine", "pine", "pine_young"], (0.6, 1.25), 9, 8)})


def drift():
    """Banks of a tiled map and thin strata of cosines, each in a wind of its own."""
    rnd = random.Random(4)
    eye, target = (-2900, 400, 1720), (-900, 62, 760)
    write("drift.json", {
        "size": [1200, 675],
        "camera": {"eye": eye, "target": target, "up": [0, 1, 0], "fov_y_deg": 32, "near": 2,
                   "far": 9000},
        "sky": [0.46, 0.56, 0.76],
        "sun": {"direction": [0.75, 0.20, -0.60], "colour": [1.5, 0.98, 0.62]},
        "terrain": MOUNTAINS,
        "fog_colour": [0.85, 0.80, 0.78],
        "fog": [
            {"model": "wavelet", "image": "../weather_coverage_512.png", "basis": "linear",
             "rect": [-2600, -2600, 2600, 2600], "extinction": 0.05, "wrap": "repeat",
             "height": {"profile": "exponential", "base": 100, "scale": 17},
             "wind": [[0, 30, -12], [10, 50, 0], [20, 30, 18]]},
            {"model": "cosines", "extinction": 0.00008, "wind": [-40, 25],
             "waves": [{"extinction": 0.00005, "direction": [1, 0, 0.4], "frequency": 0.006},
                       {"extinction": 0.00003, "direction": [-0.3, 0, 1], "frequency": 0.011}]}],
        "method": {"name": "radial", "mu": 1.0},
        "meshes": groves(rnd, 900, (-2870, 800, -1800, 1760), near_eye(eye, 60), ["pine_far"],
                         (0.6, 1.25), 50, 45)})


def change():
    """A veil that closes over a clearing: two pictures, mixed in coefficient space."""
    rnd = random.Random(5)
    eye = (168, 10.5, 128)

    def clear(x, z):
        return math.hypot(x - eye[0], z - eye[2]) < 22 or math.hypot(x - 124, z - 82) < 9

    write("change.json", {
        "size": [1200, 675],
        "camera": {"eye": eye, "target": (112, 5, 58), "up": [0, 1, 0], "fov_y_deg": 42,
                   "near": 0.2, "far": 1500},
        "sky": [0.40, 0.50, 0.66],
        "sun": {"direction": [-0.7, 0.20, -0.55], "colour": [1.45, 0.95, 0.60]},
        "terrain": HILLS,
        "fog_colour": [0.76, 0.76, 0.80],
        "fog": [{"model": "wavelet", "basis": "quadratic", "levels": 4,
                 "images": [{"time": 0, "image": "../weather_coverage_512.png"},
                            {"time": 8, "image": "../weather_smooth_512.png"},
                            {"time": 16, "image": "../weather_coverage_512.png"}],
                 "rect": [-250, -300, 350, 300], "extinction": 0.09, "wrap": "repeat",
                 "height": {"profile": "exponential", "base": 3.5, "scale": 2.6},
                 "wind": [1.2, -0.5]}],
        "method": {"name": "exact", "mu": 1.0},
        "meshes": [HUT] + groves(rnd, 300, (-20, -120, 260, 130), clear,
                                 ["pine", "pine", "pine_young"], (0.6, 1.25), 9, 8)})


def chimney():
    """Smoke of a chimney in the wind, and fog that seeps out of the brook: particles."""
    rnd = random.Random(5)
    eye = (150, 9.5, 112)

    def clear(x, z):
        return math.hypot(x - eye[0], z - eye[2]) < 14 or math.hypot(x - 124, z - 82) < 9

    def seep(x, y, z, area, seed):
        return {"model": "particles", "source": "fog", "position": [x, y, z], "area": area,
                "direction": [0, 1, 0], "spread_deg": 85, "speed": 0.6, "rate": 26,
                "step": 0.3, "radius": [0.8, 4.0], "opacity": 0.03, "lift": -0.04, "drag": 0.25,
                "wind": [-0.5, 0.35], "seed": seed}

    write("chimney.json", {
        "size": [1200, 675],
        "camera": {"eye": eye, "target": (119, 7.2, 70), "up": [0, 1, 0], "fov_y_deg": 40,
                   "near": 0.2, "far": 1500},
        "sky": [0.30, 0.38, 0.56],
        "sun": {"direction": [-0.7, 0.16, -0.55], "colour": [1.3, 0.80, 0.50]},
        "terrain": HILLS,
        "fog_colour": [0.70, 0.71, 0.77],
        "fog": [{"model": "particles", "source": "smoke", "position": [124.3, 9.75, 80.24], "area": 0.3,
                 "direction": [0, 1, 0], "spread_deg": 14, "speed": 1.6, "rate": 60,
                 "life": [8, 16], "step": 1.0, "radius": [0.25, 2.3], "opacity": 0.15,
                 "lift": 0.04, "drag": 0.3, "wind": [[0, -1.2, 0.5], [8, -0.5, 1.1], [16, -1.2, 0.5]],
                 "seed": 3},
                seep(140, 3.5, 80, 5, 11), seep(131, 3.5, 92, 5, 12), seep(112, 4, 58, 8, 13),
                seep(96, 4, 52, 8, 14),
                {"model": "layers", "profile": "exponential", "extinction": 0.0016, "base": 4,
                 "scale": 18}],
        "method": {"name": "exact", "mu": 1.0},
        "meshes": [HUT] + groves(rnd, 300, (-20, -120, 260, 130), clear,
                                 ["pine", "pine", "pine_young"], (0.6, 1.25), 9, 8)})


def tables():
    """Veils of mist one over the other: a function of height by 25 values."""
    rnd = random.Random(12)
    eye = (-2900, 372, 1720)
    values = [1, 1, 0.9, 0.7, 0.42, 0.15, 0.05, 0.12, 0.42, 0.55, 0.36, 0.1, 0.02, 0.02, 0.05,
              0.16, 0.24, 0.17, 0.06, 0.01, 0.01, 0.03, 0.06, 0.03, 0]
    write("tables.json", {
        "size": [1200, 675],
        "camera": {"eye": eye, "target": (-1100, 205, 560), "up": [0, 1, 0], "fov_y_deg": 30,
                   "near": 2, "far": 12000},
        "sky": [0.52, 0.60, 0.76],
        "sun": {"direction": [0.62, 0.20, -0.76], "colour": [1.5, 1.0, 0.62]},
        "terrain": MOUNTAINS,
        "fog_colour": [0.88, 0.80, 0.76],
        "fog": [{"model": "layers", "profile": "table", "extinction": 0.0068,
                 "y": {"values": values, "begin": 90, "end": 330}},
                {"model": "layers", "profile": "exponential", "extinction": 0.00034, "base": 120,
                 "scale": 300}],
        "method": {"name": "exact", "mu": 1.0},
        "meshes": groves(rnd, 700, (-2870, 800, -1800, 1760), near_eye(eye, 60), ["pine_far"],
                         (0.6, 1.25), 50, 45)})


def separable():
    """Mist in drifts: Perlin noise in x and z, exponential in height (paper 001, figure 10)."""
    rnd = random.Random(29)
    eye, target = (176, 11.5, 136), (112, 5, 50)
    write("separable.json", {
        "size": [1200, 675],
        "camera": {"eye": eye, "target": target, "up": [0, 1, 0], "fov_y_deg": 42, "near": 0.2,
                   "far": 1500},
        "sky": [0.44, 0.54, 0.72],
        "sun": {"direction": [-0.72, 0.2, -0.55], "colour": [1.5, 0.98, 0.6]},
        "terrain": HILLS,
        "fog_colour": [0.80, 0.80, 0.82],
        "fog": [{"model": "separable", "extinction": 0.16,
                 "x": {"noise": {"seed": 8, "features": 16}, "begin": 0, "end": 400},
                 "y": {"exponential": 2.6, "begin": 3.4},
                 "z": {"noise": {"seed": 3, "features": 16}, "begin": 0, "end": 400}},
                {"model": "layers", "profile": "exponential", "extinction": 0.0014, "base": 6,
                 "scale": 25}],
        "method": {"name": "exact", "mu": 1.0},
        "meshes": [HUT] + groves(rnd, 340, (-20, -160, 270, 130),
                                 lambda x, z: near_eye(eye, 24)(x, z) or
                                 math.hypot(x - 124, z - 82) < 9,
                                 ["pine", "pine", "pine_young"], (0.6, 1.25), 9, 8)})


def channels():
    """An evening haze that takes the blue out of what lies behind it, over banks in the valley."""
    rnd = random.Random(4)
    eye, target = (-2900, 400, 1720), (-900, 62, 760)
    write("channels.json", {
        "size": [1200, 675],
        "camera": {"eye": eye, "target": target, "up": [0, 1, 0], "fov_y_deg": 32, "near": 2,
                   "far": 12000},
        "sky": [0.46, 0.52, 0.68],
        "sun": {"direction": [0.22, 0.2, -0.92], "colour": [1.6, 0.95, 0.5]},
        "terrain": MOUNTAINS,
        "fog_colour": [0.88, 0.62, 0.42],
        "fog": [
            {"model": "wavelet", "image": "../weather_coverage_512.png", "basis": "linear",
             "rect": [-4200, -4200, 4200, 4200], "extinction": 0.035,
             "channels": [1, 0.92, 0.85],
             "height": {"profile": "exponential", "base": 111, "scale": 17}},
            {"model": "layers", "profile": "exponential", "extinction": 0.00042, "base": 140,
             "scale": 150, "channels": [0.45, 0.8, 1.5]}],
        "method": {"name": "exact", "mu": 1.0},
        "meshes": groves(rnd, 900, (-2870, 800, -1800, 1760), near_eye(eye, 60), ["pine_far"],
                         (0.6, 1.25), 50, 45)})


if __name__ == "__main__":
    valley()
    inside()
    halfspace()
    layers()
    cosines()
    polynomials()
    potentials()
    drift()
    change()
    chimney()
    tables()
    separable()
    channels()
