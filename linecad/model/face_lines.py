"""The lines that faces place, beside those that crossings placed.

What crossings placed comes first: a stretch of the photo along which such a line runs gets no other of its axis. Then
come the edges of faces, then what the photo shows on them.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from linecad.arrays import Bool, Float, Int, rows_of
from linecad.directions import UP, Turns, frame_axes
from linecad.geometry import PhotoLength
from linecad.graph.connectivity import spanning_forest
from linecad.line_graph import Segments
from linecad.lines.details import apart_from, left_of, repeats
from linecad.model.clean.absorbing import absorbed
from linecad.model.clean.sight import Sight
from linecad.model.frames import FramedLines, sight_in, together
from linecad.model.on_faces.better import better_places
from linecad.model.on_faces.by_map import WIDEST, factors_by_map
from linecad.model.on_faces.edges import edges_of
from linecad.model.on_faces.in_sky import in_the_sky
from linecad.model.on_faces.places import Samples, can_lie, in_space, stretches
from linecad.model.on_faces.posts import standing
from linecad.model.on_faces.roofed import on_roofs
from linecad.model.on_faces.seen import NO_FACE, SeenFaces
from linecad.model.regions.filling import Filled
from linecad.model.regions.mapped import MappedDepths
from linecad.scene import Camera, Intersections, Lines, Plane
from linecad.ties.depth_parts import is_map_likelier, right_by_map

NO_ROWS = np.zeros(0, np.int64)
UNKNOWN = 0.5  # the probability of a plane that no line shows
LEAST_ON_GROUND = PhotoLength(150.0, floor=30.0)  # px; shorter edges there are stones, stains and leaves


@dataclass(frozen=True, eq=False)
class LinesOnFaces:
    """The lines of a scene, K of which crossings placed and faces the others."""

    lines: FramedLines  # the K first
    planes: tuple[Plane, ...]  # with their lines
    kept: Bool  # (N,) which of the lines that were there are among the K; ids were rows
    put: Int  # ids that those have now which faces and the ground placed better
    nowhere: int = 0  # lines that were left out, as no face places them,
    in_sky: int = 0  # and as they are in the sky
    edges: Int = field(default_factory=lambda: NO_ROWS)  # ids of edges of faces
    by_map: Int = field(default_factory=lambda: NO_ROWS)  # ids of those that a depth map placed better

    def crossings(self, crossings: Intersections) -> Intersections:
        """The crossings of lines that stayed; the tree is one again."""
        if self.kept.all():
            return crossings
        rest = rows_of(crossings, np.flatnonzero(self.kept[crossings.lines].all(axis=1)))
        real = np.flatnonzero(rest.real)
        real = real[np.argsort(~rest.in_tree[real], kind="stable")]
        tree = np.zeros(len(rest), bool)
        tree[real[spanning_forest(len(self.kept), rest.lines[real])]] = True
        return replace(rest, in_tree=tree)

    def renumbered(self, pairs: Int) -> Int:
        """The pairs (P, 3) of lines that stayed, with their new rows."""
        row = np.cumsum(self.kept) - 1
        rest = pairs[self.kept[pairs[:, :2]].all(axis=1)]
        return np.column_stack([row[rest[:, :2]], rest[:, 2]])

    def notes(self, lines: Lines) -> tuple[str, ...]:
        """What faces did to the lines that are left at last, for people."""
        put = int(np.isin(lines.id, self.put).sum())
        added = int(np.asarray(lines.by_face).sum()) - put
        notes = []
        if added:
            notes.append(
                f"{added} more lines lie on faces: their edges, and what is seen on them and no crossing placed"
            )
        if put:
            where = "lie on a face in the photo or stand on its ground or roofs"
            notes.append(f"{put} lines in doubtful places {where}, and were put there")
        if by_map := int(np.isin(lines.id, self.by_map).sum()):
            notes.append(
                f"{by_map} lines that the depth map has elsewhere on both of their sides were put where it has them"
            )
        if self.nowhere:
            notes.append(
                f"{self.nowhere} doubtful lines are left out: they would lie behind the wall, floor or ceiling that "
                "they are seen on or before, and no face places them"
            )
        if self.in_sky:
            notes.append(f"{self.in_sky} lines with the sky on both sides, as wires have, are left out")
        return tuple(notes)


def lines_told(crossings: Intersections, of_bodies: Int | None = None) -> Int:
    """The rows of the lines that a person said something of: at one of their crossings, or of bodies, given by rows."""
    at_crossings = crossings.lines[np.asarray(crossings.reason) == "annotated"].ravel()
    return at_crossings if of_bodies is None else np.append(at_crossings, of_bodies)


def add_lines(
    framed: FramedLines,
    planes: tuple[Plane, ...],
    details: Segments | None,
    camera: Camera,
    sight: Sight,
    said: Int = NO_ROWS,
    shown: Filled | None = None,
) -> LinesOnFaces:
    """The lines with the edges of faces and the `details` that lie on faces; `planes` have their openings.

    The ids of the lines that were there are their rows. Those that faces place better are put onto these, and uprights
    whose foot the photo shows on the ground stand there, and what it shows on the roofs of what is `shown` stands on
    these; those that faces show to be nowhere are left out, and those in the sky that are not upright. Lines (rows) of
    which a person `said` something stay. Nothing changes where `details` are None.
    """
    if details is None:
        return LinesOnFaces(framed, planes, np.ones(len(framed.lines), bool), np.zeros(0, np.int64))
    turns, rotation = framed.turns, sight.rotation
    seen = SeenFaces.of(planes, camera, rotation, turns)
    places = better_places(framed.in_world(), _typical_of(framed.lines, seen), seen, turns)
    better, nowhere = places.face, places.nowhere
    nearer, below = standing(framed.in_world(), seen)
    farther, carrying = on_roofs(framed.in_world(), () if shown is None else shown.roofs, seen, rotation)
    nearer, below = np.where(below == NO_FACE, farther, nearer), np.where(below == NO_FACE, carrying, below)
    wires = _wires(framed, shown, camera)
    better[wires], below[wires], nowhere[wires] = NO_FACE, NO_FACE, False
    better[said], below[said], nowhere[said], wires[said] = NO_FACE, NO_FACE, False, False
    better[below != NO_FACE], nowhere[below != NO_FACE] = NO_FACE, False
    kept = (better == NO_FACE) & (below == NO_FACE) & ~nowhere & ~wires
    posts = _nearer(framed.of_rows(np.flatnonzero(below != NO_FACE)), nearer[below != NO_FACE])
    moved = framed.of_rows(np.flatnonzero(better != NO_FACE))
    framed = framed.of_rows(np.flatnonzero(kept))
    taken = _as_drawn(framed, sight).joined(_as_shown(moved)).joined(_as_drawn(posts, sight))
    edges, face = edges_of(seen, rotation, turns)
    edges, face = _one_by_one(edges, face, taken, camera)
    taken = taken.joined(edges)
    found, on = _on_faces(apart_from(details, taken, camera.width), seen)
    segments = Segments(moved.lines.segment, moved.axis).joined(edges).joined(found)
    face = np.concatenate([better[better != NO_FACE], face, on])
    ends, frame = in_space(segments, face, seen, rotation, turns)
    count = len(segments)
    segments = segments.joined(Segments(posts.lines.segment, posts.axis))
    face = np.concatenate([face, below[below != NO_FACE]])
    ends, frame = np.concatenate([ends, posts.lines.ends]), np.concatenate([frame, posts.frame])
    lines = _records(framed, segments, face, ends, frame, seen)
    none = (np.zeros((0, 2, 2)),) * (count - len(moved.lines))
    lines = replace(lines, pieces=(*moved.lines.pieces, *none, *posts.lines.pieces))
    every = FramedLines(together([framed.lines, lines]), np.concatenate([framed.frame, frame]), turns)
    # Numbers of lines that went are given again.
    members = {plane.id: [line for line in plane.lines if kept[line]] for plane in planes}
    for number, each in zip(lines.id[:count].tolist(), face[:count].tolist(), strict=True):
        members[seen.plane[each].id].append(number)
    full = tuple(replace(plane, lines=tuple(members[plane.id])) for plane in planes)
    put = np.r_[lines.id[: len(moved.lines)], lines.id[count:]]
    of_edges = lines.id[len(moved.lines) :][: len(edges)]
    left = without_repeats(every, full, sight)
    return LinesOnFaces(*left, kept, put, int(nowhere.sum()), int(wires.sum()), of_edges)


def follow_map(
    found: LinesOnFaces, mapped: MappedDepths | None, camera: Camera, sight: Sight, said: Int
) -> LinesOnFaces:
    """The lines with those at the depth that a map has beside them where it is likelier right, in no plane or crossing.

    Edges of faces stay on these, and lines of which a person `said` something (ids) where they are.
    """
    if mapped is None or mapped.width_of_parts >= WIDEST:
        return found
    ids = np.asarray(found.lines.lines.id)
    factor = factors_by_map(found.lines.in_world(), mapped, camera, sight.rotation, found.lines.turns)
    asked = (factor != 1.0) & ~np.isin(ids, np.append(found.edges, said))
    known, move = np.asarray(found.lines.lines.probability), np.log(np.where(asked, factor, 2.0))
    moved = asked & is_map_likelier(known, mapped.width_of_parts, move)
    kept = found.kept.copy()
    kept[np.flatnonzero(kept)[moved[: int(kept.sum())]]] = False
    rows = np.flatnonzero(moved)
    numbers = int(ids.max(initial=-1)) + 1 + np.arange(len(rows))  # ids ascend
    there = _at_map(_nearer(found.lines.of_rows(rows), factor[rows]), numbers, right_by_map(mapped.width_of_parts))
    rest = found.lines.of_rows(np.flatnonzero(~moved))
    lines = FramedLines(together([rest.lines, there.lines]), np.append(rest.frame, there.frame), rest.turns)
    return replace(found, lines=lines, planes=_with_lines(found.planes, ids[~moved]), kept=kept, by_map=numbers)


def _at_map(framed: FramedLines, numbers: Int, probability: float) -> FramedLines:
    """The lines with ids (N,), as a depth map placed them."""
    lines = framed.lines
    lines = replace(
        lines,
        id=numbers,
        confidence=np.where(np.asarray(lines.confidence) == "proven", "supported", lines.confidence),
        is_boundary=np.zeros(len(numbers), bool),
        probability=np.full(len(numbers), probability),
        by_face=np.zeros(len(numbers), bool),
        by_depth_map=np.ones(len(numbers), bool),
    )
    return replace(framed, lines=lines)


def without_repeats(
    framed: FramedLines, planes: tuple[Plane, ...], sight: Sight
) -> tuple[FramedLines, tuple[Plane, ...]]:
    """The lines without those by faces that go on from others or repeat them in space, and planes without theirs."""
    framed = _without_repeats(framed, sight)
    return framed, _with_lines(planes, framed.lines.id)


def _with_lines(planes: tuple[Plane, ...], ids: Int) -> tuple[Plane, ...]:
    """The planes with those of their lines that have one of the ids."""
    left = set(ids.tolist())
    return tuple(replace(plane, lines=tuple(line for line in plane.lines if line in left)) for plane in planes)


def _without_repeats(framed: FramedLines, sight: Sight) -> FramedLines:
    parts, rows = [], []
    for frame in framed.frames:
        own = framed.of(frame)
        if len(own):
            lines = rows_of(framed.lines, own)
            found, left = absorbed(lines, np.asarray(lines.by_face), sight_in(sight, frame, framed.turns).forward)
            parts.append(found)
            rows.append(own[left])
    if not parts:
        return framed
    order = np.concatenate(rows)
    lines = rows_of(together(parts), np.argsort(order))
    return FramedLines(lines, framed.frame[np.sort(order)], framed.turns)


def _wires(framed: FramedLines, shown: Filled | None, camera: Camera) -> Bool:
    """Which lines (N,) are in the sky that is shown."""
    if shown is None:
        return np.zeros(len(framed.lines), bool)
    return in_the_sky(framed.in_world(), shown.sky, camera)


def _nearer(framed: FramedLines, factor: Float) -> FramedLines:
    """The lines at so many times (N,) their distance."""
    return replace(framed, lines=replace(framed.lines, ends=framed.lines.ends * factor[:, None, None]))


def _as_drawn(framed: FramedLines, sight: Sight) -> Segments:
    """The lines in the photo: the segments that show them, and from end to end."""
    lines = framed.in_world()
    drawn = sight.pixels(lines.ends)
    visible = np.isfinite(drawn).all(axis=(1, 2))
    return _as_shown(framed).joined(Segments(drawn[visible], lines.axis[visible]))


def _as_shown(framed: FramedLines) -> Segments:
    """The segments that show the lines, all their pieces."""
    shown = [framed.lines.segments_of(row) for row in range(len(framed.lines))]
    axis = np.repeat(framed.axis, [len(each) for each in shown])
    return Segments(np.concatenate([np.zeros((0, 2, 2)), *shown]), axis)


def _one_by_one(edges: Segments, face: Int, taken: Segments, camera: Camera) -> tuple[Segments, Int]:
    """The edges apart from lines `taken` and from each other, the longest first."""
    order = np.argsort(-edges.length, kind="stable")
    edges, face = edges.subset(order), face[order]
    covered, kept, faces = repeats(edges, taken, camera.width), Segments.none(), [np.zeros(0, np.int64)]
    for row in range(len(edges)):
        edge = edges.subset(np.array([row]))
        runs = covered[row] + repeats(edge, kept, camera.width)[0]
        left = left_of(edge, [runs], camera.width)
        kept = kept.joined(left)
        faces.append(np.full(len(left), face[row]))
    return kept, np.concatenate(faces)


def _on_faces(segments: Segments, seen: SeenFaces) -> tuple[Segments, Int]:
    """The stretches of segments with one face on both sides that they can lie in, and that face (P,).

    Below the camera, on the ground, only long ones.
    """
    samples = Samples.of(segments.ends, seen.camera.width)
    first, second = seen.beside(samples.pixel, samples.along)
    lies = (first == second) & can_lie(segments.axis[samples.row], seen.axis[first])
    found = stretches(samples, np.where(lies, first, NO_FACE), segments, seen.camera.width)
    on_faces, below = found.segments(segments), np.array([p.axis == UP and p.offset < 0 for p in seen.plane], bool)
    worth = ~below[found.face] | (on_faces.length >= LEAST_ON_GROUND.px(seen.camera.width))
    return on_faces.subset(worth), found.face[worth]


def _records(framed: FramedLines, segments: Segments, face: Int, ends: Float, frame: Int, seen: SeenFaces) -> Lines:
    """The new lines, in the axes of their frames; what is no geometry they have from the lines of their plane."""
    lines = framed.lines
    first = int(lines.id.max(initial=-1)) + 1
    members = _members(lines, seen)
    component = np.array([int(np.bincount(lines.component[own]).argmax()) if len(own) else 0 for own in members])
    probability = np.array([_typical(lines, own) for own in members])
    count = len(segments)
    return Lines(
        id=first + np.arange(count),
        axis=_in_frame(segments.axis, frame, framed.turns),
        segment=segments.ends,
        ends=ends,
        is_boundary=np.zeros(count, bool),
        component=component[face] if count else np.zeros(0, np.int64),
        confidence=np.where(component[face] == 0, "supported", "weak") if count else np.zeros(0, "U9"),
        probability=probability[face] if count and len(lines.probability) else (),
        by_face=np.ones(count, bool),
    )


def _members(lines: Lines, seen: SeenFaces) -> list[Int]:
    """The rows of the lines in the plane of each face, those that are there."""
    row = {number: index for index, number in enumerate(lines.id.tolist())}
    return [np.array([row[line] for line in plane.lines if line in row], np.int64) for plane in seen.plane]


def _typical_of(lines: Lines, seen: SeenFaces) -> Float:
    """(F,) how likely the plane of each face is where it should be."""
    return np.array([_typical(lines, own) for own in _members(lines, seen)])


def _typical(lines: Lines, own: Int) -> float:
    """The middle of the probabilities of some lines (rows), each as often as it is long in the photo."""
    if len(own) == 0 or len(lines.probability) == 0:
        return UNKNOWN
    probability = np.asarray(lines.probability)[own]
    weight = np.linalg.norm(lines.segment[own, 1] - lines.segment[own, 0], axis=1)
    order = np.argsort(probability, kind="stable")
    upto = np.cumsum(weight[order])
    return float(probability[order][np.searchsorted(upto, upto[-1] / 2)])


def _in_frame(axis: Int, frame: Int, turns: Turns) -> Int:
    """x, y or z of each direction (N,) in its frame (N,)."""
    axes = np.array([frame_axes(number) for number in range(len(turns) + 1)])
    return np.asarray((axes[frame] == axis[:, None]).argmax(axis=1))
