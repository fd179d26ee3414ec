// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// sgs-camera-k4a: what `sgs run camera:k4a` starts.
#include "common/helper_main.h"
#include "k4a_driver.h"

int main(int argc, char** argv) {
  return sgs::cameras::helper_main(argc, argv, "Frames of an Azure Kinect, for `sgs run live:-`",
                                   sgs::cameras::make_k4a_driver());
}
