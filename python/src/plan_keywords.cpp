// SPDX-License-Identifier: BSD-3-Clause
#include "plan_keywords.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <span>
#include <tuple>

#include "swivel/core/problem/hooks.hpp"

namespace swivel::python {

namespace {

std::string name_of(const py::object& function) {
  const py::object name = py::getattr(function, "__name__", py::none());
  return py::isinstance<py::str>(name)
             ? name.cast<std::string>()
             : py::type::of(function).attr("__name__").cast<std::string>();
}

/// Returns the answers of a Python function as an array with one number for each of `count` states.
/// Throws ValueError for another shape or type.
template <class Number>
py::array_t<Number> answers_of(const py::object& answer, std::size_t count,
                               const std::string& what) {
  const py::array array = py::array::ensure(answer);
  PyErr_Clear();
  constexpr bool kLogical = std::is_same_v<Number, bool>;
  const bool kind =
      array && (kLogical ? array.dtype().kind() == 'b'
                         : std::string("fiu").find(array.dtype().kind()) != std::string::npos);
  if (!kind || array.ndim() != 1 || array.shape(0) != static_cast<py::ssize_t>(count))
    throw py::value_error(what + " returned " +
                          (array ? py::str(array.dtype()).cast<std::string>() + " of shape " +
                                       py::str(array.attr("shape")).cast<std::string>()
                                 : "no array") +
                          ": allowed is " + (kLogical ? "bool" : "float64") + " of shape (" +
                          std::to_string(count) + ",)");
  return py::array_t<Number, py::array::c_style | py::array::forcecast>::ensure(array);
}

/// Returns a copy of states as an array of `width` columns, since a function may keep its argument.
template <class Item>
py::array_t<double> states_of(std::span<const Item> items, std::size_t width,
                              const Config& (*joints)(const Item&)) {
  py::array_t<double> states(
      {static_cast<py::ssize_t>(items.size()), static_cast<py::ssize_t>(width)});
  double* out = states.mutable_data();
  for (const Item& item : items) out = std::copy_n(joints(item).data(), width, out);
  return states;
}
const Config& itself(const Config& q) {
  return q;
}

/// A check by Python functions of arrays. The interpreter's lock must be held when it is made and
/// destroyed.
class ArrayCheck : public StateCheck {
 public:
  ArrayCheck(py::object check, py::object motions, std::size_t joints)
      : check_(std::move(check)), motions_(std::move(motions)), joints_(joints) {
    name_ = name_of(check_.is_none() ? motions_ : check_);
  }
  [[nodiscard]] std::string name() const override { return name_; }
  void states(std::span<const Config> states, std::span<bool> allowed) override {
    if (check_is_none()) return static_cast<void>(std::fill(allowed.begin(), allowed.end(), true));
    const py::gil_scoped_acquire gil;
    const auto answer = answers_of<bool>(check_(states_of(states, joints_, itself)), states.size(),
                                         "check '" + name_ + "'");
    std::copy_n(answer.data(), allowed.size(), allowed.begin());
  }
  [[nodiscard]] bool checks_motions() const override { return motions_.ptr() != Py_None; }
  void motions(std::span<const Motion> motions, std::span<bool> allowed) override {
    const py::gil_scoped_acquire gil;
    const auto from = states_of<Motion>(motions, joints_,
                                        [](const Motion& m) -> const Config& { return m.from; });
    const auto to =
        states_of<Motion>(motions, joints_, [](const Motion& m) -> const Config& { return m.to; });
    const auto answer =
        answers_of<bool>(motions_(from, to), motions.size(), "check_motions of '" + name_ + "'");
    std::copy_n(answer.data(), allowed.size(), allowed.begin());
  }

 private:
  [[nodiscard]] bool check_is_none() const { return check_.ptr() == Py_None; }
  py::object check_, motions_;
  std::size_t joints_;
  std::string name_;
};

class ArrayCost : public StateCost {
 public:
  ArrayCost(py::object cost, std::size_t joints)
      : cost_(std::move(cost)), joints_(joints), name_(name_of(cost_)) {}
  [[nodiscard]] std::string name() const override { return name_; }
  void costs(std::span<const Config> states, std::span<double> costs) override {
    const py::gil_scoped_acquire gil;
    const auto answer = answers_of<double>(cost_(states_of(states, joints_, itself)), states.size(),
                                           "cost '" + name_ + "'");
    std::copy_n(answer.data(), costs.size(), costs.begin());
  }

 private:
  py::object cost_;
  std::size_t joints_;
  std::string name_;
};

/// Throws TypeError for what is neither None nor can be called.
void require_function(const py::object& function, const char* name) {
  if (!function.is_none() && PyCallable_Check(function.ptr()) == 0)
    throw py::type_error(std::string(name) + ": not callable: allowed is a function, or None");
}

}  // namespace

PlanOptions to_plan_options(const py::object& planner, int threads, std::optional<double> timeout,
                            bool prove) {
  PlanOptions options;
  options.check = prove;
  options.planner = to_enum<PlannerKind>(planner);
  constexpr int kMostThreads = 1024;
  if (threads < 0 || threads > kMostThreads)
    throw py::value_error("threads: " + std::to_string(threads) +
                          ": allowed are 0 (all cores) to " + std::to_string(kMostThreads));
  options.threads = threads;
  options.timeout_s = to_timeout(timeout);
  return options;
}

ProgressFunction to_progress(const py::object& progress) {
  require_function(progress, "progress");
  if (progress.is_none()) return {};
  using Clock = std::chrono::steady_clock;
  return [tell = progress.ptr(), last = Clock::time_point()](const Progress& now) mutable {
    if (Clock::now() - last < std::chrono::milliseconds(20)) return;
    last = Clock::now();
    const py::gil_scoped_acquire gil;
    py::reinterpret_borrow<py::object>(tell)(to_string(now.stage), now.done, now.of);
  };
}

std::optional<double> to_timeout(std::optional<double> timeout) {
  if (timeout && !(*timeout > 0))
    throw py::value_error("timeout: not a positive number: allowed are values above 0, or None");
  return timeout;
}

PlanOptions PlanKeywords::options(const Robot& robot) const {
  PlanOptions options = to_plan_options(planner, threads, timeout, prove);
  if (evidence) options.evidence = Evidence::all();
  require_function(check, "check");
  require_function(check_motions, "check_motions");
  require_function(cost, "cost");
  // The arm is built only where functions ask for its number of joints.
  const std::size_t joints = has_own_functions() ? arm_of(robot).chain.coordinates() : 0;
  if (!check.is_none() || !check_motions.is_none())
    options.hooks.check = std::make_shared<ArrayCheck>(check, check_motions, joints);
  if (!cost.is_none()) options.hooks.cost = std::make_shared<ArrayCost>(cost, joints);
  options.progress = to_progress(progress);
  return options;
}

TimingOptions MotionKeywords::timing(const swivel::Problem& problem) const {
  constexpr double kMostRate = 1e5;
  for (const auto& [value, name, unit] :
       {std::tuple(speed, "speed", "m/s"), std::tuple(turn_speed, "turn_speed", "rad/s"),
        std::tuple(chord, "chord", "m")})
    if (value && !(*value > 0))
      throw py::value_error(std::string(name) +
                            ": not a positive number: allowed are values above 0, " + unit);
  TimingOptions options;
  options.rate = rate.value_or(options.rate);
  if (!(options.rate > 0 && options.rate <= kMostRate))
    throw py::value_error("rate: allowed are numbers > 0, at most 100000");
  options.turn_speed = turn_speed;
  options.chord = chord;
  const bool one_path = is_path(problem);
  if (one_path && !turn_speed) options.turn_speed = problem.arm().path().limits.tool_turn_speed;
  options.speed = speed.value_or(0);
  if (speed || (!one_path && problem.arms.size() == 1)) return options;
  std::optional<double> least;
  for (const ArmTask& arm : problem.arms)
    if (const auto& of_arm = arm.path().limits.tool_speed)
      least = std::min(*of_arm, least.value_or(*of_arm));
  if (!least)
    throw py::value_error(
        "speed: is not given, nor limits.tool_speed: allowed is the speed of the tool in m/s");
  options.speed = *least;
  return options;
}

std::optional<TimingOptions> MotionKeywords::asked_timing(const swivel::Problem& problem) const {
  const bool strokes = problem.arms.size() == 1 && !is_path(problem);
  if (speed || (strokes && (turn_speed || rate || chord))) return timing(problem);
  for (const auto& [given, name] :
       {std::pair(turn_speed, "turn_speed"), std::pair(rate, "rate"), std::pair(chord, "chord")})
    if (given) throw py::value_error(std::string(name) + ": is of motions: allowed with speed");
  return std::nullopt;
}

}  // namespace swivel::python
