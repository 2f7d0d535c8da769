// SPDX-License-Identifier: BSD-3-Clause
#include "runs.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <tuple>
#include <variant>

#include "base/archive.hpp"
#include "base/interruptible.hpp"
#include "plan_keywords.hpp"
#include "problems/problem.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/study/grid_refinement.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/campaign.hpp"
#include "swivel/planner/study/place.hpp"

namespace swivel::python {

namespace {

std::string placement_words(const PlacementRow& row) {
  std::string text = formatted("%llu", static_cast<unsigned long long>(row.cell));
  for (std::size_t k = 0; k < kCoordinates.size(); ++k)
    if (row.offset[k] != 0) text += formatted(", %s %.6g", kCoordinates[k], row.offset[k]);
  for (const auto& [joint, position] : row.hold)
    text += ", " + joint + formatted(" at %.6g", position);
  if (row.status != PlanStatus::kSolved)
    return text + ": " + (row.reason.empty() ? "no path" : "no path, " + row.reason);
  text += formatted(": cost %.6g", *row.cost);
  if (row.clearance) text += formatted(", clearance %.1f mm", 1e3 * *row.clearance);
  if (row.joint_margin)
    text += formatted(", %.1f deg from a joint limit", *row.joint_margin * 180 / kPi);
  if (row.slide_margin)
    text += formatted(", %.1f mm from a slide's limit", 1e3 * *row.slide_margin);
  if (row.tool_speed) text += formatted(", tool speed up to %.3g m/s", *row.tool_speed);
  return text;
}

/// Returns an array for each joint that is varied, by its name.
std::map<std::string, py::array_t<double>> held_columns(const Placements& table) {
  std::map<std::string, py::array_t<double>> columns;
  const auto size = static_cast<py::ssize_t>(table.rows->size());
  for (py::ssize_t k = 0; k < size; ++k)
    for (const auto& [joint, position] : (*table.rows)[static_cast<std::size_t>(k)].hold) {
      py::array_t<double>& column = columns.try_emplace(joint, size).first->second;
      column.mutable_at(k) = position;
    }
  return columns;
}

std::vector<PlacementCriterion> to_criteria(const std::vector<std::string>& names) {
  if (names.empty())
    throw InvalidArgument("best: no criterion: allowed are clearance, cost, margin, slide, speed");
  std::vector<PlacementCriterion> criteria;
  for (const std::string& name : names) criteria.push_back(placement_criterion_from_string(name));
  return criteria;
}

void bind_tables(py::module_& m) {
  py::class_<PlacementRow>(m, "Placement", "What became of one placement. None: does not apply.")
      .def(pickling<PlacementRow>())
      .def_readonly("cell", &PlacementRow::cell, "Its number.")
      .def_property_readonly(
          "offset",
          [](const PlacementRow& r) {
            return py::array_t<double>(py::ssize_t{6}, r.offset.data());
          },
          "(6,): x y z (m) roll pitch yaw (rad), by how much the thing is moved.")
      .def_readonly("hold", &PlacementRow::hold,
                    "Positions of the joints that are varied, by name, rad or m.")
      .def_readonly("status", &PlacementRow::status, "Status.")
      .def_property_readonly("solved",
                             [](const PlacementRow& r) { return r.status == PlanStatus::kSolved; })
      .def_readonly("cost", &PlacementRow::cost)
      .def_readonly("clearance", &PlacementRow::clearance,
                    "m, of the pair that comes nearest to what it must keep.")
      .def_readonly("clearance_margin", &PlacementRow::clearance_margin,
                    "m, that less what the pair must keep.")
      .def_readonly("joint_margin", &PlacementRow::joint_margin,
                    "rad, to the nearest limit of a joint that turns.")
      .def_readonly("slide_margin", &PlacementRow::slide_margin,
                    "m, to the nearer limit of a joint that slides.")
      .def_readonly("tool_speed", &PlacementRow::tool_speed,
                    "m/s, highest constant speed of the tool.")
      .def_readonly("failed_s", &PlacementRow::failed_s, "m, where every path ends.")
      .def_readonly("cause", &PlacementRow::cause, "Of that: the name of a CauseKind, or ''.")
      .def_readonly("by", &PlacementRow::by,
                    "The scene object in the way, else the joint or the two bodies.")
      .def_readonly("reason", &PlacementRow::reason, "The same in words.")
      .def_readonly("checked", &PlacementRow::checked,
                    "Whether the answer was proved; None unless solved.")
      .def("__repr__",
           [](const PlacementRow& r) { return "<Placement " + placement_words(r) + ">"; });
  bind_table<Placements>(
      m, "Placements",
      "Placements in the order of their numbers: Placement by Placement, or as arrays.")
      .def_property_readonly(
          "cell", [](const Placements& t) { return plain(t, &PlacementRow::cell); },
          "(n,) uint64, numbers.")
      .def_property_readonly(
          "offset",
          [](const Placements& t) {
            return column(t.rows,
                          t.rows->empty() ? static_cast<const double*>(nullptr)
                                          : t.rows->front().offset.data(),
                          6);
          },
          "(n, 6): x y z (m) roll pitch yaw (rad).")
      .def_property_readonly(
          "hold", &held_columns,
          "Positions of the joints that are varied, by name, each (n,), rad or m.")
      .def_property_readonly(
          "clearance", [](const Placements& t) { return numbers(t, &PlacementRow::clearance); },
          "(n,), m; as cost.")
      .def_property_readonly(
          "clearance_margin",
          [](const Placements& t) { return numbers(t, &PlacementRow::clearance_margin); },
          "(n,), m; as cost.")
      .def_property_readonly(
          "joint_margin",
          [](const Placements& t) { return numbers(t, &PlacementRow::joint_margin); },
          "(n,), rad; as cost.")
      .def_property_readonly(
          "slide_margin",
          [](const Placements& t) { return numbers(t, &PlacementRow::slide_margin); },
          "(n,), m; as cost.")
      .def_property_readonly(
          "tool_speed", [](const Placements& t) { return numbers(t, &PlacementRow::tool_speed); },
          "(n,), m/s; as cost.")
      .def_property_readonly(
          "cause", [](const Placements& t) { return texts(t, &PlacementRow::cause); },
          "Names of CauseKinds.")
      .def_property_readonly(
          "by", [](const Placements& t) { return texts(t, &PlacementRow::by); },
          "The object, joint or bodies in the way.")
      .def(
          "best",
          [](const Placements& t, const std::variant<std::string, std::vector<std::string>>& by,
             std::size_t count) {
            const auto* const one = std::get_if<std::string>(&by);
            return best_placements(
                *t.rows, to_criteria(one != nullptr ? std::vector{*one} : std::get<1>(by)), count);
          },
          py::arg("by") = "cost", py::arg("count") = 10,
          "Those that have a path, the best first. by: 'clearance', 'cost', 'margin', 'slide' or "
          "'speed', "
          "or several, each of which "
          "settles\n"
          "the ties of those before.");

  py::class_<EpisodeRow>(m, "Episode",
                         "What became of one episode of a campaign. None: does not apply.")
      .def(pickling<EpisodeRow>())
      .def_readonly("episode", &EpisodeRow::episode, "Its number.")
      .def_readonly("status", &EpisodeRow::status, "Status.")
      .def_property_readonly("solved",
                             [](const EpisodeRow& r) { return r.status == PlanStatus::kSolved; })
      .def_readonly("cost", &EpisodeRow::cost)
      .def_readonly("plan_ms", &EpisodeRow::plan_ms)
      .def_readonly("nodes_checked", &EpisodeRow::nodes_checked)
      .def_readonly("fcl_calls", &EpisodeRow::fcl_calls)
      .def_readonly("tool_path_error_mm_mean", &EpisodeRow::tool_path_error_mm_mean)
      .def_readonly("tool_path_error_mm_max", &EpisodeRow::tool_path_error_mm_max)
      .def_readonly("failed_s", &EpisodeRow::failed_s, "m, where every path ends.")
      .def_readonly("cause", &EpisodeRow::cause, "What ends them: the cause's kind.")
      .def_readonly("by", &EpisodeRow::by, "The object or joint that ends them.")
      .def_readonly("reason", &EpisodeRow::reason, "What ends them, in words.")
      .def_readonly("checked", &EpisodeRow::checked,
                    "Whether the answer was proved; None unless solved.")
      .def_readonly("offsets", &EpisodeRow::offsets, "Of the coordinates that vary, m and rad.")
      .def("__repr__", [](const EpisodeRow& r) {
        return formatted("<Episode %llu: ", static_cast<unsigned long long>(r.episode)) +
               (r.cost ? formatted("cost %.6g", *r.cost) : "no path, " + r.reason) +
               formatted(", %.1f ms>", r.plan_ms);
      });
  bind_table<Episodes>(
      m, "Episodes",
      "Episodes of a campaign in the order of their numbers: Episode by Episode, or as arrays.")
      .def_property_readonly(
          "episode", [](const Episodes& t) { return plain(t, &EpisodeRow::episode); },
          "(n,) uint64, numbers.")
      .def_property_readonly(
          "plan_ms", [](const Episodes& t) { return plain(t, &EpisodeRow::plan_ms); }, "(n,)")
      .def_property_readonly(
          "nodes_checked", [](const Episodes& t) { return plain(t, &EpisodeRow::nodes_checked); },
          "(n,) int64")
      .def_property_readonly(
          "fcl_calls", [](const Episodes& t) { return plain(t, &EpisodeRow::fcl_calls); },
          "(n,) int64")
      .def_property_readonly(
          "tool_path_error_mm_mean",
          [](const Episodes& t) { return numbers(t, &EpisodeRow::tool_path_error_mm_mean); },
          "(n,), mm; as cost.")
      .def_property_readonly(
          "tool_path_error_mm_max",
          [](const Episodes& t) { return numbers(t, &EpisodeRow::tool_path_error_mm_max); },
          "(n,), mm; as cost.");
}

// --- parts of place() and campaign() of the package

/// A coordinate as given in Python: a number, (from, to) of samples, or (from, to, step).
using Range = std::variant<double, std::array<double, 2>, std::array<double, 3>>;
/// A joint that is held, with the least and the greatest of its positions.
using HeldRange = std::tuple<std::string, double, double>;

/// The cells that are asked for: those of a grid, or a sample of places between the ends of its
/// axes.
class Cells {
 public:
  /// `hold`: ranges of the joints that are held, by name.
  Cells(const std::array<std::optional<Range>, 6>& ranges, const py::dict& hold,
        std::optional<std::uint64_t> sample, std::uint64_t seed)
      : grid_(axes_of(ranges, hold, sample.has_value())), sample_(sample), seed_(seed) {
    constexpr std::uint64_t kMost = 1'000'000;
    if (size() < 1 || size() > kMost)
      throw InvalidArgument((sample ? "sample: " : "the grid: ") + std::to_string(size()) +
                            " placements: allowed are 1 to " + std::to_string(kMost));
  }
  [[nodiscard]] std::uint64_t size() const { return sample_ ? *sample_ : grid_.size(); }
  /// Returns the joints that are held, with the least and the greatest of their positions.
  [[nodiscard]] std::vector<HeldRange> joints() const {
    std::vector<HeldRange> joints;
    for (const PlacementAxis& axis : grid_.axes())
      if (!axis.joint.empty())
        joints.emplace_back(axis.joint, axis.from, sample_ ? axis.to : axis.at(axis.count - 1));
    return joints;
  }
  /// Returns the offsets of cells, with the positions of joints() behind them.
  [[nodiscard]] py::array_t<double> offsets(const std::vector<std::uint64_t>& numbers) const {
    const std::vector<HeldRange> held = joints();
    py::array_t<double> array(
        {static_cast<py::ssize_t>(numbers.size()), static_cast<py::ssize_t>(6 + held.size())});
    double* out = array.mutable_data();
    for (const std::uint64_t cell : numbers) {
      const Placement at =
          sample_ ? sampled_placement(grid_.axes(), seed_, cell) : grid_.placement(cell);
      out = std::copy(at.offset.begin(), at.offset.end(), out);
      for (const auto& [joint, low, high] : held) *out++ = at.hold.at(joint);
    }
    return array;
  }
  [[nodiscard]] GridRefinement refinement(const std::vector<std::string>& best) const {
    if (sample_)
      throw InvalidArgument("refine_grid: a sample has no neighbours: allowed without sample");
    return {grid_, to_criteria(best)};
  }

 private:
  static std::vector<PlacementAxis> axes_of(const std::array<std::optional<Range>, 6>& ranges,
                                            const py::dict& hold, bool sample) {
    std::vector<PlacementAxis> axes;
    for (const auto& [name, range] : hold) {
      const auto joint = name.cast<std::string>();
      axes.push_back(axis_of(
          "hold: '" + joint + "'", range.cast<Range>(), sample,
          [&](double from, double to, double step) { return held_axis(joint, from, to, step); }));
    }
    for (std::size_t k = 0; k < ranges.size(); ++k)
      if (ranges[k])
        axes.push_back(
            axis_of(kCoordinates[k], *ranges[k], sample, [&](double from, double to, double step) {
              return placement_axis(static_cast<int>(k), from, to, step);
            }));
    if (axes.empty())
      throw InvalidArgument(
          "x, y, z, roll, pitch, yaw, hold: none is given: allowed are one or more of them");
    return axes;
  }
  template <class Make>
  static PlacementAxis axis_of(const std::string& name, const Range& range, bool sample,
                               const Make& make) {
    if (const auto* const one = std::get_if<double>(&range)) return make(*one, *one, 0);
    if (const auto* const two = std::get_if<std::array<double, 2>>(&range)) {
      if (!sample)
        throw InvalidArgument(name + ": allowed is a number, or (from, to, step), without sample");
      return make((*two)[0], (*two)[1], 0);
    }
    const auto& [from, to, step] = std::get<2>(range);
    if (!(step > 0)) throw InvalidArgument(name + ": allowed is a step > 0");
    if (sample) throw InvalidArgument(name + ": allowed is a number, or (from, to), with sample");
    return make(from, to, step);
  }

  PlacementGrid grid_;
  std::optional<std::uint64_t> sample_;
  std::uint64_t seed_;
};

/// Plans placements of one thing; of a problem with a planner that remembers earlier plans.
class Placer {
 public:
  Placer(swivel::Problem planned, Movable thing, std::vector<HeldRange> joints,
         const py::object& planner, int threads, std::optional<double> timeout, bool prove)
      : planned_(std::move(planned)),
        thing_(std::move(thing)),
        joints_(std::move(joints)),
        options_(to_plan_options(planner, threads, timeout, prove)) {
    static_cast<void>(placed_problem(planned_, thing_, {}));
    for (const auto& [joint, low, high] : joints_)
      for (const double position : {low, high})
        static_cast<void>(held_as(planned_, {{joint, position}}));
  }
  Placements plan(const std::vector<std::uint64_t>& cells,
                  const py::array_t<double, py::array::c_style>& offsets, const py::object& each) {
    if (offsets.ndim() != 2 || offsets.shape(0) != static_cast<py::ssize_t>(cells.size()) ||
        offsets.shape(1) != static_cast<py::ssize_t>(6 + joints_.size()))
      throw py::value_error("offsets: allowed is (n, 6 + joints)");
    std::vector<PlacementCell> wanted(cells.size());
    for (std::size_t k = 0; k < cells.size(); ++k) {
      wanted[k].cell = cells[k];
      const double* in = offsets.data(static_cast<py::ssize_t>(k), 0);
      std::copy_n(in, 6, wanted[k].offset.begin());
      in += 6;
      for (const auto& [joint, low, high] : joints_) wanted[k].hold[joint] = *in++;
    }
    std::function<void(const PlacementRow&)> done;
    if (!each.is_none())
      done = [tell = each.ptr()](const PlacementRow& row) {
        const py::gil_scoped_acquire gil;
        py::reinterpret_borrow<py::object>(tell)(to_table(std::vector{row}));
      };
    return to_table(interruptible([&](const std::stop_token& stop) {
      if (!planner_) {
        PlanOptions options = options_;
        options.stop = stop_.get_token();
        const auto robot = prepare_robot(planned_, Budget({}, nullptr, stop));
        if (robot)
          planner_.emplace(robot, planned_, thing_, options);
        else
          planner_.emplace(planned_, thing_, options);
      }
      const std::stop_callback pass_on(stop, [&] { stop_.request_stop(); });
      return planner_->plan(wanted, done);
    }));
  }
  [[nodiscard]] bool stopped() const { return planner_ && planner_->stopped(); }

 private:
  swivel::Problem planned_;
  Movable thing_;
  std::vector<HeldRange> joints_;
  PlanOptions options_;
  // Stops all plans, because the planner keeps the options with which it was made.
  std::stop_source stop_;
  std::optional<PlacementPlanner> planner_;
};

/// Plans episodes of one campaign.
class Campaigner {
 public:
  Campaigner(swivel::Problem planned, std::uint64_t episodes, std::uint64_t seed,
             const py::object& planner, int threads, bool prove)
      : planned_(std::move(planned)) {
    constexpr std::uint64_t kMost = 10'000'000;
    if (episodes < 1 || episodes > kMost)
      throw InvalidArgument("episodes: " + std::to_string(episodes) + ": allowed are 1 to " +
                            std::to_string(kMost));
    options_.episodes = episodes;
    options_.seed = seed;
    options_.plan = to_plan_options(planner, threads, {}, prove);
  }
  Episodes plan(const Shard& shard, const py::object& each) {
    const std::vector<std::string> coordinates = varied_coordinates(planned_.vary);
    return to_table(interruptible([&](const std::stop_token& stop) {
                      if (!robot_) robot_ = prepare_robot(planned_, Budget({}, nullptr, stop));
                      CampaignOptions options = options_;
                      options.shard = shard;
                      options.plan.stop = stop;
                      std::vector<EpisodeRow> rows;
                      const auto row_done = [&](const EpisodeRow& row) {
                        rows.push_back(row);
                        if (each.ptr() == Py_None) return;
                        const py::gil_scoped_acquire gil;
                        each(to_table(std::vector{row}, coordinates));
                      };
                      if (robot_)
                        run_campaign(*robot_, planned_, options, row_done);
                      else
                        run_campaign(planned_, options, row_done);
                      return rows;
                    }),
                    coordinates);
  }

 private:
  swivel::Problem planned_;
  CampaignOptions options_;
  std::shared_ptr<const PreparedRobot> robot_;
};

void bind_parts(py::module_& m) {
  py::class_<GridRefinement>(m, "_Refinement")
      .def("next", &GridRefinement::next)
      .def("learn", [](GridRefinement& self, const Placements& rows) {
        for (const PlacementRow& row : *rows.rows) self.learn(row);
      });
  py::class_<Cells>(m, "_Cells")
      .def(py::init<const std::array<std::optional<Range>, 6>&, const py::dict&,
                    std::optional<std::uint64_t>, std::uint64_t>())
      .def("__len__", &Cells::size)
      .def("joints", &Cells::joints)
      .def("offsets", &Cells::offsets)
      .def("refinement", &Cells::refinement);
  py::class_<Placer>(m, "_Placer")
      .def(py::init([](const Problem& problem, const std::optional<std::string>& object, bool path,
                       bool base, bool only_held, const std::optional<std::string>& arm,
                       std::vector<HeldRange> joints, const py::object& planner, int threads,
                       std::optional<double> timeout, bool prove) {
        return std::make_unique<Placer>(to_core(problem),
                                        to_movable(object, path, base, only_held, arm),
                                        std::move(joints), planner, threads, timeout, prove);
      }))
      .def("plan", &Placer::plan)
      .def_property_readonly("stopped", &Placer::stopped);
  py::class_<Campaigner>(m, "_Campaigner")
      .def(py::init([](const Problem& problem, std::uint64_t episodes, std::uint64_t seed,
                       const py::object& planner, int threads, bool prove) {
        return std::make_unique<Campaigner>(to_core(problem), episodes, seed, planner, threads,
                                            prove);
      }))
      .def("plan",
           [](Campaigner& self, std::uint64_t index, std::uint64_t count, const py::object& each) {
             return self.plan({index, count}, each);
           });
}

}  // namespace

std::shared_ptr<const PreparedRobot> prepare_robot(const swivel::Problem& planned,
                                                   const Budget& budget) {
  if (planned.arms.size() == 2) return nullptr;
  return std::make_shared<const PreparedRobot>(problem_of_run(planned, {0, false}), budget);
}

void bind_runs(py::module_& m) {
  bind_tables(m);
  bind_parts(m);
}

}  // namespace swivel::python
