// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// SQLite files of rosbag2: tables topics(id, name, type, serialization_format) and
// messages(id, topic_id, timestamp, data).
#include <sqlite3.h>

#include <algorithm>
#include <map>

#include "sgs/bag/chunked_bag.h"
#include "sgs/bag/unpack.h"
#include "sgs/io/archive.h"

namespace sgs::bag {
namespace {

using Database = std::unique_ptr<sqlite3, decltype(&sqlite3_close)>;
using Statement = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;

std::string text_column(sqlite3_stmt* row, int column) {
  const auto* text = sqlite3_column_text(row, column);
  return text == nullptr ? std::string() : reinterpret_cast<const char*>(text);
}

/// Whether SQLite would make files beside this one to read it, and needs none of them: it was
/// written with a write-ahead log, all of which has found its way into the file.
bool is_complete_with_log(const std::filesystem::path& path, std::string_view head) {
  constexpr std::size_t kReadVersion = 19;  // place in the file's head; 2: write-ahead log
  if (head.size() <= kReadVersion || head[kReadVersion] != 2) return false;
  std::error_code none;
  const auto bytes = std::filesystem::file_size(path.string() + "-wal", none);
  return none || bytes == 0;
}

/// "file:/..." with what has a meaning there as numbers.
std::string uri_of(const std::filesystem::path& path) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(path).lexically_normal().string()) {
    if (c == '%' || c == '?' || c == '#') {
      uri += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    } else {
      uri += c;
    }
  }
  return uri;
}

class Db3 : public Bag {
 public:
  explicit Db3(std::filesystem::path path) : path_(std::move(path)) { format_ = "ROS 2 db3"; }

  /// `head` are the first bytes of the file.
  Status open(std::string_view head) {
    sqlite3* database = nullptr;
    const bool alone = is_complete_with_log(path_, head);
    const std::string name = alone ? uri_of(path_) + "?immutable=1" : path_.string();
    const int status = sqlite3_open_v2(
        name.c_str(), &database, SQLITE_OPEN_READONLY | (alone ? SQLITE_OPEN_URI : 0), nullptr);
    database_.reset(database);
    if (status != SQLITE_OK) return tl::unexpected(problem());
    constexpr const char* kTopics = "SELECT id, name, type, serialization_format FROM topics";
    auto first = prepare(kTopics);
    if (!first) {
      // SQLite refuses a file that was cut off as a whole, unless it is told not to mind.
      sqlite3_exec(database_.get(), "PRAGMA writable_schema = ON", nullptr, nullptr, nullptr);
      first = prepare(kTopics);
    }
    SGS_ASSIGN_OR_RETURN(auto topics, std::move(first));
    while (sqlite3_step(topics.get()) == SQLITE_ROW) {
      const auto encoding =
          text_column(topics.get(), 3) == "cdr" ? Encoding::kCdr : Encoding::kOther;
      channel_of_id_[sqlite3_column_int64(topics.get(), 0)] =
          channel_of(text_column(topics.get(), 1), text_column(topics.get(), 2), encoding);
    }
    return count_messages();
  }

  std::unique_ptr<Cursor> read(const std::vector<std::size_t>& channels) const override;

  Result<Statement> prepare(const std::string& sql) const {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database_.get(), sql.c_str(), -1, &statement, nullptr) != SQLITE_OK) {
      return tl::unexpected(problem());
    }
    return Statement(statement, sqlite3_finalize);
  }
  Error problem() const {
    return {ErrorCode::kInvalidFormat,
            fmt::format("{}: {}", path_.string(), sqlite3_errmsg(database_.get())),
            fmt::format("the file is damaged or no recording of rosbag2; copy it again, or see "
                        "what `sqlite3 {} .recover | sqlite3 NEW.db3` saves",
                        io::shell_quoted(path_))};
  }
  const std::map<std::int64_t, std::size_t>& channel_of_id() const { return channel_of_id_; }

 private:
  Status count_messages() {
    SGS_ASSIGN_OR_RETURN(auto rows, prepare("SELECT topic_id, COUNT(*), MIN(timestamp), "
                                            "MAX(timestamp) FROM messages GROUP BY topic_id"));
    for (Channel& channel : channels_) channel.messages = 0;
    int status = SQLITE_ROW;
    while ((status = sqlite3_step(rows.get())) == SQLITE_ROW) {
      const std::int64_t first = sqlite3_column_int64(rows.get(), 2);
      const std::int64_t last = sqlite3_column_int64(rows.get(), 3);
      first_time_ns_ = std::min(first_time_ns_.value_or(first), first);
      last_time_ns_ = std::max(last_time_ns_.value_or(last), last);
      const auto channel = channel_of_id_.find(sqlite3_column_int64(rows.get(), 0));
      if (channel == channel_of_id_.end()) continue;
      *channels_[channel->second].messages +=
          static_cast<std::uint64_t>(sqlite3_column_int64(rows.get(), 1));
    }
    if (status != SQLITE_DONE) {
      // Cut off: what can be reached is read, the counts are not known.
      warnings_.push_back(
          fmt::format("{}; what lies before the damage is read", problem().message));
      for (Channel& channel : channels_) channel.messages.reset();
    }
    return {};
  }

  std::filesystem::path path_;
  Database database_{nullptr, sqlite3_close};
  std::map<std::int64_t, std::size_t> channel_of_id_;
};

class Db3Cursor : public Cursor {
 public:
  Db3Cursor(const Db3& bag, Result<Statement> rows) : bag_(bag), rows_(std::move(rows)) {}

  Result<std::optional<Message>> next() override {
    if (done_) return std::nullopt;
    if (!rows_) {
      done_ = true;
      return tl::unexpected(rows_.error());
    }
    sqlite3_stmt* row = rows_->get();
    const int status = sqlite3_step(row);
    if (status != SQLITE_ROW) {
      done_ = true;
      if (status != SQLITE_DONE) return tl::unexpected(bag_.problem());
      return std::nullopt;
    }
    const auto* data = static_cast<const char*>(sqlite3_column_blob(row, 2));
    const auto bytes = static_cast<std::size_t>(sqlite3_column_bytes(row, 2));
    const std::size_t channel = bag_.channel_of_id().at(sqlite3_column_int64(row, 0));
    const auto stored = data == nullptr ? std::string_view() : std::string_view(data, bytes);
    SGS_ASSIGN_OR_RETURN(auto content, message_content(stored, bag_.channels()[channel].encoding));
    return Message{channel, sqlite3_column_int64(row, 1), std::move(content)};
  }

 private:
  const Db3& bag_;
  Result<Statement> rows_;
  bool done_ = false;
};

std::unique_ptr<Cursor> Db3::read(const std::vector<std::size_t>& channels) const {
  std::string ids;
  for (const auto& [id, channel] : channel_of_id_) {
    if (std::find(channels.begin(), channels.end(), channel) == channels.end()) continue;
    ids += fmt::format("{}{}", ids.empty() ? "" : ", ", id);
  }
  // By rowid, which is how the rows lie: any other order would have to be sorted in memory.
  return std::make_unique<Db3Cursor>(
      *this, prepare(fmt::format("SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN "
                                 "({}) ORDER BY rowid",
                                 ids)));
}

}  // namespace

Result<std::unique_ptr<Bag>> open_db3(const std::filesystem::path& path) {
  SGS_ASSIGN_OR_RETURN(ByteFile file, ByteFile::open(path));
  constexpr std::string_view kSqliteMagic("SQLite format 3\0", 16);
  constexpr std::uint64_t kHeadBytes = 100;
  const auto head = file.view(0, std::min(file.size(), kHeadBytes));
  if (!head) return tl::unexpected(head.error());
  if (!head->starts_with(kSqliteMagic)) {
    return not_of_its_name(file, "a SQLite file");
  }
  auto bag = std::make_unique<Db3>(path);
  SGS_RETURN_IF_ERROR(bag->open(*head));
  return bag;
}

}  // namespace sgs::bag
