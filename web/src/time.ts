// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0

/// What to count seconds from: recordings with the time of day start at what was seen first, others
/// at zero as they are.
export function startTime_s(first_s: number | undefined): number {
  const kLongestRun_s = 1e6;
  return first_s !== undefined && Math.abs(first_s) > kLongestRun_s ? first_s : 0;
}
