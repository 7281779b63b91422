"""How well a photo's camera and frame are found, and how honest the standard errors are.

    PYTHONPATH=. python tests/benchmarks/cameras.py real DATA [--photos] [--depth]
    PYTHONPATH=. python tests/benchmarks/cameras.py simulated CACHE [--count 300] [--kinds plain bent] [--photos]

DATA holds the folders york_urban, castle and south_building, or some of them, as `linecad evaluate` takes them. CACHE
keeps the simulated photos, which are made once for each seed. With --photos every photo has a line of its own, with
--depth whole scenes are reconstructed with the true camera and with the one that was found.
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from camera_verdicts import Verdict, area_below, finite_level_points, judge
from simulated_kinds import CHANGES, PLAIN, simulated_photos

from linecad.arrays import Float
from linecad.camera.distortion import straighten
from linecad.camera.photo import Photo, read_photo
from linecad.errors import LinecadError
from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.depth import score_depth
from linecad.evaluation.frames import nearest_axes, true_axes
from linecad.evaluation.references import Reference, open_case
from linecad.options import Options
from linecad.pipeline import reconstruct
from linecad.scene import QUALITIES, Camera
from solver.options import SolveOptions

FIT = Options(solve=SolveOptions(fast=True))
LIMITS = (3.0, 5.0, 10.0)  # degrees
KNOWN, CROPPED, CROP_NOT_SAID = "plain, K known", "cropped", "cropped, not said"
KINDS = (PLAIN, KNOWN, *(kind for kind in CHANGES if kind != PLAIN), CROP_NOT_SAID)
QUANTITIES = ("rotation", "focal", "principal point", "k1")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["real", "simulated"])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--photos", action="store_true", help="a line for each photo")
    parser.add_argument("--depth", action="store_true", help="real photos: reconstruct them too; takes minutes")
    parser.add_argument("--only", default="", help="real photos: the datasets with this in their name")
    parser.add_argument("--count", type=int, default=300, help="simulated scenes")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS, help="of simulated photos")
    chosen = parser.parse_args()
    if chosen.what == "simulated":
        show_simulated(chosen.folder, chosen.seed, chosen.count, set(chosen.kinds), chosen.photos)
        return
    for name in ("york_urban", "castle", "south_building"):
        if (chosen.folder / name).is_dir() and chosen.only in name:
            if name == "york_urban":
                show_york(chosen.folder / name, chosen.photos)
            else:
                show_large(chosen.folder / name, chosen.depth)


def show_york(folder: Path, photos: bool) -> None:
    """York Urban three times: with its camera, without, and with what EXIF says."""
    cases = [(case, *open_case(case)) for case in find_dataset(folder).cases]
    known = [_judge(case, "K known", photo, reference, photo) for case, photo, reference in cases]
    print(f"## {folder.name}, {len(cases)} photos\n\nK known")
    show_turns(known)
    directions = np.concatenate([_directions_off(v, case[2]) for v, case in zip(known, cases, strict=True)])
    for what, errors in (("rotation", np.degrees([_missing(v.turn) for v in known])), ("directions", directions)):
        areas = " / ".join(f"{100 * area_below(errors, limit):.1f}" for limit in LIMITS)
        print(f"area under the error curve at 3 / 5 / 10 degrees, {what}: {areas}")
    labels = [_label_share(verdict, reference) for verdict, (_, _, reference) in zip(known, cases, strict=True)]
    print(f"labels of marked lines, mean of photos: {np.mean(labels):.2%}")
    show_seconds(known)
    unknown = [_judge(case, "K unknown", photo, reference, _bare(photo)) for case, photo, reference in cases]
    exif = [_judge(case, "EXIF kept", photo, ref, read_photo(case.photo)) for case, photo, ref in cases]
    for verdicts in (unknown, exif):
        print(f"\n{verdicts[0].kind}")
        show_seconds(verdicts)
        show_focals(verdicts)
        show_turns(verdicts)
        show_honesty({"all": verdicts})
    if photos:
        show_photos([*known, *unknown, *exif])


def show_large(folder: Path, depth: bool) -> None:
    """Castle and South Building with K hidden, every photo in a line."""
    print(f"\n## {folder.name}, K hidden\n")
    print("| photo | finite level | focal error | its standard error | turn | quality | depth: K, found, ratio |")
    print("| --- " * 7 + "|")
    for case in find_dataset(folder).cases:
        photo, reference = open_case(case)
        assert photo.camera is not None
        assert reference.rotation is not None
        level = finite_level_points(photo.camera.matrix, reference.rotation, photo.width, photo.height)
        verdict = _judge(case, "K hidden", photo, reference, _bare(photo))
        cells = [case.name, f"{level}", *_cells(verdict), _depth_cell(photo, reference) if depth else ""]
        print("| " + " | ".join(cells) + " |", flush=True)


def show_simulated(cache: Path, seed: int, count: int, kinds: set[str], photos: bool) -> None:
    """Simulated photos: standard errors of the plain ones, and what becomes of each kind."""
    by_kind: dict[str, list[Verdict]] = {kind: [] for kind in KINDS}
    making = judging = 0.0
    began = time.monotonic()
    for made in simulated_photos(cache, seed, count):
        making += time.monotonic() - began
        began = time.monotonic()
        photo = read_photo(made.path)
        shown = {made.kind: photo}
        if made.kind == PLAIN:
            shown[KNOWN] = replace(photo, camera=Camera(photo.width, photo.height, made.matrix, "file"))
        if made.kind == CROPPED:
            shown = {CROPPED: replace(photo, crop="cropped"), CROP_NOT_SAID: photo}
        for kind in kinds & shown.keys():
            one = shown[kind]
            truth = (made.matrix, made.rotation, made.radial, made.second)
            by_kind[kind].append(judge(made.name, kind, one, *truth))
        judging += time.monotonic() - began
        began = time.monotonic()
    print(f"## {count} simulated scenes, seed {seed}: made in {making:.0f} s, judged in {judging:.0f} s\n")
    show_seconds([verdict for verdicts in by_kind.values() for verdict in verdicts])
    plain = by_kind[PLAIN]
    groups = {"K known": by_kind[KNOWN], "K unknown": plain}
    groups |= {f"- {word}": [verdict for verdict in plain if verdict.quality == word] for word in QUALITIES}
    groups |= {
        f"- {points} finite vanishing points": [verdict for verdict in plain if verdict.perspective == points]
        for points in (1, 2, 3)
    }
    groups |= {kind: verdicts for kind, verdicts in by_kind.items() if kind not in (PLAIN, KNOWN)}
    show_honesty(groups)
    print()
    show_kinds(by_kind)
    if photos:
        show_photos([verdict for verdicts in by_kind.values() for verdict in verdicts])


def show_seconds(verdicts: list[Verdict]) -> None:
    """How long calibration took after the detector, in a line."""
    milliseconds = 1000 * np.array([verdict.seconds for verdict in verdicts])
    print(f"calibrate: median {np.median(milliseconds):.0f} ms, largest {milliseconds.max():.0f} ms")


def show_turns(verdicts: list[Verdict]) -> None:
    """Rotation errors in a line."""
    turns = np.degrees([_missing(verdict.turn) for verdict in verdicts])
    print(
        f"rotation error: median {np.median(turns):.2f} degrees, {(turns < 2).mean():.0%} below 2, "
        f"worst {turns.max():.2f}; {sum(v.error is not None for v in verdicts)} refused"
    )


def show_focals(verdicts: list[Verdict]) -> None:
    """Relative focal errors in a line."""
    focals = np.array([_missing(abs(verdict.focal)) for verdict in verdicts])
    print(
        f"focal error: median {np.median(focals):.2%}, below 10 % on {(focals < 0.1).mean():.0%}, "
        f"worst {focals.max():.0%}"
    )


def show_honesty(groups: dict[str, list[Verdict]]) -> None:
    """For each group, the share of true values within one and within two standard errors."""
    print("| photos | number | median turn, focal | " + " | ".join(f"{name} 1, 2" for name in QUANTITIES) + " |")
    print("| --- " * (3 + len(QUANTITIES)) + "|")
    for name, verdicts in ((name, verdicts) for name, verdicts in groups.items() if verdicts):
        answered = [verdict for verdict in verdicts if verdict.error is None]
        middle = ""
        if answered:
            turn, focal = (np.median([getattr(v, field) for v in answered]) for field in ("turn", "focal_off"))
            middle = f"{np.degrees(turn):.2f}, {focal:.1%}"
        cells = [_shares([error for v in answered for error in v.sigmas.get(what, ())]) for what in QUANTITIES]
        print("| " + " | ".join([name, f"{len(verdicts)}", middle, *cells]) + " |")


def _shares(errors: list[float]) -> str:
    if not errors:
        return ""
    within = [(np.abs(errors) <= sigmas).mean() for sigmas in (1, 2)]
    return f"{within[0]:.0%}, {within[1]:.0%} of {len(errors)}"


def show_kinds(by_kind: dict[str, list[Verdict]]) -> None:
    """For each kind, what became of the photos; every photo counts in one of the last four columns."""
    heads = ("kind", "number", "refused", *QUALITIES, "recovered", "else flagged", "else near", "silently wrong")
    print("| " + " | ".join(heads) + " |")
    print("| --- " * len(heads) + "|")
    for kind, verdicts in ((kind, verdicts) for kind, verdicts in by_kind.items() if verdicts):
        left = [verdict for verdict in verdicts if not verdict.is_recovered]
        wrong = [verdict for verdict in left if verdict.is_silently_wrong]
        flagged = sum(verdict.is_flagged for verdict in left)
        counts = [len(verdicts), sum(verdict.error is not None for verdict in verdicts)]
        counts += [sum(verdict.quality == word for verdict in verdicts) for word in QUALITIES]
        counts += [len(verdicts) - len(left), flagged, len(left) - flagged - len(wrong), len(wrong)]
        print("| " + " | ".join([kind, *map(str, counts)]) + " |")
    for verdicts in by_kind.values():
        for verdict in verdicts:
            if verdict.is_silently_wrong:
                print(f"silently wrong: {verdict.name} ({verdict.kind}): {', '.join(_cells(verdict))}")


def show_photos(verdicts: list[Verdict]) -> None:
    """A line for each photo."""
    print("\n| photo | kind | finite points | explained by truth, found | focal | standard error | turn | quality |")
    print("| --- " * 8 + "|")
    for verdict in verdicts:
        explained = ", ".join(f"{share:.0%}" for share in verdict.explained)
        cells = [verdict.name, verdict.kind, f"{verdict.perspective}", explained, *_cells(verdict)]
        print("| " + " | ".join(cells) + " |")


def _cells(verdict: Verdict) -> list[str]:
    """Focal error, its standard error, rotation error, quality with its reason."""
    if verdict.error is not None:
        return ["", "", "", f"refused: {verdict.error}"]
    sigma = "" if verdict.focal_sigma is None else f"{verdict.focal_sigma:.1%}"
    if "focal" in verdict.sigmas:
        sigma += f" ({abs(verdict.sigmas['focal'][0]):.1f} of them)"
    turn = f"{np.degrees(verdict.turn):.2f} ({np.abs(verdict.sigmas['rotation']).max():.1f})"
    return [f"{verdict.focal:+.1%}", sigma, turn, f"{verdict.quality}: {verdict.reason}"]


def _judge(case: Case, kind: str, known: Photo, reference: Reference, photo: Photo) -> Verdict:
    """The verdict on `photo`, whose true camera is that of the photo as the dataset gives it."""
    assert known.camera is not None
    assert reference.rotation is not None
    return judge(case.name, kind, photo, known.camera.matrix, reference.rotation)


def _bare(photo: Photo) -> Photo:
    """The photo without anything that tells its camera."""
    return replace(photo, camera=None, exif_focal=None, crop="unknown", notes=())


def _missing(error: float) -> float:
    """An error as it counts in statistics: infinite where nothing was found."""
    return error if np.isfinite(error) else np.inf


def _directions_off(verdict: Verdict, reference: Reference) -> Float:
    """Angles (3,), degrees, between the true axes and the found ones that stand for them."""
    if verdict.found is None or reference.rotation is None:
        return np.full(3, np.inf)
    found, true = verdict.found.frame.rotation, reference.rotation
    cosines = np.abs((found * true[:, true_axes(found, true)]).sum(axis=0))
    return np.asarray(np.degrees(np.arccos(np.clip(cosines, 0, 1))))


def _label_share(verdict: Verdict, reference: Reference) -> float:
    """Share of the marked lines that point to the vanishing point of their axis."""
    assert reference.lines is not None
    assert reference.rotation is not None
    if verdict.found is None:
        return 0.0
    camera, rotation = verdict.found.camera, verdict.found.frame.rotation
    nearest = nearest_axes(reference.lines.ends, camera.matrix, rotation)
    return float((true_axes(rotation, reference.rotation)[nearest] == reference.lines.axis).mean())


def _depth_cell(photo: Photo, reference: Reference) -> str:
    """Depth precision at 5 % of component 0 with the true camera and with the one that is found, and their ratio."""
    precision = []
    for one in (photo, _bare(photo)):
        straight = straighten(one)
        if straight is not one:
            return "bent back, not measured"
        try:
            scene = reconstruct(one, FIT)
        except LinecadError as error:
            return f"{error}"
        assert reference.edges is not None
        own = scene.lines.component == 0
        precision.append(score_depth(scene, reference.edges.pixels, reference.edges.depth, own).precision_5)
    return f"{precision[0]:.3f}, {precision[1]:.3f}, {precision[1] / max(precision[0], 1e-9):.2f}"


if __name__ == "__main__":
    main()
