// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/open.h"

#include <algorithm>
#include <array>

#include "sgs/bag/bag.h"
#include "sgs/camera/resample.h"
#include "sgs/core/log.h"
#include "sgs/dataset/bags/bag_source.h"
#include "sgs/dataset/calibration_lookup.h"
#include "sgs/dataset/file_sequence.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/locate.h"
#include "sgs/dataset/prefetch.h"
#include "sgs/dataset/reduced_source.h"
#include "sgs/dataset/sens_source.h"
#include "sgs/dataset/sparse_capture.h"
#include "sgs/dataset/time_unit.h"
#include "sgs/io/archive.h"
#include "sgs/io/image_io.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

Status cut_range(FrameList& list, const OpenOptions& options) {
  const auto count = static_cast<std::int64_t>(list.frames.size());
  SGS_ASSIGN_OR_RETURN(const auto range, frame_range(options, list.folder, count));
  list.frames.erase(list.frames.begin() + range.second, list.frames.end());
  list.frames.erase(list.frames.begin(), list.frames.begin() + range.first);
  return {};
}

std::size_t count_missing(const std::vector<FrameEntry>& frames) {
  return static_cast<std::size_t>(
      std::count_if(frames.begin(), frames.end(), [](const FrameEntry& entry) {
        std::error_code error;
        return !fs::exists(entry.color, error) || !fs::exists(entry.depth, error);
      }));
}

/// What was learned from the first frame that can be read.
struct Probe {
  StoredCameras cameras;
  DepthImage depth;
  ImageSize color;
  fs::path color_file;
};

/// Whether the images of a frame have the sizes that the calibration is for.
Status check_sizes(const FrameEntry& entry, const StoredFrame& stored, const std::string& source,
                   const StoredFormat& format) {
  const auto check = [&](const fs::path& file, ImageSize size, const PinholeCamera& c) -> Status {
    if (c.width == 0 || size == ImageSize{c.width, c.height}) return {};
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} is {}x{} but the calibration from {} is for {}x{}", file.string(),
                            size.width, size.height, source, c.width, c.height),
                "give the calibration of images of this size: --camera fx,fy,cx,cy and "
                "--depth-scale S");
  };
  SGS_RETURN_IF_ERROR(check(entry.color, {stored.color.width(), stored.color.height()},
                            entry.camera.value_or(format.calibration.camera)));
  if (!(format.depth_camera.fx > 0)) return {};
  return check(entry.depth, {stored.depth.width(), stored.depth.height()}, format.depth_camera);
}

/// Decodes frames until one can be read and fits the calibration to its size. Damaged and missing
/// images are passed over; images of the wrong kind are an error of the whole sequence.
Result<Probe> probe(const FrameList& list, const std::string& source, const StoredFormat& format) {
  constexpr std::size_t kOtherSizes = 50;
  Error first_error, first_size;
  std::size_t other_sizes = 0;
  std::optional<Probe> fallback;  // depth of another size than colour
  for (const FrameEntry& entry : list.frames) {
    auto stored = read_stored(entry, format);
    if (!stored) {
      if (stored.error().code == ErrorCode::kUnsupported) return tl::unexpected(stored.error());
      if (first_error.message.empty()) first_error = stored.error();
      continue;
    }
    const auto& [color, depth, cameras] = *stored;
    const Status fits = check_sizes(entry, *stored, source, format);
    if (fits) {
      const ImageSize color_size{color.width(), color.height()};
      const ImageSize depth_size{depth.width(), depth.height()};
      const bool as_expected =
          format.depth_size_differs || format.depth_camera.fx > 0 || color_size == depth_size;
      Probe seen{cameras, std::move(stored->depth), color_size, entry.color};
      if (as_expected) return seen;
      if (!fallback) fallback = std::move(seen);
    } else if (first_size.message.empty()) {
      first_size = fits.error();
    }
    // Cameras may start in another mode than they go on in.
    if (++other_sizes > kOtherSizes) break;
  }
  if (fallback) return std::move(*fallback);
  if (!first_size.message.empty()) return tl::unexpected<Error>(std::move(first_size));
  if (const auto packed = packed_in(list.folder)) return tl::unexpected<Error>(*packed);
  first_error.message = fmt::format("{}: none of {} frames can be read; the first: {}",
                                    list.folder.string(), list.frames.size(), first_error.message);
  return tl::unexpected<Error>(std::move(first_error));
}

Status check_options(const OpenOptions& options) {
  const auto bad = [](std::string what) {
    return fail(ErrorCode::kInvalidArgument, std::move(what));
  };
  if (options.depth_scale && !(*options.depth_scale > 0 && *options.depth_scale < 1e9)) {
    return bad(fmt::format("--depth-scale {} must be positive", *options.depth_scale));
  }
  if (!(options.max_time_difference_s >= 0)) return bad("time difference must not be negative");
  return {};
}

void add_warnings(SequenceInfo& info, const FrameList& list) {
  const auto count = [&](std::size_t n, const char* what) {
    if (n > 0) info.warnings.push_back(fmt::format("{}: {} {}", info.folder.string(), n, what));
  };
  count(info.color_without_depth,
        fmt::format("colour images without depth {}, left out", list.paired).c_str());
  count(info.depth_without_color,
        fmt::format("depth images without colour {}, left out", list.paired).c_str());
  for (std::size_t i = 1; i < list.frames.size(); ++i) {
    const double before_s = list.frames[i - 1].timestamp_s, after_s = list.frames[i].timestamp_s;
    if (!is_no_pause(after_s - before_s)) continue;
    info.warnings.push_back(
        fmt::format("{}: {}", info.folder.string(), clock_set_ahead(before_s, after_s)));
    break;
  }
  count(info.missing_images, "frames name an image that does not exist; they will be skipped");
  const auto covered = [&](const FrameEntry& e) { return list.truth.at(e.timestamp_s, 0.1); };
  if (!list.truth.empty() && std::none_of(list.frames.begin(), list.frames.end(), covered)) {
    info.warnings.push_back(fmt::format(
        "{}: the ground truth covers {:.6f} .. {:.6f} s, none of the frames ({:.6f} .. {:.6f} s)",
        info.folder.string(), list.truth.poses().front().timestamp_s,
        list.truth.poses().back().timestamp_s, info.first_time_s, info.last_time_s));
  }
}

/// How the images are stored, and the camera they are delivered with. What the options or a
/// calibration file say replaces all that the layout says of its cameras.
Result<StoredFormat> stored_format(FrameList& list, const FoundCalibration& found) {
  StoredFormat format;
  format.calibration = found.calibration;
  format.depth_size_differs = list.depth_size_differs;
  format.depth_coding = list.depth_coding;
  format.max_depth_m = list.max_depth_m;
  format.min_confidence = list.min_confidence;
  if (found.of_layout) {
    format.depth_camera = list.depth_camera.value_or(PinholeCamera{});
  } else {
    // Two cameras of different size share one view.
    format.depth_size_differs = format.depth_size_differs || list.depth_camera;
    for (FrameEntry& frame : list.frames) frame.camera.reset();
  }
  return format;
}

SequenceInfo describe(const FrameList& list, const FoundCalibration& found) {
  SequenceInfo info;
  info.layout = list.layout;
  info.name = list.name;
  info.folder = list.folder;
  info.frames = static_cast<std::int64_t>(list.frames.size());
  info.first_time_s = list.frames.front().timestamp_s;
  info.last_time_s = list.frames.back().timestamp_s;
  info.calibration_source = found.source;
  info.truth_rows = list.truth.size();
  std::vector<double> delays_s;
  for (const FrameEntry& frame : list.frames) delays_s.push_back(frame.depth_delay_s);
  info.depth_delays = summarize_delays(std::move(delays_s));
  info.color_without_depth = list.color_without_depth;
  info.depth_without_color = list.depth_without_color;
  info.missing_images = count_missing(list.frames);
  info.color_images = static_cast<std::int64_t>(
      std::max(list.color_images, list.frames.size() + list.color_without_depth));
  info.unit_source = found.unit_source;
  info.relation_source = "depth is registered, as in this layout";
  info.times_source = list.times_source;
  info.warnings = list.warnings;
  add_warnings(info, list);
  return info;
}

void warn_of_little_seen(SequenceInfo& info, const PinholeCamera& color) {
  const auto seen = FrameFit(info.delivered, info.calibration.distortion).seen(color);
  if (auto warning = little_is_seen(seen.get(), info.calibration_source)) {
    info.warnings.push_back(fmt::format("{}: {}", info.folder.string(), *warning));
  }
}

std::vector<NamedFrame> names_of_frames(const FrameList& list) {
  std::vector<NamedFrame> names;
  for (const FrameEntry& frame : list.frames) names.push_back({frame.timestamp_s, frame.color});
  return names;
}

std::vector<double> times_of_frames(const FrameList& list) {
  std::vector<double> times_s;
  for (const FrameEntry& frame : list.frames) times_s.push_back(frame.timestamp_s);
  return times_s;
}

/// What the first frame lets doubt.
void warn_of_probe(const Probe& seen, const StoredFormat& format, const OpenOptions& options,
                   const std::string& source, std::vector<std::string>& warnings) {
  const ImageSize depth{seen.depth.width(), seen.depth.height()};
  const bool own_camera = format.depth_camera.fx > 0;
  if (!own_camera && !format.depth_size_differs && depth != seen.color) {
    warnings.push_back(fmt::format(
        "depth is {}x{}, colour {}x{}: they are taken for the same view, as registered depth is",
        depth.width, depth.height, seen.color.width, seen.color.height));
  }
  if (const int turned = io::viewer_orientation(seen.color_file); turned != 1) {
    warnings.push_back(fmt::format(
        "{}: viewers turn such pictures (Exif orientation {}), here they are taken as they are "
        "stored, as depth is; if colour and depth do not fit, `mogrify -auto-orient` turns them",
        seen.color_file.string(), turned));
  }
  if (!options.depth_scale) warn_of_doubtful_unit(median_depth_m(seen.depth), warnings);
  warn_of_doubtful_centre(seen.cameras.color, source, warnings);
}

Result<Sequence> open_folder(const fs::path& folder, const OpenOptions& options) {
  SGS_ASSIGN_OR_RETURN(FrameList list, list_frames(folder, options));
  std::vector<fs::path> places = {list.folder};
  if (list.layout == "replica") places.push_back(list.folder / "..");
  SGS_ASSIGN_OR_RETURN(const FoundCalibration found, find_calibration(places, list, options));
  const auto frames_in_folder = static_cast<std::int64_t>(list.frames.size());
  SGS_RETURN_IF_ERROR(cut_range(list, options));
  const auto images_outside = frames_in_folder - static_cast<std::int64_t>(list.frames.size());
  SGS_ASSIGN_OR_RETURN(StoredFormat format, stored_format(list, found));
  SGS_ASSIGN_OR_RETURN(const Probe seen, probe(list, found.source, format));
  if (format.calibration.camera.width == 0) format.calibration.camera = seen.cameras.color;
  if (format.depth_camera.fx > 0) format.depth_camera = seen.cameras.depth;
  SGS_RETURN_IF_ERROR(io::check_calibration(format.calibration, found.source));
  if (!options.depth_scale) {
    SGS_RETURN_IF_ERROR(check_depth_unit(seen.depth, format.calibration.depth_scale, found.source));
  }
  StoredCameras typical = seen.cameras;
  if (list.frames.front().camera) {
    typical.color = format.calibration.camera;
    typical.depth = scaled_to(typical.color, seen.depth.width(), seen.depth.height());
  }
  Sequence sequence;
  sequence.info = describe(list, found);
  sequence.info.color_images += images_outside;
  sequence.info.frames_in_folder = frames_in_folder;
  warn_of_probe(seen, format, options, found.source, sequence.info.warnings);
  sequence.info.calibration = format.calibration;
  sequence.info.delivered = delivered_camera(typical, options.max_width);
  warn_of_little_seen(sequence.info, typical.color);
  sequence.info.sparse = is_sparse(times_of_frames(list), list.truth);
  sequence.images = names_of_frames(list);
  sequence.frames = std::make_unique<FileSequence>(
      list.name, std::move(list.frames), std::move(list.truth), format, sequence.info.delivered);
  return sequence;
}

/// Bags prefetch, log and check by themselves.
Result<Sequence> open_bag(const fs::path& input, const OpenOptions& options) {
  SGS_ASSIGN_OR_RETURN(Sequence sequence, open_bag_sequence(input, options));
  sequence.frames = reduced(std::move(sequence.frames), options.max_width);
  sequence.info.delivered = sequence.frames->camera();
  return sequence;
}

/// What to do with what other programs record, by the name's ending in small letters.
std::optional<std::string> remedy_for_other_format(const std::string& name) {
  struct Format {
    const char* ending;
    const char* remedy;
  };
  constexpr const char* kVideo =
      "a video has no depth: give the recording that it was made from, with its depth images";
  constexpr const char* kFolders =
      " and give the folder; an sgs.toml in it names the folders of colour and depth (16-bit PNG)";
  constexpr std::array kFormats = {
      Format{".mp4", kVideo},
      Format{".mov", kVideo},
      Format{".avi", kVideo},
      Format{".svo", "of a ZED: write its images with the export sample of its SDK"},
      Format{".svo2", "of a ZED: write its images with the export sample of its SDK"},
      Format{".oni", "of OpenNI: write its images with the tools of its SDK"},
      Format{".klg", "of Logger2: write its images with a converter for .klg"}};
  for (const Format& format : kFormats) {
    if (!name.ends_with(format.ending)) continue;
    return format.remedy == kVideo ? std::string(kVideo) : std::string(format.remedy) + kFolders;
  }
  return std::nullopt;
}

/// What is not a folder: a file that holds a whole recording, or one that marks a folder.
Result<Sequence> open_file(const fs::path& file, const OpenOptions& options) {
  const std::string name = io::lower_case(file.filename().string());
  if (name == "transforms.json") return open_folder(file.parent_path(), options);
  if (is_sens(file)) return open_sens(file, options);
  if (name.ends_with(".r3d")) {
    return fail(
        ErrorCode::kUnsupported,
        fmt::format("{}: Record3D compresses depth in a way that this program does not read",
                    file.string()),
        fmt::format("convert it first: `python3 record3d_to_transforms.py {} OUT` (in the "
                    "folder scripts/ of the sources), then `sgs run OUT`",
                    io::shell_quoted(file)));
  }
  if (const auto unpacking = io::unpacking_of(file)) return io::packed_as_a_whole(file, *unpacking);
  if (const auto remedy = remedy_for_other_format(name)) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: recordings of this kind are not read", file.string()), *remedy);
  }
  return fail(ErrorCode::kUnsupported,
              fmt::format("{}: not a folder, and no recording that is known", file.string()),
              "give the folder of an RGB-D sequence, a bag (.bag, .mcap, .db3), an Azure Kinect's "
              ".mkv, or a ScanNet .sens file");
}

/// What is no bag.
Result<Sequence> open_images(const fs::path& input, const OpenOptions& options) {
  std::error_code error;
  SGS_ASSIGN_OR_RETURN(Sequence sequence, fs::is_directory(input, error)
                                              ? open_folder(input, options)
                                              : open_file(input, options));
  for (const std::string& warning : sequence.info.warnings) log().warn("{}", warning);
  if (options.prefetch > 0) {
    sequence.frames =
        std::make_unique<PrefetchingSource>(std::move(sequence.frames), options.prefetch);
  }
  return sequence;
}

Status add_given_poses(Sequence& sequence, const OpenOptions& options, const fs::path& input) {
  SequenceInfo& info = sequence.info;
  SGS_ASSIGN_OR_RETURN(auto poses, load_given_poses(options.poses, sequence.frames->ground_truth(),
                                                    {input.string(), info.first_time_s,
                                                     info.last_time_s, sequence.images}));
  for (const std::string& warning : poses.warnings) log().warn("{}", warning);
  info.warnings.insert(info.warnings.end(), poses.warnings.begin(), poses.warnings.end());
  sequence.frames = with_given_poses(std::move(sequence.frames), std::move(poses));
  return {};
}

}  // namespace

Result<std::pair<std::int64_t, std::int64_t>> frame_range(const OpenOptions& options,
                                                          const fs::path& input,
                                                          std::int64_t count) {
  const auto first = std::clamp<std::int64_t>(options.first, 0, count);
  const auto last = std::clamp<std::int64_t>(options.last, first, count);
  if (first == last) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("frames {}:{} of {}: the sequence has {}", options.first, options.last,
                            input.string(), count),
                "choose a range inside the sequence");
  }
  return std::pair{first, last};
}

Result<Sequence> open_sequence(const fs::path& input, const OpenOptions& options) {
  SGS_RETURN_IF_ERROR(check_options(options));
  SGS_ASSIGN_OR_RETURN(const Location found, locate_recording(input));
  for (const fs::path& file : options.more_files) {
    if (found.is_bag && (bag::looks_like_bag(file) || !bag::bag_files(file).empty())) continue;
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} and {}: only bags can be given in several files", input.string(),
                            file.string()),
                "give one recording at a time");
  }
  if (found.path != input) log().info("{}: read from {}", input.string(), found.path.string());
  SGS_ASSIGN_OR_RETURN(Sequence sequence, found.is_bag ? open_bag(found.path, options)
                                                       : open_images(found.path, options));
  if (!options.poses.empty()) SGS_RETURN_IF_ERROR(add_given_poses(sequence, options, input));
  return sequence;
}

}  // namespace sgs::dataset
