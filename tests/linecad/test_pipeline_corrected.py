"""A reconstruction with what a person said: crossings that are kept or given up, lengths, frames, contradictions."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.camera.photo import Photo
from linecad.camera.vanishing_points import fit_frame
from linecad.corrections.annotations import annotations_of
from linecad.corrections.apply import correct
from linecad.corrections.edits import (
    Anchor,
    Corrections,
    Cut,
    Delete,
    KnownLength,
    LabelCrossing,
    OnePlane,
    PlaceAt,
    SetFrame,
)
from linecad.corrections.lengths import measured
from linecad.decide.blocks import find_blocks
from linecad.errors import ContradictionError, ReconstructionError
from linecad.finding import FoundLines, connect, name_lines
from linecad.options import SHORT_REACH, Options
from linecad.pipeline import prepare, reconstruct, reconstruct_lines, reconstruct_prepared
from solver.options import FORMULATIONS, SolveOptions

# False crossings too, one of them between the two boxes; their optimum takes long to prove, and is not what is tested.
NEAR = Options(joins="biconnected", weights="junctions")
FAR = Options(extension=800.0, joins="biconnected", weights="junctions", solve=SolveOptions(time_limit_s=1.0))


def plain(ends):
    (a, b), (c, d) = np.asarray(ends, float).tolist()
    return (a, b), (c, d)


class Made:
    """The exact lines of the made scene, and corrections of them."""

    def __init__(self, made):
        self.made = made
        self.free = {}  # the scene without corrections, by options
        self.photo = Photo("made.jpg", np.zeros((made.camera.height, made.camera.width, 3), np.uint8), made.camera)

    def found(self, options):
        """The exact lines, grouped already."""
        reach = replace(SHORT_REACH, extension=options.extension or SHORT_REACH.extension)
        return FoundLines(self.made.camera, self.made.frame, self.made.segments, (), reach, known_inconsistency=0.0)

    def anchor(self, line):
        return Anchor(plain(self.made.pixels[line]), int(self.made.axis[line]))

    def label(self, graph, edge, word):
        i, j = graph.edges[edge].tolist()
        return LabelCrossing((self.anchor(i), self.anchor(j)), tuple(graph.crossing[edge].tolist()), word)

    def corrected(self, *edits):
        camera = self.made.camera
        corrections = Corrections("made.jpg", camera.width, camera.height, edits)
        return correct(self.made.segments, camera, self.made.frame, corrections)

    def scene(self, *edits, options=None):
        corrected = self.corrected(*edits)
        options = options or NEAR
        if not edits and options in self.free:
            return self.free[options]
        made = reconstruct_lines("made.jpg", self.found(options), options, corrected=corrected)
        scene = measured(made.scene, corrected)
        if not edits:
            self.free[options] = scene
        return scene

    def decision(self, scene, graph, edge):
        """Whether a crossing of the graph of all lines is real in a scene; None if the scene does not have it."""
        look = {ends.tobytes(): number for number, ends in zip(scene.lines.id, scene.lines.segment, strict=True)}
        pair = [look.get(graph.segments.ends[line].tobytes()) for line in graph.edges[edge]]
        rows = [sorted(row) for row in scene.intersections.lines.tolist()]
        return bool(scene.intersections.real[rows.index(sorted(pair))]) if None not in pair else None


@pytest.fixture(scope="module")
def house(made):
    return Made(made)


@pytest.fixture(scope="module")
def graph(house):
    return connect(house.found(NEAR), NEAR)[0]


@pytest.fixture(scope="module")
def far_graph(house):
    return connect(house.found(FAR), FAR)[0]


@pytest.mark.parametrize("backend", ["scip", pytest.param("highs", marks=pytest.mark.thorough)])
@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_a_crossing_called_fake_or_real_is_so_in_the_scene(house, graph, made, formulation, backend):
    solve = SolveOptions(formulation=formulation, backend=backend, time_limit_s=1)
    options = Options(joins="biconnected", weights="junctions", solve=solve)
    plain_crossing = (graph.kind != "collinear") & graph.informative
    true = np.flatnonzero(made.truly_real(graph) & plain_crossing)
    edge = int(true[len(true) // 2])
    for word in ("real", "fake"):
        scene = house.scene(house.label(graph, edge, word), options=options)
        assert bool(house.decision(scene, graph, edge)) == (word == "real")  # None where it held a line alone


def test_a_crossing_called_real_is_never_refused(house, far_graph):
    """One crossing alone ties the two boxes: it is refused, but not where a person calls it real."""
    box = house.made.box[far_graph.edges]
    (edge,) = np.flatnonzero((box[:, 0] != box[:, 1]) & far_graph.informative).tolist()
    lines = far_graph.edges[edge].tolist()
    free = house.scene(options=FAR)
    assert not house.decision(free, far_graph, edge)
    scene = house.scene(house.label(far_graph, edge, "real"), options=FAR)
    assert house.decision(scene, far_graph, edge)
    first, second = (length_in_scene(scene, house, line)[1] for line in lines)
    assert first == second


def test_without_corrections_that_bear_on_it_the_scene_is_the_same(house):
    lone = house.scene()
    same = house.scene(KnownLength(house.anchor(0), None))
    assert np.array_equal(lone.lines.ends, same.lines.ends)
    assert np.array_equal(lone.intersections.real, same.intersections.real)


def test_a_deleted_line_is_not_in_the_scene(house):
    scene = house.scene(Delete(house.anchor(5)))
    assert house.made.pixels[5].tobytes() not in {ends.tobytes() for ends in scene.lines.segment}


def length_in_scene(scene, house, line):
    """The length of a line and its component; component -1 where the scene does not have it."""
    looks = [ends.tobytes() for ends in scene.lines.segment]
    if house.made.pixels[line].tobytes() not in looks:
        return 0.0, -1
    row = looks.index(house.made.pixels[line].tobytes())
    return np.linalg.norm(scene.lines.ends[row, 1] - scene.lines.ends[row, 0]), int(scene.lines.component[row])


@pytest.fixture(scope="module")
def main(house):
    """Lines of component 0 of the scene without corrections."""
    scene = house.scene()
    return [line for line in range(len(house.made.axis)) if length_in_scene(scene, house, line)[1] == 0]


class TestLengths:
    def test_a_known_length_sets_the_scale(self, house, main):
        scene = house.scene(KnownLength(house.anchor(main[0]), 3.5))
        assert scene.metres_per_unit * length_in_scene(scene, house, main[0])[0] == pytest.approx(3.5)

    def test_two_lengths_make_a_mean_and_a_note_where_they_disagree(self, house, main):
        free = house.scene()
        lengths = [length_in_scene(free, house, line)[0] for line in main[:2]]
        said = [
            KnownLength(house.anchor(line), float(scale * length))
            for line, length, scale in zip(main[:2], lengths, [2.0, 8.0], strict=True)
        ]
        scene = house.scene(*said)
        assert scene.metres_per_unit == pytest.approx(4.0)
        assert any("disagree by up to 300%" in note for note in scene.notes)

    def test_a_length_on_another_component_says_nothing_and_is_a_note(self, house):
        scene = house.scene()
        other = next(line for line in range(len(house.made.axis)) if length_in_scene(scene, house, line)[1] > 0)
        scene = house.scene(KnownLength(house.anchor(other), 3.5))
        assert scene.metres_per_unit is None
        assert any("3.5 m) is not on component 0" in note for note in scene.notes)


class TestContradiction:
    def test_it_is_told_by_places_and_ids(self, house, far_graph, made):
        graph = far_graph
        false = np.flatnonzero(~made.truly_real(graph) & graph.possible & graph.informative)
        with pytest.raises(ContradictionError, match=r"the crossings at \(\d+, \d+\), .* cannot all be real") as raised:
            house.scene(*(house.label(graph, e, "real") for e in np.flatnonzero(graph.possible)), options=FAR)
        pairs = {tuple(pair) for pair in graph.edges.tolist()}
        assert set(raised.value.crossings) <= pairs
        assert any(tuple(graph.edges[e].tolist()) in raised.value.crossings for e in false)

    @pytest.mark.thorough
    def test_none_of_its_crossings_can_be_left_out(self, house, far_graph):
        graph = far_graph
        said = {tuple(graph.edges[e].tolist()): house.label(graph, e, "real") for e in np.flatnonzero(graph.possible)}
        with pytest.raises(ContradictionError) as raised:
            house.scene(*said.values(), options=FAR)
        assert len(raised.value.crossings) <= 4
        for left_out in raised.value.crossings:
            house.scene(*(said[pair] for pair in raised.value.crossings if pair != left_out), options=FAR)


def test_a_label_of_a_line_that_is_not_there_is_a_note(house):
    lost = Anchor(((5.0, 5.0), (90.0, 9.0)), 0)
    scene = house.scene(LabelCrossing((lost, house.anchor(0)), (5.0, 5.0), "fake"))
    assert any("correction 1 is left out: no line runs from" in note for note in scene.notes)


class TestFrame:
    def drawn(self, made, lines, names=(0, 1, 2)):
        return [(made.pixels[line], names[made.axis[line]]) for line in lines]

    def some(self, made, *counts):
        return [line for axis, count in enumerate(counts) for line in np.flatnonzero(made.axis == axis)[::3][:count]]

    @pytest.mark.parametrize("counts", [(2, 1, 0), (0, 2, 1), (1, 0, 2), (2, 2, 2), (3, 1, 1)])
    @pytest.mark.parametrize("names", [(0, 1, 2), (2, 0, 1)])
    def test_the_true_frame_comes_out_whatever_the_axes_were_called(self, made, counts, names):
        lines = self.some(made, *counts)
        frame = fit_frame(made.pixels[lines], np.array(names)[made.axis[lines]], made.camera.matrix, made.unlabelled)
        assert np.abs(frame.rotation - made.frame.rotation).max() < 1e-6

    @pytest.mark.parametrize(
        ("counts", "message"), [((1, 1, 0), "2 lines were drawn"), ((3, 0, 0), "3 lines were drawn")]
    )
    def test_too_few_lines_are_refused(self, made, counts, message):
        lines = self.some(made, *counts)
        with pytest.raises(ReconstructionError, match=message):
            fit_frame(made.pixels[lines], made.axis[lines], made.camera.matrix, made.unlabelled)

    def test_two_pieces_of_one_image_line_are_refused(self, made):
        line, other = made.pixels[0], made.pixels[np.flatnonzero(made.axis != made.axis[0])[0]]
        middle = line.mean(axis=0)
        ends = np.array([[line[0], middle], [middle, line[1]], other])
        with pytest.raises(ReconstructionError, match="lie on one line of the photo"):
            fit_frame(ends, np.array([0, 0, 1]), made.camera.matrix, made.unlabelled)

    def test_the_lines_of_the_photo_are_named_by_it(self, house, made):
        lines = self.some(made, 2, 2, 1)
        said = SetFrame(tuple(house.anchor(line) for line in lines))
        found = name_lines(house.photo, made.noisy(0.2), drawn=said)
        assert np.abs(found.frame.rotation - made.frame.rotation).max() < 1e-6
        assert "the Manhattan frame is that of lines drawn by hand" in found.notes


def test_reconstruct_takes_corrections(made):
    """From pixels to scene: the line that is deleted is found anew, by its place, and left out."""
    photo = Photo("made.jpg", np.repeat(made.image()[:, :, None], 3, axis=2), made.camera)
    options = Options()
    scene = reconstruct(photo, options)
    ends = scene.lines.segment[0]
    gone = Delete(Anchor(plain(ends + 0.7), int(scene.lines.axis[0])))
    corrections = Corrections("made.jpg", photo.width, photo.height, (gone,))
    corrected = reconstruct(photo, options, corrections=corrections)
    assert ends.tobytes() not in {seen.tobytes() for seen in corrected.lines.segment}
    assert len(corrected.lines) >= len(scene.lines) - 3


def test_a_sure_crossing_makes_one_body_of_two(far_graph, made):
    graph = far_graph
    chosen = made.truly_real(graph)
    apart = find_blocks(graph, chosen)
    box = made.box[graph.edges]
    across = np.flatnonzero((box[:, 0] != box[:, 1]) & graph.informative)[:1]
    sure = np.zeros(len(graph.edges), bool)
    sure[across] = True
    one = apart.merged(graph.edges[sure])
    assert apart.count > one.count >= 1
    assert one.joins(graph)[across].all()
    assert (apart.joins(graph) <= one.joins(graph)).all()
    assert np.bincount(one.body)[0] == np.bincount(one.body).max()


def test_only_crossings_called_real_or_fake_change_the_graph(house, graph):
    corrected = house.corrected(house.label(graph, 3, "unsure"))
    noted = annotations_of(graph, corrected)
    assert not noted.real.any()
    assert not noted.fake.any()
    nothing = Corrections("made.jpg", 1600, 1200)
    nothing = Corrections("made.jpg", 1600, 1200)
    assert correct(house.made.segments, house.made.camera, house.made.frame, nothing).is_like(corrected)


class TestFacts:
    """The two boxes are two bodies; one word about an edge of each says how they stand."""

    OPTIONS = Options()

    @pytest.fixture
    def pair(self, house):
        """A level edge of each box, on one side of the camera."""
        made = house.made
        side = np.sign(made.ends[:, :, 2]).mean(axis=1)
        levels = [np.flatnonzero((made.axis != 2) & (made.box == box)).tolist() for box in range(2)]
        return next([one, other] for one in levels[0] for other in levels[1] if abs(side[one] + side[other]) == 2)

    def height(self, scene, house, line):
        look = house.made.pixels[line].tobytes()
        (row,) = [row for row in range(len(scene.lines.id)) if look in {ends.tobytes() for ends in
                  scene.lines.segments_of(row)}]  # fmt: skip
        return scene.lines.ends[row, :, 2]

    def test_levels_that_are_one_are_exactly_so(self, house, pair):
        fact = OnePlane(tuple(map(house.anchor, pair)), 2)
        free, told = house.scene(options=self.OPTIONS), house.scene(fact, options=self.OPTIONS)
        heights = [[self.height(scene, house, line) for line in pair] for scene in (free, told)]
        assert np.ptp(heights[0]) > 1e-3
        assert np.ptp(heights[1]) == 0
        assert not any("left out" in note for note in told.notes)

    def test_what_says_nothing_is_a_note(self, house):
        one = np.flatnonzero((house.made.box == 0) & (house.made.axis == 0))[:2].tolist()
        fact = OnePlane(tuple(map(house.anchor, one)), 2)
        scene = house.scene(fact, options=self.OPTIONS)
        [note] = [note for note in scene.notes if "left out" in note and "same height" in note]
        assert "on opposite sides of the camera" in note

    def test_programs_without_bodies_say_so(self, house, pair):
        fact = OnePlane(tuple(map(house.anchor, pair)), 2)
        assert any("places none" in note for note in house.scene(fact, options=NEAR).notes)

    def test_what_cannot_hold_is_named(self, house, pair):
        first, second = map(house.anchor, pair)
        facts = [PlaceAt(second, first, log_ratio) for log_ratio in (0.1, 0.7)]
        with pytest.raises(ContradictionError, match=r'"stands here at .*", "stands here at .*" cannot all') as told:
            house.scene(*facts, options=self.OPTIONS)
        assert told.value.facts == tuple(facts)
        assert set(told.value.lines) == set(pair)

    def test_a_scene_by_what_was_prepared_is_the_same(self, house, pair):
        fact = OnePlane(tuple(map(house.anchor, pair)), 2)
        free, told = house.corrected(), house.corrected(fact)
        prepared = prepare(house.found(self.OPTIONS), self.OPTIONS, corrected=free)
        assert prepared.is_for(told)
        assert not prepared.is_for(house.corrected(Cut(fact.lines)))
        made = reconstruct_prepared("made.jpg", prepared, self.OPTIONS, corrected=told)
        scene = house.scene(fact, options=self.OPTIONS)
        for name in ("ends", "segment", "probability", "component"):
            assert getattr(made.scene.lines, name).tobytes() == getattr(scene.lines, name).tobytes()
        assert made.scene.notes == scene.notes
