#!/usr/bin/env python3
"""Writes pine.obj, pine_young.obj, pine_far.obj and hut.obj, the meshes of the example scenes.

Own work of the wavefog project, MIT licence. Repeatable: fixed seeds, standard library only.
Units are metres, y up, the foot of each thing at y = 0. Vertex colours ("v x y z r g b") are
linear and multiply the material's: they darken what lies deep inside a tree.
"""
import math
import pathlib
import random

HERE = pathlib.Path(__file__).parent


class Obj:
    """Collects vertices with normals and colours, and faces by material."""

    def __init__(self):
        self.vertices, self.normals, self.faces = [], [], {}

    def vertex(self, position, normal, colour):
        length = math.sqrt(sum(c * c for c in normal)) or 1.0
        self.vertices.append((position, colour))
        self.normals.append(tuple(c / length for c in normal))
        return len(self.vertices)

    def face(self, material, *indices):
        self.faces.setdefault(material, []).append(indices)

    def flat(self, material, shade, *corners):
        """A polygon with one normal, corners counter-clockwise from outside."""
        a, b, c = corners[:3]
        u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
        n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
        self.face(material, *[self.vertex(p, n, (shade,) * 3) for p in corners])

    def write(self, name, materials):
        lines = ["# " + name + ": made by make_meshes.py (wavefog, MIT). Metres, y up.",
                 "mtllib " + pathlib.Path(name).stem + ".mtl"]
        lines += ["v %.3f %.3f %.3f %.2f %.2f %.2f" % (p + c) for p, c in self.vertices]
        lines += ["vn %.2f %.2f %.2f" % n for n in self.normals]
        for material, faces in self.faces.items():
            lines.append("usemtl " + material)
            lines += ["f " + " ".join("%d//%d" % (i, i) for i in face) for face in faces]
        (HERE / name).write_text("\n".join(lines) + "\n")
        text = ["# Made by make_meshes.py. Linear colours."]
        for material, colour in materials.items():
            text += ["newmtl " + material, "Kd %.3f %.3f %.3f" % colour[:3]]
            if len(colour) > 3:
                text.append("Ke %.3f %.3f %.3f" % colour[3:])
        (HERE / name).with_suffix(".mtl").write_text("\n".join(text) + "\n")


def pine(name, seed, height, radius, bare, whorls, needles):
    """A conifer: a tapered trunk and whorls of drooping branches, each a serrated ridge whose two
    sides hang down like a tent. Normals lean outwards, so that the crown shades like a volume."""
    rnd = random.Random(seed)
    obj = Obj()
    bend = (rnd.uniform(-0.02, 0.02), rnd.uniform(-0.02, 0.02))

    def axis(y):
        return bend[0] * y * y / height, bend[1] * y * y / height

    sides, rings = 7, (0.0, 0.04, 0.35, 0.97)
    previous = None
    for t in rings:
        y, (ax, az) = t * height, axis(t * height)
        r = height * 0.017 * (1 - t) + 0.015 + (0.10 if t == 0 else 0)
        ring = []
        for s in range(sides):
            a = 2 * math.pi * s / sides
            n = (math.cos(a), 0.1, math.sin(a))
            shade = 0.9 if t < 0.2 else 0.45
            ring.append(obj.vertex((ax + r * n[0], y - (0.4 if t == 0 else 0), az + r * n[2]), n,
                                   (shade,) * 3))
        if previous:
            for s in range(sides):
                q = (s + 1) % sides
                obj.face("bark", previous[s], ring[s], ring[q], previous[q])
        previous = ring

    for w in range(whorls):
        t = bare + (0.985 - bare) * (w + rnd.uniform(-0.25, 0.25)) / (whorls - 1)
        t = min(max(t, bare), 0.985)
        up = (t - bare) / (1 - bare)
        reach = radius * (1 - up) ** 0.82 * (0.72 + 0.28 * min(1.0, 7 * up)) + 0.10
        count = max(4, round(9 - 4.5 * up))
        turn = rnd.uniform(0, 2 * math.pi)
        for b in range(count):
            azimuth = turn + 2 * math.pi * (b + rnd.uniform(-0.28, 0.28)) / count
            length = reach * rnd.uniform(0.74, 1.10)
            droop = length * rnd.uniform(0.24, 0.46) * (1.15 - 0.9 * up)
            rise = length * 0.75 * up ** 2
            wide = (0.25 * length + 0.24) * rnd.uniform(0.85, 1.15)
            out = (math.cos(azimuth), math.sin(azimuth))
            side = (-out[1], out[0])
            y0, (ax, az) = t * height, axis(t * height)
            tint = rnd.uniform(0.84, 1.14)

            def point(s, across, hang):
                # Down along the branch, the tip bent up again.
                drop = droop * (1.5 * s - 0.75 * s * s * s) - rise * s
                return (ax + out[0] * s * length + side[0] * across,
                        y0 - drop - hang,
                        az + out[1] * s * length + side[1] * across)

            def make(s, across, hang):
                lean = across / wide if wide else 0
                normal = (0.55 * out[0] + 0.8 * lean * side[0], 0.8,
                          0.55 * out[1] + 0.8 * lean * side[1])
                deep = min(1.0, 0.30 + 0.62 * s + 0.16 * up) * tint
                tip = s ** 3
                return obj.vertex(point(s, across, hang), normal,
                                  (deep * (1 + 0.30 * tip), deep * (1 + 0.22 * tip), deep * 0.95))

            steps = 6 if up < 0.5 else 4 if up < 0.8 else 3
            spine = [make(0.02 + 0.98 * k / steps, 0.0, 0.0) for k in range(steps + 1)]
            for sign in (-1, 1):
                for k in range(steps):
                    s0, s1 = k / steps, (k + 1) / steps
                    # A tooth between two points of the ridge, swept forward.
                    at = min(s0 + 1.25 / steps, 1.02) * rnd.uniform(0.93, 1.0)
                    swell = math.sin(math.pi * min(0.25 + 0.68 * (s0 + s1) / 2, 1.0)) ** 0.8
                    across = sign * wide * swell * rnd.uniform(0.65, 1.25)
                    tooth = make(at, across, abs(across) * 0.55)
                    a, c = spine[k], spine[k + 1]
                    if sign < 0:
                        obj.face("needles", a, tooth, c)
                    else:
                        obj.face("needles", a, c, tooth)
    # The leader.
    ax, az = axis(height)
    top = obj.vertex((ax, height, az), (0, 1, 0), (1.15, 1.1, 0.95))
    ring = []
    for s in range(5):
        a = 2 * math.pi * s / 5
        r = 0.035 * radius + 0.02
        ring.append(obj.vertex((ax + r * math.cos(a), height * 0.955, az + r * math.sin(a)),
                               (math.cos(a), 0.4, math.sin(a)), (0.8, 0.8, 0.8)))
    for s in range(5):
        obj.face("needles", ring[s], top, ring[(s + 1) % 5])
    obj.write(name, {"bark": (0.105, 0.075, 0.052), "needles": needles})


def far_pine(name, height, radius):
    """The same tree for views from hundreds of metres: ragged cones, less than 100 triangles."""
    rnd = random.Random(3)
    obj = Obj()
    tiers, points = 6, 7
    for k in range(tiers):
        low, high = height * (0.10 + 0.86 * k / tiers), height * (0.10 + 0.90 * (k + 1.9) / tiers)
        reach = radius * (1 - k / tiers) ** 0.85
        apex = obj.vertex((0, min(high, height), 0), (0, 1, 0), (1.0, 1.0, 1.0))
        ring = []
        for s in range(2 * points):
            a = math.pi * (s + 0.37 * k + rnd.uniform(-0.2, 0.2)) / points
            r = reach * (rnd.uniform(0.85, 1.1) if s % 2 else rnd.uniform(0.45, 0.6))
            shade = 1.05 if s % 2 else 0.45
            ring.append(obj.vertex((r * math.cos(a), low + (0 if s % 2 else 0.03 * height),
                                    r * math.sin(a)), (math.cos(a), 0.7, math.sin(a)), (shade,) * 3))
        for s in range(2 * points):
            obj.face("needles", ring[s], apex, ring[(s + 1) % (2 * points)])
    obj.flat("bark", 0.8, (-0.2, -0.5, 0), (0.2, -0.5, 0), (0.15, height * 0.15, 0),
             (-0.15, height * 0.15, 0))
    obj.write(name, {"bark": (0.105, 0.075, 0.052), "needles": (0.056, 0.080, 0.034)})


def hut(name):
    """A log hut with a steep shingle roof, a chimney, a door and lit windows."""
    obj = Obj()
    rnd = random.Random(7)
    half_x, half_z, wall, ridge, over = 3.0, 2.3, 2.3, 4.9, 0.55

    def box(material, shade, x0, y0, z0, x1, y1, z1):
        p = [(x, y, z) for x in (x0, x1) for y in (y0, y1) for z in (z0, z1)]
        for corners in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4),
                        (1, 5, 7, 3)):
            obj.flat(material, shade, *[p[c] for c in corners])

    box("stone", 0.8, -half_x - 0.15, -1.2, -half_z - 0.15, half_x + 0.15, 0.25, half_z + 0.15)
    logs = 8
    for k in range(logs):
        y0, y1 = 0.25 + (wall - 0.25) * k / logs, 0.25 + (wall - 0.25) * (k + 0.93) / logs
        shade = rnd.uniform(0.75, 1.1)
        end = 0.28 if k % 2 else 0.12
        box("log", shade, -half_x - end, y0, -half_z, half_x + end, y1, -half_z + 0.25)
        box("log", shade * 0.97, -half_x - end, y0, half_z - 0.25, half_x + end, y1, half_z)
        box("log", shade * 1.03, -half_x, y0, -half_z - end, -half_x + 0.25, y1, half_z + end)
        box("log", shade * 0.94, half_x - 0.25, y0, -half_z - end, half_x, y1, half_z + end)
    for x, flip in ((-half_x + 0.1, False), (half_x - 0.1, True)):
        gable = [(x, wall, -half_z), (x, wall, half_z), (x, ridge - 0.15, 0.0)]
        obj.flat("log", 0.85, *(reversed(gable) if flip else gable))
    rows = 9
    for sign in (-1, 1):
        for k in range(rows):
            # Courses of shingles, each a little above the next lower one.
            t0, t1 = k / rows, (k + 1.12) / rows
            def at(t, x, lift):
                z = sign * (half_z + over) * (1 - t)
                y = wall - 0.45 + (ridge - wall + 0.45) * t + lift
                return (x, y, z)
            for c in range(8):
                shade = rnd.uniform(0.72, 1.15)
                x0 = -half_x - over + (2 * (half_x + over)) * c / 8
                x1 = -half_x - over + (2 * (half_x + over)) * (c + 1) / 8
                lift = 0.10 + rnd.uniform(0, 0.02)
                quad = [at(t0, x0, lift), at(t0, x1, lift), at(min(t1, 1.0), x1, 0.02),
                        at(min(t1, 1.0), x0, 0.02)]
                obj.flat("shingle", shade, *(quad if sign > 0 else reversed(quad)))
                lip = [at(t0, x0, -0.02), at(t0, x1, -0.02), at(t0, x1, lift), at(t0, x0, lift)]
                obj.flat("shingle", shade * 0.5, *(lip if sign > 0 else reversed(lip)))
    box("stone", 0.9, 1.2, 3.2, -1.2, 1.95, 5.9, -0.5)
    box("stone", 0.7, 1.1, 5.75, -1.3, 2.05, 5.95, -0.4)
    front = half_z + 0.02
    box("door", 0.8, -0.5, 0.25, front - 0.05, 0.45, 2.0, front + 0.03)
    for x in (-2.0, 1.55):
        box("door", 0.7, x - 0.48, 0.95, front - 0.05, x + 0.48, 1.85, front + 0.03)
        box("lamp", 1.0, x - 0.38, 1.05, front, x + 0.38, 1.75, front + 0.05)
    obj.write(name, {"stone": (0.20, 0.19, 0.18), "log": (0.155, 0.098, 0.058),
                     "shingle": (0.085, 0.078, 0.072), "door": (0.09, 0.055, 0.035),
                     "lamp": (0.30, 0.22, 0.12, 1.9, 0.98, 0.30)})


if __name__ == "__main__":
    pine("pine.obj", 11, 17.0, 3.2, 0.12, 33, (0.060, 0.092, 0.045))
    pine("pine_young.obj", 5, 7.5, 1.9, 0.04, 19, (0.078, 0.112, 0.048))
    far_pine("pine_far.obj", 17.0, 3.2)
    hut("hut.obj")
