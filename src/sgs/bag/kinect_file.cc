// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Recordings of Azure Kinect cameras: Matroska files with the tracks COLOR, DEPTH, IR and IMU, tags
// K4A_... and the factory calibration as an attachment (Azure Kinect DK, "recording file format").
// The container is FFmpeg's part; pictures are passed on as they are.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <deque>
#include <limits>

#include "sgs/bag/chunked_bag.h"
#include "sgs/bag/kinect_calibration.h"
#include "sgs/bag/matroska_input.h"
#include "sgs/bag/message_writer.h"

namespace sgs::bag {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMatroskaMagic = "\x1A\x45\xDF\xA3";
constexpr const char* kAttach =
    "give the file that was recorded, or attach the calibration of another recording of the "
    "camera: "
    "`mkvextract OTHER.mkv attachments 1:calibration.json`, then `mkvpropedit FILE.mkv "
    "--add-attachment calibration.json` (`--replace-attachment 1:calibration.json` where one is "
    "there)";
constexpr const char* kColorFrame = "color_camera";
constexpr const char* kDepthFrame = "depth_camera";
constexpr const char* kImuFrame = "imu";

std::uint32_t fourcc(const char (&name)[5]) {
  std::uint32_t code = 0;
  std::memcpy(&code, name, sizeof code);
  return code;
}

std::string text_of_fourcc(std::uint32_t code) {
  std::string text(sizeof code, '\0');
  std::memcpy(text.data(), &code, sizeof code);
  return printable(text);
}

/// How the pictures of a track are packed, as messages of images say it.
struct Picture {
  std::string encoding;
  int width = 0, height = 0;
  int row_bytes = 0;
  bool big_endian = false;
};

/// What the file says of one of its tracks of images.
struct ImageTrack {
  int index = -1;
  Picture picture;
};

std::string place(const fs::path& path, const char* track) {
  return fmt::format("{}: track {}", path.string(), track);
}

/// By the tag that the recorder writes for each track, else by the track's name.
const AVStream* find_track(const MatroskaInput& input, const std::string& name) {
  const std::string tag = "K4A_" + name + "_TRACK";
  for (const AVStream* stream : input.streams()) {
    if (!input.entry(stream->metadata, tag.c_str()).empty()) return stream;
  }
  for (const AVStream* stream : input.streams()) {
    if (input.entry(stream->metadata, "title") == name) return stream;
  }
  return nullptr;
}

Result<const AVStream*> image_track(const MatroskaInput& input, const fs::path& path,
                                    const char* name, const char* remedy) {
  const AVStream* track = find_track(input, name);
  if (track == nullptr) {
    const bool other =
        find_track(input, "COLOR") == nullptr && find_track(input, "DEPTH") == nullptr;
    if (other) {
      return fail(ErrorCode::kUnsupported,
                  fmt::format("{}: a video, not the recording of an Azure Kinect: it has no tracks "
                              "COLOR and DEPTH",
                              path.string()),
                  "a video has no depth: give the recording that it was made from");
    }
    return fail(ErrorCode::kUnsupported, fmt::format("{}: has no track {}", path.string(), name),
                remedy);
  }
  const AVCodecParameters& p = *track->codecpar;
  if (p.codec_type == AVMEDIA_TYPE_VIDEO && p.width > 0 && p.height > 0) return track;
  return fail(ErrorCode::kInvalidFormat, fmt::format("{} holds no images", place(path, name)),
              "the file is damaged; copy or record it again");
}

Result<ImageTrack> color_track(const MatroskaInput& input, const fs::path& path) {
  constexpr const char* kName = "COLOR";
  SGS_ASSIGN_OR_RETURN(
      const AVStream* track,
      image_track(input, path, kName,
                  "record with colour, for example `k4arecorder --color-mode 720p`"));
  const AVCodecParameters& p = *track->codecpar;
  ImageTrack out{track->index, {"mjpg", p.width, p.height, 0}};
  if (p.codec_id == AV_CODEC_ID_MJPEG) return out;
  struct Packed {
    std::uint32_t code;
    const char* encoding;
    int pixel_bytes;  // of a row; NV12 has its colour behind
  };
  const std::array kPacked = {Packed{fourcc("NV12"), "nv12", 1}, Packed{fourcc("YUY2"), "yuy2", 2},
                              Packed{fourcc("BGRA"), "bgra8", 4}};
  for (const Packed& packed : kPacked) {
    if (p.codec_tag != packed.code) continue;
    out.picture.encoding = packed.encoding;
    out.picture.row_bytes = packed.pixel_bytes * p.width;
    return out;
  }
  return fail(ErrorCode::kUnsupported,
              fmt::format("{} is packed as '{}', which is not read", place(path, kName),
                          text_of_fourcc(p.codec_tag)),
              "record it as MJPG, NV12, YUY2 or BGRA");
}

Result<ImageTrack> depth_track(const MatroskaInput& input, const fs::path& path) {
  constexpr const char* kName = "DEPTH";
  SGS_ASSIGN_OR_RETURN(
      const AVStream* track,
      image_track(input, path, kName,
                  "record with depth, for example `k4arecorder --depth-mode NFOV_UNBINNED`; "
                  "passive infrared has none"));
  const AVCodecParameters& p = *track->codecpar;
  constexpr int kPixel_bytes = 2;
  if (p.codec_tag == fourcc("b16g")) {
    return ImageTrack{track->index, {"16UC1", p.width, p.height, kPixel_bytes * p.width, true}};
  }
  return fail(ErrorCode::kUnsupported,
              fmt::format("{} is packed as '{}', where 16-bit grey values are needed",
                          place(path, kName), text_of_fourcc(p.codec_tag)),
              "a converted file may have lost its depth: give the file that was recorded");
}

/// A sample of the IMU track. The recorder has applied the unit's own calibration.
struct ImuSampleOfFile {
  std::int64_t acceleration_time_ns = 0;
  Eigen::Vector3d acceleration_m_s2, angular_velocity_rad_s;
};

/// A sample as it lies in the file, little-endian: time and three numbers of each sensor.
constexpr std::size_t kImuSample_bytes = 2 * (sizeof(std::uint64_t) + 3 * sizeof(float));

ImuSampleOfFile imu_sample(std::string_view bytes) {
  static_assert(std::endian::native == std::endian::little);
  ImuSampleOfFile out;
  std::size_t at = 0;
  const auto take = [&](auto& value) {
    std::memcpy(&value, bytes.data() + at, sizeof value);
    at += sizeof value;
  };
  for (Eigen::Vector3d* vector : {&out.acceleration_m_s2, &out.angular_velocity_rad_s}) {
    std::uint64_t time_ns = 0;
    std::array<float, 3> v{};
    take(time_ns);
    take(v);
    if (vector == &out.acceleration_m_s2) {
      out.acceleration_time_ns =
          time_ns <= std::uint64_t{kLatest_ns} ? static_cast<std::int64_t>(time_ns) : kNoTime;
    }
    *vector = Eigen::Vector3f(v[0], v[1], v[2]).cast<double>();
  }
  return out;
}

std::string_view bytes_of(const AVPacket& packet) {
  if (packet.data == nullptr || packet.size <= 0) return {};
  return {reinterpret_cast<const char*>(packet.data), static_cast<std::size_t>(packet.size)};
}

CameraInfoMessage camera_info(const LensCamera& lens, const char* frame) {
  const PinholeCamera& c = lens.camera;
  CameraInfoMessage info;
  info.header.frame_id = frame;
  info.height = static_cast<std::uint32_t>(c.height);
  info.width = static_cast<std::uint32_t>(c.width);
  info.distortion_model = "rational_polynomial";
  const auto D = lens.distortion.coefficients();
  info.D.assign(D.begin(), D.end());
  info.K = {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1};
  return info;
}

TransformMessage mounted(const char* frame, const SE3& T_color_frame) {
  TransformMessage out;
  out.header.frame_id = kColorFrame;
  out.child = frame;
  out.T_parent_child = T_color_frame;
  return out;
}

/// Depth camera and accelerometer in the colour camera.
std::string transforms(const KinectCalibration& calibration) {
  std::vector<TransformMessage> all;
  all.push_back(mounted(kDepthFrame, calibration.T_color_depth));
  if (const auto& unit = calibration.inertial) {
    all.push_back(mounted(kImuFrame, unit->T_color_accelerometer));
  }
  return write_transforms(all, Encoding::kRos1);
}

class KinectFile : public Bag {
 public:
  explicit KinectFile(fs::path path) : path_(std::move(path)) {
    format_ = ".mkv of an Azure Kinect";
  }

  Status open(ByteFile& file) {
    SGS_ASSIGN_OR_RETURN(MatroskaInput input, MatroskaInput::open(path_));
    SGS_ASSIGN_OR_RETURN(color_, color_track(input, path_));
    SGS_ASSIGN_OR_RETURN(depth_, depth_track(input, path_));
    const AVStream* imu = find_track(input, "IMU");
    if (imu != nullptr && imu->codecpar->codec_type == AVMEDIA_TYPE_SUBTITLE) imu_ = imu->index;
    const auto calibration = calibration_of(input);
    add_calibration(calibration);
    color_channel_ = channel_of("/color/image", "sensor_msgs/Image", Encoding::kRos1);
    depth_channel_ = channel_of("/depth/image", "sensor_msgs/Image", Encoding::kRos1);
    if (imu_) imu_channel_ = channel_of("/imu", "sensor_msgs/Imu", Encoding::kRos1);
    find_times(input, file);
    return check_images();
  }

  std::unique_ptr<Cursor> read(const std::vector<std::size_t>& channels) const override;

 private:
  friend class KinectCursor;

  /// Whether there is any; from the file's beginning.
  Status check_images() const {
    SGS_ASSIGN_OR_RETURN(MatroskaInput input, MatroskaInput::open(path_));
    input.keep_only(std::array{color_.index, depth_.index});
    if (input.next() != nullptr) return {};
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: ends before its first image", path_.string()),
                "it was cut off, or nothing was recorded; copy or record it again");
  }

  /// Of the attachment that a tag names, else of that with the usual name.
  Result<KinectCalibration> calibration_of(const MatroskaInput& input) const {
    constexpr const char* kUsual = "calibration.json";
    const AVStream* found = nullptr;
    for (const AVStream* stream : input.streams()) {
      if (stream->codecpar->codec_type != AVMEDIA_TYPE_ATTACHMENT) continue;
      const bool named = !input.entry(stream->metadata, "K4A_CALIBRATION_FILE").empty();
      if (named || (found == nullptr && input.entry(stream->metadata, "filename") == kUsual)) {
        found = stream;
      }
    }
    if (found == nullptr || found->codecpar->extradata_size <= 0) {
      return fail(ErrorCode::kNotFound,
                  fmt::format("{}: has no attachment {}, which the camera's recorder writes",
                              path_.string(), kUsual),
                  kAttach);
    }
    const std::string_view json(reinterpret_cast<const char*>(found->codecpar->extradata),
                                static_cast<std::size_t>(found->codecpar->extradata_size));
    auto calibration = read_kinect_calibration(
        json, fmt::format("{}: {}", path_.string(), kUsual),
        {color_.picture.width, color_.picture.height, depth_.picture.width, depth_.picture.height});
    if (calibration || calibration.error().code == ErrorCode::kUnsupported) return calibration;
    return fail(calibration.error().code, calibration.error().message, kAttach);
  }

  /// Channels with one message each; without a calibration its error.
  void add_calibration(const Result<KinectCalibration>& calibration) {
    const auto add = [&](const char* topic, const char* type, auto write) {
      fixed_.push_back({channel_of(topic, type, Encoding::kRos1), {}});
      channels_.back().messages = 1;
      if (calibration) {
        fixed_.back().data = write(*calibration);
      } else {
        fixed_.back().data = tl::unexpected<Error>(calibration.error());
      }
    };
    add("/color/camera_info", "sensor_msgs/CameraInfo", [](const KinectCalibration& c) {
      return write_camera_info(camera_info(c.color, kColorFrame), Encoding::kRos1);
    });
    add("/depth/camera_info", "sensor_msgs/CameraInfo", [](const KinectCalibration& c) {
      return write_camera_info(camera_info(c.depth, kDepthFrame), Encoding::kRos1);
    });
    add("/tf_static", "tf2_msgs/TFMessage", transforms);
    if (calibration && calibration->inertial) {
      R_imu_gyroscope_ = calibration->inertial->R_accelerometer_gyroscope;
    }
  }

  /// Times in the file count from its first image or sample, whose device time a tag tells; samples
  /// have that of the device themselves.
  void find_times(MatroskaInput& input, ByteFile& file) {
    const std::string tag = input.tag("K4A_START_OFFSET_NS");
    std::int64_t offset_ns = 0;
    const auto read = std::from_chars(tag.data(), tag.data() + tag.size(), offset_ns);
    const bool said =
        !tag.empty() && read.ec == std::errc{} && offset_ns >= 0 && offset_ns <= kLatest_ns;
    const std::int64_t duration = input.file().duration;
    if (said) {
      start_ns_ = offset_ns;
    } else if (imu_) {
      start_ns_ = start_by_imu(input);
    }
    // As its head says; where that is missing, the recorder did not get to its end.
    const auto end = announced_end(file);
    if (end && *end > file.size()) {
      warnings_.push_back(fmt::format("{}: cut off: {} of {} bytes are there, and are read",
                                      path_.string(), file.size(), *end));
    } else if (duration <= 0) {
      warnings_.push_back(
          fmt::format("{}: the recorder did not finish it, or it was cut off; what "
                      "is there is read",
                      path_.string()));
    } else if (duration < kLatest_ns / (1'000'000'000 / AV_TIME_BASE)) {
      first_time_ns_ = start_ns_;
      last_time_ns_ = start_ns_ + duration * (1'000'000'000 / AV_TIME_BASE);
    }
  }

  /// The tag is written when the recorder finishes: before that, a sample tells what it would say.
  std::int64_t start_by_imu(MatroskaInput& input) const {
    input.keep_only(std::array{*imu_});
    const AVPacket* first = input.next();
    const std::int64_t in_file_ns = first == nullptr ? kNoTime : input.time_ns(*first);
    if (in_file_ns == kNoTime || bytes_of(*first).size() < kImuSample_bytes) return 0;
    const std::int64_t device_ns = imu_sample(bytes_of(*first)).acceleration_time_ns;
    return std::max<std::int64_t>(0, device_ns == kNoTime ? 0 : device_ns - in_file_ns);
  }

  struct Fixed {
    std::size_t channel = 0;
    Result<std::string> data;
  };

  fs::path path_;
  ImageTrack color_, depth_;
  std::optional<int> imu_;
  std::size_t color_channel_ = 0, depth_channel_ = 0, imu_channel_ = 0;
  std::vector<Fixed> fixed_;
  Eigen::Matrix3d R_imu_gyroscope_ = Eigen::Matrix3d::Identity();
  std::int64_t start_ns_ = 0;  ///< device time of the file's beginning
};

/// The calibration first, then the tracks as they lie in the file, which each cursor opens anew.
class KinectCursor : public Cursor {
 public:
  KinectCursor(const KinectFile& bag, const std::vector<std::size_t>& channels) : bag_(bag) {
    const auto wanted = [&](std::size_t channel) {
      return std::find(channels.begin(), channels.end(), channel) != channels.end();
    };
    for (const auto& fixed : bag.fixed_) {
      if (wanted(fixed.channel)) fixed_.push_back(&fixed);
    }
    if (wanted(bag.color_channel_)) tracks_.push_back(bag.color_.index);
    if (wanted(bag.depth_channel_)) tracks_.push_back(bag.depth_.index);
    if (bag.imu_ && wanted(bag.imu_channel_)) tracks_.push_back(*bag.imu_);
  }

  Result<std::optional<Message>> next() override {
    if (!fixed_.empty()) {
      const auto* fixed = fixed_.front();
      fixed_.pop_front();
      if (!fixed->data) return tl::unexpected<Error>(fixed->data.error());
      return Message{fixed->channel, bag_.start_ns_, *fixed->data};
    }
    while (samples_.empty()) {
      if (tracks_.empty()) return std::nullopt;
      if (!input_) {
        auto input = MatroskaInput::open(bag_.path_);
        if (!input) return ended(std::move(input.error()));
        input_.emplace(std::move(*input));
        input_->keep_only(tracks_);
      }
      const AVPacket* packet = input_->next();
      if (packet == nullptr) {
        tracks_.clear();
        return std::nullopt;
      }
      if (packet->stream_index == bag_.color_.index) {
        return image(*packet, bag_.color_, bag_.color_channel_, kColorFrame);
      }
      if (packet->stream_index == bag_.depth_.index) {
        return image(*packet, bag_.depth_, bag_.depth_channel_, kDepthFrame);
      }
      take_samples(bytes_of(*packet));
    }
    Message sample = std::move(samples_.front());
    samples_.pop_front();
    return sample;
  }

 private:
  tl::unexpected<Error> ended(Error error) {
    tracks_.clear();
    return tl::unexpected<Error>(std::move(error));
  }

  Result<std::optional<Message>> image(const AVPacket& packet, const ImageTrack& track,
                                       std::size_t channel, const char* frame) const {
    const std::int64_t in_file_ns = input_->time_ns(packet);
    if (in_file_ns == kNoTime || (packet.flags & AV_PKT_FLAG_CORRUPT) != 0) {
      return fail(ErrorCode::kInvalidFormat,
                  fmt::format("{}: a damaged image of {}", bag_.path_.string(), frame),
                  "it is left out; copy the file again");
    }
    const std::int64_t time_ns = bag_.start_ns_ + in_file_ns;
    const Picture& p = track.picture;
    const ImageMessage message{{time_ns, frame},
                               static_cast<std::uint32_t>(p.height),
                               static_cast<std::uint32_t>(p.width),
                               p.encoding,
                               p.big_endian,
                               static_cast<std::uint32_t>(p.row_bytes),
                               bytes_of(packet)};
    return Message{channel, time_ns, write_image(message, Encoding::kRos1)};
  }

  /// Some lie together in a part of the track.
  void take_samples(std::string_view bytes) {
    for (; bytes.size() >= kImuSample_bytes; bytes.remove_prefix(kImuSample_bytes)) {
      const ImuSampleOfFile sample = imu_sample(bytes);
      const std::int64_t time_ns = sample.acceleration_time_ns;
      if (time_ns == kNoTime) continue;
      const ImuMessage message{{time_ns, kImuFrame},
                               bag_.R_imu_gyroscope_ * sample.angular_velocity_rad_s,
                               sample.acceleration_m_s2};
      samples_.push_back({bag_.imu_channel_, time_ns, write_imu(message, Encoding::kRos1)});
    }
  }

  const KinectFile& bag_;
  std::deque<const KinectFile::Fixed*> fixed_;
  std::vector<int> tracks_;
  std::optional<MatroskaInput> input_;
  std::deque<Message> samples_;
};

std::unique_ptr<Cursor> KinectFile::read(const std::vector<std::size_t>& channels) const {
  return std::make_unique<KinectCursor>(*this, channels);
}

}  // namespace

bool is_kinect_recording(const fs::path& path) {
  // Tracks and tags lie before all images.
  constexpr std::uint64_t kBeginning_bytes = 64 << 10;
  auto file = ByteFile::open(path);
  if (!file) return false;
  const auto begin = file->view(0, std::min(file->size(), kBeginning_bytes));
  return begin && begin->starts_with(kMatroskaMagic) &&
         (begin->find("K4A_") != begin->npos || begin->find("b16g") != begin->npos);
}

Result<std::unique_ptr<Bag>> open_kinect(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(ByteFile file, ByteFile::open(path));
  const auto magic = file.view(0, std::min<std::uint64_t>(file.size(), kMatroskaMagic.size()));
  if (!magic) return tl::unexpected(magic.error());
  if (*magic != kMatroskaMagic) return not_of_its_name(file, "a Matroska file");
  auto bag = std::make_unique<KinectFile>(path);
  SGS_RETURN_IF_ERROR(bag->open(file));
  return bag;
}

}  // namespace sgs::bag
