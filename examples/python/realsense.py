# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Feeds a RealSense camera to a session (needs the package pyrealsense2 of the maker).

    realsense.py OUTPUT_FOLDER [SECONDS]

Not tested on hardware: what it asks of pyrealsense2 is taken from that package's documentation.
"""
import sys
import time

import numpy as np
import pyrealsense2 as rs

import sgs

WIDTH, HEIGHT, RATE = 640, 480, 30
WARM_UP = 30  # frames until exposure and white balance have settled


def main(output: str, seconds: float) -> None:
    pipeline, wanted = rs.pipeline(), rs.config()
    wanted.enable_stream(rs.stream.depth, WIDTH, HEIGHT, rs.format.z16, RATE)
    wanted.enable_stream(rs.stream.color, WIDTH, HEIGHT, rs.format.rgb8, RATE)
    profile = pipeline.start(wanted)
    try:
        units = 1 / profile.get_device().first_depth_sensor().get_depth_scale()
        stream = profile.get_stream(rs.stream.color).as_video_stream_profile()
        lens = stream.get_intrinsics()
        # The factory's "inverse" Brown-Conrady of most colour cameras has coefficients of zero.
        camera = sgs.Camera(
            WIDTH,
            HEIGHT,
            fx=lens.fx,
            fy=lens.fy,
            cx=lens.ppx,
            cy=lens.ppy,
            distortion=list(lens.coeffs),
        )
        align = rs.align(rs.stream.color)
        for _ in range(WARM_UP):
            pipeline.wait_for_frames()
        with sgs.Session(camera, live=True) as session:
            end = time.monotonic() + seconds
            while time.monotonic() < end:
                frames = align.process(pipeline.wait_for_frames())
                color, depth = frames.get_color_frame(), frames.get_depth_frame()
                if not color or not depth:
                    continue
                result = session.feed(
                    np.asanyarray(color.get_data()),
                    np.asanyarray(depth.get_data()),
                    color.get_timestamp() / 1000,
                    depth_scale=units,
                )
                weak = ", ".join(f"{w.weight:.2f}" for w in result.weak_directions())
                print(f"{result.status:10} {result.T_world_camera[:3, 3]} weak: {weak or 'none'}")
    except KeyboardInterrupt:
        pass
    finally:
        pipeline.stop()
    session.save(output)


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(sys.argv[1], float(sys.argv[2]) if len(sys.argv) == 3 else 60.0)
