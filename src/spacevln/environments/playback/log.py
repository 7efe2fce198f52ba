"""The posed RGB-D log: a directory with ``log.json``, ``frames.jsonl``, colour as JPEG and depth as 16-bit PNG in millimetres."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import cv2
import numpy as np
from pydantic import BaseModel, ConfigDict, ValidationError

from spacevln.core.errors import RecordError
from spacevln.core.geometry import Pose
from spacevln.core.sensing import Camera, Observation

FORMAT: Literal["spacevln-rgbd/1"] = "spacevln-rgbd/1"
_JPEG_QUALITY = 95


class _Line(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class LogHead(_Line):
    """``log.json``. ``source`` says where the frames are from, e.g. the robot's profile."""

    format: Literal["spacevln-rgbd/1"] = FORMAT
    camera: Camera
    source: str = ""


class LogFrame(_Line):
    """One line of ``frames.jsonl``: file names, time of the measurement, pose of the body, (4, 4) of the camera, row-major."""

    index: int
    stamp_ns: int
    pose: Pose
    T_world_camera: tuple[float, ...]
    rgb: str
    depth: str
    note: str = ""


class LogWriter:
    """Appends frames; a killed process loses at most the one being written.

    Args:
        directory: created; must not hold a log.
        camera: of every frame.
        source: where the frames are from.

    Raises:
        RecordError: it cannot be written, or holds a log.
    """

    def __init__(self, directory: Path, camera: Camera, source: str = "") -> None:
        self._directory, self._count = directory, 0
        if (directory / "log.json").exists():
            raise RecordError(f"{str(directory)!r} holds a log already: give another --out.")
        try:
            (directory / "images").mkdir(parents=True, exist_ok=True)
            (directory / "log.json").write_text(LogHead(camera=camera, source=source).model_dump_json(), encoding="utf-8")
            self._file = (directory / "frames.jsonl").open("w", encoding="utf-8")
        except OSError as error:
            raise RecordError(f"Cannot write the log {str(directory)!r} ({error.strerror}): give a writable --out.") from error

    def add(self, observation: Observation, stamp_ns: int, note: str = "") -> None:
        """Append a frame.

        Raises:
            RecordError: it cannot be written.
        """
        rgb, depth = f"images/{self._count:06d}.jpg", f"images/{self._count:06d}.png"
        millimetres = np.clip(np.rint(observation.depth_m * 1000), 0, 65535).astype(np.uint16)
        colour = np.ascontiguousarray(observation.rgb[..., ::-1])
        frame = LogFrame(
            index=self._count,
            stamp_ns=stamp_ns,
            pose=observation.pose,
            T_world_camera=tuple(map(float, observation.T_world_camera.ravel())),
            rgb=rgb,
            depth=depth,
            note=note,
        )
        written = cv2.imwrite(str(self._directory / rgb), colour, [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])
        written = written and cv2.imwrite(str(self._directory / depth), millimetres)
        try:
            if not written:
                raise OSError(0, "images cannot be written")
            self._file.write(frame.model_dump_json() + "\n")
            self._file.flush()
        except OSError as error:
            raise RecordError(f"Cannot write the log {str(self._directory)!r} ({error.strerror}): free space.") from error
        self._count += 1

    def __len__(self) -> int:
        return self._count

    def close(self) -> None:
        """Close the file. May be called twice."""
        self._file.close()


class Log:
    """A log that is read.

    Raises:
        RecordError: it is no log, or damaged.
    """

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        try:
            self.head = LogHead.model_validate_json((directory / "log.json").read_text(encoding="utf-8"))
            lines = (directory / "frames.jsonl").read_text(encoding="utf-8").splitlines(keepends=True)
            whole = [line for line in lines if line.endswith("\n")]  # the last may have been cut off by a kill
            self.frames = tuple(LogFrame.model_validate_json(line) for line in whole)
        except (OSError, ValidationError) as error:
            raise RecordError(f"{str(directory)!r} is no posed RGB-D log ({str(error).splitlines()[0]}).") from error

    def __len__(self) -> int:
        return len(self.frames)

    def observation(self, index: int) -> Observation:
        """One frame.

        Raises:
            RecordError: an image is missing or damaged.
        """
        frame = self.frames[index]
        colour = cv2.imread(str(self._directory / frame.rgb), cv2.IMREAD_COLOR)
        millimetres = cv2.imread(str(self._directory / frame.depth), cv2.IMREAD_UNCHANGED)
        if colour is None or millimetres is None:
            raise RecordError(f"Frame {index} of {str(self._directory)!r} lacks its images: record it anew.")
        return Observation(
            rgb=np.ascontiguousarray(colour[..., ::-1], np.uint8),
            depth_m=millimetres.astype(np.float32) / np.float32(1000),
            pose=frame.pose,
            camera=self.head.camera,
            T_world_camera=np.array(frame.T_world_camera).reshape(4, 4),
        )

    def __iter__(self) -> Iterator[Observation]:
        return (self.observation(index) for index in range(len(self)))
