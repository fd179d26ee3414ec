// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A participant of another DDS (Fast DDS, the one that ROS 2 takes by default) which knows nothing
// of sgs: it sends and takes messages as bytes, for a script (foreign.py) that packs and reads
// them.
//
//   foreign_node DOMAIN
//
// Standard input, any number of records: a letter, then topic, type and data, each behind its
// 32-bit length. W: publish there, R: read there (`data` has r: reliable, l: latched), P: publish
// this, G: publish no longer. Standard output: the same records; D: this has come, M: so many (in
// `data`) on the other side.
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace eprosima::fastdds::dds;
using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;

/// Bytes as they travel, with the four of the encapsulation.
class Raw final : public TopicDataType {
 public:
  explicit Raw(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 4096;
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }
  bool serialize(void* data, SerializedPayload_t* payload) override {
    const auto& bytes = *static_cast<const std::string*>(data);
    if (bytes.size() > payload->max_size) return false;
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(SerializedPayload_t* payload, void* data) override {
    static_cast<std::string*>(data)->assign(reinterpret_cast<const char*>(payload->data),
                                            payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] {
      return static_cast<std::uint32_t>(static_cast<const std::string*>(data)->size());
    };
  }
  void* createData() override { return new std::string; }
  void deleteData(void* data) override { delete static_cast<std::string*>(data); }
  bool getKey(void*, InstanceHandle_t*, bool) override { return false; }
};

std::mutex writing;

void put(char what, const std::string& topic, const std::string& type, const std::string& data) {
  const std::scoped_lock lock(writing);
  std::fputc(what, stdout);
  for (const std::string* part : {&topic, &type, &data}) {
    const auto size = static_cast<std::uint32_t>(part->size());
    std::fwrite(&size, sizeof size, 1, stdout);
    std::fwrite(part->data(), 1, part->size(), stdout);
  }
  std::fflush(stdout);
}

struct Writing final : DataWriterListener {
  std::string topic;
  void on_publication_matched(DataWriter*, const PublicationMatchedStatus& now) override {
    put('M', topic, "", std::to_string(now.current_count));
  }
};

struct Reading final : DataReaderListener {
  std::string topic;
  void on_subscription_matched(DataReader*, const SubscriptionMatchedStatus& now) override {
    put('M', topic, "", std::to_string(now.current_count));
  }
  void on_data_available(DataReader* reader) override {
    std::string data;
    SampleInfo info;
    while (reader->take_next_sample(&data, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) put('D', topic, "", data);
    }
  }
};

template <class Qos>
void set_quality(Qos& qos, const std::string& flags) {
  const auto has = [&](char flag) { return flags.find(flag) != std::string::npos; };
  qos.reliability().kind = has('r') ? RELIABLE_RELIABILITY_QOS : BEST_EFFORT_RELIABILITY_QOS;
  qos.reliability().max_blocking_time = {200, 0};
  qos.durability().kind = has('l') ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
  qos.endpoint().history_memory_policy =
      eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
}

class Node {
 public:
  explicit Node(int domain) {
    DomainParticipantQos qos;
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList = {"127.0.0.1"};
    udp->receiveBufferSize = udp->sendBufferSize = 1 << 20;
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    eprosima::fastrtps::rtps::Locator_t here;
    eprosima::fastrtps::rtps::IPLocator::setIPv4(here, "127.0.0.1");
    qos.wire_protocol().builtin.initialPeersList.push_back(here);
    // Tests wait for it.
    qos.wire_protocol().builtin.discovery_config.leaseDuration_announcementperiod = {0,
                                                                                     100'000'000};
    participant_ = DomainParticipantFactory::get_instance()->create_participant(
        static_cast<std::uint32_t>(domain), qos);
    if (participant_ == nullptr) std::exit(1);
    publisher_ = participant_->create_publisher(PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  }

  void publish_on(const std::string& topic, const std::string& type, const std::string& flags) {
    DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
    set_quality(qos, flags);
    const bool latched = flags.find('l') != std::string::npos;
    qos.history().kind = latched ? KEEP_LAST_HISTORY_QOS : KEEP_ALL_HISTORY_QOS;
    qos.resource_limits().max_samples = latched ? 100 : 4;
    qos.resource_limits().max_instances = 1;
    qos.resource_limits().max_samples_per_instance = latched ? 100 : 4;
    qos.resource_limits().allocated_samples = 1;
    qos.publish_mode().kind = ASYNCHRONOUS_PUBLISH_MODE;
    // What was lost in a full buffer is asked for at once.
    qos.reliable_writer_qos().times.heartbeatPeriod = {0, 100'000'000};
    auto listener = std::make_unique<Writing>();
    listener->topic = topic;
    writers_[topic] = publisher_->create_datawriter(topic_of(topic, type), qos, listener.get());
    writing_.push_back(std::move(listener));
    if (writers_[topic] == nullptr) std::exit(3);
  }
  void read_from(const std::string& topic, const std::string& type, const std::string& flags) {
    DataReaderQos qos = DATAREADER_QOS_DEFAULT;
    set_quality(qos, flags);
    qos.history().kind = KEEP_LAST_HISTORY_QOS;
    qos.history().depth = 1000;
    auto listener = std::make_unique<Reading>();
    listener->topic = topic;
    if (subscriber_->create_datareader(topic_of(topic, type), qos, listener.get()) == nullptr) {
      std::exit(4);
    }
    reading_.push_back(std::move(listener));
  }
  void publish(const std::string& topic, std::string data) {
    // Where the history is full, write() may refuse rather than wait.
    constexpr int kMostTries = 200;
    DataWriter* writer = writers_.at(topic);
    for (int i = 0; !writer->write(&data); ++i) {
      if (i == kMostTries) std::exit(6);
      writer->wait_for_acknowledgments({1, 0});
    }
  }
  void go(const std::string& topic) {
    publisher_->delete_datawriter(writers_.at(topic));
    writers_.erase(topic);
  }

 private:
  Topic* topic_of(const std::string& topic, const std::string& type) {
    TypeSupport(new Raw(type)).register_type(participant_);
    return participant_->create_topic(topic, type, TOPIC_QOS_DEFAULT);
  }

  DomainParticipant* participant_ = nullptr;
  Publisher* publisher_ = nullptr;
  Subscriber* subscriber_ = nullptr;
  std::map<std::string, DataWriter*> writers_;
  std::vector<std::unique_ptr<Writing>> writing_;
  std::vector<std::unique_ptr<Reading>> reading_;
};

bool get(std::string& part) {
  std::uint32_t size = 0;
  if (std::fread(&size, sizeof size, 1, stdin) != 1) return false;
  part.resize(size);
  return std::fread(part.data(), 1, size, stdin) == size;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  Node node(std::atoi(argv[1]));
  for (int what = 0; (what = std::fgetc(stdin)) != EOF;) {
    std::string topic, type, data;
    if (!get(topic) || !get(type) || !get(data)) return 5;
    if (what == 'W') node.publish_on(topic, type, data);
    if (what == 'R') node.read_from(topic, type, data);
    if (what == 'P') node.publish(topic, std::move(data));
    if (what == 'G') node.go(topic);
  }
  std::_Exit(0);  // without a farewell: as a node that is killed
}
