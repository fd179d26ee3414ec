# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Rotations, for the programs of ROS 1."""
import numpy as np


def quaternion(R):
    """x, y, z, w of a rotation matrix: the eigenvector of the largest eigenvalue of a symmetric matrix
    of R (I. Bar-Itzhack, New Method for Extracting the Quaternion from a Rotation Matrix, 2000)."""
    K = np.empty((4, 4))
    K[:3, :3] = R + R.T - np.trace(R) * np.eye(3)
    K[3, :3] = K[:3, 3] = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    K[3, 3] = np.trace(R)
    q = np.linalg.eigh(K)[1][:, -1]
    return q if q[3] >= 0 else -q
