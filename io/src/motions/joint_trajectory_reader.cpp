// SPDX-License-Identifier: BSD-3-Clause
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>

#include "files/bad_input.hpp"
#include "files/files.hpp"
#include "files/text_number.hpp"
#include "motions/joint_rows.hpp"
#include "motions/trajectory_formats.hpp"

namespace swivel::io {

namespace {

/// A JointTrajectory, event by event, so that nothing is kept of a file but the numbers of its
/// points. Lines are counted from 1; 0: not known. Each function throws InputError for what may not
/// stand there.
class Message {
 public:
  Message(const Sought& sought, const std::string& file)
      : rows_(sought.arms, file), file_(file), of_job_(sought.job) {}

  void begin(bool map, int line) {
    line_ = line;
    if (done_) fail("holds more than one message", "one");
    if (aside_ > 0) {
      constexpr int kMostDepth = 16;
      if (++aside_ > kMostDepth) fail("is nested too deep", "at most 16 levels");
      if (!open_.empty()) record(map ? Json::object() : Json::array());
      return;
    }
    if (levels_.empty()) return push(map, Level::kRoot);
    Here& here = levels_.back();
    switch (here.level) {
      case Level::kRoot:
        need_key();
        if (here.key == "header" || here.key == "events") {
          const bool as_it_should_be = map == (here.key == "header");
          if (!as_it_should_be) fail_kind(!map);
          aside_ = 1;
          if (!map && of_job_) record(Json::array());
          return;
        }
        return here.key == "joint_names" ? push(!map, Level::kNames) : push(!map, Level::kPoints);
      case Level::kPoints:
        if (lines_.size() == kMostTrajectoryRows)
          fail("too many points", "at most " + std::to_string(kMostTrajectoryRows));
        lines_.push_back(line);
        sizes_.push_back({});
        nanoseconds_.push_back(0);
        return push(map, Level::kPoint);
      case Level::kPoint:
        need_key();
        return here.key == "time_from_start" ? push(map, Level::kTime)
                                             : push(!map, Level::kNumbers);
      default:
        fail(map ? "is a map" : "is a list",
             here.level == Level::kNames ? "the name of a joint" : "a number");
    }
  }

  void end() {
    if (aside_ > 0) {
      if (!open_.empty()) open_.pop_back();
      if (--aside_ == 0) levels_.back().key.clear();
      return;
    }
    const Here ended = levels_.back();
    const auto require = [&](std::initializer_list<const char*> keys) {
      for (const char* key : keys)
        if (!ended.seen.contains(key)) fail(std::string(key) + ": is missing", kKeys);
    };
    if (ended.level == Level::kRoot) require({"joint_names", "points"});
    if (ended.level == Level::kPoint) require({"positions", "time_from_start"});
    if (ended.level == Level::kTime) {
      require({"sec", "nanosec"});
      nanoseconds_.back() = sec_ * 1'000'000'000 + nanosec_;
    }
    levels_.pop_back();
    if (levels_.empty())
      done_ = true;
    else
      levels_.back().key.clear();
  }

  /// How a scalar is written: a number or true and false, in quotes, or as a plain word of YAML,
  /// which may be either.
  enum class Scalar { kNumber, kText, kPlain };

  /// A key, a name or a number, whichever is due.
  void scalar(const std::string& text, int line, Scalar kind) {
    line_ = line;
    if (done_) fail("holds more than one message", "one");
    if (aside_ > 0) {
      if (!open_.empty()) record_scalar(text, kind);
      return;
    }
    if (levels_.empty()) fail("is no map", kKeys);
    Here& here = levels_.back();
    switch (here.level) {
      case Level::kNames:
        if (names_.size() == rows_.joint_count())
          fail("has more than " + std::to_string(rows_.joint_count()) + " names", allowed());
        if (kind == Scalar::kNumber) fail("is " + text, "the name of a joint, in quotes");
        names_.push_back(text);
        return;
      case Level::kNumbers:
        return number(text, kind);
      case Level::kPoints:
        fail("is '" + text + "'", "a map");
      default:
        break;
    }
    if (here.key.empty()) return begin_key(text);
    if (here.level != Level::kTime)
      fail("is '" + text + "'", "a map or list, as JointTrajectory has it");
    const auto value = to_number<std::int64_t>(text);
    const bool seconds = here.key == "sec";
    const std::int64_t least = seconds ? std::numeric_limits<std::int32_t>::min() : 0,
                       most = seconds ? std::numeric_limits<std::int32_t>::max() : 999'999'999;
    if (kind == Scalar::kText || !value || *value < least || *value > most)
      fail(written(text, kind),
           "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
    (seconds ? sec_ : nanosec_) = *value;
    here.key.clear();
  }

  void null(int line) {
    line_ = line;
    if (!open_.empty()) return record(nullptr);
    if (aside_ > 0 || done_) return;  // of the empty document behind the last line "---"
    fail("is null", kKeys);
  }
  [[noreturn]] void alias(int line) {
    line_ = line;
    fail("is an alias", "what it stands for");
  }
  /// Refuses what the text says: names the file, the line that is being read, and the point.
  [[noreturn]] void fail(const std::string& what, const std::string& allowed) const {
    std::string where = at_line(file_, line_);
    if (!sizes_.empty() && levels_.size() > 1)
      where += ": points[" + std::to_string(sizes_.size() - 1) + "]";
    for (const Here& here : levels_)
      if (!here.key.empty() && here.key != "points")
        where += (here.level == Level::kTime ? "." : ": ") + here.key;
    bad_input(where, what, allowed);
  }

  [[nodiscard]] FileRows finish() {
    if (!done_) fail("holds no message", kKeys);
    rows_.joints(names_, file_ + ": joint_names");
    std::size_t at = 0;
    for (std::size_t k = 0; k < sizes_.size(); ++k) {
      const auto next = [&](std::size_t count) {
        at += count;
        return std::span<const double>(numbers_).subspan(at - count, count);
      };
      // In the order of the file.
      std::array<std::span<const double>, 3> values;
      for (const int which : sizes_[k].order)
        if (which >= 0)
          values[static_cast<std::size_t>(which)] =
              next(sizes_[k].count[static_cast<std::size_t>(which)]);
      rows_.add(nanoseconds_[k], values[0], values[1], values[2],
                at_line(file_, lines_[k]) + ": points[" + std::to_string(k) + "]");
    }
    FileRows read{file_, rows_.finish()};
    if (events_) read.events = events_->get<std::vector<Json>>();
    return read;
  }

 private:
  using Json = nlohmann::json;
  static constexpr const char* kKeys =
      "trajectory_msgs/msg/JointTrajectory: header, joint_names, points of positions, velocities, "
      "accelerations, effort and "
      "time_from_start of sec and nanosec";
  enum class Level { kRoot, kNames, kPoints, kPoint, kNumbers, kTime };
  struct Here {
    Level level;
    std::string key;  // whose value is due
    std::set<std::string> seen;
  };
  /// How many numbers of a point are positions, velocities, accelerations, and in what order the
  /// file has them.
  struct Sizes {
    std::array<std::uint8_t, 3> count{};
    std::array<std::int8_t, 3> order{-1, -1, -1};
  };

  [[nodiscard]] std::string allowed() const {
    return rows_.joint_count() == kDof ? "one for each of the arm's joints"
                                       : "one for each joint of both arms";
  }

  /// Adds a value to the innermost list or map of the events that is not ended, and enters it if it
  /// is one itself. The first one is the list of all events.
  void record(Json value) {
    constexpr int kMostValues = 1'000'000;  // each takes many times its bytes
    if (++values_ > kMostValues) fail("has too many values", std::to_string(kMostValues));
    const bool enter = value.is_structured();
    Json* added = nullptr;
    if (open_.empty()) {
      added = &events_.emplace(std::move(value));
    } else if (open_.back()->is_array()) {
      added = &open_.back()->emplace_back(std::move(value));
    } else {
      if (!event_key_) fail("a key is no word", "words for keys of events");
      const auto [place, is_new] = open_.back()->emplace(*event_key_, std::move(value));
      if (!is_new) fail("key '" + *event_key_ + "' is there twice", "each key once");
      event_key_.reset();
      added = &*place;
    }
    if (enter) open_.push_back(added);
  }
  /// Adds a number, a text or a key to the events.
  void record_scalar(const std::string& text, Scalar kind) {
    if (open_.back()->is_object() && !event_key_) {
      event_key_ = text;
      return;
    }
    const auto number = to_number<double>(text);
    if (kind == Scalar::kText || !number || !std::isfinite(*number))
      record(text);
    else
      record(*number);
  }
  [[noreturn]] void fail_kind(bool map) const { fail(map ? "is no map" : "is no list", kKeys); }
  void push(bool as_it_should_be, Level level) {
    if (!as_it_should_be)
      fail_kind(level == Level::kRoot || level == Level::kPoint || level == Level::kTime);
    levels_.push_back({level, {}, {}});
  }
  void need_key() const {
    if (levels_.back().key.empty()) fail("a key is no word", kKeys);
  }
  void begin_key(const std::string& key) {
    Here& here = levels_.back();
    const auto one_of = [&](std::initializer_list<const char*> keys) {
      return std::find(keys.begin(), keys.end(), key) != keys.end();
    };
    const bool known =
        here.level == Level::kRoot ? one_of({"header", "joint_names", "points", "events"})
        : here.level == Level::kPoint
            ? one_of({"positions", "velocities", "accelerations", "effort", "time_from_start"})
            : one_of({"sec", "nanosec"});
    if (!known) fail("key '" + key + "' is unknown", kKeys);
    if (!here.seen.insert(key).second) fail("key '" + key + "' is there twice", kKeys);
    here.key = key;
    which_ = key == "positions" ? 0 : key == "velocities" ? 1 : key == "accelerations" ? 2 : -1;
  }
  /// What stands where another thing is due.
  static std::string written(const std::string& text, Scalar kind) {
    return kind == Scalar::kText ? "is the text \"" + text + "\"" : "is '" + text + "'";
  }
  void number(const std::string& text, Scalar kind) {
    if (kind == Scalar::kText) fail(written(text, kind), "a finite number");
    const auto value = to_number<double>(text);
    if (!value || !std::isfinite(*value)) fail("'" + text + "' is not a number", "a finite number");
    if (which_ < 0) return;
    Sizes& sizes = sizes_.back();
    std::uint8_t& count = sizes.count[static_cast<std::size_t>(which_)];
    if (count == rows_.joint_count())
      fail("has more than " + std::to_string(rows_.joint_count()) + " numbers", allowed());
    if (count++ == 0)
      *std::find(sizes.order.begin(), sizes.order.end(), -1) = static_cast<std::int8_t>(which_);
    numbers_.push_back(*value);
  }

  JointRows rows_;
  std::string file_;
  int line_ = 0;
  std::vector<Here> levels_;
  int aside_ = 0;  // levels inside the header or the events, which say nothing of joints
  bool done_ = false;
  int which_ = -1;
  std::int64_t sec_ = 0, nanosec_ = 0;
  std::vector<std::string> names_;
  std::vector<double> numbers_;
  std::vector<Sizes> sizes_;
  std::vector<std::int64_t> nanoseconds_;
  std::vector<int> lines_;
  bool of_job_;                           // events are wanted
  std::optional<Json> events_;            // the list of all, once it has begun
  std::vector<Json*> open_;               // lists and maps of events that are not ended
  std::optional<std::string> event_key_;  // whose value is due
  int values_ = 0;                        // of events
};

class JsonEvents final : public nlohmann::json_sax<nlohmann::json> {
 public:
  JsonEvents(Message& message, const std::string& file) : message_(&message), file_(file) {}
  bool null() override { return message_->null(0), true; }
  bool boolean(bool value) override {
    return message_->scalar(value ? "true" : "false", 0, Scalar::kNumber), true;
  }
  bool number_integer(number_integer_t value) override {
    return message_->scalar(std::to_string(value), 0, Scalar::kNumber), true;
  }
  bool number_unsigned(number_unsigned_t value) override {
    return message_->scalar(std::to_string(value), 0, Scalar::kNumber), true;
  }
  bool number_float(number_float_t, const string_t& text) override {
    return message_->scalar(text, 0, Scalar::kNumber), true;
  }
  bool string(string_t& text) override { return message_->scalar(text, 0, Scalar::kText), true; }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return message_->begin(true, 0), true; }
  bool key(string_t& text) override { return message_->scalar(text, 0, Scalar::kText), true; }
  bool end_object() override { return message_->end(), true; }
  bool start_array(std::size_t) override { return message_->begin(false, 0), true; }
  bool end_array() override { return message_->end(), true; }
  bool parse_error(std::size_t, const std::string&,
                   const nlohmann::detail::exception& error) override {
    bad_input(file_, error.what(), "well-formed JSON");
  }

 private:
  using Scalar = Message::Scalar;
  Message* message_;
  std::string file_;
};

class YamlEvents final : public YAML::EventHandler {
 public:
  explicit YamlEvents(Message& message) : message_(&message) {}
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { message_->null(mark.line + 1); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { message_->alias(mark.line + 1); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                const std::string& text) override {
    const bool plain = tag == "?";  // quotes, and tags of YAML, say that it is text
    message_->scalar(text, mark.line + 1, plain ? Message::Scalar::kPlain : Message::Scalar::kText);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    message_->begin(false, mark.line + 1);
  }
  void OnSequenceEnd() override { message_->end(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    message_->begin(true, mark.line + 1);
  }
  void OnMapEnd() override { message_->end(); }

 private:
  Message* message_;
};

}  // namespace

FileRows read_joint_trajectory_json(const std::string& file, std::string_view text,
                                    const Sought& sought) {
  Message message(sought, file);
  JsonEvents events(message, file);
  (void)nlohmann::json::sax_parse(text, &events);
  return message.finish();
}

FileRows read_joint_trajectory_yaml(const std::string& file, const std::string& text,
                                    const Sought& sought) {
  if (text.size() > kMostYamlMotionBytes)
    bad_input(file, "is too large",
              "YAML of at most " + std::to_string(kMostYamlMotionBytes >> 20) +
                  " MiB; JSON may be larger");
  Message message(sought, file);
  YamlEvents events(message);
  std::istringstream stream(text);
  try {
    YAML::Parser parser(stream);
    // An empty document may follow, as `ros2 topic echo` ends every message with "---".
    for (int documents = 0; documents < 2 && parser.HandleNextDocument(events); ++documents)
      continue;
    if (parser) bad_input(file, "holds more than one YAML document", "one message");
  } catch (const YAML::Exception& error) {
    bad_input(at_line(file, error.mark.line + 1), "not YAML (" + error.msg + ")",
              "well-formed YAML");
  }
  return message.finish();
}

}  // namespace swivel::io
