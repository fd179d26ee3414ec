// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/version.h"

namespace sgs::run {

std::string version() { return SGS_VERSION; }

}  // namespace sgs::run
