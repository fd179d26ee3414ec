// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// sgs-camera-realsense: what `sgs run camera:realsense` starts.
#include "common/helper_main.h"
#include "realsense_driver.h"

int main(int argc, char** argv) {
  return sgs::cameras::helper_main(argc, argv, "Frames of a RealSense camera, for `sgs run live:-`",
                                   sgs::cameras::make_realsense_driver());
}
