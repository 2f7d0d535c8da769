// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/study/plan_many.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include "plan/layout/lattice_cache.hpp"
#include "study/plan_in_order.hpp"
#include "study/study_planner.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/parallel/executor.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

namespace {

/// Delivers rows in order: holds a row back until all before it have been delivered. Rows are
/// delivered by one thread at a time, while others add theirs.
class InOrder {
 public:
  InOrder(std::uint64_t first, const std::function<void(const EpisodeRow&)>& row_done)
      : next_(first), row_done_(row_done) {}

  /// Adds the row of the k-th problem of the shard. Delivers those whose turn it is, unless another
  /// thread does. Throws what the delivery throws.
  void add(std::uint64_t k, EpisodeRow row) {
    std::unique_lock lock(mutex_);
    waiting_.emplace(k, std::move(row));
    if (delivering_) return;
    delivering_ = true;
    while (!waiting_.empty() && waiting_.begin()->first == next_) {
      const auto ready = waiting_.extract(waiting_.begin());
      ++next_;
      lock.unlock();
      // After a row whose delivery throws none is delivered, because later ones would leave a gap.
      row_done_(ready.mapped());
      lock.lock();
    }
    delivering_ = false;
  }

 private:
  std::mutex mutex_;
  std::map<std::uint64_t, EpisodeRow> waiting_;
  std::uint64_t next_;
  bool delivering_ = false;
  const std::function<void(const EpisodeRow&)>& row_done_;
};

/// Plans problems one by one, on several threads.
class Plans {
 public:
  /// `robot`: as StudyPlanner takes it.
  Plans(const std::shared_ptr<const PreparedRobot>& robot, const Problem& like,
        const ProblemOf& problem_of, const ManyOptions& options, int workers,
        const RowOfBadInput& of_bad_input, const std::function<void(const EpisodeRow&)>& row_done)
      : like_(like),
        problem_of_(problem_of),
        options_(options),
        all_(options.plan.timeout_s, options.plan.cancel, options.plan.stop),
        single_(options.plan),
        of_bad_input_(of_bad_input),
        in_order_(options.skip, row_done),
        next_(options.skip) {
    single_.threads = 1;
    single_.evidence = {.tool_path_error = true,  // a column
                        .cause = options.plan.evidence.cause};
    single_.progress = nullptr;
    const auto lattices = std::make_shared<LatticeCache>();
    for (int worker = 0; worker < workers; ++worker)
      planners_.emplace_back(robot, like, single_, lattices);
  }

  /// Plans the next problem with the planner of a worker and delivers its row; does nothing once
  /// the run has stopped. Several workers may call it at a time.
  void plan_next(int worker) {
    if (stopped_ || all_.spent()) return;
    const std::uint64_t k = next_++, number = options_.shard.episode(k);
    try {
      std::optional<EpisodeRow> row = row_of(number, worker);
      if (row)
        in_order_.add(k, std::move(*row));
      else
        stopped_ = true;
    } catch (...) {
      stopped_ = true;
      throw;
    }
  }

 private:
  /// Plans a problem and tells the caller of its answer. Returns its row; none if all plans were
  /// stopped. What goes wrong with one problem must not take the others with it: it becomes a row.
  std::optional<EpisodeRow> row_of(std::uint64_t number, int worker) {
    PlanOptions options = single_;
    options.timeout_s = all_.seconds_left();
    if (const auto each = options_.timeout_each_s)
      options.timeout_s = std::min(*each, options.timeout_s.value_or(*each));
    const Budget budget = options.budget();
    std::optional<StudiedAnswer> found;
    try {
      const Problem problem = problem_of_(number);
      found = planners_[static_cast<std::size_t>(worker)].plan(problem, options, budget);
    } catch (const InputError& error) {
      return of_bad_input_(number, error);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const Stopped&) {
    } catch (const std::exception& error) {
      return EpisodeRow(number, error.what());
    }
    if (!found || !found->known(budget)) {
      // The verdict may be known, and columns not.
      if (all_.spent()) return std::nullopt;
      return late(number);
    }
    if (options_.planned) options_.planned(number, found->answer);
    EpisodeRow row(number, found->answer, like_);
    if (found->fault) found->fault->tell(row);
    return row;
  }
  [[nodiscard]] static EpisodeRow late(std::uint64_t number) {
    EpisodeRow row;
    row.episode = number;
    row.status = PlanStatus::kTimeout;
    row.reason = "not planned in the time for each";
    return row;
  }

  const Problem& like_;
  const ProblemOf& problem_of_;
  const ManyOptions& options_;
  Budget all_;
  PlanOptions single_;  ///< of one problem
  const RowOfBadInput& of_bad_input_;
  std::vector<StudyPlanner> planners_;  ///< by worker
  InOrder in_order_;
  /// Number of the next problem in the shard. Problems come from a counter and not from the
  /// executor's index, which starts threads far apart: rows would wait for long, and be lost if the
  /// process is killed; and lattices would be shared by fewer.
  std::atomic<std::uint64_t> next_;
  std::atomic<bool> stopped_{false};
};

/// Returns the row of bad input, which says what is wrong.
EpisodeRow told(std::uint64_t number, const InputError& error) {
  return EpisodeRow(number, error.what());
}

}  // namespace

void plan_in_order(const std::shared_ptr<const PreparedRobot>& robot, const Problem& like,
                   std::uint64_t count, const ProblemOf& problem_of, const ManyOptions& options,
                   const RowOfBadInput& of_bad_input,
                   const std::function<void(const EpisodeRow&)>& row_done) {
  if (options.timeout_each_s && !(*options.timeout_each_s > 0))
    throw InvalidArgument("timeout_each_s: allowed is a number above 0");
  static_cast<void>(StudyPlanner(robot, like, options.plan));  // throws for bad input
  const std::uint64_t size = options.shard.size(count);
  if (size > static_cast<std::uint64_t>(std::numeric_limits<int>::max()))
    throw InputError("too many plans for one shard: allowed are 2147483647");
  const int left = static_cast<int>(size - std::min(size, options.skip));
  if (left == 0) return;
  Executor executor(options.plan.threads);
  Plans plans(robot, like, problem_of, options, executor.threads(), of_bad_input, row_done);
  executor.for_each(left, [&](int, int worker) { plans.plan_next(worker); });
}

void plan_many(const PreparedRobot& robot, const Problem& like, std::uint64_t count,
               const ProblemOf& problem_of, const ManyOptions& options,
               const std::function<void(const EpisodeRow&)>& row_done) {
  // The pointer does not own the robot, which outlives this call.
  const std::shared_ptr<const PreparedRobot> known(std::shared_ptr<void>(), &robot);
  plan_in_order(known, like, count, problem_of, options, told, row_done);
}

void plan_many(const Problem& like, std::uint64_t count, const ProblemOf& problem_of,
               const ManyOptions& options, const std::function<void(const EpisodeRow&)>& row_done) {
  validate(like);
  std::shared_ptr<const PreparedRobot> robot;
  if (like.arms.size() == 1)
    robot = std::make_shared<const PreparedRobot>(problem_of_run(like, {0, false}));
  plan_in_order(robot, like, count, problem_of, options, told, row_done);
}

}  // namespace swivel
