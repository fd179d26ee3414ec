// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/stream_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <future>
#include <thread>

#include "sgs/dataset/source_failure.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/stream/frame_codec.h"
#include "sgs/stream/sender.h"

namespace sgs::stream {
namespace {

using dataset::FrameRead;
using testing::HasSubstr;

Hello greeting(double fx = 50) {
  Hello hello;
  hello.name = "test";
  hello.color_camera.camera = {32, 24, fx, 50, 15.5, 11.5};
  return hello;
}

Packet packet_at(double time_s) {
  RgbdFrame frame;
  frame.timestamp_s = time_s;
  frame.color = ColorImage(32, 24, {1, 2, 3});
  frame.depth = DepthImage(32, 24, 2.0f);
  return encode_frame(frame, greeting()).value();
}

std::string bytes_at(double time_s) { return encode_packet(packet_at(time_s)).value(); }

/// A client that may send anything.
class Client {
 public:
  explicit Client(unsigned short port) {
    socket_.connect({boost::asio::ip::make_address("127.0.0.1"), port});
  }
  void send(std::string_view bytes) { boost::asio::write(socket_, boost::asio::buffer(bytes)); }
  /// All that the other end says until it closes the connection.
  std::string last_words() {
    std::string words;
    std::array<char, 256> buffer{};
    boost::system::error_code error;
    while (!error) {
      words.append(buffer.data(), socket_.read_some(boost::asio::buffer(buffer), error));
    }
    return words;
  }

 private:
  boost::asio::io_context context_;
  boost::asio::ip::tcp::socket socket_{context_};
};

/// A source that is being opened on a port of its own, and its greeting sent.
class Stream : public testing::Test {
 protected:
  void begin(const Patience& patience) {
    std::promise<unsigned short> port;
    const auto announce = [&](const std::string& what) {
      // "live:tcp://127.0.0.1:PORT: waiting ..."
      const auto end = what.find(": waiting");
      const auto colon = what.rfind(':', end - 1);
      port.set_value(
          static_cast<unsigned short>(std::stoi(what.substr(colon + 1, end - colon - 1))));
    };
    auto opened = std::async(std::launch::async, [&] {
      return open_stream({"127.0.0.1", 0, ""}, patience, announce);
    });
    port_ = port.get_future().get();
    client_ = std::make_unique<Client>(port_);
    client_->send(encode_hello(greeting()));
    auto source = opened.get();
    ASSERT_TRUE(source) << source.error().text();
    source_ = std::move(*source);
  }
  /// "frame TIME", "bad REASON", "event WHAT", "end" or "failure WHAT".
  std::string next() {
    RgbdFrame frame;
    Error error;
    try {
      switch (source_->next(frame, error)) {
        case FrameRead::kOk:
          return fmt::format("frame {} {}", frame.index, frame.timestamp_s);
        case FrameRead::kBadFrame:
          return fmt::format("bad {} {}", frame.index, error.text());
        case FrameRead::kEvent:
          return "event " + error.text();
        case FrameRead::kEnd:
          return "end";
      }
    } catch (const dataset::SourceFailure& failure) {
      return "failure " + failure.error().text();
    }
    return "";
  }
  static Patience patient() { return {3600, 3600, 3600, 3600}; }

  unsigned short port_ = 0;
  std::unique_ptr<Client> client_;
  std::unique_ptr<StreamSource> source_;
};

TEST_F(Stream, FramesAndTheirEnd) {
  begin(patient());
  EXPECT_TRUE(source_->live());
  EXPECT_EQ(source_->name(), "test");
  EXPECT_EQ(source_->camera(), greeting().color_camera.camera);
  EXPECT_FALSE(source_->size());
  client_->send(bytes_at(1.5) + bytes_at(1.75) + std::string(kEndMark));
  EXPECT_EQ(next(), "frame 0 1.5");
  EXPECT_EQ(next(), "frame 1 1.75");
  EXPECT_EQ(next(), "end");
  EXPECT_EQ(next(), "end");
  EXPECT_EQ(client_->last_words(), "ok\ndone\n");
}

TEST_F(Stream, ALateFrameAndADamagedOneAreBadAndTheNextOneIsNot) {
  begin(patient());
  Packet damaged = packet_at(3);
  damaged.depth.clear();
  client_->send(bytes_at(2) + bytes_at(1) + bytes_at(2) + encode_packet(damaged).value() +
                bytes_at(4));
  EXPECT_EQ(next(), "frame 0 2");
  EXPECT_THAT(next(), HasSubstr("bad 1 it came too late: its time is 1.0"));
  EXPECT_THAT(next(), HasSubstr("bad 2 it came too late"));
  EXPECT_THAT(next(), HasSubstr("bad 3 depth has 0 bytes"));
  EXPECT_EQ(next(), "frame 4 4");
}

TEST_F(Stream, AClockThatIsSetBackCostsAFewFrames) {
  begin(patient());
  std::string bytes = bytes_at(100) + bytes_at(101);
  for (int i = 0; i < 6; ++i) bytes += bytes_at(50 + i);
  client_->send(bytes);
  EXPECT_EQ(next(), "frame 0 100");
  EXPECT_EQ(next(), "frame 1 101");
  for (int i = 2; i < 5; ++i) EXPECT_THAT(next(), HasSubstr("it came too late"));
  // Those after it follow the ones before, at their own distances.
  EXPECT_THAT(next(), HasSubstr("frame 5 101.03"));
  EXPECT_THAT(next(), HasSubstr("was set back by 48.000 s"));
  EXPECT_THAT(next(), HasSubstr("frame 6 102.03"));
}

TEST_F(Stream, DepthOfAnotherClockIsToldOnceAndTakenAsOfItsColoursTime) {
  begin(patient());
  double time_s = 0;
  for (const double delay_s : {0.02, 37.5, 37.6, -0.01}) {
    Packet packet = packet_at(++time_s);
    packet.depth_delay_s = delay_s;
    client_->send(encode_packet(packet).value());
  }
  client_->send(kEndMark);
  std::vector<double> delays_s;
  int told = 0;
  RgbdFrame frame;
  Error error;
  for (auto read = source_->next(frame, error); read != FrameRead::kEnd;
       read = source_->next(frame, error)) {
    if (read == FrameRead::kOk) delays_s.push_back(frame.depth_delay_s);
    told += read == FrameRead::kEvent && error.text().find("same clock") != std::string::npos;
  }
  ASSERT_EQ(delays_s.size(), 4u);
  EXPECT_NEAR(delays_s[0], 0.02, 1e-12);
  EXPECT_EQ(delays_s[1], 0);
  EXPECT_EQ(delays_s[2], 0);
  EXPECT_NEAR(delays_s[3], -0.01, 1e-12);
  EXPECT_EQ(told, 1);
}

TEST_F(Stream, SilenceIsSaidOnceAndItsEnd) {
  Patience patience = patient();
  patience.stall_s = 0.02;
  begin(patience);
  EXPECT_THAT(next(), HasSubstr("event no frame for 0."));
  auto waiting = std::async(std::launch::async, [&] { return next(); });
  client_->send(bytes_at(1));
  EXPECT_THAT(waiting.get(), HasSubstr("event frames come again after"));
  EXPECT_EQ(next(), "frame 0 1");
}

TEST_F(Stream, WhoGoesAwayMayComeBack) {
  begin(patient());
  client_->send(bytes_at(1) + bytes_at(2).substr(0, 100));
  EXPECT_EQ(next(), "frame 0 1");
  client_.reset();
  EXPECT_THAT(next(), testing::AllOf(HasSubstr("event 127.0.0.1:"),
                                     HasSubstr("went away in the middle of a frame; waiting")));
  Client again(port_);
  again.send(encode_hello(greeting()) + bytes_at(2));
  EXPECT_THAT(next(), HasSubstr("event a sender is there again after"));
  EXPECT_EQ(next(), "frame 1 2");
}

TEST_F(Stream, ItEndsWhenNobodyComesBack) {
  Patience patience = patient();
  patience.wait_s = 0.05;
  begin(patience);
  client_.reset();
  EXPECT_THAT(next(), HasSubstr("without saying that it was done; waiting 0.05 s"));
  EXPECT_THAT(next(), HasSubstr("failure live:tcp://127.0.0.1"));
}

TEST_F(Stream, ItEndsWhenTheSenderStaysSilent) {
  Patience patience = patient();
  patience.stall_s = 0.02;
  patience.wait_s = 0.06;
  begin(patience);
  EXPECT_THAT(next(), HasSubstr("event no frame for"));
  EXPECT_THAT(next(), HasSubstr("no frame for 0.06 s"));
}

TEST_F(Stream, AStopEndsTheWait) {
  begin(patient());
  auto waiting = std::async(std::launch::async, [&] { return next(); });
  source_->stop();
  EXPECT_EQ(waiting.get(), "end");
}

TEST_F(Stream, StrangersAreRefusedAndChangeNothing) {
  Patience patience = patient();
  patience.greeting_s = 2;
  begin(patience);
  auto reading = std::async(std::launch::async, [&] {
    std::vector<std::string> said;
    do {
      said.push_back(next());
    } while (said.back() != "end");
    return said;
  });
  Client garbage(port_), large(port_), other(port_), second(port_), silent(port_);
  garbage.send("GET / HTTP/1.1\r\n\r\n");
  large.send(std::string("SGS1\xff\xff\xff\xff", 8));
  other.send(encode_hello(greeting(51)));
  second.send(encode_hello(greeting()));
  EXPECT_THAT(garbage.last_words(), HasSubstr("refused this is no stream"));
  EXPECT_THAT(large.last_words(), HasSubstr("refused a greeting of 4294967295 bytes"));
  EXPECT_THAT(other.last_words(), HasSubstr("refused its camera is another one"));
  EXPECT_THAT(second.last_words(), HasSubstr("refused another sender is connected"));
  EXPECT_THAT(silent.last_words(), HasSubstr("refused no greeting within 2 s"));
  client_->send(bytes_at(1) + std::string(kEndMark));
  const auto said = reading.get();
  EXPECT_EQ(said.size(), 7u);  // five refusals
  EXPECT_THAT(said, testing::Contains("frame 0 1"));
  EXPECT_THAT(said, testing::Contains(HasSubstr("was refused: no greeting within")));
}

TEST_F(Stream, GarbageInTheMiddleEndsTheConnectionAndNotTheRun) {
  begin(patient());
  client_->send(bytes_at(1) + "garbage");
  EXPECT_EQ(next(), "frame 0 1");
  EXPECT_THAT(next(), HasSubstr("is no stream: a part begins with byte 103"));
  EXPECT_THAT(client_->last_words(), HasSubstr("refused a part begins"));
  Client again(port_);
  again.send(encode_hello(greeting()) + bytes_at(2) + std::string(kEndMark));
  EXPECT_THAT(next(), HasSubstr("there again"));
  EXPECT_EQ(next(), "frame 1 2");
  EXPECT_EQ(next(), "end");
}

TEST_F(Stream, WhoIsSilentGivesWayToAnother) {
  Patience patience = patient();
  patience.stall_s = 0.02;
  begin(patience);
  EXPECT_THAT(next(), HasSubstr("no frame for"));
  Client second(port_);
  second.send(encode_hello(greeting()) + bytes_at(2));
  std::string said = next();
  EXPECT_THAT(said, HasSubstr("takes over"));
  while (said.starts_with("event")) said = next();
  EXPECT_EQ(said, "frame 0 2");
  EXPECT_THAT(client_->last_words(), HasSubstr("another sender took over"));
}

TEST_F(Stream, TheSenderOfTheToolIsUnderstood) {
  begin(patient());
  client_->send(kEndMark);
  EXPECT_EQ(next(), "end");
  source_.reset();

  const io::TemporaryFolder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(Sender::open({"", 0, pipe}, greeting()).error().code, ErrorCode::kNotFound);
  auto opened = std::async(std::launch::async, [&] {
    return open_stream({"", 0, pipe}, patient(), nullptr);
  });
  auto sender = Sender::open({"", 0, pipe}, greeting());
  while (!sender) sender = Sender::open({"", 0, pipe}, greeting());
  ASSERT_TRUE((*sender)->send(packet_at(5)));
  auto source = opened.get();
  ASSERT_TRUE(source) << source.error().text();
  source_ = std::move(*source);
  EXPECT_EQ(next(), "frame 0 5");
  sender->reset();  // gone, and there again
  EXPECT_THAT(next(), HasSubstr("went away without saying"));
  auto waiting = std::async(std::launch::async, [&] { return next(); });
  sender = Sender::open({"", 0, pipe}, greeting());
  while (!sender) sender = Sender::open({"", 0, pipe}, greeting());
  EXPECT_THAT(waiting.get(), HasSubstr("there again"));
  auto rest = std::async(std::launch::async, [&] {
    const std::string frame = next();
    return frame + ", " + next();
  });
  ASSERT_TRUE((*sender)->send(packet_at(6)));
  ASSERT_TRUE((*sender)->finish());
  EXPECT_EQ(rest.get(), "frame 1 6, end");
}

TEST(OpenStream, AFileIsReadToItsEnd) {
  const io::TemporaryFolder folder;
  const std::string path = folder / "stream";
  ASSERT_TRUE(io::write_file(path, encode_hello(greeting()) + bytes_at(1)));
  auto source = open_stream({"", 0, path}, {}, nullptr);
  ASSERT_TRUE(source) << source.error().text();
  RgbdFrame frame;
  Error error;
  EXPECT_EQ((*source)->next(frame, error), FrameRead::kOk);
  EXPECT_EQ((*source)->next(frame, error), FrameRead::kEvent);
  EXPECT_THAT(error.text(), HasSubstr("without saying that it was done"));
  EXPECT_THROW((*source)->next(frame, error), dataset::SourceFailure);
}

TEST(OpenStream, SaysWhyItCannot) {
  const io::TemporaryFolder folder;
  ASSERT_TRUE(io::write_file(folder / "garbage", "this is no stream at all"));
  const auto error_of = [](const Address& address) {
    const auto source = open_stream(address, {0.05, 0.01, 0.05, 0.01}, nullptr);
    return source ? "no error" : source.error().text();
  };
  EXPECT_THAT(error_of({"", 0, folder / "garbage"}), HasSubstr("does not begin with SGS1"));
  EXPECT_THAT(error_of({"", 0, folder / "none"}), HasSubstr("none"));
  EXPECT_THAT(error_of({"", 0, folder.path()}), HasSubstr("is a folder"));
  EXPECT_THAT(error_of({"0.0.0.0", 0, ""}), HasSubstr("ssh -L"));
  EXPECT_THAT(error_of({"camera.local", 0, ""}), HasSubstr("is no address"));
  EXPECT_THAT(error_of({"127.0.0.1", 0, ""}), HasSubstr("no sender within 0.05 s"));
}

TEST(OpenStream, AStopEndsTheWaitForAGreeting) {
  std::stop_source stop;
  const auto source = open_stream(
      {"127.0.0.1", 0, ""}, {0, 2, 0, 5}, [&](const std::string&) { stop.request_stop(); },
      stop.get_token());
  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().code, ErrorCode::kInterrupted);
}

}  // namespace
}  // namespace sgs::stream
