// SPDX-License-Identifier: BSD-3-Clause
// Answers of every kind of problem that went through a file: check_answer() passes what was planned
// and refuses what was spoiled, time_answer() makes the motion that the planner makes.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "../../io/io_support.hpp"
#include "seed.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/problem/given_answer.hpp"
#include "swivel/planner/problem/problem_planner.hpp"
#include "swivel/planner/problem/time_answer.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"

namespace swivel {
namespace {

using namespace test;
using io::test::TempFolder;

/// A problem of one kind, and the speed of its motion, m/s; 0: its strokes have their own.
struct Kind {
  const char* problem;
  double speed;
};
constexpr std::array kKinds = {Kind{"experiment_a", 0.1}, Kind{"door_job", 0},
                               Kind{"sda10f_bar_workcell", 0.1}};

Problem load(const Kind& kind) {
  return io::load_problem(std::string(SWIVEL_DATA_DIR "/problems/") + kind.problem + ".yaml");
}

/// Plans a problem of a kind, in time or not, and reads the answer from a file again.
struct Written {
  Problem problem;
  Answer answer;
  PreparedProblem prepared;
  GivenAnswer given;

  Written(const TempFolder& folder, const Kind& kind, bool in_time)
      : problem(load(kind)),
        answer(planned(problem, kind, in_time)),
        prepared(in_time && problem.arms.size() == 2 ? with_motion_defaults(problem) : problem),
        given(io::load_answer(written(folder, in_time), problem, prepared.joint_names())) {}

  static Answer planned(const Problem& problem, const Kind& kind, bool in_time) {
    MotionRequest asked;
    if (in_time) asked.timing = TimingOptions{.speed = kind.speed, .turn_speed = {}, .rate = 50};
    return ProblemPlanner(problem, asked).plan({});
  }
  [[nodiscard]] std::filesystem::path written(const TempFolder& folder, bool in_time) const {
    return folder.write("answer.csv", in_time ? io::motion_text(answer, problem, "answer.csv")
                                              : io::to_csv(answer, problem));
  }
  [[nodiscard]] GivenAnswer completed() const { return complete_answer(prepared, given); }
};

template <class Item>
Item& any_of(std::vector<Item>& items, Random& random) {
  return items[static_cast<std::size_t>(random.below(static_cast<int>(items.size())))];
}

/// Returns a part that is a run: a transition may go another way.
Part& any_run_of(std::vector<Part>& parts, Random& random) {
  while (true)
    if (Part& part = any_of(parts, random); part.run) return part;
}

TEST(GivenAnswer, PassesItsCheckUnlessItIsSpoiled) {
  const TempFolder folder;
  Random random(seed("PassesItsCheckUnlessItIsSpoiled"));
  for (const Kind& kind : kKinds)
    for (const bool in_time : {false, true}) {
      SCOPED_TRACE(kind.problem + std::string(in_time ? " in time" : ""));
      const Written written(folder, kind, in_time);
      ASSERT_TRUE(written.answer.is_whole());
      const GivenAnswer given = written.completed();
      EXPECT_EQ(given.has_times(), in_time);
      EXPECT_EQ(given.arms.size(), written.problem.arms.size());
      const AnswerCheck check = check_answer(written.prepared, given);
      EXPECT_TRUE(check.passed);
      EXPECT_EQ(check.runs.size(), written.problem.arms.size() == 2 ? 2 : given.runs());
      for (int trial = 0; trial < 3; ++trial) {
        GivenAnswer spoiled = given;
        GivenArm& arm = any_of(spoiled.arms, random);
        Config& q = in_time ? any_of(arm.motion->rows, random).row.q
                            : any_of(any_run_of(arm.parts, random).rows, random).q;
        q[random.below(6)] += random.coin() ? 0.3 : -0.3;
        const AnswerCheck refused = check_answer(written.prepared, spoiled, {.margins = false});
        EXPECT_FALSE(refused.passed) << "trial " << trial;
        EXPECT_THROW(require_passed(refused), std::logic_error);
      }
    }
}

TEST(GivenAnswer, IsTimedAsThePlannerTimesItsOwn) {
  const TempFolder folder;
  for (const Kind& kind : kKinds) {
    SCOPED_TRACE(kind.problem);
    const Written in_time(folder, kind, true);
    const Motion& planned = *in_time.answer.timed();
    // Rows of the motion's own plan: what the planner timed.
    Answer rows = in_time.answer;
    rows.timing.reset(), rows.motion.reset();
    const Problem problem = with_motion_defaults(in_time.problem);
    const GivenAnswer given = io::load_answer(folder.write("rows.csv", io::to_csv(rows, problem)),
                                              problem, in_time.prepared.joint_names());
    const MotionRequest asked{.timing = in_time.answer.timing};
    const TimedAnswer timed = time_answer(in_time.prepared, given, asked, true);
    EXPECT_EQ(timed.fault, "");
    ASSERT_NE(timed.answer.timed(), nullptr);
    const Motion& made = *timed.answer.timed();
    ASSERT_EQ(made.arms.size(), planned.arms.size());
    for (std::size_t k = 0; k < made.arms.size(); ++k) {
      const auto &own = planned.arms[k].rows, &again = made.arms[k].rows;
      ASSERT_EQ(again.size(), own.size());
      for (std::size_t row = 0; row < own.size(); ++row)
        ASSERT_TRUE(again[row].row.q == own[row].row.q && again[row].t == own[row].t)
            << "arm " << k << ", row " << row;
    }
    // A motion that is timed again takes as long.
    const TimedAnswer again = time_answer(in_time.prepared, in_time.given, asked, true);
    ASSERT_NE(again.answer.timed(), nullptr);
    EXPECT_NEAR(again.answer.timed()->duration, planned.duration, 1e-3 * planned.duration);
  }
}

}  // namespace
}  // namespace swivel
