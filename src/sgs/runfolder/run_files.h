// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

/// The files of a run folder, named here only (docs/formats.md tells what is in them).
namespace sgs::run::files {

inline constexpr const char* kConfig = "config.toml";  ///< input and every parameter as used
inline constexpr const char* kCamera = "camera.txt";   ///< of the frames as they were tracked
inline constexpr const char* kCalibration = "calibration.toml";  ///< of the depths, where used
inline constexpr const char* kTrajectory = "trajectory.txt";
inline constexpr const char* kOnline = "trajectory_online.txt";  ///< as said frame by frame
inline constexpr const char* kKeyframes = "keyframes.txt";
inline constexpr const char* kTruth = "groundtruth.txt";
inline constexpr const char* kFrames = "frames.csv";
inline constexpr const char* kMovers = "movers.txt";  ///< what moved in each frame, where it did
inline constexpr const char* kMap = "map.ply";
inline constexpr const char* kLastingMap = "map.sgsmap";  ///< for others to come back to
inline constexpr const char* kUpright = "upright.toml";   ///< which way is up in its world
inline constexpr const char* kTimings = "timings.json";
inline constexpr const char* kMetrics = "metrics.json";
inline constexpr const char* kReport = "report.html";
inline constexpr const char* kState = "state.toml";    ///< running, finished or interrupted
inline constexpr const char* kLock = "lock.txt";       ///< who writes the folder, while they do
inline constexpr const char* kRefine = "refine.toml";  ///< how the map was learnt on, if it was
inline constexpr const char* kCheckpoint = "checkpoint.txt";     ///< name of the newest checkpoint
inline constexpr const char* kCheckpointFolder = "checkpoint.";  ///< and a number
inline constexpr const char* kResume = "resume.sgs";  ///< in there: what --resume goes on from
inline constexpr const char* kLog = "log.txt";
inline constexpr const char* kRenders = "renders";  ///< folder
inline constexpr const char* kPictures = "renders/pictures.csv";
inline constexpr const char* kSaved = "saved";  ///< folder: map and trajectory while it went on
inline constexpr const char* kSavedMap = "saved/map.ply";
inline constexpr const char* kSavedTrajectory = "saved/trajectory.txt";
inline constexpr const char* kRecording = "recording";  ///< folder: what was recorded on the way

/// What a checkpoint may hold.
inline constexpr std::array<const char*, 4> kOfCheckpoint = {kMap, kKeyframes, kCalibration,
                                                             kResume};

/// What a run makes, checkpoints apart: a new run into the same folder begins by removing these.
inline constexpr std::array<const char*, 20> kResults = {
    kConfig, kCamera,  kCalibration, kTrajectory, kOnline,          kKeyframes, kTruth,
    kFrames, kMap,     kTimings,     kMetrics,    kReport,          kLog,       kPictures,
    kRefine, kUpright, kLastingMap,  kSavedMap,   kSavedTrajectory, kMovers};

}  // namespace sgs::run::files
