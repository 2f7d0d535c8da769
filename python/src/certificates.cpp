// SPDX-License-Identifier: BSD-3-Clause
// Certificates that problems have no answer, and what verifies them.
#include <algorithm>
#include <optional>
#include <variant>

#include "answers/answer.hpp"
#include "base/archive.hpp"
#include "base/interruptible.hpp"
#include "plan_keywords.hpp"
#include "problems/problem.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/problem/problem_planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"

namespace swivel {

namespace python {

namespace {

/// Plans a problem, and returns the certificate that it has no answer; nothing where it has one.
/// Throws ValueError where there is no certificate, and TimeoutError.
std::optional<AnyCertificate> certificate_of(const Problem& of, const py::object& kind, int threads,
                                             std::optional<double> timeout) {
  PlanOptions options = to_plan_options(kind, threads, timeout);
  const swivel::Problem problem = to_core(of);
  return interruptible([&](const std::stop_token& stop) -> std::optional<AnyCertificate> {
    const Budget budget(timeout, nullptr, stop);
    options.stop = stop;
    ProblemPlanner planner(problem, {}, budget);
    swivel::Answer answer = planner.plan(options, true);
    if (answer.status == PlanStatus::kSolved) return std::nullopt;
    if (answer.status != PlanStatus::kInfeasible) throw Stopped();
    answer.warnings.clear();
    auto proof = planner.prove_infeasible(answer, budget);
    if (!proof) throw py::value_error(answer.warnings.front());
    return proof;
  });
}

/// Returns the run that a certificate is about. Throws InputError for the certificate of another
/// problem.
PathProblem problem_of(const swivel::Problem& problem,
                       const InfeasibilityCertificate& certificate) {
  if (problem.arms.size() == 2)
    throw InputError("certificate", "is of one arm: allowed is a certificate of two arms");
  if (is_path(problem)) {
    if (!certificate.stroke.empty())
      throw InputError("certificate", "stroke: is of stroke '" + certificate.stroke +
                                          "': allowed is a certificate of one path");
    return problem_of_run(problem, {0, false});
  }
  const auto stroke = find_stroke(problem, certificate.stroke);
  if (!stroke)
    throw InputError("certificate", "stroke: '" + certificate.stroke +
                                        "' is none of the job: allowed are the names of its "
                                        "strokes");
  if (certificate.reversed && !problem.arm().strokes[*stroke].reversible)
    throw InputError("certificate", "reversed: stroke '" + certificate.stroke +
                                        "' is not `reversible`: allowed is a certificate of it "
                                        "forwards");
  return problem_of_run(problem, {*stroke, certificate.reversed});
}

std::variant<CertificateCheck, WorkcellCertificateCheck> verdict_on(
    const Problem& of, const AnyCertificate& certificate, std::optional<double> timeout) {
  const swivel::Problem whole = to_core(of);
  const auto* const of_run = std::get_if<InfeasibilityCertificate>(&certificate);
  if (of_run == nullptr && whole.arms.size() != 2)
    throw InputError("certificate", "is of two arms: allowed is a certificate of one");
  const PathProblem problem = of_run != nullptr ? problem_of(whole, *of_run) : PathProblem();
  return interruptible(
      [&](const std::stop_token& stop) -> std::variant<CertificateCheck, WorkcellCertificateCheck> {
        const Budget budget(timeout, nullptr, stop);
        if (of_run != nullptr)
          return verify_certificate(PreparedRobot(problem, budget), problem, *of_run, budget);
        return verify_certificate(PreparedWorkcell(whole, budget),
                                  std::get<WorkcellCertificate>(certificate), budget);
      });
}

std::string words_of(const InfeasibilityCertificate& certificate) {
  const std::string of =
      certificate.stroke.empty()
          ? ""
          : "stroke '" + certificate.stroke + (certificate.reversed ? "' backwards, " : "', ");
  return "<Certificate: " + of +
         formatted("no path, layers %d to %zu of %d: ", certificate.first_layer,
                   certificate.first_layer + certificate.band.size() - 1, certificate.layers) +
         removed_text(certificate) + ">";
}

/// Returns how many sets of pairs are divided by a region of conflict.
std::int64_t regions_of(const WorkcellCertificate& certificate) {
  return std::count_if(certificate.tree.begin(), certificate.tree.end(),
                       [](const auto& branch) { return branch.region.has_value(); });
}

void bind_workcell_certificates(py::module_& m) {
  py::class_<WorkcellCertificate>(
      m, "WorkcellCertificate",
      "Proves that two arms have no paths without conflict at their resolution: a tree of regions "
      "of conflict, with a cut of one arm at each leaf.")
      .def(pickling<WorkcellCertificate>())
      .def_readonly("layers", &WorkcellCertificate::layers, "Of both lattices.")
      .def_property_readonly("regions", &regions_of, "Regions of conflict.")
      .def_property_readonly(
          "cuts",
          [](const WorkcellCertificate& x) {
            return static_cast<std::int64_t>(x.tree.size()) - regions_of(x);
          },
          "Leaves: sets of pairs of paths in which an arm has none.")
      .def(
          "to_json", [](const WorkcellCertificate& x) { return io::to_json(x); },
          "As text, docs/formats.md: what `plan WORKCELL --certificate` writes.")
      .def(
          "save",
          [](const WorkcellCertificate& x, const std::filesystem::path& file) {
            io::write_file(file, io::to_json(x));
          },
          py::arg("file"),
          "As JSON, which `swivel check --certificate` and check_certificate() read.")
      .def(
          "__eq__",
          // cuts in files have no lattice of their own
          [](const WorkcellCertificate& a, const WorkcellCertificate& b) {
            return io::to_json(a) == io::to_json(b);
          },
          py::is_operator())
      .def("__repr__",
           [](const WorkcellCertificate& x) {
             const auto regions = regions_of(x);
             return formatted("<WorkcellCertificate: no plan, %lld regions, %lld cuts, %d layers>",
                              static_cast<long long>(regions),
                              static_cast<long long>(x.tree.size()) - regions, x.layers);
           })
      .attr("__hash__") = py::none();
  py::class_<WorkcellCertificateCheck>(m, "WorkcellCertificateCheck",
                                       "What a certificate of a workcell proves, or its fault.")
      .def(pickling<WorkcellCertificateCheck>())
      .def_readonly("passed", &WorkcellCertificateCheck::passed)
      .def("__bool__", [](const WorkcellCertificateCheck& x) { return x.passed; })
      .def_property_readonly(
          "failure",
          [](const WorkcellCertificateCheck& x) -> std::optional<std::string> {
            if (x.passed) return {};
            return x.failure;
          },
          "The first fault; None if it passed.")
      .def_readonly("complete", &WorkcellCertificateCheck::complete,
                    "False: the proof covers only those solutions of the arms that were found.")
      .def_readonly("regions", &WorkcellCertificateCheck::regions, "Regions of conflict.")
      .def_readonly("cuts", &WorkcellCertificateCheck::cuts, "Cuts of one arm.")
      .def_readonly("pairs", &WorkcellCertificateCheck::pairs,
                    "Pairs of nodes and of moves of both arms asked.")
      .def_readonly("nodes", &WorkcellCertificateCheck::nodes, "Nodes asked.")
      .def_readonly("edges", &WorkcellCertificateCheck::edges, "Edges asked.")
      .def("__repr__", [](const WorkcellCertificateCheck& x) {
        if (!x.passed) return "<WorkcellCertificateCheck failed: " + x.failure + ">";
        return formatted("<WorkcellCertificateCheck passed: %lld regions, %lld cuts>",
                         static_cast<long long>(x.regions), static_cast<long long>(x.cuts));
      });
  m.def("_load_workcell_certificate", &io::load_workcell_certificate);
}

}  // namespace

void bind_certificates(py::module_& m) {
  bind_workcell_certificates(m);
  py::class_<InfeasibilityCertificate>(
      m, "Certificate",
      "Proves that a problem has no path at its resolution: a band of layers that nothing crosses.")
      .def(pickling<InfeasibilityCertificate>())
      .def_property_readonly(
          "stroke",
          [](const InfeasibilityCertificate& x) -> std::optional<std::string> {
            if (x.stroke.empty()) return {};
            return x.stroke;
          },
          "Name of the stroke of a job that has no path; None: it is of a problem.")
      .def_readonly("reversed", &InfeasibilityCertificate::reversed,
                    "Whether that stroke is run from its last waypoint to the first.")
      .def_readonly("layers", &InfeasibilityCertificate::layers, "Of the whole lattice.")
      .def_property_readonly(
          "band",
          [](const InfeasibilityCertificate& x) {
            return std::pair(x.first_layer, x.first_layer + static_cast<int>(x.band.size()) - 1);
          },
          "First and last layer of the band.")
      .def_readonly("causes", &InfeasibilityCertificate::witnesses,
                    "Causes, which remove the band's nodes and edges.")
      .def(
          "to_json", [](const InfeasibilityCertificate& x) { return io::to_json(x); },
          "CERTIFICATE.json as text, docs/formats.md: what `plan --certificate` writes.")
      .def(
          "save",
          [](const InfeasibilityCertificate& x, const std::filesystem::path& file) {
            io::write_file(file, io::to_json(x));
          },
          py::arg("file"),
          "As JSON, which `swivel check --certificate` and load_certificate() read.")
      .def(
          "__eq__",
          [](const InfeasibilityCertificate& a, const InfeasibilityCertificate& b) {
            return a == b;
          },
          py::is_operator())
      .def("__repr__", &words_of)
      .attr("__hash__") = py::none();
  py::class_<CertificateCheck>(m, "CertificateCheck",
                               "What a certificate proves, or what is wrong with it.")
      .def(pickling<CertificateCheck>())
      .def_readonly("passed", &CertificateCheck::passed)
      .def("__bool__", [](const CertificateCheck& x) { return x.passed; })
      .def_property_readonly(
          "failure",
          [](const CertificateCheck& x) -> std::optional<std::string> {
            if (x.passed) return {};
            return x.failure;
          },
          "The first fault, with layer and slot; None if it passed.")
      .def_property_readonly(
          "s", [](const CertificateCheck& x) { return std::pair(x.s[0], x.s[1]); },
          "m along the path: first and last layer of the band.")
      .def_readonly("complete", &CertificateCheck::complete,
                    "False: the proof covers only those solutions of the arm that were found.")
      .def_readonly("nodes", &CertificateCheck::nodes, "Nodes asked.")
      .def_readonly("edges", &CertificateCheck::edges, "Edges asked.")
      .def("__repr__", [](const CertificateCheck& x) {
        if (!x.passed) return "<CertificateCheck failed: " + x.failure + ">";
        return formatted("<CertificateCheck passed: nothing leads from s = %.4f to %.4f m>", x.s[0],
                         x.s[1]);
      });
  m.def("_load_certificate", &io::load_certificate);
  m.def("_certificate", &certificate_of);
  m.def("_check_certificate", &verdict_on);
}

}  // namespace python

}  // namespace swivel
