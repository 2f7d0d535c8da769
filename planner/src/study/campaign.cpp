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

#include "plan/supported_options.hpp"
#include "study/answered.hpp"
#include "study/studied_workcell.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/parallel/executor.hpp"
#include "swivel/planner/job/plan_job.hpp"
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

/// Plans the episodes of a campaign one by one, on several threads. Derived classes say how one is
/// planned.
class EpisodePlanner {
 public:
  /// `vary`: what differs from episode to episode.
  EpisodePlanner(const std::vector<Variation>& vary, const CampaignOptions& options,
                 const std::function<void(const EpisodeRow&)>& row_done)
      : options_(options),
        single_(options.plan),
        vary_(vary),
        in_order_(options.skip, row_done),
        next_(options.skip) {
    single_.threads = 1;
    single_.evidence = {.tool_path_error = true};  // a column
    single_.progress = nullptr;
  }
  virtual ~EpisodePlanner() = default;

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
      row->offsets = episode_offsets(vary_, options_.seed, episode);
      in_order_.add(k, std::move(*row));
    } catch (const InputError& error) {
      stopped_ = true;
      throw InputError(std::string(error.what()) + " (episode " + std::to_string(episode) + ")");
    } catch (...) {
      stopped_ = true;
      throw;
    }
  }

 protected:
  /// Plans an episode and tells the caller of its answer. Returns its row; none if it was stopped.
  virtual std::optional<EpisodeRow> row_of(std::uint64_t episode, int worker) = 0;

  /// Returns what `plan` returns. An internal error of it, which must not take the other episodes
  /// with it, becomes the row of the episode in `failed`; returns none then.
  template <class Plan>
  auto answer_of(std::uint64_t episode, std::optional<EpisodeRow>& failed, const Plan& plan)
      -> std::optional<decltype(plan())> {
    try {
      return plan();
    } catch (const InputError&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      failed.emplace(episode, error.what());
      return std::nullopt;
    }
  }

  const CampaignOptions& options_;
  PlanOptions single_;  ///< of one episode

 private:
  const std::vector<Variation>& vary_;
  InOrder in_order_;
  /// Number of the next episode in the shard. Episodes come from a counter and not from the
  /// executor's index, which starts threads far apart: rows would wait for long, and be lost if the
  /// process is killed.
  std::atomic<std::uint64_t> next_;
  std::atomic<bool> stopped_{false};
};

class ProblemEpisodes : public EpisodePlanner {
 public:
  /// Prepares `workers` planners.
  ProblemEpisodes(const std::shared_ptr<const PreparedRobot>& prepared, const PathProblem& problem,
                  const CampaignOptions& options, int workers,
                  const std::function<void(const EpisodeRow&)>& row_done)
      : EpisodePlanner(problem.vary, options, row_done), problem_(problem) {
    for (int worker = 0; worker < workers; ++worker) planners_.emplace_back(prepared, problem);
  }

 private:
  std::optional<EpisodeRow> row_of(std::uint64_t episode, int worker) override {
    std::optional<EpisodeRow> failed;
    const auto result = answer_of(episode, failed, [&] {
      Planner& planner = planners_[static_cast<std::size_t>(worker)];
      planner.set_problem(episode_problem(problem_, options_.seed, episode));
      return planner.plan(single_);
    });
    if (!result) return failed;
    if (!answered(*result)) return std::nullopt;
    if (options_.planned) options_.planned(episode, *result);
    return EpisodeRow(episode, *result, problem_);
  }
  /// Returns true if the verdict and all columns of the row are known.
  static bool answered(const PlanResult& result) {
    return result.status == PlanStatus::kSolved
               ? result.evidence.tool_path_error
               : result.status == PlanStatus::kInfeasible && result.diagnosis.complete;
  }

  const PathProblem& problem_;
  std::vector<Planner> planners_;  ///< by worker
};

class JobEpisodes : public EpisodePlanner {
 public:
  JobEpisodes(const PreparedRobot& robot, const Problem& job, const CampaignOptions& options,
              const std::function<void(const EpisodeRow&)>& row_done)
      : EpisodePlanner(job.vary, options, row_done), robot_(robot), job_(job) {}

 private:
  std::optional<EpisodeRow> row_of(std::uint64_t episode, int) override {
    std::optional<EpisodeRow> failed;
    const Budget budget = single_.budget();
    const auto result = answer_of(episode, failed, [&] {
      return plan_job(robot_, episode_problem(job_, options_.seed, episode), single_);
    });
    if (!result) return failed;
    if (!answered(*result, budget)) return std::nullopt;
    if (options_.job_planned) options_.job_planned(episode, *result);
    return EpisodeRow(episode, *result, job_);
  }

  const PreparedRobot& robot_;
  const Problem& job_;
};

class WorkcellEpisodes : public EpisodePlanner {
 public:
  WorkcellEpisodes(const Problem& cell, const CampaignOptions& options,
                   const std::function<void(const EpisodeRow&)>& row_done)
      : EpisodePlanner(cell.vary, options, row_done), cell_(cell) {}

 private:
  std::optional<EpisodeRow> row_of(std::uint64_t episode, int) override {
    std::optional<EpisodeRow> failed;
    const Budget budget = single_.budget();
    try {
      const auto found = answer_of(episode, failed, [&] {
        return plan_studied(episode_problem(cell_, options_.seed, episode), single_, budget);
      });
      if (!found) return failed;
      if (!found->fault && !answered(found->result, budget)) return std::nullopt;
      if (options_.workcell_planned) options_.workcell_planned(episode, found->result);
      EpisodeRow row(episode, found->result, cell_);
      if (found->fault) found->fault->tell(row);
      return row;
    } catch (const Stopped&) {
      return std::nullopt;
    }
  }

  const Problem& cell_;
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

}  // namespace

void run_campaign(const PreparedRobot& robot, const PathProblem& problem,
                  const CampaignOptions& options,
                  const std::function<void(const EpisodeRow&)>& row_done) {
  // Not owned: `robot` outlives this call.
  const std::shared_ptr<const PreparedRobot> prepared(std::shared_ptr<void>(), &robot);
  const Planner checked(prepared, problem);
  const int count = episodes_to_plan(problem.source, problem.vary, options);
  if (count == 0) return;
  Executor executor(options.plan.threads);
  ProblemEpisodes planner(prepared, problem, options, executor.threads(), row_done);
  executor.for_each(count, [&](int, int worker) { planner.plan_next(worker); });
}

void run_campaign(const PreparedRobot& robot, const Problem& job, const CampaignOptions& options,
                  const std::function<void(const EpisodeRow&)>& row_done) {
  validate(job);
  if (is_path(job)) {
    run_campaign(robot, problem_of_run(job, {0, false}), options, row_done);
    return;
  }
  require_supported(options.plan, "jobs");
  robot.require_prepared_for(problem_of_run(job, {0, false}));
  const int count = episodes_to_plan(job.source, job.vary, options);
  if (count == 0) return;
  Executor executor(options.plan.threads);
  JobEpisodes planner(robot, job, options, row_done);
  executor.for_each(count, [&](int, int worker) { planner.plan_next(worker); });
}

void run_campaign(const Problem& cell, const CampaignOptions& options,
                  const std::function<void(const EpisodeRow&)>& row_done) {
  validate(cell);
  if (cell.arms.size() == 1) {
    run_campaign(PreparedRobot(problem_of_run(cell, {0, false})), cell, options, row_done);
    return;
  }
  require_supported(options.plan, "workcells");
  const int count = episodes_to_plan(cell.source, cell.vary, options);
  if (count == 0) return;
  Executor executor(options.plan.threads);
  WorkcellEpisodes planner(cell, options, row_done);
  executor.for_each(count, [&](int, int worker) { planner.plan_next(worker); });
}

}  // namespace swivel
