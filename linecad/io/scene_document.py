"""A Scene as plain JSON values, in the order of docs/reference/scene-file.md."""

import math

import numpy as np

from linecad.directions import frame_of, letter_of
from linecad.scene import (
    Certainty,
    DepthMapReport,
    Intersections,
    Lines,
    Opening,
    Plane,
    Scene,
)

FORMAT = "linecad-scene"
VERSION = 1
FRAMES_VERSION = 2  # of files whose lines and planes may be of further frames (`frame`) or sloped (`tilt`)
LARGEST_ERROR = 180.0  # degrees; whoever errs by that much about a rotation knows nothing of it
ANGLE_DIGITS = 12  # after the point, of degrees: a number that was turned to radians and back is the same again


def document_of(scene: Scene) -> dict[str, object]:
    """The file's content as plain values, its keys in the order of the file."""
    camera, solve = scene.camera, scene.solve
    return {
        "format": FORMAT,
        "version": version_of(scene),
        "photo": scene.photo,
        "camera": {
            "width": int(camera.width),
            "height": int(camera.height),
            "K": camera.matrix.tolist(),
            "distortion": [float(coefficient) for coefficient in camera.distortion],
            "resampled": camera.is_resampled,
            **({} if camera.taken_fy is None else {"taken_fy": float(camera.taken_fy)}),
            "source": camera.source,
            "R_cam_from_world": scene.rotation.tolist(),
        },
        **({"turns": list(scene.turns)} if scene.turns else {}),
        "certainty": None if scene.certainty is None else certainty_document(scene.certainty),
        "metres_per_unit": None if scene.metres_per_unit is None else float(scene.metres_per_unit),
        "scale_source": scene.scale_source or None,
        "lines": _line_records(scene.lines),
        "intersections": _crossing_records(scene.intersections),
        "planes": [_plane_record(plane) for plane in scene.planes],
        **({"openings": [_opening_record(each) for each in scene.openings]} if scene.openings else {}),
        "solve": {
            "solver": solve.solver,
            "formulation": solve.formulation,
            "status": solve.status,
            "objective": float(solve.objective),
            "bound": _finite_or_null(solve.bound),
            "gap": _finite_or_null(solve.gap),
            "cuts": int(solve.cuts),
            "nodes": int(solve.nodes),
        },
        **({} if scene.depth_map is None else {"depth_map": _depth_map_record(scene.depth_map)}),
        "notes": list(scene.notes),
    }


def version_of(scene: Scene) -> int:
    """Of its file: the first, which all readers know, where one frame suffices and no plane is sloped."""
    return FRAMES_VERSION if scene.turns or any(plane.tilt for plane in scene.planes) else VERSION


def _direction(axis: int) -> dict[str, object]:
    """The axis within its frame, so that readers who know three axes find one of them, and the frame but the main."""
    frame = int(frame_of(np.array(axis)))
    return {"axis": letter_of(axis), **({"frame": frame} if frame else {})}


def _line_records(lines: Lines) -> list[dict[str, object]]:
    return [
        {
            "id": int(lines.id[row]),
            **_direction(int(lines.axis[row])),
            "segment": lines.segment[row].tolist(),
            "ends": lines.ends[row].tolist(),
            "boundary": bool(lines.is_boundary[row]),
            "component": int(lines.component[row]),
            "confidence": str(lines.confidence[row]),
            "role": str(lines.role[row]),
            **({"probability": float(lines.probability[row])} if len(lines.probability) else {}),
            **({"by_depth_map": True} if lines.by_depth_map[row] else {}),
            **({"by_face": True} if lines.by_face[row] else {}),
            **({"pieces": lines.pieces[row].tolist()} if len(lines.pieces[row]) else {}),
        }
        for row in range(len(lines))
    ]


def _crossing_records(crossings: Intersections) -> list[dict[str, object]]:
    return [
        {
            "lines": crossings.lines[row].tolist(),
            "kind": str(crossings.kind[row]),
            "pixel": crossings.pixel[row].tolist(),
            "real": bool(crossings.real[row]),
            **({"reason": str(crossings.reason[row])} if crossings.reason[row] else {}),
            "in_tree": bool(crossings.in_tree[row]),
            "weight": float(crossings.weight[row]),
        }
        for row in range(len(crossings))
    ]


def _plane_record(plane: Plane) -> dict[str, object]:
    return {
        "id": int(plane.id),
        **_direction(plane.axis),
        **({"tilt": float(plane.tilt)} if plane.tilt else {}),
        "offset": float(plane.offset),
        "lines": [int(line) for line in plane.lines],
        "faces": [
            {
                "id": int(face.id),
                "kind": face.kind,
                "outline": face.outline.tolist(),
                "holes": [hole.tolist() for hole in face.holes],
                **({"hidden": [part.tolist() for part in face.hidden]} if face.hidden else {}),
                **({} if face.opening is None else {"opening": int(face.opening)}),
            }
            for face in plane.faces
        ],
    }


def _opening_record(opening: Opening) -> dict[str, object]:
    return {
        "id": int(opening.id),
        "plane": int(opening.plane),
        "kind": opening.kind,
        "u": [float(opening.u0), float(opening.u1)],
        "v": [float(opening.v0), float(opening.v1)],
        "recess": None if opening.recess is None else float(opening.recess),
        "panel": None if opening.panel is None else float(opening.panel),
        "shape": int(opening.shape),
        **({"completed": True} if opening.is_completed else {}),
    }


def _depth_map_record(report: DepthMapReport) -> dict[str, object]:
    return {"file": report.file, "left_out": report.left_out or None} | {
        key: value for key in ("kind", "shift", "scale", "width") if (value := getattr(report, key)) is not None
    }


def certainty_document(certainty: Certainty) -> dict[str, object]:
    """How sure a camera and its frame are as plain values, as they stand in scene files and camera files."""
    degrees = np.minimum(np.degrees(certainty.rotation), LARGEST_ERROR)
    return {
        "quality": certainty.quality,
        "reason": certainty.reason,
        "rotation_degrees": [round(angle, ANGLE_DIGITS) for angle in degrees.tolist()],
        "focal": None if certainty.focal is None else float(certainty.focal),
        "principal_point": None if certainty.center is None else [float(error) for error in certainty.center],
        "k1": None if certainty.radial is None else float(certainty.radial),
    }


def _finite_or_null(number: float) -> float | None:
    return float(number) if math.isfinite(number) else None
