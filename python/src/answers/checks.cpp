// SPDX-License-Identifier: BSD-3-Clause
// Bindings of what an independent look at rows found.
#include "answers/answer.hpp"
#include "base/archive.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel::python {

namespace {

/// Returns all failures: those of runs are repeated for strokes alone (AnswerCheck::failures).
std::vector<std::string> failures_of(const Check& check) {
  std::vector<std::string> all;
  if (!check.has_strokes)
    for (const CheckResult& run : check.result.runs)
      all.insert(all.end(), run.failures.begin(), run.failures.end());
  all.insert(all.end(), check.result.failures.begin(), check.result.failures.end());
  return all;
}

std::int64_t failure_count_of(const Check& check) {
  std::int64_t count = check.result.failure_count;
  if (!check.has_strokes)
    for (const CheckResult& run : check.result.runs) count += run.failure_count;
  return count;
}

double cost_of(const Check& check) {
  if (check.has_strokes) return check.result.cost;
  double cost = 0;
  for (const CheckResult& run : check.result.runs) cost += run.cost;
  return cost;
}

std::vector<Check> checks_of(const Check& check) {
  std::vector<Check> runs;
  for (const CheckResult& run : check.result.runs) {
    Check& one = runs.emplace_back();
    one.result.passed = run.passed;
    one.result.runs = {run};
  }
  return runs;
}

/// Returns the check of the only run. Throws AttributeError for a word `name` where there are more.
const CheckResult& only_run(const Check& check, const char* name) {
  if (check.result.runs.size() != 1)
    throw py::attribute_error(std::string(name) + ": of one run: allowed is check.runs[k]." + name);
  return check.result.runs.front();
}

std::string words_of(const Check& check) {
  std::string text = formatted("passed: cost %.6g", cost_of(check));
  if (!check.result.passed)
    text = formatted("failed, %lld failures: ", static_cast<long long>(failure_count_of(check))) +
           failures_of(check).front();
  if (check.result.runs.size() != 1)
    return text + formatted(", %zu runs", check.result.runs.size());
  const CheckResult& run = check.result.runs.front();
  if (run.min_clearance)
    text += formatted(", least clearance %.3f mm, %.3f mm more than asked",
                      1e3 * *run.min_clearance, 1e3 * *run.min_margin);
  if (run.deepest_contact)
    text += formatted(", contact %.3f mm deep", 1e3 * run.deepest_contact->depth);
  return text;
}

/// Binds a member of the check of the only run.
template <class Member>
void bind_member(py::class_<Check>& type, const char* name, Member CheckResult::*member,
                 const char* doc) {
  type.def_property_readonly(
      name, [name, member](const Check& c) -> Member { return only_run(c, name).*member; }, doc);
}

void bind_status(py::class_<Check>& type, const char* name, Known CheckResult::*member,
                 const char* doc) {
  type.def_property_readonly(
      name,
      [name, member](const Check& c) -> MeasureStatusName {
        return to_string(only_run(c, name).*member);
      },
      doc);
}

void bind_run_members(py::class_<Check>& type) {
  bind_member(type, "worst_position", &CheckResult::worst_position,
              "m, tool against path at the rows. As all that follow of one run: of strokes and two "
              "arms each of `runs` has it.");
  bind_member(type, "worst_angle", &CheckResult::worst_angle, "rad.");
  bind_member(type, "worst_path_error", &CheckResult::worst_path_error, "m, between rows.");
  bind_member(type, "worst_path_angle", &CheckResult::worst_path_angle, "rad.");
  bind_member(type, "largest_step", &CheckResult::largest_step,
              "A joint's move over what is allowed.");
  bind_member(type, "rounded", &CheckResult::rounded,
              "Whether the rows were judged on the path of motions, whose corners are rounded.");
  bind_member(type, "min_clearance", &CheckResult::min_clearance, "m, of any pair at the rows.");
  bind_status(type, "min_clearance_status", &CheckResult::min_clearance_status,
              "Of min_clearance and min_margin: 'measured', 'none' (no pair is near) or "
              "'not_measured' (no row could be examined).");
  bind_member(type, "min_margin", &CheckResult::min_margin,
              "m, least clearance less what the pair must keep.");
  bind_member(type, "deepest_contact", &CheckResult::deepest_contact, "DeepestContact.");
  bind_status(type, "deepest_contact_status", &CheckResult::deepest_contact_status,
              "'measured', 'none' (no allowed pair was found to touch) or 'not_measured' (a row "
              "has joints that are no numbers).");
  type.def_property_readonly(
          "duration",
          [](const Check& c) {
            const auto& motion = only_run(c, "duration").motion;
            return motion ? std::optional(motion->duration) : std::nullopt;
          },
          "Of motions, s.")
      .def_property_readonly(
          "peaks", [](const Check& c) -> std::optional<Typed<"dict[str, float]">> {
            const auto& motion = only_run(c, "peaks").motion;
            if (!motion) return {};
            py::dict peaks;
            const char* const names[] = {"speed", "acceleration", "jerk"};
            for (std::size_t k = 0; k < 3; ++k) peaks[names[k]] = motion->peaks[k].ratio;
            return peaks;
          },
          "Of motions: the largest over what the joint can do, by name.");
}

}  // namespace

void bind_check(py::module_& m) {
  py::class_<Check> type(m, "Check", "What an independent look at rows found.");
  type.def(pickling<Check>())
      .def_property_readonly("passed", [](const Check& c) { return c.result.passed; })
      .def("__bool__", [](const Check& c) { return c.result.passed; })
      .def_property_readonly(
          "failures", &failures_of,
          "A line each, with part and row; the first 20 of each run. Of two arms first those of "
          "each arm, then those of both together.")
      .def_property_readonly("failure_count", &failure_count_of)
      .def_property_readonly("cost", &cost_of, "Of the rows as given.")
      .def_property_readonly("runs", &checks_of,
                             "A Check of each run of a stroke in their order, or of each arm.")
      .def_property_readonly(
          "between", [](const Check& c) { return c.result.between; },
          "LeastMargin of bodies of two arms, or None.")
      .def("__repr__", [](const Check& c) { return "<Check " + words_of(c) + ">"; });
  bind_run_members(type);
}

}  // namespace swivel::python
