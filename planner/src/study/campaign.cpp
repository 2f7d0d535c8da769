// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/study/campaign.hpp"

#include <atomic>
#include <limits>
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "swivel/core/messages/input_error.hpp"
#include "swivel/parallel/executor.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

namespace {

/// Delivers rows in order: holds a row back until all before it have been delivered.
class InOrder {
 public:
  InOrder(std::uint64_t first, const std::function<void(const EpisodeRow&)>& row_done)
      : next_(first), row_done_(row_done) {}

  void add(std::uint64_t k, EpisodeRow row) {
    const std::lock_guard lock(mutex_);
    waiting_.emplace(k, std::move(row));
    // A row whose delivery throws stays first, because rows delivered after it would leave a gap.
    for (; !waiting_.empty() && waiting_.begin()->first == next_ && !failed_;
         ++next_, waiting_.erase(waiting_.begin())) {
      failed_ = true;
      row_done_(waiting_.begin()->second);
      failed_ = false;
    }
  }

 private:
  std::mutex mutex_;
  std::map<std::uint64_t, EpisodeRow> waiting_;
  std::uint64_t next_;
  bool failed_ = false;
  const std::function<void(const EpisodeRow&)>& row_done_;
};

/// Plans the episodes of a campaign one by one, on several threads.
class EpisodePlanner {
 public:
  /// Prepares `workers` planners.
  EpisodePlanner(const std::shared_ptr<const PreparedRobot>& prepared, const Problem& problem,
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
    for (int worker = 0; worker < workers; ++worker) planners_.emplace_back(prepared, problem);
  }

  /// Plans the next episode with the planner of a worker and delivers its row; does nothing once
  /// the campaign has stopped. Several workers may call it at a time.
  void plan_next(int worker) {
    if (stopped_ || single_.budget().cancelled()) return;
    const std::uint64_t k = next_++;
    const std::uint64_t episode = options_.shard.episode(k);
    try {
      const auto result = plan(k, episode, planners_[static_cast<std::size_t>(worker)]);
      if (!result) return;
      // The plan was stopped, maybe with its verdict known and its columns not.
      if (!answered(*result)) {
        stopped_ = true;
        return;
      }
      if (options_.planned) options_.planned(episode, *result);
      add(k, EpisodeRow(episode, *result, problem_));
    } catch (const InputError& error) {
      stopped_ = true;
      throw InputError(std::string(error.what()) + " (episode " + std::to_string(episode) + ")");
    } catch (...) {
      stopped_ = true;
      throw;
    }
  }

 private:
  /// Returns the answer of an episode. An internal error, which must not take the other episodes
  /// with it, becomes the row of the episode; returns none then.
  std::optional<PlanResult> plan(std::uint64_t k, std::uint64_t episode, Planner& planner) {
    try {
      planner.set_problem(episode_problem(problem_, options_.seed, episode));
      return planner.plan(single_);
    } catch (const InputError&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      add(k, EpisodeRow(episode, error.what()));
      return std::nullopt;
    }
  }

  /// Returns true if the verdict and all columns of the row are known.
  static bool answered(const PlanResult& result) {
    return result.status == PlanStatus::kSolved
               ? result.evidence.tool_path_error
               : result.status == PlanStatus::kInfeasible && result.diagnosis.complete;
  }

  void add(std::uint64_t k, EpisodeRow row) {
    row.offsets = episode_offsets(problem_.vary, options_.seed, row.episode);
    in_order_.add(k, std::move(row));
  }

  const Problem& problem_;
  const CampaignOptions& options_;
  PlanOptions single_;             ///< of one episode
  std::vector<Planner> planners_;  ///< by worker
  InOrder in_order_;
  /// Number of the next episode in the shard. Episodes come from a counter and not from the
  /// executor's index, which starts threads far apart: rows would wait for long, and be lost if the
  /// process is killed.
  std::atomic<std::uint64_t> next_;
  std::atomic<bool> stopped_{false};
};

}  // namespace

void run_campaign(const PreparedRobot& robot, const Problem& problem,
                  const CampaignOptions& options,
                  const std::function<void(const EpisodeRow&)>& row_done) {
  // Not owned: `robot` outlives this call.
  const std::shared_ptr<const PreparedRobot> prepared(std::shared_ptr<void>(), &robot);
  const Planner checked(prepared, problem);
  if (problem.vary.empty() && options.episodes > 1)
    throw InputError(problem.source,
                     "vary: missing, so that all episodes would be the same: allowed are a key "
                     "vary, or one episode");
  const std::uint64_t size = options.shard.size(options.episodes);
  if (size > static_cast<std::uint64_t>(std::numeric_limits<int>::max()))
    throw InputError("episodes: too many for one shard: allowed are 2147483647");
  if (options.skip >= size) return;

  Executor executor(options.plan.threads);
  EpisodePlanner planner(prepared, problem, options, executor.threads(), row_done);
  executor.for_each(static_cast<int>(size - options.skip),
                    [&](int, int worker) { planner.plan_next(worker); });
}

}  // namespace swivel
