// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/study/campaign.hpp"

#include <memory>
#include <string>

#include "study/plan_in_order.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

namespace {

/// `robot`: as StudyPlanner takes it.
void run(const std::shared_ptr<const PreparedRobot>& robot, const Problem& problem,
         const CampaignOptions& options, const std::function<void(const EpisodeRow&)>& row_done) {
  validate(problem);
  if (problem.vary.empty() && options.episodes > 1)
    throw InputError(problem.source,
                     "vary: missing, so that all episodes would be the same: allowed are a key "
                     "vary, or one episode");
  ManyOptions many;
  many.plan = options.plan;
  many.shard = options.shard;
  many.skip = options.skip;
  many.planned = options.planned;
  plan_in_order(
      robot, problem, options.episodes,
      [&](std::uint64_t episode) { return episode_problem(problem, options.seed, episode); }, many,
      [](std::uint64_t episode, const InputError& error) -> EpisodeRow {
        throw InputError(std::string(error.what()) + " (episode " + std::to_string(episode) + ")");
      },
      [&](EpisodeRow row) {
        row.offsets = episode_offsets(problem.vary, options.seed, row.episode);
        row_done(row);
      });
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
