"""A batch goes on where it was, redoes what changed, and has one row for each photo that it worked on."""

import dataclasses
import json

import pytest

from linecad.batch.job import THUMBNAILS, Outcome
from linecad.batch.record import NAME
from linecad.batch.run import LARGEST_LOSSES, run_batch
from linecad.errors import LinecadError, OutputError

LOST = Outcome("killed", "lost", is_lost=True)


@pytest.fixture
def photos(tmp_path):
    folder = tmp_path / "survey"
    folder.mkdir()
    made = [folder / f"p{number}.jpg" for number in range(5)]
    for number, photo in enumerate(made):
        photo.write_bytes(bytes([number]) * 10)
    return made


def run(plan, executor, on_row=lambda _progress, _row: None):
    result = run_batch(plan, lambda _lock: executor, on_row)
    assert executor.is_closed
    return result


def recorded(output):
    return [json.loads(line) for line in (output / NAME).read_text().splitlines()]


def test_every_photo_is_done_once(photos, plan_of, fake, output):
    result = run(plan_of(photos), fake())
    assert [row["photo"] for row in recorded(output)] == [str(photo) for photo in photos]
    assert {row["status"] for row in recorded(output)} == {"done"}
    assert (result.progress.done, result.progress.over, result.progress.total) == (5, 5, 5)
    assert (output / "index.html").is_file()


def test_a_second_run_has_nothing_to_do(photos, plan_of, fake, output):
    run(plan_of(photos), fake())
    before = (output / NAME).read_bytes()
    executor = fake()
    result = run(plan_of(photos), executor)
    assert executor.taken == []
    assert result.progress.skipped == 5
    assert len(result.rows) == 5
    assert (output / NAME).read_bytes() == before


def test_what_changed_is_done_again(photos, plan_of, fake, output, conversion):
    run(plan_of(photos), fake())
    photos[1].write_bytes(b"another photo")
    (output / "p2.json").unlink()
    (output / THUMBNAILS / "p3.jpg").write_bytes(b"cut")
    executor = fake()
    run(plan_of(photos), executor)
    assert executor.taken == ["p1.jpg", "p2.jpg", "p3.jpg"]
    executor = fake()
    run(plan_of(photos, conversion=dataclasses.replace(conversion, focal=301.0)), executor)
    assert len(executor.taken) == 5


def test_limits_are_no_reason_to_do_anything_again(photos, plan_of, fake):
    run(plan_of(photos), fake())
    executor = fake()
    plan = plan_of(photos)
    run(dataclasses.replace(plan, limits=dataclasses.replace(plan.limits, seconds=7.0)), executor)
    assert executor.taken == []


def test_a_failure_is_a_row_and_is_tried_again_by_the_next_run(photos, plan_of, fake, output):
    result = run(plan_of(photos), fake({"p2.jpg": Outcome("failed", "too few lines")}))
    assert (result.progress.done, result.progress.failed) == (4, 1)
    assert [row["error"] for row in recorded(output) if row["status"] == "failed"] == ["too few lines"]
    executor = fake()
    assert run(plan_of(photos), executor).progress.failed == 0
    assert executor.taken == ["p2.jpg"]
    assert len(recorded(output)) == 6


def test_a_photo_that_is_gone_is_a_row(photos, plan_of, fake, output):
    photos[0].unlink()
    result = run(plan_of(photos), fake())
    assert (result.progress.done, result.progress.failed) == (4, 1)
    assert "no longer there" in recorded(output)[0]["error"]


def test_a_lost_photo_is_begun_again_but_not_for_ever(photos, plan_of, fake, output):
    executor = fake({"p0.jpg": [LOST, LOST], "p1.jpg": [LOST] * (LARGEST_LOSSES + 1)})
    result = run(plan_of(photos), executor)
    assert executor.taken.count("p0.jpg") == 3
    assert executor.taken.count("p1.jpg") == LARGEST_LOSSES + 1
    assert {row["photo"][-6:]: row["status"] for row in recorded(output)}["p1.jpg"] == "killed"
    assert len(recorded(output)) == 5
    assert (result.progress.done, result.progress.failed) == (4, 1)


def test_a_photo_that_was_moved_is_known_by_its_content(photos, plan_of, fake):
    run(plan_of(photos), fake())
    moved = [photo.rename(photo.with_name(f"moved-{photo.name}")) for photo in photos]
    executor = fake()
    result = run(plan_of(moved), executor)
    assert executor.taken == []
    assert [row.name for row in result.rows] == [photo.stem.removeprefix("moved-") for photo in moved]


def test_a_copy_of_a_photo_is_a_photo_of_its_own(photos, plan_of, fake):
    run(plan_of(photos[:1]), fake())
    copy = photos[0].with_name("copy.jpg")
    copy.write_bytes(photos[0].read_bytes())
    executor = fake()
    run(plan_of([photos[0], copy]), executor)
    assert executor.taken == ["copy.jpg"]


def test_what_a_killed_run_left_half_written_goes(photos, plan_of, fake, output):
    (output / THUMBNAILS).mkdir()
    (output / ".linecad-0123.json").write_text("half")
    (output / THUMBNAILS / ".linecad-0123.jpg").write_text("half")
    for folder in ("p0.obj.textures", "p1.usda.textures", ".linecad-0123"):  # the last one as a killed .usdz leaves it
        (output / folder).mkdir()
        (output / folder / ".linecad-0123.jpg").write_text("half")
    run(plan_of(photos), fake())
    assert not list(output.rglob(".linecad-*"))


def test_an_output_that_is_a_link_is_not_followed(photos, plan_of, fake, output, tmp_path):
    (output / "p1.json").symlink_to(tmp_path / "elsewhere.json")
    result = run(plan_of(photos), fake())
    assert result.progress.failed == 1
    assert not (tmp_path / "elsewhere.json").exists()


def test_pictures_that_would_go_elsewhere_end_the_batch(photos, plan_of, fake, output, tmp_path):
    (output / THUMBNAILS).symlink_to(tmp_path)
    with pytest.raises(OutputError, match="is a link"):
        run_batch(plan_of(photos), lambda _lock: fake(), lambda _progress, _row: None)


def test_no_photo_is_overwritten_by_what_is_made_of_it(plan_of, fake, output):
    photo = output / "facade.json"  # a file with an odd name, in the output folder itself
    photo.write_bytes(b"photo")
    result = run(plan_of([photo]), fake())
    assert result.progress.failed == 1
    assert photo.read_bytes() == b"photo"


def test_the_page_is_there_also_after_an_interrupt(photos, plan_of, fake, output):
    def interrupt(progress, _row):
        if progress.done == 2:
            raise KeyboardInterrupt

    executor = fake()
    with pytest.raises(KeyboardInterrupt):
        run_batch(plan_of(photos), lambda _lock: executor, interrupt)
    assert executor.is_closed
    assert "2 photos, 2 done" in (output / "index.html").read_text()
    executor = fake()
    run(plan_of(photos), executor)
    assert executor.taken == ["p2.jpg", "p3.jpg", "p4.jpg"]


def test_a_batch_in_a_folder_where_one_runs_is_refused(photos, plan_of, fake, monkeypatch):
    monkeypatch.setattr("linecad.batch.lock.PATIENCE", 0.0)
    inner = []

    def again(_progress, _row):
        if not inner:
            with pytest.raises(LinecadError, match="another batch works") as error:
                run_batch(plan_of(photos), lambda _lock: fake(), lambda _p, _r: None)
            inner.append(error)

    run(plan_of(photos), fake(), again)
    assert inner


@pytest.fixture
def maps(photos):
    """Depth maps of the first two photos; the second one in the folder that MoGe makes."""
    folder = photos[1].with_suffix("")
    folder.mkdir()
    found = {photos[0]: photos[0].with_name("p0.depth.npy"), photos[1]: folder / "depth.exr"}
    found[photos[0]].write_bytes(b"\x93NUMPY 0")
    found[photos[1]].write_bytes(b"\x76\x2f\x31\x01 1")
    return found


def test_each_photo_has_its_own_map_and_the_record_says_which(photos, maps, plan_of, fake, output):
    executor = fake()
    run(plan_of(photos, maps=maps), executor)
    assert [job.conversion.depth for job in executor.jobs] == [*maps.values(), None, None, None]
    assert [row["depth"] for row in recorded(output)] == [*map(str, maps.values()), "", "", ""]
    page = (output / "index.html").read_text()
    assert page.count("depth map: ") == 2
    assert "depth map: p1/depth.exr" in page


def test_a_map_that_changed_came_or_went_makes_its_photo_again(photos, maps, plan_of, fake):
    run(plan_of(photos, maps=maps), fake())

    def taken(maps=maps):
        executor = fake()
        run(plan_of(photos, maps=maps), executor)
        return executor.taken

    assert taken() == []
    maps[photos[0]].write_bytes(b"\x93NUMPY 2")
    assert taken() == ["p0.jpg"]
    maps[photos[1]].with_name("fov.json").write_bytes(b"{}")  # read with the map
    assert taken() == ["p1.jpg"]
    maps[photos[1]].with_name("mask.png").write_bytes(b"1")  # not read
    assert taken() == []
    assert taken({}) == ["p0.jpg", "p1.jpg"]
    assert taken() == ["p0.jpg", "p1.jpg"]


def test_a_map_that_was_renamed_changes_nothing_but_the_record(photos, maps, plan_of, fake):
    run(plan_of(photos, maps=maps), fake())
    maps[photos[0]] = maps[photos[0]].rename(photos[0].with_name("p0_depth.npy"))
    executor = fake()
    result = run(plan_of(photos, maps=maps), executor)
    assert executor.taken == []
    assert result.rows[0].depth == str(maps[photos[0]])


def test_a_map_that_is_none_is_a_row(photos, maps, plan_of, fake, output):
    maps[photos[0]].write_bytes(b"")
    result = run(plan_of(photos, maps=maps), fake())
    assert (result.progress.done, result.progress.failed) == (4, 1)
    [failed] = [row for row in recorded(output) if row["status"] == "failed"]
    assert "p0.depth.npy is empty" in failed["error"]
    assert failed["depth"] == str(maps[photos[0]])


def test_no_map_is_overwritten_by_what_is_made_of_its_photo(plan_of, fake, output):
    photo, depth = output / "facade.jpg", output / "facade.png"
    photo.write_bytes(b"photo")
    depth.write_bytes(b"\x89PNG")
    result = run(plan_of([photo], suffixes=(".png",), maps={photo: depth}), fake())
    assert "is the depth map and would be lost" in result.rows[0].outcome.error
    assert depth.read_bytes() == b"\x89PNG"
