// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/verify/complete_rows.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>

#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/kinematics/srs/arm_angle.hpp"
#include "swivel/core/lattice/kinds/arc_lattice.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "verify/check_rates.hpp"
#include "verify/given_ends.hpp"
#include "verify/path_following.hpp"
#include "verify/places_on_path.hpp"

namespace swivel {

namespace {

template <class... Values>
[[noreturn]] void refuse(const char* format, Values... values) {
  throw InputError(formatted(format, values...));
}

class Completion {
 public:
  /// Finds the places of the rows. `of_motion`: rows are samples in time, which may be anywhere
  /// between layers. Throws InputError if the last joint is not stated and is not the roll.
  Completion(const PreparedRobot& robot, const PathProblem& problem,
             std::vector<TrajectoryRow> rows, const Stated& stated, bool of_motion,
             const Budget& budget)
      : stated_(stated),
        of_motion_(of_motion),
        budget_(budget),
        chain_(robot.arm().chain),
        class_(robot.arm_class()),
        rows_(std::move(rows)),
        path_(problem_path(problem, chain_, budget)),
        first_turn_(problem.start ? (*problem.start)[kDof - 1] : 0),
        any_turn_(path_.has_waypoint_turns() ||
                  (chain_.roll ? !stated.last_joint : chain_.free_roll && !stated.roll)),
        places_(path_, problem.smooth.has_value(), problem.smooth ? problem.smooth->position : 0,
                any_turn_) {
    if (!stated.last_joint && !chain_.roll)
      refuse("joint '%s' is missing: allowed are trajectories with all joints of the arm",
             chain_.joint_names.back().c_str());
    find_places();
  }
  Completion(const Completion&) = delete;
  Completion& operator=(const Completion&) = delete;

  /// Returns the number of rows whose tool is nowhere on the path.
  [[nodiscard]] std::ptrdiff_t off_path() const {
    return std::count(on_path_.begin(), on_path_.end(), false);
  }

  /// Returns the rows, completed with what was not stated. Call once.
  std::vector<TrajectoryRow> rows() {
    label();
    return counted_from_waypoints();
  }

  /// Returns completed rows at the layers of the path, as rows_at_layers() describes. Call once.
  std::vector<TrajectoryRow> at_layers() {
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      if (!on_path_[k]) {
        const Pose there = pose_at(path_, place_[k]);
        const Pose tool =
            any_turn_ ? rolled(tools_[k], -roll_between(there, tools_[k])) : tools_[k];
        refuse("row %zu: the tool is %.3g m and %.3g rad from the path: allowed is 1e-6", k,
               (there.translation() - tool.translation()).norm(),
               Eigen::AngleAxisd(there.linear().transpose() * tool.linear()).angle());
      }
      if (k > 0 && place_[k] < place_[k - 1])
        refuse(
            "rows %zu-%zu: the tool goes back on its path, from s = %.9g to %.9g: allowed are rows "
            "in its order",
            k - 1, k, places_.s_at(place_[k - 1]), places_.s_at(place_[k]));
    }
    const int last = path_.size() - 1;
    if (rows_.size() < 2 || place_.front() > 0 || place_.back() < last)
      refuse(
          "the rows do not reach from the path's beginning to its end: allowed are rows along all "
          "of it");
    label();
    const bool at_layers =
        std::all_of(place_.begin(), place_.end(),
                    [](double place) { return place == std::floor(place); }) &&
        std::adjacent_find(place_.begin(), place_.end(), std::greater_equal<>()) == place_.end();
    if (at_layers) return counted_from_waypoints();
    std::vector<TrajectoryRow> laid;
    std::vector<std::size_t> made;
    std::size_t k = 0;  // the last row at or before the layer
    for (int layer = 0; layer <= last; ++layer) {
      budget_.poll();
      while (k + 1 < rows_.size() && place_[k + 1] <= layer) ++k;
      if (place_[k] < layer) made.push_back(laid.size());
      laid.push_back(place_[k] < layer ? between(k, layer) : rows_[k]);
      laid.back().s = path_.layer(layer).s;
    }
    rows_ = std::move(laid);
    place_.resize(rows_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) place_[i] = static_cast<double>(i);
    stated_.phi = stated_.branch = false;
    if (class_.srs && planes_.empty()) planes_ = carried_planes(*class_.srs, path_, budget_);
    for (const std::size_t i : made) label_posture(i);
    return counted_from_waypoints();
  }

 private:
  struct Link {
    double place = 0;
    std::size_t row = 0;
    std::ptrdiff_t before = -1;
  };

  /// Returns the rows, whose rolls are counted from the frames of the path since label(), as rows
  /// have them. Call once.
  std::vector<TrajectoryRow> counted_from_waypoints() {
    for (std::size_t k = 0; k < rows_.size(); ++k)
      rows_[k] = swivel::counted_from_waypoints(chain_, path_, travel(place_[k]), rows_[k]);
    return std::move(rows_);
  }

  /// Returns the tool's pose without the turn that the file states.
  [[nodiscard]] Pose tool_of(const TrajectoryRow& row) const {
    Config q = row.q;
    if (!stated_.last_joint) q[kDof - 1] = 0;
    const Pose tool = chain_.tool(q);
    return chain_.free_roll && stated_.roll ? rolled(tool, -row.roll) : tool;
  }

  void find_places() {
    const std::size_t n = rows_.size();
    place_.assign(n, 0);
    on_path_.assign(n, false);
    std::vector<std::vector<double>> fits(n);
    for (std::size_t k = 0; k < n; ++k) {
      budget_.poll();
      tools_.push_back(rows_[k].q.allFinite() ? tool_of(rows_[k]) : Pose::Identity());
      if (!rows_[k].q.allFinite()) continue;
      fits[k] = stated_.s ? places_.fits(tools_[k], rows_[k].s) : places_.fits(tools_[k]);
      on_path_[k] = !fits[k].empty();
    }
    const std::vector<bool> in_order = match(fits);
    // The other rows get places between those of their neighbours.
    const double end = path_.size() - 1;
    std::vector<double> next(n + 1, end);
    for (std::size_t k = n; k-- > 0;) next[k] = in_order[k] ? place_[k] : next[k + 1];
    double before = 0;
    for (std::size_t k = 0; k < n; ++k) {
      if (in_order[k]) {
        before = place_[k];
        continue;
      }
      budget_.poll();
      if (on_path_[k]) {
        const auto beyond = [&](double place) {
          return std::max({before - place, place - next[k], 0.0});
        };
        place_[k] = *std::min_element(fits[k].begin(), fits[k].end(),
                                      [&](double a, double b) { return beyond(a) < beyond(b); });
        // The place may be out of order by rounding alone.
        const double inside = std::clamp(place_[k], before, next[k]);
        if (std::abs(places_.s_at(inside) - places_.s_at(place_[k])) <= kSameS &&
            places_.fits_at(tools_[k], inside))
          before = place_[k] = inside;
      } else if (stated_.s) {
        place_[k] = std::isfinite(rows_[k].s) ? places_.place_at(rows_[k].s) : 0;
      } else if (rows_[k].q.allFinite()) {
        place_[k] = places_.nearest(tools_[k], before, next[k]);
      }
    }
    for (std::size_t k = 0; k < n; ++k)
      if (on_path_[k]) move_to_layer(k);
  }

  /// Gives as many rows as possible places that never go back along the path: the longest
  /// non-decreasing sequence with at most one of the places of each row. If there are several, each
  /// row comes as early on the path as possible. Returns which rows have got places.
  std::vector<bool> match(const std::vector<std::vector<double>>& fits) {
    std::vector<Link> links;
    // for each length, the end of the sequence that ends earliest
    std::vector<std::ptrdiff_t> ends;
    for (std::size_t k = 0; k < fits.size(); ++k)
      for (auto place = fits[k].rbegin(); place != fits[k].rend(); ++place) {
        const auto end = std::upper_bound(
            ends.begin(), ends.end(), *place, [&](double value, std::ptrdiff_t link) {
              return value < links[static_cast<std::size_t>(link)].place;
            });
        links.push_back({*place, k, end == ends.begin() ? -1 : *(end - 1)});
        const auto link = static_cast<std::ptrdiff_t>(links.size()) - 1;
        if (end == ends.end())
          ends.push_back(link);
        else
          *end = link;
      }
    std::vector<bool> in_order(fits.size(), false);
    for (std::ptrdiff_t at = ends.empty() ? -1 : ends.back(); at >= 0;
         at = links[static_cast<std::size_t>(at)].before) {
      const Link& link = links[static_cast<std::size_t>(at)];
      place_[link.row] = link.place;
      in_order[link.row] = true;
    }
    return in_order;
  }

  /// Moves row k to a layer whose pose its tool has, unless the row belongs to a timed motion or
  /// other rows are so near that they could be at the layer as well.
  void move_to_layer(std::size_t k) {
    const double layer = std::round(place_[k]);
    if (place_[k] == layer || !places_.fits_at(tools_[k], layer)) return;
    const auto is_near = [&](std::size_t other) {
      constexpr double kSamePlace = 4 * PlacesOnPath::kOnPath;
      return (tools_[k].translation() - tools_[other].translation()).norm() < kSamePlace &&
             Eigen::AngleAxisd(tools_[k].linear().transpose() * tools_[other].linear()).angle() <
                 kSamePlace;
    };
    const bool at_end =
        (k == 0 && layer == 0) || (k + 1 == rows_.size() && layer == path_.size() - 1);
    const bool alone =
        !of_motion_ && (k == 0 || !is_near(k - 1)) && (k + 1 == rows_.size() || !is_near(k + 1));
    if (at_end || alone ||
        std::abs(place_[k] - layer) * path_.layer(static_cast<int>(place_[k])).step_length <=
            kSameS)
      place_[k] = layer;
  }

  [[nodiscard]] double travel(double place) const { return travel_at(path_, place); }

  /// Returns a row at a layer between row k and the next row. Throws InputError if Newton's method
  /// finds no joints near those between the two.
  [[nodiscard]] TrajectoryRow between(std::size_t k, int layer) const {
    const double begin = travel(place_[k]),
                 share = (travel(layer) - begin) / (travel(place_[k + 1]) - begin);
    TrajectoryRow row = rows_[k];
    const double turn = rows_[k + 1].roll - row.roll;
    if (chain_.free_roll)
      row.roll += share * (chain_.free_roll->circle() ? wrap_angle(turn) : turn);
    const Pose& there = path_.layer(layer).tool;
    const Pose goal = chain_.free_roll ? rolled(there, row.roll) : there;
    const Config straight = row.q + share * (rows_[k + 1].q - row.q);
    row.q = straight;
    constexpr int kMostSteps = 20;
    constexpr double kReached = 1e-11, kFarthest = 0.5;  // m and rad; rad
    for (int step = 0; step < kMostSteps; ++step) {
      const Pose tool = chain_.tool(row.q);
      const Eigen::AngleAxisd turned(goal.linear() * tool.linear().transpose());
      Eigen::Matrix<double, 6, 1> off;
      off << goal.translation() - tool.translation(), turned.angle() * turned.axis();
      if (off.norm() <= kReached) return row;
      row.q += Config(chain_.jacobian(row.q).completeOrthogonalDecomposition().solve(off));
      if (!((row.q - straight).lpNorm<Eigen::Infinity>() <= kFarthest)) break;
    }
    refuse(
        "rows %zu-%zu: no joints near those between them lead to s = %.9g: allowed are rows nearer "
        "to each other",
        k, k + 1, path_.layer(layer).s);
  }

  /// Returns the angle plus the number of whole turns that brings it nearest to `other`, within
  /// bounds if there are any.
  [[nodiscard]] static double image_near(double angle, double other,
                                         const std::optional<Roll>& bounds) {
    const double nearest = other + wrap_angle(angle - other);
    if (!bounds) return nearest;
    constexpr double kBound = 1e-6;  // rad
    std::optional<double> best;
    for (double image = angle + kTwoPi * std::ceil((bounds->lower - kBound - angle) / kTwoPi);
         image <= bounds->upper + kBound; image += kTwoPi)
      if (!best || std::abs(image - other) < std::abs(*best - other)) best = image;
    return best.value_or(nearest);
  }

  void label() {
    if (class_.srs && !stated_.phi) planes_ = carried_planes(*class_.srs, path_, budget_);
    for (std::size_t k = 0; k < rows_.size(); ++k)
      if (rows_[k].q.allFinite()) label(k);
  }

  void label(std::size_t k) {
    TrajectoryRow& row = rows_[k];
    const Pose there = pose_at(path_, place_[k]);
    TrajectoryRow counted = counted_from_path(chain_, path_, travel(place_[k]), row);
    if (chain_.roll ? stated_.last_joint : stated_.roll) row.q = counted.q, row.roll = counted.roll;
    if (chain_.roll && stated_.phi) row.phi = counted.phi;
    if (!stated_.s) row.s = places_.s_at(place_[k]);
    if (!stated_.last_joint) {
      const JointLimit& limit = chain_.limit.back();
      const std::optional<Roll> bounds =
          limit.continuous ? std::optional<Roll>() : Roll{limit.lower, limit.upper};
      row.q[kDof - 1] = image_near(roll_between(there, tools_[k]),
                                   k > 0 ? rows_[k - 1].q[kDof - 1] : first_turn_, bounds);
    }
    if (chain_.free_roll && !stated_.roll) {
      const Roll& range = *chain_.free_roll;
      const double roll = roll_between(there, tools_[k]);
      row.roll = range.circle() ? roll : image_near(roll, k > 0 ? rows_[k - 1].roll : 0, range);
    }
    label_posture(k);
  }

  /// Fills in arm angle and branch, if they are not stated.
  void label_posture(std::size_t k) {
    TrajectoryRow& row = rows_[k];
    if (class_.srs) {
      if (!stated_.branch) row.branch = class_.srs->branch(row.q);
      if (stated_.phi) return;
      const auto layer = static_cast<int>(std::floor(place_[k]));
      ArmPlane plane = planes_[static_cast<std::size_t>(layer)];
      const Pose there = pose_at(path_, place_[k]);
      if (layer < place_[k]) plane = carry_plane(*class_.srs, plane, there);
      if (chain_.free_roll) plane = carry_plane(*class_.srs, plane, rolled(there, row.roll));
      row.phi = arm_angle(*class_.srs, plane, row.q);
    } else {
      if (!stated_.phi) row.phi = arc_angle(chain_, row.q);
      if (!stated_.branch) row.branch = arc_branch(chain_, class_.lock, row.q);
    }
  }

  static constexpr double kSameS = 1e-9;  // m
  Stated stated_;
  bool of_motion_;
  const Budget& budget_;
  const Chain& chain_;
  const ArmClass& class_;
  std::vector<TrajectoryRow> rows_;
  ToolPath path_;
  // rad; if the last joint is not stated, its first value is the one nearest to this
  double first_turn_;
  bool any_turn_;
  PlacesOnPath places_;
  std::vector<Pose> tools_;
  std::vector<double> place_;
  std::vector<bool> on_path_;
  std::vector<ArmPlane> planes_;
};

}  // namespace

namespace {

/// Returns the rows placed on the problem's own path, or on the rounded path of
/// with_motion_defaults() if more of the rows are on that.
std::unique_ptr<Completion> completion_of(const PreparedRobot& robot, const PathProblem& problem,
                                          const std::vector<TrajectoryRow>& rows,
                                          const Stated& stated, bool of_motion,
                                          const Budget& budget) {
  validate(problem);
  robot.require_prepared_for(problem);
  auto own = std::make_unique<Completion>(robot, problem, rows, stated, of_motion, budget);
  if (problem.smooth || own->off_path() == 0) return own;
  try {
    auto rounded = std::make_unique<Completion>(robot, with_motion_defaults(problem), rows, stated,
                                                of_motion, budget);
    return rounded->off_path() < own->off_path() ? std::move(rounded) : std::move(own);
  } catch (const InputError&) {  // a given start that is not on that path
    return own;
  }
}

}  // namespace

std::vector<TrajectoryRow> complete_rows(const PreparedRobot& robot, const PathProblem& problem,
                                         std::vector<TrajectoryRow> rows, const Stated& stated,
                                         const Budget& budget) {
  return stated.rows() ? rows : completion_of(robot, problem, rows, stated, false, budget)->rows();
}

std::vector<TimedRow> complete_motion(const PreparedRobot& robot, const PathProblem& problem,
                                      std::vector<TimedRow> rows, const Stated& stated,
                                      const Budget& budget) {
  std::vector<TrajectoryRow> places;
  for (const TimedRow& row : rows) places.push_back(row.row);
  if (!stated.rows())
    places =
        completion_of(robot, with_motion_defaults(problem), places, stated, true, budget)->rows();
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k].row = places[k];
  complete_rates(rows, stated);
  return rows;
}

std::vector<TrajectoryRow> rows_at_layers(const PreparedRobot& robot, const PathProblem& problem,
                                          const std::vector<TrajectoryRow>& rows,
                                          const Stated& stated, const Budget& budget) {
  std::vector<TrajectoryRow> laid =
      completion_of(robot, problem, rows, stated, false, budget)->at_layers();
  const std::vector<std::string> faults = faults_of_given_ends(problem, robot.arm().chain, laid);
  if (!faults.empty()) refuse("%s: allowed are rows of this problem", faults.front().c_str());
  return laid;
}

}  // namespace swivel
