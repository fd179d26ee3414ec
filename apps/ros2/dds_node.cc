// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "ros2/dds_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>

namespace sgs::ros2 {
namespace {

constexpr std::string_view kTopicPrefix = "rt";
constexpr std::string_view kTypeMiddle = "::msg::dds_::";
constexpr int kLargestDomain = 232;

using Qos = std::unique_ptr<dds_qos_t, void (*)(dds_qos_t*)>;

Qos qos_of(const Quality& quality) {
  Qos qos(dds_create_qos(), dds_delete_qos);
  constexpr dds_duration_t kWait = DDS_MSECS(100);
  dds_qset_reliability(
      qos.get(), quality.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, kWait);
  dds_qset_durability(qos.get(),
                      quality.latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (quality.depth > 0) {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, quality.depth);
  } else {
    constexpr std::int32_t kMostSamples = 8;
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0);
    dds_qset_resource_limits(qos.get(), kMostSamples, DDS_LENGTH_UNLIMITED, kMostSamples);
  }
  return qos;
}

tl::unexpected<Error> failed(const std::string& what, dds_return_t code) {
  return fail(ErrorCode::kIo, fmt::format("{}: {}", what, dds_strretcode(code)),
              "the network that DDS uses is chosen by CYCLONEDDS_URI, as for ROS 2 with "
              "rmw_cyclonedds_cpp");
}

Result<int> domain_of(const std::optional<int>& asked) {
  if (asked) return *asked;
  const char* text = std::getenv("ROS_DOMAIN_ID");
  if (text == nullptr || *text == '\0') return 0;
  const std::string_view said = text;
  int domain = -1;
  const auto parsed = std::from_chars(said.data(), said.data() + said.size(), domain);
  if (parsed.ec == std::errc{} && parsed.ptr == said.data() + said.size() && domain >= 0 &&
      domain <= kLargestDomain) {
    return domain;
  }
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("ROS_DOMAIN_ID is '{}': no number from 0 to {}", said, kLargestDomain),
              "unset it, or set it as the other programs have it");
}

bool is_reliable(const dds_qos_t* qos) {
  dds_reliability_kind_t kind = DDS_RELIABILITY_BEST_EFFORT;
  dds_duration_t unused = 0;
  return dds_qget_reliability(qos, &kind, &unused) && kind == DDS_RELIABILITY_RELIABLE;
}

}  // namespace

std::string dds_topic(std::string_view ros_topic) {
  return fmt::format("{}{}{}", kTopicPrefix, ros_topic.starts_with('/') ? "" : "/", ros_topic);
}

std::string ros_topic(std::string_view dds_topic) {
  if (!dds_topic.starts_with("rt/")) return {};
  return std::string(dds_topic.substr(kTopicPrefix.size()));
}

std::string ros_type(std::string_view dds_type) {
  const auto middle = dds_type.find(kTypeMiddle);
  if (middle == std::string_view::npos || !dds_type.ends_with('_')) return {};
  dds_type.remove_suffix(1);
  return fmt::format("{}/msg/{}", dds_type.substr(0, middle),
                     dds_type.substr(middle + kTypeMiddle.size()));
}

Result<std::unique_ptr<DdsNode>> DdsNode::open(const std::optional<int>& asked) {
  SGS_ASSIGN_OR_RETURN(const int domain, domain_of(asked));
  const dds_entity_t participant =
      dds_create_participant(static_cast<dds_domainid_t>(domain), nullptr, nullptr);
  if (participant < 0) return failed("DDS does not start", participant);
  const dds_entity_t publications =
      dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr);
  if (publications < 0) {
    dds_delete(participant);
    return failed("DDS does not say what is published", publications);
  }
  return std::unique_ptr<DdsNode>(new DdsNode(domain, participant, publications));
}

DdsNode::~DdsNode() { dds_delete(participant_); }

std::vector<Offer> DdsNode::offers() const {
  constexpr std::size_t kMost = 1024;
  std::vector<Offer> offers;
  std::array<void*, kMost> samples{};
  std::array<dds_sample_info_t, kMost> infos{};
  const int count = dds_read_mask(publications_, samples.data(), infos.data(), kMost, kMost,
                                  DDS_ALIVE_INSTANCE_STATE);
  for (std::size_t i = 0; count > 0 && i < static_cast<std::size_t>(count); ++i) {
    if (!infos[i].valid_data) continue;
    const auto& endpoint = *static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
    Offer offer{ros_topic(endpoint.topic_name), ros_type(endpoint.type_name),
                is_reliable(endpoint.qos)};
    if (!offer.topic.empty() && !offer.type.empty()) offers.push_back(std::move(offer));
  }
  if (count > 0) dds_return_loan(publications_, samples.data(), count);
  std::ranges::sort(offers);
  return offers;
}

Result<dds_entity_t> DdsNode::reader(const dds_topic_descriptor_t& type, const std::string& topic,
                                     const Quality& quality) const {
  const dds_entity_t on =
      dds_create_topic(participant_, &type, dds_topic(topic).c_str(), nullptr, nullptr);
  if (on < 0) return failed(fmt::format("no topic {}", topic), on);
  const dds_entity_t reader = dds_create_reader(participant_, on, qos_of(quality).get(), nullptr);
  if (reader < 0) return failed(fmt::format("{} cannot be read", topic), reader);
  return reader;
}

Result<dds_entity_t> DdsNode::writer(const dds_topic_descriptor_t& type, const std::string& topic,
                                     const Quality& quality) const {
  const dds_entity_t on =
      dds_create_topic(participant_, &type, dds_topic(topic).c_str(), nullptr, nullptr);
  if (on < 0) return failed(fmt::format("no topic {}", topic), on);
  const dds_entity_t writer = dds_create_writer(participant_, on, qos_of(quality).get(), nullptr);
  if (writer < 0) return failed(fmt::format("{} cannot be written", topic), writer);
  return writer;
}

}  // namespace sgs::ros2
