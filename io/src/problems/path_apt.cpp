// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "files/bad_input.hpp"
#include "files/files.hpp"
#include "files/text_number.hpp"
#include "problems/path_file.hpp"
#include "swivel/core/messages/bounds.hpp"

namespace swivel::io {

/// A feed of the tool: a length, in the file's unit unless it is stated, per minute.
struct AptFeed {
  double value = 0;  ///< 0: not known
  std::optional<LengthUnit> unit = {};
};

/// A position that the tool is moved to.
struct AptPoint {
  Vector3d position;  // in the unit of the file
  Vector3d axis;      // from tip to holder
  AptFeed feed;       // of the move to it
  int line = 0;
};

/// What an APT file has: points, and where cuts begin and end among them. Within a cut each point
/// is reached by a move that is not rapid.
struct AptMoves {
  struct Cut {
    std::size_t first = 0, count = 0;
  };
  std::vector<AptPoint> points;
  std::vector<Cut> cuts;
  std::optional<LengthUnit> unit;
  int unit_line = 0;
  std::vector<std::string> warnings;
};

namespace {

constexpr std::size_t kMostPoints = 1'000'000, kMostStatement = std::size_t{1} << 20,
                      kMostKinds = 8;  // words of statements that a warning names
constexpr double kUnknownFeed = 0;

std::string_view without_blanks(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\v\f");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\v\f") - first + 1);
}

std::string in_capitals(std::string_view text) {
  std::string capitals(text);
  for (char& c : capitals)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return capitals;
}

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// A statement: its word, in capital letters, and what follows the slash.
struct Statement {
  std::string word;
  std::string rest;
  int line = 0;
  [[nodiscard]] std::vector<std::string> values() const {
    std::vector<std::string> values;
    std::string_view left = rest;
    while (!left.empty() || !values.empty()) {
      const auto comma = left.find(',');
      values.push_back(in_capitals(without_blanks(left.substr(0, comma))));
      if (comma == std::string_view::npos) break;
      left.remove_prefix(comma + 1);
    }
    return values;
  }
};

/// Cuts a text into statements: lines, joined where they end with $, without comments.
class AptStatements {
 public:
  AptStatements(const std::string& file, std::string_view text) : file_(file), rest_(text) {
    if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
    if (const auto zero = rest_.find('\0'); zero != std::string_view::npos)
      bad_input(file_, "is a binary file", "APT or CL statements as text");
  }

  /// Reads the next statement that is not empty; returns false at the end.
  bool next(Statement& statement) {
    while (!rest_.empty()) {
      std::string text;
      statement.line = line_ + 1;
      while (append_line(text)) {
        if (text.size() > kMostStatement)
          bad_input(at_line(file_, statement.line), "is too long", "a statement of at most 1 MiB");
        if (rest_.empty())
          bad_input(at_line(file_, line_), "ends with $, and no line follows",
                    "a line that goes on");
      }
      const std::string_view whole = without_blanks(text);
      if (whole.empty()) continue;
      const auto slash = whole.find('/');
      statement.word = in_capitals(without_blanks(whole.substr(0, slash)));
      statement.rest = slash == std::string_view::npos ? "" : whole.substr(slash + 1);
      return true;
    }
    return false;
  }

 private:
  /// Appends the next line, and returns whether the statement goes on in the one after.
  bool append_line(std::string& text) {
    ++line_;
    const auto end = std::min(rest_.find_first_of("\r\n"), rest_.size());
    std::string_view line = rest_.substr(0, end);
    std::size_t ends = end;
    if (ends < rest_.size()) ends += rest_.substr(ends, 2) == "\r\n" ? 2 : 1;
    rest_.remove_prefix(ends);
    if (line.size() > kMostStatement)
      bad_input(at_line(file_, line_), "has " + std::to_string(line.size()) + " bytes",
                "a line of at most 1 MiB");
    if (text.empty() && is_text(line)) return false;
    if (skips_note(line)) return false;
    const auto dollar = line.find('$');
    text += line.substr(0, dollar);
    return dollar != std::string_view::npos && line.substr(dollar, 2) != "$$";
  }

  /// Returns whether a line is of a note, which begins with $$-> and, unlike other comments, goes
  /// on in the next line where it ends with $.
  bool skips_note(std::string_view line) {
    line = without_blanks(line);
    const bool note = in_note_ || line.starts_with("$$->");
    in_note_ = note && line.ends_with('$') && !line.ends_with("$$");
    return note;
  }

  /// Returns whether a line is a statement whose rest is text for people.
  static bool is_text(std::string_view line) {
    line = without_blanks(line);
    const std::string word =
        in_capitals(line.substr(0, std::min(line.find_first_of("/ \t"), line.size())));
    return is_one_of(word, {"PARTNO", "PPRINT", "REMARK", "TPRINT", "INSERT", "LETTER", "TITLES"});
  }

  const std::string& file_;
  std::string_view rest_;
  int line_ = 0;
  bool in_note_ = false;
};

class AptReader {
 public:
  AptReader(const std::string& file, std::string_view text)
      : file_(file), statements_(file, text) {}

  AptMoves read() {
    while (statements_.next(now_)) take();
    end_cut();
    tell_skipped();
    return std::move(moves_);
  }

 private:
  void take() {
    const std::string& word = now_.word;
    if (word == "GOTO")
      go(false);
    else if (word == "FROM")
      go(true);
    else if (is_one_of(word, {"GOHOME", "RETRCT"}))
      end_cut();  // to a place that the file does not say
    else if (word == "RAPID")
      rapid_ = true;
    else if (word == "FEDRAT")
      set_feed();
    else if (word == "UNITS")
      set_unit();
    else if (word == "TLAXIS")
      axis_ = fixed_axis_ = vector(numbers({3}), 0);
    else if (word == "MULTAX")
      set_axes();
    else if (word == "FINI")
      finished_ = true;
    else
      refuse_or_skip();
  }

  void go(bool rapid) {
    if (finished_) bad_input(where(), now_.word + " after FINI", "one program in a file");
    const std::vector<double> values = numbers({3, 6});
    if (values.size() == 6) axis_ = vector(values, 3);
    if (moves_.points.size() == kMostPoints)
      bad_input(where(), "is one position too many", "at most " + std::to_string(kMostPoints));
    if (rapid || rapid_) end_cut();
    rapid_ = false;
    moves_.points.push_back({vector(values, 0), axis_, feed_, now_.line});
  }

  /// Ends a cut at the last point; a cut has at least two.
  void end_cut() {
    const std::size_t count = moves_.points.size() - begun_;
    if (count >= 2) moves_.cuts.push_back({begun_, count});
    begun_ = moves_.points.size();
  }

  void set_feed() {
    feed_ = {};
    for (const std::string& value : now_.values()) {
      if (const auto number = to_number<double>(value); number && std::isfinite(*number)) {
        feed_.value = *number;
      } else if (value == "MMPM") {
        feed_.unit = LengthUnit::kMillimetre;
      } else if (value == "IPM") {
        feed_.unit = LengthUnit::kInch;
      } else if (value != "PERMIN") {
        feed_.value = kUnknownFeed;
        skip("FEDRAT in " + value);
        return;
      }
    }
    if (!(feed_.value > 0)) {
      feed_.value = kUnknownFeed;
      skip("FEDRAT without a number > 0");
    }
  }

  void set_unit() {
    const std::vector<std::string> values = now_.values();
    const std::string value = values.size() == 1 ? values[0] : "";
    std::optional<LengthUnit> unit;
    if (is_one_of(value, {"MM", "MILLIMETERS", "MILLIMETRES"})) unit = LengthUnit::kMillimetre;
    if (is_one_of(value, {"IN", "INCH", "INCHES"})) unit = LengthUnit::kInch;
    if (!unit) bad_input(where(), "UNITS is not known", "UNITS/MM or UNITS/INCHES");
    if (moves_.unit && moves_.unit != unit)
      bad_input(where(), "UNITS is another than on line " + std::to_string(moves_.unit_line),
                "one unit in a file");
    moves_.unit = unit;
    moves_.unit_line = now_.line;
  }

  /// After MULTAX/OFF the axis is that of TLAXIS again.
  void set_axes() {
    const std::vector<std::string> values = now_.values();
    if (!values.empty() && values[0] == "OFF") axis_ = fixed_axis_;
  }

  /// Refuses statements that move the tool or change what coordinates mean. Counts all others.
  void refuse_or_skip() {
    const std::string& word = now_.word;
    const std::vector<std::string> values = now_.values();
    const bool off = !values.empty() && is_one_of(values[0], {"OFF", "NOMORE"});
    if (is_one_of(word, {"CIRCLE", "MOVARC", "ARCMOV", "ARC", "HELIX", "NURBS", "SPLINE"}))
      bad_input(where(), word + ": a curve", "GOTO alone: curves written as short lines");
    if (word == "CYCLE" && !off)
      bad_input(where(), "CYCLE: moves that the machine adds", "GOTO alone, without cycles");
    if (word == "CUTCOM" && !off)
      bad_input(where(), "CUTCOM: a path that the machine offsets by the tool's radius",
                "the path of the tool's tip");
    if (is_one_of(word, {"GODLTA", "GOFWD", "GOBACK", "GOLFT", "GORGT", "GOUP", "GODOWN", "GO",
                         "COPY", "LOOPST", "CALL", "THREAD"}))
      bad_input(where(), word + ": a move that is not read", "GOTO alone");
    if (is_one_of(word, {"TRANS", "ORIGIN", "TRACUT", "ROTABL", "ROTATE", "ROTHED"}) && !off &&
        !zeros(values))
      bad_input(where(), word + ": it changes where coordinates are, and is not read",
                "coordinates in one frame");
    if (is_one_of(word, {"LOADTL", "LOAD", "TOOL PATH", "END-OF-PATH"})) end_cut();
    skip(word);
  }

  static bool zeros(const std::vector<std::string>& values) {
    return std::all_of(values.begin(), values.end(),
                       [](const std::string& value) { return to_number<double>(value) == 0.0; });
  }

  void skip(const std::string& word) {
    if (skipped_ == 0) first_skipped_ = now_.line;
    ++skipped_;
    for (auto& [name, count] : kinds_)
      if (name == word) {
        ++count;
        return;
      }
    if (kinds_.size() < kMostKinds) kinds_.emplace_back(word, 1);
  }

  void tell_skipped() {
    if (skipped_ == 0) return;
    std::string names;
    std::size_t named = 0;
    for (const auto& [name, count] : kinds_) {
      names += (names.empty() ? "" : ", ") + printable(name.substr(0, 40));
      if (count > 1) names += " (" + std::to_string(count) + ")";
      named += count;
    }
    if (named < skipped_) names += " and " + std::to_string(skipped_ - named) + " others";
    moves_.warnings.push_back(at_line(file_, first_skipped_) + ": " + std::to_string(skipped_) +
                              (skipped_ == 1 ? " statement is" : " statements are") +
                              " not read: " + names);
  }

  /// Returns the numbers of the statement, as many as one of `counts`. Throws InputError.
  [[nodiscard]] std::vector<double> numbers(std::initializer_list<std::size_t> counts) const {
    const std::vector<std::string> values = now_.values();
    const char* const allowed =
        counts.size() == 2 ? "three numbers x,y,z, or six: x,y,z,i,j,k" : "three numbers i,j,k";
    if (std::find(counts.begin(), counts.end(), values.size()) == counts.end())
      bad_input(where() + ": " + now_.word, "has " + std::to_string(values.size()) + " values",
                allowed);
    std::vector<double> numbers;
    for (const std::string& value : values) {
      const auto number = to_number<double>(value);
      if (!number || !std::isfinite(*number))
        bad_input(where() + ": " + now_.word,
                  "'" + printable(value.substr(0, 60)) + "' is not a number", allowed);
      numbers.push_back(*number);
    }
    return numbers;
  }

  static Vector3d vector(const std::vector<double>& values, std::size_t first) {
    return {values[first], values[first + 1], values[first + 2]};
  }

  [[nodiscard]] std::string where() const { return at_line(file_, now_.line); }

  const std::string& file_;
  AptStatements statements_;
  Statement now_;
  AptMoves moves_;
  std::size_t begun_ = 0;  // first point of the cut, which may be none yet
  bool rapid_ = false, finished_ = false;
  Vector3d axis_ = Vector3d::UnitZ(), fixed_axis_ = Vector3d::UnitZ();
  AptFeed feed_;
  std::size_t skipped_ = 0;
  int first_skipped_ = 0;
  std::vector<std::pair<std::string, std::size_t>> kinds_;
};

/// Returns the cut that is asked for. Throws InputError.
AptMoves::Cut chosen_cut(const std::string& file, const AptMoves& moves,
                         const std::optional<std::size_t>& cut) {
  const std::size_t count = moves.cuts.size();
  const std::string cuts = std::to_string(count) + (count == 1 ? " cut" : " cuts");
  if (count == 0)
    bad_input(file, "has no cut",
              "at least two GOTO, of which the second is reached by no rapid move");
  if (cut) {
    if (*cut > count)
      bad_input(file, "has " + cuts + ", and `cut: " + std::to_string(*cut) + "` is asked for",
                count == 1 ? "cut: 1" : "cut: 1 to " + std::to_string(count));
    return moves.cuts[*cut - 1];
  }
  if (count > 1)
    bad_input(
        at_line(file, moves.points[moves.cuts[1].first].line),
        "begins the second of " + cuts + " with rapid moves between them",
        "`cut: 1` to " + std::to_string(count) + " beside `file`, in a stroke of a job for each");
  return moves.cuts[0];
}

class AptPath {
 public:
  AptPath(const std::string& file, const AptMoves& moves, const PathFileOptions& options)
      : file_(file), moves_(moves), options_(options), unit_(chosen_unit()) {}

  PathFile path() {
    const AptMoves::Cut cut = chosen_cut(file_, moves_, options_.cut);
    points_ = std::span(moves_.points).subspan(cut.first, cut.count);
    path_.axis_alone = true;
    path_.warnings = moves_.warnings;
    place();
    take_feeds();
    tell_left_out(cut);
    return std::move(path_);
  }

 private:
  [[nodiscard]] LengthUnit chosen_unit() const {
    if (moves_.unit && options_.units && moves_.unit != options_.units)
      bad_input(at_line(file_, moves_.unit_line),
                std::string("UNITS in ") + name_of(*moves_.unit) +
                    ", and the problem file says `units: " + name_of(*options_.units) + "`",
                "the same unit, or one of the two");
    if (!moves_.unit && !options_.units)
      bad_input(file_, "has no UNITS",
                "UNITS/MM or UNITS/INCHES in it, or `units: mm` or `units: inch` beside `file`");
    return moves_.unit ? *moves_.unit : *options_.units;
  }

  void place() {
    std::vector<AxisPoint> points;
    points.reserve(points_.size());
    for (const AptPoint& point : points_) {
      AxisPoint& placed = points.emplace_back();
      for (Eigen::Index k = 0; k < 3; ++k) placed.position[k] = in_metres(point.position[k], unit_);
      placed.outward = point.axis;
      if (!(placed.position.array().abs() <= kMostMetres).all())
        bad_input(at_line(file_, point.line), "a coordinate is too large", "at most 1000 m");
    }
    const std::vector<Quaterniond> frames =
        tool_frames(points, options_.turns_freely,
                    [&](std::size_t k) { return at_line(file_, points_[k].line) + ": tool axis"; });
    path_.waypoints.resize(points.size());
    for (std::size_t k = 0; k < points.size(); ++k) {
      path_.waypoints[k].position = points[k].position;
      path_.waypoints[k].orientation = frames[k];
    }
  }

  /// A feed holds for the move to its GOTO; those of a path hold from a waypoint to the next.
  void take_feeds() {
    const auto moves = points_.subspan(1);
    const auto known = [](const AptPoint& point) { return point.feed.value > 0; };
    const auto first = std::find_if(moves.begin(), moves.end(), known);
    if (first == moves.end()) return;
    if (!options_.feeds) {
      path_.warnings.push_back(at_line(file_, first->line) + ": FEDRAT is not used: " + kNoFeeds);
      return;
    }
    for (const AptPoint& point : moves) {
      if (!known(point))
        bad_input(at_line(file_, point.line), "has no feed that is read, and other moves have one",
                  "FEDRAT per minute before it");
      path_.feeds.push_back(in_metres(point.feed.value, point.feed.unit.value_or(unit_)) / 60);
    }
    path_.feeds.push_back(path_.feeds.back());
  }

  void tell_left_out(const AptMoves::Cut& cut) {
    if (options_.cut) return;  // other cuts are those of other strokes
    const std::size_t before = cut.first, behind = moves_.points.size() - cut.first - cut.count;
    if (before + behind == 0) return;
    path_.warnings.push_back(file_ + ": rapid moves are left out: " + std::to_string(before) +
                             " before the cut, " + std::to_string(behind) + " behind it");
  }

  const std::string& file_;
  const AptMoves& moves_;
  const PathFileOptions& options_;
  LengthUnit unit_;
  std::span<const AptPoint> points_;
  PathFile path_;
};

}  // namespace

bool is_apt_name(const std::filesystem::path& file) {
  return is_one_of(in_capitals(file.extension().string()),
                   {".APT", ".APTSOURCE", ".CL", ".CLS", ".NCL"});
}

std::shared_ptr<const AptMoves> read_apt(const std::string& file, std::string_view text) {
  return std::make_shared<const AptMoves>(AptReader(file, text).read());
}

PathFile apt_path(const std::string& file, const AptMoves& moves, const PathFileOptions& options) {
  return AptPath(file, moves, options).path();
}

}  // namespace swivel::io
