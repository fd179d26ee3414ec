// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/alignment/joint_aligner.h"
#include "sgs/alignment/step_times.h"
#include "sgs/degeneracy/observability.h"
#include "sgs/degeneracy/spectrum.h"
#include "sgs/tracker/track_result.h"

namespace sgs::tracker {

inline void note_times(const alignment::StepTimes& times, Diagnostics& d) {
  d.ms_points = times.points;
  d.ms_index = times.index;
  d.ms_geometry = times.geometry;
  d.ms_visual = times.visual;
  d.ms_update = times.update;
}

/// Eigenvalues and condition number of a registration.
inline void note_spectrum(const degeneracy::Spectrum& spectrum, Diagnostics& d) {
  for (int k = 0; k < 6; ++k) d.eigenvalues[static_cast<std::size_t>(k)] = spectrum.eigenvalues[k];
  d.condition_number = spectrum.condition_number();
}

/// Which axes the frame's own surfaces show.
inline void note_observability(const degeneracy::Observability& observability, Diagnostics& d) {
  for (int k = 0; k < 6; ++k) {
    d.snr[static_cast<std::size_t>(k)] = observability.snr[k];
    d.weights[static_cast<std::size_t>(k)] = observability.weights[k];
  }
  d.axes = observability.camera_axes;
  d.degenerate_mask = observability.mask;
}

/// What an alignment of the frame that the aligner looks at says of the frame's record.
Diagnostics describe(const alignment::JointAligner& aligner, const alignment::Alignment& a);

}  // namespace sgs::tracker
