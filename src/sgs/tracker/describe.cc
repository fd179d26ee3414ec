// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/describe.h"

namespace sgs::tracker {

Diagnostics describe(const alignment::JointAligner& aligner, const alignment::Alignment& a) {
  Diagnostics d;
  note_times(aligner.times(), d);
  d.source_points = aligner.source_points();
  d.targets = static_cast<int>(aligner.geometry().targets().cloud().points.size());
  d.planarity = aligner.planarity();
  note_observability(aligner.observability(), d);
  d.iterations = a.iterations;
  if (a.geometry) {
    d.inliers = a.geometry->inliers;
    d.cost = a.geometry->cost;
    d.overlap = a.geometry->overlap;
    if (aligner.leaves_out_movers()) d.movers = a.geometry->movers;
    note_spectrum(a.geometry->spectrum, d);
  }
  if (a.picture) {
    d.visual_inliers = a.picture->pixels;
    d.visual_cost = a.picture->mean_cost;
  }
  if (a.picture_holds()) d.prior_source = PriorSource::kPhotometric;
  d.prior_active = d.degenerate_mask != 0 && a.picture_holds();
  return d;
}

}  // namespace sgs::tracker
