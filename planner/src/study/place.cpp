// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/study/place.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "measure/nearest_approach.hpp"
#include "study/study_planner.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/parallel/executor.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

/// The nearest approach of paths, by their margin; where one object alone moves, of pairs without
/// it once for each path, and with it on the rows that it may have come near to since.
class LeastMargins {
 public:
  /// `moved`: its number in the scene.
  explicit LeastMargins(std::optional<int> moved) : moved_(moved) {}
  std::optional<NearestApproach> of(const PlanView& view, const std::vector<TrajectoryRow>& rows,
                                    const Budget& budget) {
    if (!moved_) return nearest_approach(view.world, rows, Seek::kMargin, budget);
    Path& path = path_of(view, rows, budget);
    const Pose& pose = view.problem.scene[static_cast<std::size_t>(*moved_)].pose;
    std::vector<double> proved;
    for (const Proof& proof : path.proofs)
      proved.push_back(proof.margin == kNone
                           ? kNone
                           : proof.margin - view.world.displacement(*moved_, proof.pose, pose));
    const auto before = proved;
    const World with_it(view.world, std::vector<int>{*moved_});
    const auto nearest =
        nearest_approach(with_it, rows, Seek::kMargin, budget, path.without_it, &proved);
    for (std::size_t row = 0; row < proved.size(); ++row)
      if (proved[row] != before[row]) path.proofs[row] = {proved[row], pose};
    return nearest;
  }

 private:
  static constexpr double kNone = -std::numeric_limits<double>::infinity();
  /// What the margin of the object's pairs on a row was proved to be at least, where the object
  /// stood.
  struct Proof {
    double margin = kNone;
    Pose pose = Pose::Identity();
  };
  struct Path {
    std::optional<NearestApproach> without_it;
    std::vector<Proof> proofs;  // by row
  };
  Path& path_of(const PlanView& view, const std::vector<TrajectoryRow>& rows,
                const Budget& budget) {
    std::vector<double> joints;
    for (const TrajectoryRow& row : rows)
      joints.insert(joints.end(), row.q.data(), row.q.data() + kMaxDof);
    auto known = paths_.find(joints);
    if (known != paths_.end()) return known->second;
    // Paths may be of many thousand rows.
    constexpr std::size_t kMostRows = 100'000;
    rows_ += rows.size();
    if (rows_ > kMostRows) {
      paths_.clear();
      rows_ = rows.size();
    }
    const World without_it(view.world, std::vector<int>{*moved_}, World::Pairs::kBut);
    return paths_
        .emplace(std::move(joints), Path{nearest_approach(without_it, rows, Seek::kMargin, budget),
                                         std::vector<Proof>(rows.size())})
        .first->second;
  }

  std::optional<int> moved_;
  std::map<std::vector<double>, Path> paths_;  // by the joints of all rows
  std::size_t rows_ = 0;                       // of all paths
};

namespace {

/// Returns the number of the object that is moved, where there is one path, which stays.
std::optional<int> alone_moved(const Problem& problem, const Movable& thing) {
  if (!is_path(problem) || thing.kind != Movable::Kind::kObject ||
      thing.object == problem.arm().path().path_frame)
    return std::nullopt;
  const auto found = std::find_if(problem.scene.begin(), problem.scene.end(),
                                  [&](const auto& o) { return o.name == thing.object; });
  return static_cast<int>(found - problem.scene.begin());
}

/// Lowers the clearance of a row to this one, if it comes nearer to what must be kept.
void take_least(const LeastMargin& margin, PlacementRow& row) {
  if (row.clearance_margin && *row.clearance_margin <= margin.margin) return;
  row.clearance = margin.clearance;
  row.clearance_margin = margin.margin;
}

/// Lowers what a row keeps and how fast its tool may be to what a stroke or an arm keeps and
/// allows.
void take_least(const Measures& measures, PlacementRow& row) {
  const auto lower = [](std::optional<double>& least, double value) {
    least = std::min(least.value_or(value), value);
  };
  if (measures.nearest_limit) lower(row.joint_margin, measures.nearest_limit->margin);
  if (measures.nearest_slide_limit) lower(row.slide_margin, measures.nearest_slide_limit->margin);
  if (measures.top_tool_speed) lower(row.tool_speed, measures.top_tool_speed->speed);
  if (measures.min_margin) take_least(*measures.min_margin, row);
}

/// Returns where a cell is, for messages.
std::string place_of(const PlacementCell& cell) {
  std::string text;
  const auto add = [&](const std::string& name, double value) {
    text += (text.empty() ? "" : ", ") + name + formatted(" %.9g", value);
  };
  for (std::size_t c = 0; c < kCoordinates.size(); ++c)
    if (cell.offset[c] != 0) add(kCoordinates[c], cell.offset[c]);
  text = text.empty() ? "" : "moved by " + text;
  for (const auto& [joint, position] : cell.hold) add(joint + " at", position);
  return text.empty() ? "moved by nothing" : text;
}

}  // namespace

struct PlacementPlanner::Impl {
  /// What one thread plans with, and where its robot's joints are held.
  struct Worker {
    std::shared_ptr<const PreparedRobot> robot;  ///< null for two arms
    Problem problem;
    HeldPositions hold;
    StudyPlanner planner;
    LeastMargins margins;
  };
  Problem problem;
  Movable thing;
  PlanOptions single;
  Executor executor;
  std::vector<Worker> workers;
  std::optional<std::chrono::steady_clock::time_point> deadline;
  std::atomic<bool> stopped{false};

  /// `robot`: as StudyPlanner takes it.
  Impl(const std::shared_ptr<const PreparedRobot>& robot, Problem of, Movable moved,
       const PlanOptions& options)
      : problem(std::move(of)),
        thing(std::move(moved)),
        single(options),
        executor(options.threads) {
    single.threads = 1;
    // The clearances of one path come from LeastMargins, which is faster.
    single.evidence = {.postures = !is_path(problem)};
    single.hooks = {};
    single.progress = nullptr;
    constexpr double kFar = 1e9;  // s; what no clock can measure never passes
    if (single.timeout_s && *single.timeout_s < kFar)
      deadline = std::chrono::steady_clock::now() +
                 std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                     std::chrono::duration<double>(*single.timeout_s));
    validate(problem);
    static_cast<void>(placed_problem(problem, thing, {}));
    for (int worker = 0; worker < executor.threads(); ++worker)
      workers.push_back(made(robot, problem, {}));
  }
  [[nodiscard]] Worker made(std::shared_ptr<const PreparedRobot> robot, const Problem& held,
                            HeldPositions hold) const {
    StudyPlanner planner(robot, held, single);
    return {std::move(robot), held, std::move(hold), std::move(planner),
            LeastMargins(alone_moved(problem, thing))};
  }
  /// Returns a worker, with the joints held as a cell has them.
  Worker& held(int number, const HeldPositions& hold, const Budget& budget) {
    Worker& worker = workers[static_cast<std::size_t>(number)];
    if (worker.hold == hold) return worker;
    Problem changed = problem;
    hold_joints(changed, hold);
    auto robot = worker.robot ? std::make_shared<const PreparedRobot>(
                                    problem_of_run(changed, {0, false}), budget)
                              : nullptr;
    return worker = made(std::move(robot), changed, hold);
  }

  [[nodiscard]] PlanOptions options_now() const {
    PlanOptions options = single;
    if (deadline)
      options.timeout_s = std::max(
          1e-9,
          std::chrono::duration<double>(*deadline - std::chrono::steady_clock::now()).count());
    return options;
  }
  /// Returns the row of a cell; none where it was stopped.
  std::optional<PlacementRow> plan(const PlacementCell& cell, int worker) {
    PlacementRow row;
    row.cell = cell.cell;
    row.offset = cell.offset;
    row.hold = cell.hold;
    try {
      if (!fill(row, worker)) return std::nullopt;
    } catch (const Stopped&) {
      return std::nullopt;
    } catch (const InputError&) {
      throw;
    } catch (
        const InvalidArgument& error) {  // of the placed problem: the one before it was a valid one
      throw InputError(error.what());
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {  // must not take the other cells with it
      row.status = PlanStatus::kError;
      row.reason = error.what();
    }
    return row;
  }
  /// Plans a placement, and fills in its row. Returns false if it was stopped.
  bool fill(PlacementRow& row, int worker) {
    const PlanOptions options = options_now();
    const Budget budget = options.budget();
    Worker& with = held(worker, row.hold, budget);
    const StudiedAnswer found =
        with.planner.plan(placed_problem(with.problem, thing, row.offset), options, budget);
    const Answer& answer = found.answer;
    if (!found.known(budget)) return false;
    row.status = answer.status;
    if (answer.status != PlanStatus::kSolved) {
      found.failure(problem).tell(row);
      return true;
    }
    row.cost = answer.cost;
    row.checked = answer.checked;
    for (const ArmAnswer& arm : answer.arms)
      for (const RunAnswer& run : arm.runs) take_least(run, row);
    if (answer.pair.nearest) take_least(*answer.pair.nearest, row);
    if (const Planner* const path = with.planner.planner())
      if (const auto least = with.margins.of(path->view(), answer.arm().rows(), budget))
        take_least({.margin = least->clearance.margin(), .clearance = least->clearance.distance},
                   row);
    return true;
  }
  /// Plans the cells of a problem of one path again and calls `found` after each that was answered.
  void plan_again(const std::vector<PlacementCell>& cells,
                  const std::function<void(const PlacementCell&, const PlanResult&, const PlanView&,
                                           const Worker&)>& found) {
    if (!is_path(problem)) return;
    for (const PlacementCell& cell : cells) {
      Worker& with = held(0, cell.hold, options_now().budget());
      Planner& planner = *with.planner.planner();
      planner.set_problem(
          problem_of_run(placed_problem(with.problem, thing, cell.offset), {0, false}));
      const PlanResult result = planner.plan(options_now());
      if (result.status == PlanStatus::kSolved || result.status == PlanStatus::kInfeasible)
        found(cell, result, planner.view(), with);
    }
  }
};

PlacementPlanner::PlacementPlanner(std::shared_ptr<const PreparedRobot> robot, PathProblem problem,
                                   Movable thing, PlanOptions options)
    : PlacementPlanner(std::move(robot), one_path(problem), std::move(thing), std::move(options)) {}
PlacementPlanner::PlacementPlanner(std::shared_ptr<const PreparedRobot> robot, Problem problem,
                                   Movable thing, PlanOptions options)
    : impl_(std::make_unique<Impl>(robot, std::move(problem), std::move(thing), options)) {}
PlacementPlanner::PlacementPlanner(Problem problem, Movable thing, PlanOptions options) {
  std::shared_ptr<const PreparedRobot> robot;
  if (problem.arms.size() == 1)
    robot = std::make_shared<const PreparedRobot>(problem_of_run(problem, {0, false}));
  impl_ = std::make_unique<Impl>(robot, std::move(problem), std::move(thing), options);
}
PlacementPlanner::PlacementPlanner(PlacementPlanner&&) noexcept = default;
PlacementPlanner& PlacementPlanner::operator=(PlacementPlanner&&) noexcept = default;
PlacementPlanner::~PlacementPlanner() = default;

bool PlacementPlanner::stopped() const {
  return impl_->stopped;
}

std::vector<PlacedPlan> PlacementPlanner::trajectories(const std::vector<PlacementCell>& cells) {
  std::vector<PlacedPlan> plans;
  impl_->plan_again(cells, [&](const PlacementCell& cell, const PlanResult& result,
                               const PlanView& view, const Impl::Worker& with) {
    if (result.status == PlanStatus::kSolved)
      plans.push_back({cell, view.problem.scene, result.trajectory, with.robot});
  });
  return plans;
}

void PlacementPlanner::plan_again(
    const std::vector<PlacementCell>& cells,
    const std::function<void(const PlacementCell&, const PlanResult&, const PlanView&)>& found) {
  impl_->plan_again(cells,
                    [&](const PlacementCell& cell, const PlanResult& result, const PlanView& view,
                        const Impl::Worker&) { found(cell, result, view); });
}

std::vector<PlacementRow> PlacementPlanner::plan(
    const std::vector<PlacementCell>& cells, const std::function<void(const PlacementRow&)>& done) {
  std::vector<std::optional<PlacementRow>> rows(cells.size());
  // Taken from a counter and not from the executor's index, which starts threads far apart:
  // neighbours are alike.
  std::atomic<std::size_t> next{0};
  std::mutex one_at_a_time;
  impl_->executor.for_each(static_cast<int>(cells.size()), [&](int, int worker) {
    if (impl_->stopped || impl_->options_now().budget().spent()) {
      impl_->stopped = true;
      return;
    }
    const std::size_t k = next++;
    try {
      rows[k] = impl_->plan(cells[k], worker);
      if (!rows[k]) impl_->stopped = true;
      if (!rows[k] || !done) return;
      const std::lock_guard lock(one_at_a_time);
      done(*rows[k]);
    } catch (const InputError& error) {
      impl_->stopped = true;
      throw InputError(std::string(error.what()) + " (" + place_of(cells[k]) + ")");
    } catch (...) {
      impl_->stopped = true;
      throw;
    }
  });
  std::vector<PlacementRow> known;
  for (std::optional<PlacementRow>& row : rows)
    if (row) known.push_back(std::move(*row));
  return known;
}

}  // namespace swivel
