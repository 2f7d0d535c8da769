// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/study/campaign.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/study_planner.hpp"
#include "swivel/core/messages/input_error.hpp"
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

  /// Adds the row of episode `k` of the shard. Delivers those whose turn it is, unless another
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

/// Plans the episodes of a campaign one by one, on several threads.
class Episodes {
 public:
  /// `robot`: as StudyPlanner takes it.
  Episodes(const std::shared_ptr<const PreparedRobot>& robot, const Problem& problem,
           const CampaignOptions& options, int workers,
           const std::function<void(const EpisodeRow&)>& row_done)
      : problem_(problem),
        options_(options),
        single_(options.plan),
        in_order_(options.skip, row_done),
        next_(options.skip) {
    single_.threads = 1;
    single_.evidence = {.tool_path_error = true};  // a column
    single_.progress = nullptr;
    for (int worker = 0; worker < workers; ++worker)
      planners_.emplace_back(robot, problem, single_);
  }

  /// Plans the next episode with the planner of a worker and delivers its row; does nothing once
  /// the campaign has stopped. Several workers may call it at a time.
  void plan_next(int worker) {
    if (stopped_ || single_.budget().cancelled()) return;
    const std::uint64_t k = next_++;
    const std::uint64_t episode = options_.shard.episode(k);
    try {
      std::optional<EpisodeRow> row = row_of(episode, worker);
      // The plan was stopped, maybe with its verdict known and its columns not.
      if (!row) {
        stopped_ = true;
        return;
      }
      row->offsets = episode_offsets(problem_.vary, options_.seed, episode);
      in_order_.add(k, std::move(*row));
    } catch (const InputError& error) {
      stopped_ = true;
      throw InputError(std::string(error.what()) + " (episode " + std::to_string(episode) + ")");
    } catch (...) {
      stopped_ = true;
      throw;
    }
  }

 private:
  /// Plans an episode and tells the caller of its answer. Returns its row; none if it was stopped.
  /// An internal error, which must not take the other episodes with it, becomes a row.
  std::optional<EpisodeRow> row_of(std::uint64_t episode, int worker) {
    const Budget budget = single_.budget();
    std::optional<StudiedAnswer> found;
    try {
      found = planners_[static_cast<std::size_t>(worker)].plan(
          episode_problem(problem_, options_.seed, episode), single_, budget);
    } catch (const InputError&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const Stopped&) {
      return std::nullopt;
    } catch (const std::exception& error) {
      return EpisodeRow(episode, error.what());
    }
    if (!found->known(budget)) return std::nullopt;
    if (options_.planned) options_.planned(episode, found->answer);
    EpisodeRow row(episode, found->answer, problem_);
    if (found->fault) found->fault->tell(row);
    return row;
  }

  const Problem& problem_;
  const CampaignOptions& options_;
  PlanOptions single_;                  ///< of one episode
  std::vector<StudyPlanner> planners_;  ///< by worker
  InOrder in_order_;
  /// Number of the next episode in the shard. Episodes come from a counter and not from the
  /// executor's index, which starts threads far apart: rows would wait for long, and be lost if the
  /// process is killed.
  std::atomic<std::uint64_t> next_;
  std::atomic<bool> stopped_{false};
};

/// Returns how many episodes of the shard are to be planned. Throws InputError for a campaign that
/// makes no sense.
int episodes_to_plan(const std::string& source, const std::vector<Variation>& vary,
                     const CampaignOptions& options) {
  if (vary.empty() && options.episodes > 1)
    throw InputError(source,
                     "vary: missing, so that all episodes would be the same: allowed are a key "
                     "vary, or one episode");
  const std::uint64_t size = options.shard.size(options.episodes);
  if (size > static_cast<std::uint64_t>(std::numeric_limits<int>::max()))
    throw InputError("episodes: too many for one shard: allowed are 2147483647");
  return static_cast<int>(size - std::min(size, options.skip));
}

void run(const std::shared_ptr<const PreparedRobot>& robot, const Problem& problem,
         const CampaignOptions& options, const std::function<void(const EpisodeRow&)>& row_done) {
  static_cast<void>(StudyPlanner(robot, problem, options.plan));  // throws for bad input
  const int count = episodes_to_plan(problem.source, problem.vary, options);
  if (count == 0) return;
  Executor executor(options.plan.threads);
  Episodes episodes(robot, problem, options, executor.threads(), row_done);
  executor.for_each(count, [&](int, int worker) { episodes.plan_next(worker); });
}

}  // namespace

void run_campaign(const PreparedRobot& robot, const PathProblem& problem,
                  const CampaignOptions& options,
                  const std::function<void(const EpisodeRow&)>& row_done) {
  run_campaign(robot, one_path(problem), options, row_done);
}

void run_campaign(const PreparedRobot& robot, const Problem& problem,
                  const CampaignOptions& options,
                  const std::function<void(const EpisodeRow&)>& row_done) {
  // The pointer does not own the robot, which outlives this call.
  run(std::shared_ptr<const PreparedRobot>(std::shared_ptr<void>(), &robot), problem, options,
      row_done);
}

void run_campaign(const Problem& problem, const CampaignOptions& options,
                  const std::function<void(const EpisodeRow&)>& row_done) {
  validate(problem);
  if (problem.arms.size() == 2)
    run(nullptr, problem, options, row_done);
  else
    run_campaign(PreparedRobot(problem_of_run(problem, {0, false})), problem, options, row_done);
}

}  // namespace swivel
