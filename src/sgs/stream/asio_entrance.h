// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <string>
#include <utility>

#include "sgs/stream/link.h"

namespace sgs::stream {

/// What all kinds of entrance share.
class AsioEntrance : public Entrance {
 public:
  void run_until(Link::Clock::time_point until) override {
    context_.restart();
    context_.run_one_until(until);
  }
  void wake() override {
    boost::asio::post(context_, [] {});
  }

 protected:
  boost::asio::io_context context_;
};

/// The reading end of a pipe, which is closed with it.
class PipeLink : public Link {
 public:
  PipeLink(boost::asio::io_context& context, int descriptor, std::string who)
      : Link(std::move(who)), pipe_(context, descriptor) {}
  void answer(const std::string&) override {}
  void close() override {
    boost::system::error_code ignored;
    pipe_.close(ignored);
  }

 private:
  void start_read() override {
    pipe_.async_read_some(
        boost::asio::buffer(buffer_),
        [this, self = shared_from_this()](const boost::system::error_code& error,
                                          std::size_t bytes) { came(error ? 0 : bytes); });
  }

  boost::asio::posix::stream_descriptor pipe_;
};

}  // namespace sgs::stream
