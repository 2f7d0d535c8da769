// SPDX-License-Identifier: BSD-3-Clause
// A program's locale changes nothing of what is read and written: its decimal point may be a comma,
// its thousands may be grouped.
#include <gtest/gtest.h>
#include <unistd.h>

#include <clocale>
#include <cstdlib>
#include <filesystem>
#include <locale>
#include <map>
#include <nlohmann/json.hpp>

#include "robots.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/motions/motion.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/report/lattice_map.hpp"
#include "swivel/report/page.hpp"

namespace swivel {
namespace {

using namespace test;
namespace fs = std::filesystem;

struct Comma : std::numpunct<char> {
  [[nodiscard]] char do_decimal_point() const override { return ','; }
  [[nodiscard]] char do_thousands_sep() const override { return '.'; }
  [[nodiscard]] std::string do_grouping() const override { return "\3"; }
};

/// C's locale and C++'s have a decimal comma while this lives: one that is installed, or that
/// localedef makes.
class DecimalComma {
 public:
  DecimalComma() : before_(std::setlocale(LC_ALL, nullptr)) {
    is_set_ = set_one();
    if (!is_set_) {
      const std::string name = (folder_ / "de_DE.UTF-8").string();
      fs::create_directories(folder_);
      if (std::system(("localedef -i de_DE -f UTF-8 '" + name + "' > /dev/null 2>&1").c_str()) ==
          0) {
        setenv("LOCPATH", folder_.c_str(), 1);
        is_set_ = set_one();
      }
    }
    cpp_before_ =
        std::locale::global(std::locale(std::locale::classic(), new Comma));  // which a locale owns
  }
  ~DecimalComma() {
    std::locale::global(cpp_before_);
    std::setlocale(LC_ALL, before_.c_str());
    unsetenv("LOCPATH");
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  DecimalComma(const DecimalComma&) = delete;
  DecimalComma& operator=(const DecimalComma&) = delete;
  /// Says whether the locale of C is set; that of C++ always is.
  [[nodiscard]] bool is_set() const { return is_set_; }

 private:
  static bool set_one() {
    for (const char* name :
         {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "it_IT.UTF-8", "es_ES.UTF-8"})
      if (std::setlocale(LC_ALL, name) != nullptr && *std::localeconv()->decimal_point == ',')
        return true;
    return false;
  }
  std::string before_;
  std::locale cpp_before_;
  fs::path folder_ = fs::temp_directory_path() / ("swivel-locale-" + std::to_string(getpid()));
  bool is_set_ = false;
};

/// All that is read and written of a problem, by what it is.
std::map<std::string, std::string> texts() {
  std::map<std::string, std::string> texts;
  PathProblem problem = io::load_path_problem(data_dir() / "problems" / "experiment_c.yaml");
  problem.resolution = {0.02, 0.2, 0.1};
  problem.limits.edges = EdgeMode::kNodes;
  for (const std::uint64_t episode : {0ull, 258ull}) {  // the post blocks the second
    const std::string of = " of episode " + std::to_string(episode);
    PlanOptions options;
    options.planner = PlannerKind::kEagerDp;
    options.evidence = Evidence::all();
    Planner planner(episode_problem(problem, 1, episode));
    const PlanResult result = planner.plan(options);
    nlohmann::json json = nlohmann::json::parse(io::to_json(result));
    json["time_ms"] = nullptr;
    texts["result" + of] = json.dump();
    texts["answer" + of] = answer_text(result);
    const LatticeMap map = make_map(planner.view(), true);
    texts["svg" + of] = to_svg(map);
    texts["map" + of] = to_text(map, 100, false);
    if (page_available()) texts["page" + of] = to_page(planner.view(), map, json.dump());
    if (result.status != PlanStatus::kSolved) continue;
    const fs::path file =
        fs::temp_directory_path() / ("swivel-locale-" + std::to_string(getpid()) + ".csv");
    io::write_trajectory(file, result);
    for (const TrajectoryRow& row :
         io::load_trajectory_file(file, planner.view().lattice.chain().joint_names).rows)
      texts["trajectory"] += formatted("%.17g %.17g %.17g\n", row.s, row.phi, joint_sum(row.q));
    fs::remove(file);
  }
  return texts;
}

TEST(Locale, ChangesNothingThatIsReadOrWritten) {
  const auto classic = texts();
  const DecimalComma locale;
  if (!locale.is_set())
    std::printf(
        "no locale with a decimal comma here, and none could be made: C++'s alone is tried\n");
  const auto foreign = texts();
  ASSERT_EQ(classic.size(), foreign.size());
  EXPECT_GE(classic.size(), 8u);
  for (const auto& [what, text] : classic)
    EXPECT_TRUE(foreign.at(what) == text) << what << (text.size() < 400 ? foreign.at(what) : "");
  EXPECT_EQ(formatted("%.2f", 1234.5), "1234.50");
  if (locale.is_set())
    EXPECT_EQ(*std::localeconv()->decimal_point, ',');  // and the program's own is as it was
}

}  // namespace
}  // namespace swivel
