# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Spectral GS-SLAM: RGB-D SLAM that builds a photorealistic 3D Gaussian map on an ordinary CPU.

    session = sgs.Session(sgs.Camera(640, 480, fx=525, fy=525, cx=319.5, cy=239.5))
    result = session.feed(color, depth, time, depth_scale=1000)   # numpy arrays

Poses are 4x4 matrices T_world_camera (camera: x right, y down, z ahead), lengths metres, times
seconds. docs/python.md has the whole story.
"""
from ._sgs import (
    BadFrame,
    Camera,
    Config,
    Frame,
    FrameResult,
    Map,
    ParameterInfo,
    Recording,
    Rendering,
    RunSummary,
    Session,
    Spectrum,
    Trajectory,
    WeakDirection,
    __version__,
    evaluate,
    evaluate_run,
    log_to_stderr,
    open,
    run,
)
from .errors import Busy, Error, InvalidArgument, NotFound, UnknownKey

__all__ = [
    "BadFrame",
    "Busy",
    "Camera",
    "Config",
    "Error",
    "Frame",
    "FrameResult",
    "InvalidArgument",
    "Map",
    "NotFound",
    "ParameterInfo",
    "Recording",
    "Rendering",
    "RunSummary",
    "Session",
    "Spectrum",
    "Trajectory",
    "UnknownKey",
    "WeakDirection",
    "__version__",
    "evaluate",
    "evaluate_run",
    "log_to_stderr",
    "open",
    "run",
]
