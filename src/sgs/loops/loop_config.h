// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/config.h"

namespace sgs::loops {

/// How far the tracker's poses can be trusted over a distance.
struct DriftConfig {
  double information_scale = 0.02;
  double translation_per_m = 0.01;
  double rotation_deg_per_m = 0.5;
  double lost_speed_m_per_s = 1;
  double lost_turn_rad_per_s = 1;
  double floor_m = 0.004;

  void declare(ParameterList& p) {
    p.add("information_scale", information_scale,
          "Share of an alignment's pixels and points that count as independent of each other.", "",
          {1e-6, 1});
    p.add("translation_per_m", translation_per_m,
          "Standard deviation of the drift after one metre; it grows with the root of the way.",
          "m", {0, 1});
    p.add("rotation_deg_per_m", rotation_deg_per_m, "The same of rotation.", "deg", {0, 45});
    p.add("lost_speed_m_per_s", lost_speed_m_per_s,
          "How fast a camera that is lost may have moved (standard deviation).", "m/s", {0, 100});
    p.add("lost_turn_rad_per_s", lost_turn_rad_per_s, "The same of rotation.", "rad/s", {0, 100});
    p.add("floor_m", floor_m,
          "Error of an alignment that more pixels do not lessen: distortion, shutter.", "m",
          {1e-6, 1});
  }
};

/// Closing loops (docs/loops.md).
struct LoopConfig {
  bool enabled = true;
  int lag = 20;
  double view_distance = 0.15;
  double min_gap_s = 5;
  double left_distance = 0.8;
  double revisit_distance = 0.45;
  double reach_sigmas = 2;
  int candidates = 2;
  int spacing_nodes = 3;
  double spacing_share = 0.01;
  int most_loops = 800;
  double min_used = 0.2;
  double min_overlap = 0.35;
  int min_rank = 3;
  double min_information = 2e4;
  double agree_m = 0.02;
  double agree_deg = 1;
  double max_gate_chi2 = 22.5;
  int support = 2;
  int patience_nodes = 20;
  double max_odometry_chi2 = 30;
  double apply_m = 0.004;
  double apply_deg = 0.1;
  double rhythm = 0.1;
  double odometry_doubt = 0.1;
  double odometry_ratio = 10;
  double doubt_share = 0.33;
  DriftConfig drift;

  void declare(ParameterList& p) {
    p.add("enabled", enabled, "Close loops.");
    p.add("lag", lag,
          "Offline a correction is applied so many frames after the one that gave it, so that "
          "nothing depends on timing.",
          "frames", {1, 1000});
    p.add("view_distance", view_distance, "How far the view moves between two nodes.",
          "image widths", {0.01, 2});
    p.add("min_gap_s", min_gap_s, "A place seen less than this long ago is no loop.", "s",
          {0, 3600});
    p.add("left_distance", left_distance,
          "How far the view must have been from a place in between.", "image widths", {0, 9});
    p.add("revisit_distance", revisit_distance,
          "Nodes are compared whose views are closer than this.", "image widths", {0, 2});
    p.add("reach_sigmas", reach_sigmas,
          "By how many standard deviations of the expected drift they may be farther.", "",
          {0, 10});
    p.add("candidates", candidates, "Nodes that a new node is compared with.", "", {0, 50});
    p.add("spacing_nodes", spacing_nodes,
          "Nodes after a loop until the next one between the same two stretches.", "nodes",
          {0, 1000});
    p.add("spacing_share", spacing_share,
          "The same as a share of all nodes that there were: the longer a session, the fewer new "
          "ties a known place needs. Up to eight times spacing_nodes.",
          "", {0, 1});
    p.add("most_loops", most_loops,
          "Of more loops every second older one is forgotten when they have been solved for.", "",
          {1, 1000000});
    p.add("min_used", min_used, "Least share of the older view's pixels that fit.", "", {0, 1});
    p.add("min_overlap", min_overlap, "Least share of the newer view's points that fit.", "",
          {0, 1});
    p.add("min_rank", min_rank, "Least number of directions that a loop must see.", "", {1, 6});
    p.add("min_information", min_information,
          "A direction of which an alignment tells less counts as not seen.", "1/m^2", {0, 1e12});
    p.add("agree_m", agree_m,
          "Alignments to an older node and to its neighbours must agree this well.", "m", {0, 1});
    p.add("agree_deg", agree_deg, "The same of rotation.", "deg", {0, 45});
    p.add(
        "max_gate_chi2", max_gate_chi2,
        "A loop that contradicts the expected drift by more (squared deviations) is not believed.",
        "", {0, 1e6});
    p.add("support", support, "Loops that must agree before any of them is believed.", "", {1, 20});
    p.add("patience_nodes", patience_nodes,
          "A loop that finds no support for so long is forgotten.", "nodes", {1, 1000});
    p.add("max_odometry_chi2", max_odometry_chi2,
          "Loops that bend the way between two nodes by more are taken back.", "", {0, 1e6});
    p.add("apply_m", apply_m, "Corrections that move no pose by more are not applied.", "m",
          {0, 10});
    p.add("apply_deg", apply_deg, "The same of rotation; either suffices.", "deg", {0, 90});
    p.add("rhythm", rhythm,
          "Loops that contradict the path by no more than their own noise correct it only when the "
          "session has grown by this share since the last time: a place that is well known is not "
          "moved again and again.",
          "", {0, 1});
    p.add("odometry_doubt", odometry_doubt,
          "Odometry edges that deviate from what the two views say by less are "
          "believed (squared, per direction, in units of drift.floor_m; median of ten nodes).",
          "", {0, 1e6});
    p.add(
        "odometry_ratio", odometry_ratio,
        "Beyond, the views re-estimate the edge if they contradict each other so many times less.",
        "", {1, 1e6});
    p.add("doubt_share", doubt_share,
          "While odometry edges are re-estimated nodes are so much closer together: what drifts in "
          "between stays.",
          "", {0.05, 1});
    p.add_group("drift", drift);
    p.renamed("way_doubt", "odometry_doubt");
    p.renamed("way_ratio", "odometry_ratio");
    p.for_users({"enabled", "most_loops", "rhythm"});
    p.removed("memory_mb", "history.memory_mb bounds all frames that are remembered");
  }
};

}  // namespace sgs::loops
