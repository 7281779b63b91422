"""Comparisons with an expectation that several checkers make: lines, faces, and where lines fall on the photo.

Points are sequences of three numbers in metres, z up. Runs in the Pythons of FreeCAD and Blender too, so it needs
nothing but the standard library of Python 3.10.
"""

import math
import statistics
from collections import Counter

AXES = "xyz"


def check_lines(findings, expected, segments, tolerance):
    """Compare the lines of a file, group name -> [(start, end)], with the expected ones; either end may come first.

    Returns line id -> (start, end) as the file has them, turned as expected, of all lines that are in their place.
    """
    counts = {name: len(group["ids"]) for name, group in sorted(expected["groups"].items())}
    seen = {name: len(lines) for name, lines in sorted(segments.items())}
    findings.need(seen == counts, f"lines by group are {seen}, expected {counts}")
    placed, left = {}, {name: list(lines) for name, lines in segments.items()}
    for line in expected["lines"]:
        start, end = line["ends"]
        both = [
            (max(apart(start, a), apart(end, b)), number, (a, b))
            for number, segment in enumerate(left.get(line["group"], []))
            for a, b in (segment, segment[::-1])
        ]
        distance, number, found = min(both, key=lambda each: each[0], default=(math.inf, 0, None))
        if findings.need(
            distance <= tolerance, f"line {line['id']}: the nearest of {line['group']} is {distance:.3g} m away"
        ):
            placed[line["id"]] = found
            del left[line["group"]][number]
    return placed


def check_face(findings, face, points, triangles, tolerance):
    """Compare a triangulated face with the expected one.

    The triangles must use every corner of the rings and nothing else, have the rings as their border and the rings'
    area, and be turned to the side that the face looks to.
    """
    name = face["name"]
    used = {index for triangle in triangles for index in triangle}
    corner = {}  # of each point that is used
    for index in used:
        nearest = min(range(len(face["corners"])), key=lambda number: apart(points[index], face["corners"][number]))
        distance = apart(points[index], face["corners"][nearest])
        findings.need(distance <= tolerance, f"{name}: a vertex is {distance:.3g} m from the nearest corner")
        corner[index] = nearest
    unused = len(face["corners"]) - len(set(corner.values()))
    findings.need(not unused, f"{name}: {unused} of {len(face['corners'])} corners are in no triangle, as at a crack")
    edges = Counter()  # directed; an edge between two triangles is there in both directions
    for triangle in triangles:
        numbers = [corner[index] for index in triangle]
        edges.update(zip(numbers, numbers[1:] + numbers[:1], strict=True))
    border = {frozenset((a, b)) for a, b in edges if not edges[b, a]}
    rings = {frozenset(edge) for edge in ring_edges(face)}
    lost = len(rings - border)
    findings.need(border == rings, f"{name}: {lost} of {len(rings)} edges of its rings do not bound the triangles")
    findings.need(max(edges.values(), default=0) <= 1, f"{name}: neighbouring triangles are turned differently")
    corners = [[points[index] for index in triangle] for triangle in triangles]
    area = sum(math.hypot(*normal_of(*triangle)) / 2 for triangle in corners)
    right = math.isclose(area, face["area"], rel_tol=1e-4, abs_tol=1e-4)
    findings.need(right, f"{name}: area {area} m2, expected {face['area']}")
    away = sum(dot(normal_of(*triangle), face["normal"]) <= 0 for triangle in corners)
    findings.need(not away, f"{name}: {away} of {len(triangles)} triangles are turned away from where it is seen")


def check_names(findings, kind, names, wanted):
    """Need each wanted name once, and nothing else."""
    counts = Counter(list(names))
    twice = sorted(name for name, count in counts.items() if count > 1)
    findings.need(not twice, f"{kind}: {twice[:5]} are there more than once")
    missing, more = sorted(set(wanted) - set(counts)), sorted(set(counts) - set(wanted))
    findings.need(not missing, f"{kind}: {len(missing)} are missing, such as {missing[:3]}")
    findings.need(not more, f"{kind}: {len(more)} are not expected, such as {more[:3]}")


def check_pixels(findings, expected, placed, project, tolerance):
    """Need the ends of all lines as the file has them, seen through the file's camera, in their place in the photo.

    `project` takes a point to (u, v, depth): px from the photo's top left corner, and m along the axis. Returns the
    largest distance in px; NaN where no line could be compared.
    """
    errors, behind = [], 0
    for line in expected["lines"]:
        ends = zip(placed[line["id"]], line["pixels"], strict=True) if line["id"] in placed else ()
        for point, pixel in ends:
            u, v, depth = project(point)
            behind += depth <= 0
            errors.append((math.dist((u, v), pixel), line["id"]))
    findings.need(not behind, f"{behind} ends of lines lie behind the camera")
    if not findings.need(errors, "no line could be looked at through the camera"):
        return math.nan
    largest, number = max(errors)
    usual = statistics.median(error for error, _ in errors)
    findings.need(
        all(error <= tolerance for error, _ in errors),  # which NaN is not
        f"line {number} ends {largest:.3f} px from its place in the photo, allowed {tolerance} (median {usual:.3f})",
    )
    return largest


def check_clipping(findings, expected, near, far):
    """Need every line between the clipping planes of a camera, whose distances are in m along its axis."""
    forward, eye = expected["camera"]["rotation"][2], expected["camera"]["eye"]
    depths = [dot(forward, end) - dot(forward, eye) for line in expected["lines"] for end in line["ends"]]
    findings.need(
        near < min(depths) and max(depths) < far,
        f"clipping at {near} and {far} m cuts the lines, which are {min(depths)} to {max(depths)} m away",
    )


def check_colour(findings, name, colour, wanted, tolerance=2e-3):
    """Compare two colours channel by channel, 0 to 1."""
    same = len(colour) >= 3 and all(abs(a - b) <= tolerance for a, b in zip(colour[:3], wanted, strict=True))
    findings.need(same, f"{name}: colour {rounded(colour)}, expected {rounded(wanted)}")


def rounded(values):
    """For people."""
    return [round(value, 3) for value in values]


def ring_edges(face):
    """The edges of all rings of an expected face, as pairs of numbers of corners."""
    return [pair for ring in face["rings"] for pair in zip(ring, ring[1:] + ring[:1], strict=True)]


def normal_of(a, b, c):
    """Of a triangle, twice as long as its area is large."""
    p, q = [x - y for x, y in zip(b, a, strict=True)], [x - y for x, y in zip(c, a, strict=True)]
    return (p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0])


def apart(a, b):
    """The largest difference of a coordinate of two points."""
    return max(abs(a[0] - b[0]), abs(a[1] - b[1]), abs(a[2] - b[2]))


def dot(a, b):
    """The scalar product."""
    return sum(x * y for x, y in zip(a, b, strict=True))
