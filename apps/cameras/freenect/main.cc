// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// sgs-camera-freenect: what `sgs run camera:freenect` starts.
#include "common/helper_main.h"
#include "freenect_driver.h"

int main(int argc, char** argv) {
  return sgs::cameras::helper_main(argc, argv,
                                   "Frames of a Kinect (the first one), for `sgs run live:-`",
                                   sgs::cameras::make_freenect_driver());
}
