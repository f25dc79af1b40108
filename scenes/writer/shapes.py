"""Geometry of the bundled scenes: triangles in pieces, one piece a material."""
import math


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def unit(v):
    length = math.sqrt(dot(v, v))
    return (v[0] / length, v[1] / length, v[2] / length)


class Piece:
    """Triangles of one material. Vertices equal in position and normal are stored once."""

    def __init__(self):
        self.positions, self.normals, self.triangles = [], [], []
        self._index = {}

    def vertex(self, position, normal):
        key = (position, normal)
        if key not in self._index:
            self._index[key] = len(self.positions)
            self.positions.append(position)
            self.normals.append(normal)
        return self._index[key]

    def triangle(self, a, b, c):
        """Flat, counter-clockwise seen from its front."""
        n = unit(cross(sub(b, a), sub(c, a)))
        self.triangles.append(tuple(self.vertex(p, n) for p in (a, b, c)))

    def quad(self, a, b, c, d):
        self.triangle(a, b, c)
        self.triangle(a, c, d)

    def quad_facing(self, corners, point, away=False):
        """A quad whose front looks at `point` (or away from it), whichever way its corners run."""
        a, b, c, _ = corners
        looks_at = dot(cross(sub(b, a), sub(c, a)), sub(point, a)) > 0
        self.quad(*(corners if looks_at != away else corners[::-1]))


def inward_box(piece, low, high):
    """The six walls of a closed box, seen from inside."""
    corner = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    center = tuple((a + b) / 2 for a, b in zip(low, high))
    for a, b, c, d in ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)):
        piece.quad_facing((corner[a], corner[b], corner[c], corner[d]), center)


class Blocks:
    """Solids made of axis-aligned boxes painted one over the other; None carves a hollow.

    All boxes are cut along all planes of all boxes, and a face is written wherever solid meets
    hollow, in the material of the solid. So the surface is closed, every edge is shared by exactly
    two triangles (no T-junction for light to slip through), and nothing lies hidden.
    """

    def __init__(self):
        self.boxes = []

    def paint(self, low, high, material):
        # Rounded, so that planes meant to coincide do.
        self.boxes.append((tuple(round(x, 7) for x in low), tuple(round(x, 7) for x in high), material))

    def pieces(self):
        cuts = [sorted({b[side][axis] for b in self.boxes for side in (0, 1)}) for axis in range(3)]

        def material_at(cell):
            if any(i < 0 or i + 1 >= len(c) for i, c in zip(cell, cuts)):
                return None
            p = [(c[i] + c[i + 1]) / 2 for i, c in zip(cell, cuts)]
            for low, high, material in reversed(self.boxes):
                if all(l < x < h for l, x, h in zip(low, p, high)):
                    return material
            return None

        count = [len(c) - 1 for c in cuts]
        solid = {(i, j, k): material_at((i, j, k)) for i in range(-1, count[0] + 1)
                 for j in range(-1, count[1] + 1) for k in range(-1, count[2] + 1)}
        pieces = {}
        for cell, material in solid.items():
            if material is None:
                continue
            for axis in range(3):
                for side in (0, 1):
                    neighbour = list(cell)
                    neighbour[axis] += 2 * side - 1
                    if solid[tuple(neighbour)] is not None:
                        continue
                    u, v = (axis + 1) % 3, (axis + 2) % 3
                    corners = []
                    for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        p = [0.0, 0.0, 0.0]
                        p[axis] = cuts[axis][cell[axis] + side]
                        p[u] = cuts[u][cell[u] + du]
                        p[v] = cuts[v][cell[v] + dv]
                        corners.append(tuple(p))
                    pieces.setdefault(material, Piece()).quad(*(corners if side else corners[::-1]))
        return pieces


def cylinder(piece, x, z, radius, y_low, y_high, segments):
    """An upright closed cylinder with smooth sides and flat caps, seen from outside."""
    ring = [(math.cos(2 * math.pi * i / segments), math.sin(2 * math.pi * i / segments)) for i in range(segments)]
    for i in range(segments):
        (c0, s0), (c1, s1) = ring[i], ring[(i + 1) % segments]
        p0, p1 = (x + radius * c0, z + radius * s0), (x + radius * c1, z + radius * s1)
        low0, low1 = (p0[0], y_low, p0[1]), (p1[0], y_low, p1[1])
        high0, high1 = (p0[0], y_high, p0[1]), (p1[0], y_high, p1[1])
        n0, n1 = (c0, 0.0, s0), (c1, 0.0, s1)
        a, b = piece.vertex(low0, n0), piece.vertex(low1, n1)
        c, d = piece.vertex(high1, n1), piece.vertex(high0, n0)
        piece.triangles += [(a, c, b), (a, d, c)]
        piece.triangle(low0, low1, (x, y_low, z))
        piece.triangle(high1, high0, (x, y_high, z))


def inward_sphere(subdivisions):
    """A subdivided icosahedron seen from inside, scaled so that its area is that of the unit sphere.

    In any closed shape of albedo rho the absorbed indirect light is flux * rho, so the mean indirect
    E is flux * rho / ((1 - rho) area): the same as in the round sphere, faceted or not. It has no
    normals, which in glTF means flat shading; the facets are then a scene in its own right, not an
    approximation of one.
    """
    golden = (1 + math.sqrt(5)) / 2
    points = [unit(p) for p in ((-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0),
                                (0, -1, golden), (0, 1, golden), (0, -1, -golden), (0, 1, -golden),
                                (golden, 0, -1), (golden, 0, 1), (-golden, 0, -1), (-golden, 0, 1))]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
             (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5),
             (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(subdivisions):
        middle = {}

        def between(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                middle[key] = len(points)
                points.append(unit(tuple((x + y) / 2 for x, y in zip(points[a], points[b]))))
            return middle[key]

        faces = [t for a, b, c in faces for ab, bc, ca in [(between(a, b), between(b, c), between(c, a))]
                 for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
    area = 0.0
    for a, b, c in faces:
        n = cross(sub(points[b], points[a]), sub(points[c], points[a]))
        area += math.sqrt(dot(n, n)) / 2
    scale = math.sqrt(4 * math.pi / area)
    piece = Piece()
    piece.positions = [tuple(scale * x for x in p) for p in points]
    piece.triangles = [(a, c, b) for a, b, c in faces]
    return piece


def torus_knot(along, around, relief):
    """A (2,3) torus knot, its tube embossed by coarse waves and, with `relief`, fine ones.

    The fine waves are too short for a coarse tessellation, as a modeller would leave them to a normal
    map. Their mean is zero, and the tube's radius makes up for the area that a polygon lacks against
    its circle, so that the two tessellations bound the same volume to about 2 %.
    """
    fullness = math.sqrt(2 * math.pi / around / math.sin(2 * math.pi / around))

    def center(u):
        r = 0.55 + 0.25 * math.cos(3 * u)
        return (r * math.cos(2 * u), 0.25 * math.sin(3 * u), r * math.sin(2 * u))

    def point(u, v):
        step = 1e-4
        tangent = unit(sub(center(u + step), center(u - step)))
        outward = sub(center(u), (0.55 * math.cos(2 * u), 0.0, 0.55 * math.sin(2 * u)))
        along_tangent = dot(outward, tangent)
        normal = unit(tuple(o - along_tangent * t for o, t in zip(outward, tangent)))
        binormal = cross(tangent, normal)
        radius = 0.15 + 0.02 * math.sin(12 * u) * math.cos(2 * v)
        if relief:
            radius += 0.012 * math.sin(60 * u) * math.cos(6 * v)
        c, s = fullness * radius * math.cos(v), fullness * radius * math.sin(v)
        return tuple(p + c * n + s * b for p, n, b in zip(center(u), normal, binormal))

    piece = Piece()
    for i in range(along):
        for j in range(around):
            u, v, step = 2 * math.pi * i / along, 2 * math.pi * j / around, 1e-4
            du = sub(point(u + step, v), point(u - step, v))
            dv = sub(point(u, v + step), point(u, v - step))
            piece.positions.append(point(u, v))
            piece.normals.append(unit(cross(dv, du)))
    for i in range(along):
        for j in range(around):
            a, b = i * around + j, i * around + (j + 1) % around
            c, d = (i + 1) % along * around + (j + 1) % around, (i + 1) % along * around + j
            piece.triangles += [(a, b, c), (a, c, d)]
    return piece
