// SPDX-License-Identifier: BSD-3-Clause
// Certificates that a problem has no path, and what verifies them.
#include <optional>

#include "archive.hpp"
#include "bindings.hpp"
#include "interruptible.hpp"
#include "plan_keywords.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/answer/infeasibility_certificate.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

template <class A>
void serialize(A& archive, InfeasibilityCertificate::Range& x) {
  auto& [first, last] = x;
  archive(first, last);
}
template <class A>
void serialize(A& archive, InfeasibilityCertificate::Nodes& x) {
  auto& [slots, witness] = x;
  archive(slots, witness);
}
template <class A>
void serialize(A& archive, InfeasibilityCertificate::Edges& x) {
  auto& [tails, heads, witness, count] = x;
  archive(tails, heads, witness, count);
}
template <class A>
void serialize(A& archive, InfeasibilityCertificate::Layer& x) {
  auto& [slots, reached, removed, edges] = x;
  archive(slots, reached, removed, edges);
}
template <class A>
void serialize(A& archive, InfeasibilityCertificate& x) {
  auto& [stroke, reversed, resolution, edges, windings, layers, first_layer, band, witnesses] = x;
  archive(stroke, reversed, resolution, edges, windings, layers, first_layer, band, witnesses);
}
template <class A>
void serialize(A& archive, CertificateCheck& x) {
  auto& [passed, failure, s, complete, nodes, edges] = x;
  archive(passed, failure, s, complete, nodes, edges);
}

namespace python {

namespace {

/// Plans a problem, and returns the certificate that it has no path; nothing where it has one.
/// Throws TimeoutError.
std::optional<InfeasibilityCertificate> certificate_of(const Problem& problem,
                                                       const py::object& kind, int threads,
                                                       std::optional<double> timeout) {
  PlanOptions options = to_plan_options(kind, threads, timeout);
  return interruptible([&](const std::stop_token& stop) -> std::optional<InfeasibilityCertificate> {
    const Budget budget(timeout, nullptr, stop);
    options.stop = stop;
    Planner planner(problem);
    const PlanResult result = planner.plan(options);
    if (result.status == PlanStatus::kSolved) return std::nullopt;
    if (result.status != PlanStatus::kInfeasible) throw Stopped();
    return prove_infeasible(planner.view(), budget);
  });
}

CertificateCheck verdict_on(const Problem& problem, const InfeasibilityCertificate& certificate,
                            std::optional<double> timeout) {
  if (!certificate.stroke.empty())
    throw InputError("certificate", "stroke: is of stroke '" + certificate.stroke +
                                        "' of a job: allowed is a certificate of one path");
  return interruptible([&](const std::stop_token& stop) {
    const Budget budget(timeout, nullptr, stop);
    return verify_certificate(PreparedRobot(problem, budget), problem, certificate, budget);
  });
}

std::string words_of(const InfeasibilityCertificate& certificate) {
  return formatted("<Certificate: no path, layers %d to %zu of %d: ", certificate.first_layer,
                   certificate.first_layer + certificate.band.size() - 1, certificate.layers) +
         removed_text(certificate) + ">";
}

}  // namespace

void bind_certificates(py::module_& m) {
  py::class_<InfeasibilityCertificate>(
      m, "Certificate",
      "Proves that a problem has no path at its resolution: a band of layers that nothing crosses.")
      .def(pickling<InfeasibilityCertificate>())
      .def_readonly("layers", &InfeasibilityCertificate::layers, "Of the whole lattice.")
      .def_property_readonly(
          "band",
          [](const InfeasibilityCertificate& x) {
            return py::make_tuple(x.first_layer,
                                  x.first_layer + static_cast<int>(x.band.size()) - 1);
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
          "s", [](const CertificateCheck& x) { return py::make_tuple(x.s[0], x.s[1]); },
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
  m.def("load_certificate", &io::load_certificate, py::arg("file"),
        "A Certificate: what `plan --certificate` or save() wrote. Raises InputError.");
  m.def("_certificate", &certificate_of, py::arg("problem"), py::arg("planner"), py::arg("threads"),
        py::arg("timeout"));
  m.def("_check_certificate", &verdict_on, py::arg("problem"), py::arg("certificate"),
        py::arg("timeout"));
}

}  // namespace python

}  // namespace swivel
