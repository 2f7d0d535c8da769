// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/study/campaign.hpp"

#include <atomic>
#include <limits>
#include <map>
#include <mutex>
#include <new>
#include <string>

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

  PlanOptions single = options.plan;
  single.threads = 1;
  single.evidence = {.tool_path_error = true};  // a column
  single.progress = nullptr;

  Executor executor(options.plan.threads);
  std::vector<Planner> planners;  // by worker
  for (int worker = 0; worker < executor.threads(); ++worker)
    planners.emplace_back(prepared, problem);
  InOrder in_order(options.skip, row_done);
  const auto add = [&](std::uint64_t k, EpisodeRow row) {
    row.offsets = episode_offsets(problem.vary, options.seed, row.episode);
    in_order.add(k, std::move(row));
  };
  // Episodes come from a counter and not from the executor's index, which starts threads far apart:
  // rows would wait for long, and be lost if the process is killed.
  std::atomic<std::uint64_t> next{options.skip};
  std::atomic<bool> stopped{false};
  executor.for_each(static_cast<int>(size - options.skip), [&](int, int worker) {
    if (stopped || single.budget().cancelled()) return;
    const std::uint64_t k = next++;
    const std::uint64_t episode = options.shard.episode(k);
    try {
      PlanResult result;
      try {
        Planner& planner = planners[static_cast<std::size_t>(worker)];
        planner.set_problem(episode_problem(problem, options.seed, episode));
        result = planner.plan(single);
      } catch (const InputError&) {
        throw;
      } catch (const std::bad_alloc&) {
        throw;
      } catch (const std::exception& error) {  // must not take the other episodes with it
        add(k, EpisodeRow(episode, error.what()));
        return;
      }
      const bool answered =
          result.status == PlanStatus::kSolved
              ? result.evidence.tool_path_error
              : result.status == PlanStatus::kInfeasible && result.diagnosis.complete;
      // The plan was stopped, maybe with its verdict known and its columns not.
      if (!answered) {
        stopped = true;
        return;
      }
      if (options.planned) options.planned(episode, result);
      add(k, EpisodeRow(episode, result, problem));
    } catch (const InputError& error) {
      stopped = true;
      throw InputError(std::string(error.what()) + " (episode " + std::to_string(episode) + ")");
    } catch (...) {
      stopped = true;
      throw;
    }
  });
}

}  // namespace swivel
