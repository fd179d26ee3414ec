// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/http_policy.h"

#include <gtest/gtest.h>

#include "sgs/viewer/downloads.h"

namespace sgs::viewer {
namespace {

constexpr EmbeddedFile kFiles[] = {{"index.html", "page"}, {"assets/app.js", "code"}};

Verdict get(std::string_view target, std::string_view host = "localhost:8765",
            std::string_view method = "GET") {
  return judge({method, target, host, std::nullopt, false}, {}, "127.0.0.1", kFiles);
}

Verdict upgrade(std::string_view host, std::optional<std::string_view> origin,
                std::string_view target = "/ws") {
  return judge({"GET", target, host, origin, true}, {}, "127.0.0.1", kFiles);
}

TEST(HttpPolicy, ServesExactlyTheTable) {
  EXPECT_EQ(get("/").file, &kFiles[0]);
  EXPECT_EQ(get("/index.html").file, &kFiles[0]);
  EXPECT_EQ(get("/?mode=points").file, &kFiles[0]);
  EXPECT_EQ(get("/assets/app.js").file, &kFiles[1]);
  EXPECT_EQ(get("/healthz").status, 200);
  EXPECT_EQ(get("/healthz").file, nullptr);
  for (const std::string_view target : std::initializer_list<std::string_view>{
           "", "*", "index.html", "//index.html", "/assets", "/assets/", "/assets/../index.html",
           "/../../etc/passwd", "/%2e%2e/index.html", "/assets%2fapp.js", "/assets/app.js/",
           "/ASSETS/app.js", "/assets\\app.js", "http://localhost/",
           std::string_view("/\0index.html", 12)}) {
    EXPECT_EQ(get(target).status, 404) << target;
    EXPECT_EQ(get(target).file, nullptr) << target;
  }
}

TEST(HttpPolicy, OnlyReads) {
  EXPECT_EQ(get("/", "localhost", "HEAD").status, 200);
  for (const std::string_view method : {"POST", "PUT", "DELETE", "OPTIONS", "CONNECT", "BREW"}) {
    EXPECT_EQ(get("/", "localhost", method).status, 405) << method;
  }
}

TEST(HttpPolicy, ForeignNamesAreRefused) {
  for (const std::string_view host :
       {"localhost", "LocalHost:1", "127.0.0.1", "127.0.0.1:8765", "[::1]", "[::1]:8765"}) {
    EXPECT_EQ(get("/", host).status, 200) << host;
  }
  for (const std::string_view host :
       {"", "evil.example", "localhost.evil.example", "evil.example:8765", "192.168.1.7", "::1",
        "localhost:", "localhost:x", "localhost:123456", "[::1", "127.0.0.1@evil.example"}) {
    EXPECT_EQ(get("/", host).status, 403) << host;
    EXPECT_EQ(upgrade(host, std::nullopt).status, 403) << host;
  }
  const HostPolicy named{{"robot.local"}};
  EXPECT_TRUE(named.host_allowed("robot.local:80", "10.0.0.2"));
  EXPECT_TRUE(named.host_allowed("10.0.0.2", "10.0.0.2"));
  EXPECT_FALSE(named.host_allowed("10.0.0.3", "10.0.0.2"));
}

TEST(HttpPolicy, WebSocketsOnlyFromOurOwnPage) {
  EXPECT_TRUE(upgrade("localhost:8765", std::nullopt).websocket);
  EXPECT_TRUE(upgrade("localhost:8765", "http://localhost:8765").websocket);
  EXPECT_TRUE(upgrade("robot", "https://x").status == 403);
  for (const std::string_view origin :
       {"http://evil.example", "null", "", "http://localhost", "http://localhost:9999", "file://",
        "http://", "http://localhost:8765.evil.example"}) {
    EXPECT_EQ(upgrade("localhost:8765", origin).status, 403) << origin;
  }
  EXPECT_EQ(upgrade("localhost:8765", std::nullopt, "/").status, 404);
  EXPECT_EQ(get("/ws").status, 426);
}

TEST(HttpPolicy, AWebSocketNeedsTheTokenWhereThereIsOne) {
  HostPolicy policy;
  const auto status = [&](std::string_view target) {
    RequestFacts facts{"GET", target, "localhost", std::nullopt, true};
    return judge(facts, policy, "127.0.0.1", {}).status;
  };
  EXPECT_EQ(status("/ws"), 101);
  EXPECT_EQ(status("/ws?token=anything"), 101);
  EXPECT_EQ(status("/wsx"), 404);
  policy.token = make_token();
  EXPECT_EQ(policy.token.size(), 32u);
  EXPECT_NE(policy.token, make_token());
  EXPECT_EQ(status("/ws?token=" + policy.token), 101);
  for (const std::string& wrong :
       {std::string("/ws"), std::string("/ws?token="), "/ws?token=" + policy.token + "0",
        "/ws?token=" + policy.token.substr(1), "/ws?token=" + std::string(32, '0'),
        "/ws?Token=" + policy.token, "/ws?token=" + policy.token + "&x=1"}) {
    EXPECT_EQ(status(wrong), 403) << wrong;
  }
}

TEST(HttpPolicy, FilesOfTheRunHaveNamesAndNeedTheTokenWhereThereIsOne) {
  HostPolicy policy;
  const auto ask = [&](std::string_view target) {
    return judge({"GET", target, "localhost", std::nullopt, false}, policy, "127.0.0.1", kFiles);
  };
  EXPECT_EQ(ask("/download/map.ply").download, "map.ply");
  EXPECT_EQ(ask("/download/map.ply?mode=points").download, "map.ply");
  // Whatever it says is looked up as it stands.
  EXPECT_EQ(ask("/download/../x").download, "../x");
  EXPECT_EQ(ask("/download/").status, 404);
  EXPECT_EQ(ask("/download").status, 404);
  policy.token = make_token();
  EXPECT_EQ(ask("/download/map.ply").status, 403);
  EXPECT_EQ(ask("/download/map.ply?token=" + std::string(32, '0')).status, 403);
  EXPECT_EQ(ask("/download/map.ply?token=" + policy.token).download, "map.ply");
}

TEST(Downloads, AreFoundByTheirExactNamesOnly) {
  Downloads downloads;
  downloads.offer("map.ply", "/runs/1/map.ply");
  EXPECT_EQ(downloads.find("map.ply"), "/runs/1/map.ply");
  for (const std::string_view name : {"", ".", "..", "map", "../map.ply", "map.ply/", "MAP.PLY"}) {
    EXPECT_EQ(downloads.find(name), "") << name;
  }
  downloads.offer("map.ply", "/runs/1-refined/map.ply");
  EXPECT_EQ(downloads.find("map.ply"), "/runs/1-refined/map.ply");
  downloads.offer("map.ply", "");
  EXPECT_EQ(downloads.find("map.ply"), "");
}

TEST(EmbeddedFiles, AlwaysHaveAPage) {
  const auto files = embedded_files();
  const Verdict verdict =
      judge({"GET", "/", "localhost", std::nullopt, false}, {}, "127.0.0.1", files);
  ASSERT_NE(verdict.file, nullptr);
  EXPECT_NE(verdict.file->bytes.find("<html"), std::string_view::npos);
  for (const EmbeddedFile& file : files) {
    EXPECT_FALSE(file.bytes.empty()) << file.path;
    EXPECT_NE(content_type(file.path), "application/octet-stream") << file.path;
  }
}

TEST(HttpPolicy, ContentTypeByEnding) {
  EXPECT_EQ(content_type("assets/app-1a2b.js"), "text/javascript; charset=utf-8");
  EXPECT_EQ(content_type("index.html"), "text/html; charset=utf-8");
  EXPECT_EQ(content_type("js"), "application/octet-stream");
}

}  // namespace
}  // namespace sgs::viewer
