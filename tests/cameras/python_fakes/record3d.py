# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""What sgs-camera-record3d asks of record3d, played from a rendered scene. Written from the package's
documentation; it shares no code with it."""
import threading
import time
import types

import numpy as np
from played import Scene, serials, variant

METRES = np.float32(0.001)


class Record3DStream:
    def __init__(self):
        self.on_new_frame = self.on_stream_stopped = None
        self.scene = Scene()
        self.frame = None

    @staticmethod
    def get_connected_devices():
        return [types.SimpleNamespace(product_id=0x12A8, udid=serial) for serial in serials()]

    def connect(self, device):
        if variant("fail"):
            return False
        self.thread = threading.Thread(target=self.play, daemon=True)
        self.thread.start()
        return True

    def disconnect(self):
        self.on_stream_stopped()

    def play(self):
        while not self.scene.unplugged():
            self.frame = self.scene.take()
            if self.frame is None:
                return
            self.on_new_frame()
            time.sleep(0.002)  # stamps are those of arrival, and must rise
        self.on_stream_stopped()

    def shown(self, image):
        return image[:, ::-1] if self.get_device_type() == 0 else image

    def get_rgb_frame(self):
        return self.shown(self.frame[1])

    def get_depth_frame(self):
        if variant("bad_depth"):
            return self.frame[2]
        return self.shown(self.frame[2] * METRES)

    def get_confidence_frame(self):
        """Low where nothing was measured, and in a corner where something was."""
        if self.get_device_type() == 0:
            return np.zeros((0, 0), np.uint8)
        confidence = np.full(self.frame[2].shape, 2, np.uint8)
        confidence[: int(variant("unsure", "0")), :] = 0
        return confidence

    def get_intrinsic_mat(self):
        camera = self.scene.color
        cx = camera.cx if self.get_device_type() else camera.width - 1 - camera.cx
        moved = float(variant("moved", "0")) * self.scene.played()
        return types.SimpleNamespace(fx=camera.fx, fy=camera.fy, tx=cx + moved, ty=camera.cy)

    def get_device_type(self):
        return int(variant("kind", "1"))
