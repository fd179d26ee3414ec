// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// sgs-camera-openni2: what `sgs run camera:openni2` starts.
#include "common/helper_main.h"
#include "openni2_driver.h"

int main(int argc, char** argv) {
  return sgs::cameras::helper_main(argc, argv,
                                   "Frames of a camera that OpenNI2 knows, for `sgs run live:-`",
                                   sgs::cameras::make_openni2_driver());
}
