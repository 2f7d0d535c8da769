// SPDX-License-Identifier: BSD-3-Clause
// Bindings of what is asked of single states: inverse kinematics of a pose, clearance of a batch.
#include "states.hpp"

#include <cmath>
#include <optional>

#include "base/bindings.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/closed_form/closed_form.hpp"
#include "swivel/core/kinematics/srs/arm_angle.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/problem/tool_path.hpp"
#include "swivel/planner/robot/planning_arm.hpp"

namespace swivel::python {

namespace {

/// The inverse kinematics of a robot, prepared once. A pose has one free coordinate besides: the
/// arm angle of S-R-S arms, else the value of one joint; of six joints without a roll nothing.
class Kinematics {
 public:
  explicit Kinematics(const Robot& robot) : arm_(planning_arm(robot)) {
    const LockMethod& lock = arm_.kind.lock;
    if (arm_.kind.srs) return;
    joint_ = chain().roll && lock.by_joint[kDof - 1] ? kDof - 1 : lock.best;
    if (joint_ < 0)
      throw py::value_error(
          "Kinematics: this arm has no closed form whichever joint is locked: allowed are arms of "
          "which `swivel info` says closed form");
  }

  [[nodiscard]] std::string coordinate() const {
    if (chain().roll_fixed) return "none";
    return arm_.kind.srs ? "arm angle" : chain().joint_names[static_cast<std::size_t>(joint_)];
  }
  [[nodiscard]] std::string method() const { return arm_.kind.method(); }
  [[nodiscard]] auto joint_names() const { return names_in(chain().joint_names); }

  /// Returns the free coordinate of each state, rad: (n,).
  [[nodiscard]] py::array_t<double> coordinates(const ArrayLike& joints) const {
    const std::vector<Config> states = to_joints(joints, "joints", chain().coordinates()).rows;
    py::array_t<double> values(static_cast<py::ssize_t>(states.size()));
    for (std::size_t k = 0; k < states.size(); ++k) {
      const Config& q = states[k];
      values.mutable_at(static_cast<py::ssize_t>(k)) =
          arm_.kind.srs ? arm_angle(*arm_.kind.srs, first_plane(*arm_.kind.srs, chain().tool(q)), q)
                        : q[joint_];
    }
    return values;
  }

  /// Returns all joints that bring the tool to a pose at given values of the free coordinate: (n,
  /// 7), rad.
  [[nodiscard]] py::array_t<double> ik(const Pose& tool, const ArrayLike& at, double step,
                                       bool limits, bool turns) const {
    if (!(step > 0 && step <= kTwoPi))
      throw py::value_error("step: allowed are numbers > 0, at most 2*pi, rad");
    if (chain().roll_fixed && !at.is_none())
      throw py::value_error("at: a pose leaves nothing free: allowed is None");
    std::vector<Config> found;
    const std::vector<double> values = at.is_none() ? grid(step) : values_of(at);
    for (const double value : values) {
      if (arm_.kind.srs)
        solve_srs(tool, value, limits, turns, found);
      else
        solve_locked(tool, value, limits, turns, found);
    }
    const std::size_t width = chain().coordinates();
    py::array_t<double> joints(
        {static_cast<py::ssize_t>(found.size()), static_cast<py::ssize_t>(width)});
    double* out = joints.mutable_data();
    for (const Config& q : found) out = std::copy_n(q.data(), width, out);
    return joints;
  }

 private:
  [[nodiscard]] const Chain& chain() const { return arm_.model.chain; }

  static std::vector<double> values_of(const py::object& at) {
    const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(at);
    PyErr_Clear();
    if (!array || array.ndim() > 1)
      throw py::value_error("at: allowed is a number, or one-dimensional numbers, rad");
    std::vector<double> values(array.data(), array.data() + array.size());
    for (const double value : values)
      if (!std::isfinite(value)) throw py::value_error("at: not finite: allowed are numbers, rad");
    return values;
  }

  /// Returns values of the free coordinate `step` apart or less; the roll of a six-joint arm is 0.
  [[nodiscard]] std::vector<double> grid(double step) const {
    double lower = -kPi, upper = kPi;
    bool circle = true;
    if (!arm_.kind.srs) {
      if (chain().roll && joint_ == kDof - 1) return {0};
      const JointLimit& limit = chain().limit[static_cast<std::size_t>(joint_)];
      circle = limit.continuous || limit.wide();
      if (!circle) lower = limit.lower, upper = limit.upper;
    }
    const int steps = std::max(1, static_cast<int>(std::ceil((upper - lower) / step - 1e-9)));
    std::vector<double> values;
    for (int k = 0; k < steps + (circle ? 0 : 1); ++k)
      values.push_back(lower + (upper - lower) * k / steps);
    return values;
  }

  void solve_srs(const Pose& tool, double phi, bool limits, bool turns,
                 std::vector<Config>& found) const {
    const SrsArm& arm = *arm_.kind.srs;
    const ArmPlane plane = first_plane(arm, tool);
    if (reach_status(arm, plane.reach) != ReachStatus::kReachable) return;
    const auto circles = elbow_circles(arm, plane, tool);
    for (int branch = 0; branch < kBranches; ++branch) {
      const auto q =
          solve_exact_chain(chain(), arm, plane, tool, phi, srs_ik(arm, circles, phi, branch));
      if (q) add(*q, limits, turns, found);
    }
  }

  void solve_locked(const Pose& tool, double value, bool limits, bool turns,
                    std::vector<Config>& found) const {
    const auto form = ClosedForm::of(lock_joint(chain(), joint_, value));
    if (!form) return;
    for (const Config6& six : form->solve(tool)) {
      const Config q = with_joint(six, joint_, value);
      add(q, limits, turns, found, joint_);
    }
  }

  /// Adds q, with each joint but `fixed` in a turn within its limits: the one nearest to the middle
  /// of these, or, with `turns`, each. Without limits, joints are from -pi to pi.
  void add(Config q, bool limits, bool turns, std::vector<Config>& found, int fixed = -1) const {
    std::vector<Config> images{q};
    for (int j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain().limit[static_cast<std::size_t>(j)];
      if (j == fixed) {
        if (limits && !limit.continuous && !(q[j] >= limit.lower && q[j] <= limit.upper)) return;
        continue;
      }
      const double angle = wrap_angle(q[j]);
      std::vector<double> values{angle};
      if (limits && !limit.continuous) values = turns_within(angle, limit, turns);
      if (images.size() * values.size() > kMostImages)
        throw py::value_error(
            "turns: the limits allow more than 4096 combinations of turns: allowed is turns=False");
      std::vector<Config> next;
      for (const Config& image : images)
        for (const double value : values) next.push_back(image), next.back()[j] = value;
      images = std::move(next);
    }
    found.insert(found.end(), images.begin(), images.end());
  }

  /// Returns the values equal to an angle but for whole turns that are within the limits to 1e-9
  /// rad, ascending: all of them, or the one nearest to the middle.
  static std::vector<double> turns_within(double angle, const JointLimit& limit, bool all) {
    constexpr double kSlack = 1e-9;
    const double middle = (limit.lower + limit.upper) / 2;
    const auto within = [&](double value) {
      return value >= limit.lower - kSlack && value <= limit.upper + kSlack;
    };
    if (!all) {
      const double value = angle + kTwoPi * std::round((middle - angle) / kTwoPi);
      return within(value) ? std::vector{value} : std::vector<double>();
    }
    std::vector<double> values;
    for (double k = std::ceil((limit.lower - kSlack - angle) / kTwoPi); within(angle + kTwoPi * k);
         ++k) {
      values.push_back(angle + kTwoPi * k);
      if (values.size() > kMostImages) break;  // too many for add()
    }
    return values;
  }

  static constexpr std::size_t kMostImages = 4096;
  PlanningArm arm_;
  int joint_ = -1;  // the joint whose value is given, of arms that are not S-R-S
};

template <class Get>
auto numbers_of(const Clearances& all, const Get& get) {
  using Number = std::decay_t<decltype(get(all.result->states.front()))>;
  py::array_t<Number> values(static_cast<py::ssize_t>(all.result->states.size()));
  std::transform(all.result->states.begin(), all.result->states.end(), values.mutable_data(), get);
  return values;
}

void bind_kinematics(py::module_& m) {
  py::class_<Kinematics>(
      m, "Kinematics",
      "Inverse kinematics of a robot in closed form, prepared once. A pose of "
      "the tool leaves one coordinate free (`coordinate`):\n"
      "the arm angle of S-R-S arms, the roll of the tool of six joints with roll (without, none), "
      "else the value of one joint.")
      .def(py::init<const Robot&>(), py::arg("robot"),
           "Raises ValueError for an arm without a closed form.")
      .def_property_readonly("coordinate", &Kinematics::coordinate,
                             "\"arm angle\", or the name of a joint.")
      .def_property_readonly("method", &Kinematics::method, "How solutions are found, in a line.")
      .def_property_readonly("joint_names", &Kinematics::joint_names)
      .def("coordinates", &Kinematics::coordinates, py::arg("joints"),
           "The free coordinate of states (n, 7), rad: (n,). The arm angle is measured from the "
           "plane of the state's own pose.")
      .def("ik", &Kinematics::ik, py::arg("pose"), py::arg("at") = py::none(), py::kw_only(),
           py::arg("step") = 0.1, py::arg("limits") = true, py::arg("turns") = false,
           "All joints that bring the tool to a pose: (n, 7), rad; n is 0 where there are none.\n"
           "\n"
           "at: values of the free coordinate, rad; unset: `step` apart over its range, or 0 for "
           "the roll. limits: leave out\n"
           "states beyond joint limits. turns: every turn of a joint that its limits allow, else "
           "the one nearest to their\n"
           "middle. Poses at which the arm is straight, or two axes line up, may have solutions "
           "that are not among them.");
}

void bind_clearances(py::module_& m) {
  py::class_<Clearances>(m, "Clearances",
                         "How near bodies come at states: a row for each. The pair is the one that "
                         "comes nearest to what it must keep.")
      .def_property_readonly(
          "distance",
          [](const Clearances& all) {
            return numbers_of(all, [](const auto& state) { return state.distance; });
          },
          "(n,): of the pair, m; 0 where it touches.")
      .def_property_readonly(
          "required",
          [](const Clearances& all) {
            return numbers_of(all, [](const auto& state) { return state.required; });
          },
          "(n,): what the pair must keep, m.")
      .def_property_readonly(
          "margin",
          [](const Clearances& all) {
            return numbers_of(all,
                              [](const auto& state) { return state.distance - state.required; });
          },
          "(n,): distance - required, m; a state is free where it is not negative.")
      .def_property_readonly(
          "least",
          [](const Clearances& all) {
            return numbers_of(all, [](const auto& state) { return state.least; });
          },
          "(n,): least distance of all pairs, m.")
      .def_property_readonly(
          "pairs",
          [](const Clearances& all) {
            py::array_t<int> pairs(
                {static_cast<py::ssize_t>(all.result->states.size()), static_cast<py::ssize_t>(2)});
            int* out = pairs.mutable_data();
            for (const auto& state : all.result->states)
              out = std::copy_n(state.pair.data(), 2, out);
            return pairs;
          },
          "(n, 2): the two bodies, as indices into `bodies`; -1 where nothing must keep clear.")
      .def_property_readonly(
          "bodies", [](const Clearances& all) { return all.result->bodies; },
          "Names: links and attached bodies, then scene objects.")
      .def(
          "names",
          [](const Clearances& all,
             py::ssize_t k) -> std::optional<std::pair<std::string, std::string>> {
            const auto size = static_cast<py::ssize_t>(all.result->states.size());
            if (k < -size || k >= size)
              throw py::index_error("state " + std::to_string(k) + " of " + std::to_string(size));
            const auto& pair =
                all.result->states[static_cast<std::size_t>(k < 0 ? k + size : k)].pair;
            if (pair[0] < 0) return std::nullopt;
            const auto& bodies = all.result->bodies;
            return std::pair(bodies[static_cast<std::size_t>(pair[0])],
                             bodies[static_cast<std::size_t>(pair[1])]);
          },
          py::arg("state"), "The names of the two bodies of a state, None where there are none.")
      .def("__len__", [](const Clearances& all) { return all.result->states.size(); })
      .def("__repr__", [](const Clearances& all) {
        return "<Clearances: " + std::to_string(all.result->states.size()) + " states>";
      });
}

}  // namespace

std::vector<Config> to_states(py::handle joints, std::size_t width) {
  std::vector<Config> states = to_joints(joints, "joints", width).rows;
  for (std::size_t k = 0; k < states.size(); ++k)
    if (!states[k].allFinite())
      throw py::value_error("joints: row " + std::to_string(k) +
                            " is not finite: allowed are numbers, rad");
  return states;
}

void bind_states(py::module_& m) {
  bind_kinematics(m);
  bind_clearances(m);
}

}  // namespace swivel::python
