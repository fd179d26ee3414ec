// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// sgs-camera-orbbec: what `sgs run camera:orbbec` starts.
#include "common/helper_main.h"
#include "orbbec_driver.h"

int main(int argc, char** argv) {
  return sgs::cameras::helper_main(argc, argv, "Frames of an Orbbec camera, for `sgs run live:-`",
                                   sgs::cameras::make_orbbec_driver());
}
