// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A library that has nothing to do with cameras.
extern "C" int nothing_of_a_camera() { return 0; }
