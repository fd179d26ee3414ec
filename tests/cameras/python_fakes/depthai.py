# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""What sgs-camera-oakd asks of depthai 3, played from a rendered scene. Written from the package's
documentation; it shares no code with it."""
import enum
import types
from datetime import timedelta

from played import Scene, serials, variant

__version__ = variant("version", "3.3.0")


class CameraBoardSocket(enum.Enum):
    CAM_A, CAM_B, CAM_C = range(3)


class Platform(enum.Enum):
    RVC2, RVC4 = range(2)


class CameraExposureOffset(enum.Enum):
    START, MIDDLE, END = range(3)


class MessageQueue:
    class QueueException(Exception):
        pass

    def __init__(self, pipeline):
        self.pipeline = pipeline

    def get(self, timeout):
        assert isinstance(timeout, timedelta)
        scene = self.pipeline.scene
        if scene.unplugged():
            raise self.QueueException("X_LINK_ERROR")
        frame = scene.take()
        if frame is None:
            return None
        t, color, depth = frame
        if variant("smaller_depth"):
            depth = depth[::2, ::2]
        kinds = ImgFrame.Type
        kind = kinds.NV12 if variant("nv12") else kinds.RGB888i
        return {
            "color": ImgFrame(color, kind, t, scene.color),
            "depth": ImgFrame(depth, kinds.RAW16, t, scene.color),
        }


class ImgFrame:
    class Type(enum.Enum):
        RGB888i, RAW16, NV12 = range(3)

    def __init__(self, image, kind, t, camera):
        self.image, self.kind, self.t, self.camera = image, kind, t, camera

    def getType(self):
        return self.kind

    def getFrame(self):
        return self.image

    def getWidth(self):
        return self.image.shape[1]

    def getHeight(self):
        return self.image.shape[0]

    def getTimestampDevice(self, offset):
        assert offset == CameraExposureOffset.MIDDLE
        return timedelta(seconds=self.t)

    def getExposureTime(self):
        return timedelta(milliseconds=8)

    def getSensitivity(self):
        return 400

    def getTransformation(self):
        camera = self.camera
        rows = [[camera.fx, 0, camera.cx], [0, camera.fy, camera.cy], [0, 0, 1]]
        return types.SimpleNamespace(getIntrinsicMatrix=lambda: rows)


class Port:
    """An output or an input of a node; remembers what it is linked to."""

    def __init__(self, owner):
        self.owner, self.links = owner, []

    def link(self, other):
        self.links.append(other)
        other.links.append(self)

    def createOutputQueue(self, maxSize, blocking):
        assert blocking or maxSize > 0
        return MessageQueue(self.owner.pipeline)


class Node:
    ports = ()

    def __init__(self, pipeline):
        self.pipeline = pipeline
        for name in self.ports:
            setattr(self, name, Port(self))


class Camera(Node):
    def build(self, socket):
        self.socket, self.outputs = socket, []
        return self

    def requestOutput(self, size, type=None, fps=None, enableUndistortion=None):
        if self.socket == CameraBoardSocket.CAM_A:
            assert enableUndistortion and type == ImgFrame.Type.RGB888i
            if size[0] % 2:
                raise RuntimeError("no such resolution")
        self.outputs.append(Port(self))
        return self.outputs[-1]


class StereoDepth(Node):
    ports = "left", "right", "inputAlignTo", "depth"


class ImageAlign(Node):
    ports = "input", "inputAlignTo", "outputAligned"


class Sync(Node):
    ports = ("out",)

    def __init__(self, pipeline):
        super().__init__(pipeline)
        self.inputs = {name: Port(self) for name in ("color", "depth")}

    def setSyncThreshold(self, threshold):
        assert isinstance(threshold, timedelta)


node = types.SimpleNamespace(
    Camera=Camera, StereoDepth=StereoDepth, ImageAlign=ImageAlign, Sync=Sync
)


class Device:
    def __init__(self, info):
        if variant("fail"):
            raise RuntimeError(variant("fail"))
        self.info = info

    @staticmethod
    def getAllAvailableDevices():
        return [types.SimpleNamespace(deviceId=serial, name="1.3") for serial in serials()]

    def getPlatform(self):
        return Platform[variant("platform", "RVC2")]


class Pipeline:
    def __init__(self, device):
        self.device, self.nodes, self.scene, self.running = device, [], Scene(), False

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.running = False

    def getDefaultDevice(self):
        return self.device

    def create(self, kind):
        self.nodes.append(kind(self))
        return self.nodes[-1]

    def start(self):
        self._check_wiring()
        self.running = True

    def isRunning(self):
        return self.running

    def _check_wiring(self):
        """Colour and depth reach the queue, and depth is brought into colour where that is done."""
        (stereo,) = (one for one in self.nodes if isinstance(one, StereoDepth))
        (sync,) = (one for one in self.nodes if isinstance(one, Sync))
        align = [one for one in self.nodes if isinstance(one, ImageAlign)]
        assert stereo.left.links and stereo.right.links
        (color,) = sync.inputs["color"].links
        if self.device.getPlatform() == Platform.RVC4:
            assert align[0].input.links == [stereo.depth] and align[0].inputAlignTo.links == [color]
            assert sync.inputs["depth"].links == [align[0].outputAligned]
        else:
            assert not align and stereo.inputAlignTo.links == [color]
            assert sync.inputs["depth"].links == [stereo.depth]
