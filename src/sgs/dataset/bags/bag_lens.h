// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sgs/bag/messages.h"
#include "sgs/camera/pinhole.h"
#include "sgs/core/error.h"
#include "sgs/dataset/image_size.h"

namespace sgs::dataset {

/// Whether an image topic's name says that its pictures are rectified.
bool is_rectified(const std::string& image_topic);

/// The lens of pictures of one size, as a camera info says it: K and D of pictures as they come, P
/// of rectified ones or where there is no K. Binning, a region of interest, and another size of
/// equal shape are allowed for (sensor_msgs/CameraInfo, image_geometry's reading of it). What
/// contradicts itself but can be read is said in `warnings`. `topic` is for messages. Errors: a
/// camera info without numbers (kNotFound), an unknown lens model or size (kUnsupported).
Result<LensCamera> lens_of(const bag::CameraInfoMessage& info, const std::string& topic,
                           bool rectified, ImageSize images, std::vector<std::string>& warnings);

/// A camera brought to another size of the same view.
LensCamera scaled_lens(const LensCamera& lens, ImageSize size);

/// Whether two cameras see the same in the same pixels, within a tenth of one.
bool same_lens(const LensCamera& a, const LensCamera& b);

/// Whether two cameras of one size can be one: focal lengths and centres within 2 %. Lenses are not
/// compared: registered depth often says nothing of colour's.
bool same_view(const PinholeCamera& a, const PinholeCamera& b);

}  // namespace sgs::dataset
