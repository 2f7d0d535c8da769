// SPDX-License-Identifier: BSD-3-Clause
// Bindings of what answers say besides their rows: measures, causes and diagnoses.
#include "answers/answer.hpp"
#include "base/archive.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel::python {

namespace {

template <class E>
std::vector<std::pair<std::string, E>> names_from(E first, E last) {
  std::vector<std::pair<std::string, E>> names;
  for (int k = static_cast<int>(first); k <= static_cast<int>(last); ++k)
    names.emplace_back(to_string(static_cast<E>(k)), static_cast<E>(k));
  return names;
}

std::pair<std::string, std::string> bodies_of(const std::array<std::string, 2>& bodies) {
  return {bodies[0], bodies[1]};
}
/// Returns a distance from a limit with its unit: degrees, or mm of a joint that slides.
std::string distance_words(const NearestLimit& limit) {
  return limit.slides ? formatted("%.2f mm", 1e3 * limit.margin)
                      : formatted("%.2f deg", limit.margin * 180 / kPi);
}
std::optional<std::string> or_none(const std::string& text) {
  return text.empty() ? std::nullopt : std::optional(text);
}
std::optional<std::pair<int, int>> pair_or_none(int first, int last) {
  if (first < 0 && last < 0) return {};
  return std::pair(first, last);
}

void bind_figures(py::module_& m) {
  py::class_<LeastMargin>(m, "LeastMargin",
                          "The row and pair that come nearest to what must be kept there.")
      .def(pickling<LeastMargin>())
      .def_readonly("margin", &LeastMargin::margin, "clearance - required, m.")
      .def_readonly("clearance", &LeastMargin::clearance, "m.")
      .def_readonly("required", &LeastMargin::required, "m.")
      .def_property_readonly("bodies", [](const LeastMargin& x) { return bodies_of(x.bodies); })
      .def_readonly("row", &LeastMargin::row)
      .def("__repr__", [](const LeastMargin& x) {
        return formatted("<LeastMargin %.3f mm: %.3f mm of %.3f asked, ", 1e3 * x.margin,
                         1e3 * x.clearance, 1e3 * x.required) +
               x.bodies[0] + " - " + x.bodies[1] + formatted(", row %d>", x.row);
      });
  py::class_<DeepestContact>(
      m, "DeepestContact", "The deepest contact of bodies that a scene object allows to touch it.")
      .def(pickling<DeepestContact>())
      .def_readonly("depth", &DeepestContact::depth,
                    "m, found at a row: the bodies are at least so deep.")
      .def_readonly("at_most", &DeepestContact::at_most,
                    "m: the bodies are nowhere deeper at rows; None where that is not known "
                    "within 0.5 mm.")
      .def_readonly("allowed", &DeepestContact::allowed, "m, or None: however deep.")
      .def_property_readonly("bodies", [](const DeepestContact& x) { return bodies_of(x.bodies); })
      .def_readonly("row", &DeepestContact::row, "Index of the row.")
      .def("__repr__", [](const DeepestContact& x) {
        return formatted("<DeepestContact %.3f mm", 1e3 * x.depth) +
               (x.at_most ? formatted(", at most %.3f", 1e3 * *x.at_most) : "") +
               (x.allowed ? formatted(", allowed %.3f", 1e3 * *x.allowed) : "") + ", " +
               x.bodies[0] + " - " + x.bodies[1] + formatted(", row %d>", x.row);
      });
  py::class_<NearestLimit>(m, "NearestLimit", "How near the rows come to a joint's limit.")
      .def(pickling<NearestLimit>())
      .def_readonly("margin", &NearestLimit::margin,
                    "rad, to the limit itself; m of a joint that slides.")
      .def_readonly("joint", &NearestLimit::joint)
      .def_property_readonly(
          "side", [](const NearestLimit& x) { return to_string(x.side); }, "'lower' or 'upper'.")
      .def_readonly("row", &NearestLimit::row)
      .def_readonly("slides", &NearestLimit::slides)
      .def("__repr__", [](const NearestLimit& x) {
        return "<NearestLimit " + x.joint + ", " + distance_words(x) +
               formatted(" from its %s limit, row %d>", to_string(x.side), x.row);
      });
  py::class_<TopToolSpeed>(
      m, "TopToolSpeed",
      "The highest constant speed of the tool at which no joint need turn faster than it can.")
      .def(pickling<TopToolSpeed>())
      .def_readonly("speed", &TopToolSpeed::speed, "m/s.")
      .def_readonly("joint", &TopToolSpeed::joint, "That bounds it.")
      .def_readonly("row", &TopToolSpeed::row, "On the step from it.")
      .def("__repr__", [](const TopToolSpeed& x) {
        return formatted("<TopToolSpeed %.4g m/s, ", x.speed) + x.joint +
               formatted(", row %d>", x.row);
      });
  using ToolPathError = decltype(Measures::tool_path_error_mm);
  py::class_<ToolPathError>(m, "ToolPathError",
                            "How far the tool leaves its path between layers, mm.")
      .def(pickling<ToolPathError>())
      .def_readonly("mean", &ToolPathError::mean, "mm.")
      .def_readonly("max", &ToolPathError::max, "mm.")
      .def_readonly("row", &ToolPathError::row, "The step from it has the largest.")
      .def_readonly("allowed", &ToolPathError::allowed, "limits.tool_path_error, m, or None.")
      .def("__repr__", [](const ToolPathError& x) {
        return formatted("<ToolPathError mean %.4g mm, max %.4g mm>", x.mean, x.max);
      });
  py::class_<Measures>(m, "Measures",
                       "What a trajectory comes near to, and how well it follows its path. None: "
                       "not asked for, or does not apply.")
      .def(pickling<Measures>())
      .def_readonly("nearest_limit", &Measures::nearest_limit,
                    "NearestLimit of the joints that turn.")
      .def_readonly("nearest_slide_limit", &Measures::nearest_slide_limit,
                    "NearestLimit of the joint that slides.")
      .def_readonly("top_tool_speed", &Measures::top_tool_speed, "TopToolSpeed.")
      .def_property_readonly(
          "tool_path_error_mm",
          [](const Measures& x) {
            return x.evidence.tool_path_error ? std::optional(x.tool_path_error_mm) : std::nullopt;
          },
          "ToolPathError.")
      .def_readonly("min_clearance", &Measures::min_clearance, "Of the nearest pair on any row, m.")
      .def_property_readonly(
          "min_clearance_status",
          [](const Measures& x) -> MeasureStatusName {
            return to_string(x.min_clearance_status());
          },
          "Of min_clearance and min_margin: 'measured', 'none' (no pair is near) or "
          "'not_measured' (not asked for, or time ran out).")
      .def_readonly("min_margin", &Measures::min_margin, "LeastMargin.")
      .def_readonly("deepest_contact", &Measures::deepest_contact, "DeepestContact.")
      .def_property_readonly(
          "deepest_contact_status",
          [](const Measures& x) -> MeasureStatusName {
            return to_string(x.deepest_contact_status());
          },
          "'measured', 'none' (no allowed pair was found to touch) or 'not_measured' (not asked "
          "for, or time ran out).")
      .def_property_readonly(
          "min_manipulability",
          [](const Measures& x) {
            return x.evidence.postures ? std::optional(x.min_manipulability) : std::nullopt;
          },
          "Least sqrt(det(J J^T)).")
      .def_property_readonly(
          "arm_angle",
          [](const Measures& x) {
            return py::array_t<double>(static_cast<py::ssize_t>(x.arm_angle.size()),
                                       x.arm_angle.data());
          },
          "Conventional arm angle of each row of S-R-S arms, (n,), rad; empty where not asked for.")
      .def("__repr__", [](const Measures& x) {
        std::string text;
        const auto add = [&](const std::string& more) {
          text += (text.empty() ? "" : ", ") + more;
        };
        if (x.min_clearance) add(formatted("least clearance %.3f mm", 1e3 * *x.min_clearance));
        if (x.min_margin)
          add(formatted("%.3f mm more than asked (", 1e3 * x.min_margin->margin) +
              x.min_margin->bodies[0] + " - " + x.min_margin->bodies[1] + ")");
        if (x.deepest_contact)
          add(formatted("contact %.3f mm deep", 1e3 * x.deepest_contact->depth));
        if (const std::string missing = words_of_unmeasured(x); !missing.empty())
          add("not measured: " + missing);
        for (const auto& nearest : {x.nearest_limit, x.nearest_slide_limit})
          if (nearest) add(nearest->joint + " " + distance_words(*nearest) + " from its limit");
        if (x.evidence.tool_path_error)
          add(formatted("tool %.4g mm off", x.tool_path_error_mm.max));
        if (x.top_tool_speed) add(formatted("tool speed up to %.3g m/s", x.top_tool_speed->speed));
        return "<Measures " + text + ">";
      });
}

void bind_verdicts(py::module_& m) {
  bind_enum<PlanStatus>(m, "Status", "What became of a plan; ERROR is one of rows of many plans.",
                        names_from(PlanStatus::kSolved, PlanStatus::kError));
  bind_enum<Cause::Kind>(m, "CauseKind", "What removes nodes or edges of a lattice.",
                         names_from(Cause::Kind::kNone, Cause::Kind::kCheck));
  bind_enum<Advice::Change>(m, "Change", "What may be changed of a problem.",
                            names_from(Advice::Change::kFreeStart, Advice::Change::kLines));
  bind_enum<Advice::Outcome>(m, "Outcome", "What planning the changed problem gave.",
                             names_from(Advice::Outcome::kSolved, Advice::Outcome::kUnknown));

  py::class_<Cause>(m, "Cause", "One thing that ends paths. str() says it in words, with figures.")
      .def(pickling<Cause>())
      .def_readonly("kind", &Cause::kind, "CauseKind.")
      .def_property_readonly(
          "side", [](const Cause& c) { return or_none(to_string(c.side)); },
          "'lower', 'upper' or None.")
      .def_property_readonly(
          "joint", [](const Cause& c) { return or_none(c.joint); }, "Of limits, steps and speeds.")
      .def_readonly("other_joints", &Cause::other_joints,
                    "Every node has several joints beyond their limits; `joint` is the furthest.")
      .def_readonly("unwinds", &Cause::unwinds,
                    "Of a limit: the joint can follow only beyond the end of its range, where it "
                    "would have to unwind by a turn.")
      .def_property_readonly(
          "bodies",
          [](const Cause& c) {
            const bool none = c.bodies[0].empty() && c.bodies[1].empty();
            return none ? std::nullopt : std::optional(bodies_of(c.bodies));
          },
          "Of pairs: two names.")
      .def_readonly("between_layers", &Cause::between_layers)
      .def_property_readonly(
          "object", [](const Cause& c) { return or_none(c.object); },
          "A scene object that several bodies come too near to.")
      .def_readonly("value", &Cause::value,
                    "What it is where it misses least, in `unit`; None where it was not measured.")
      .def_readonly("limit", &Cause::limit, "What is allowed, in `unit`.")
      .def_readonly("over", &Cause::over,
                    "Of the roll's slope: the length of path for which `limit` is allowed, m.")
      .def_property_readonly("unit", &Cause::unit, "'m', 'rad' or ''.")
      .def_property_readonly(
          "check", [](const Cause& c) { return or_none(c.check); },
          "Name of the caller's own check.")
      .def("__str__",
           [](const Cause& c) {
             const std::string by = figures(c);
             return words(c) + (by.empty() ? "" : " (" + by + ")");
           })
      .def("__repr__", [](const Cause& c) {
        return "<Cause " + py::str(py::cast(c)).cast<std::string>() + ">";
      });
  py::class_<EmptyLayers>(m, "EmptyLayers",
                          "Layers, one after the other, that have no node left for one cause.")
      .def(pickling<EmptyLayers>())
      .def_property_readonly(
          "layers", [](const EmptyLayers& e) { return std::pair(e.first, e.last); },
          "First and last.")
      .def_property_readonly(
          "s", [](const EmptyLayers& e) { return std::pair(e.first_s, e.last_s); },
          "m, first and last.")
      .def_property_readonly(
          "waypoints",
          [](const EmptyLayers& e) { return pair_or_none(e.first_waypoint, e.last_waypoint); })
      .def_readonly("cause", &EmptyLayers::cause, "At the layer that misses least.")
      .def_readonly("most", &EmptyLayers::most, "The most that one of them misses by.")
      .def("__repr__", [](const EmptyLayers& e) {
        return formatted("<EmptyLayers %d to %d: ", e.first, e.last) + words(e.cause) + ">";
      });
  py::class_<Diagnosis>(m, "Diagnosis", "Why an infeasible problem has no path.")
      .def(pickling<Diagnosis>())
      .def_readonly("reached_layer", &Diagnosis::reached_layer,
                    "The furthest that a valid path reaches; None: the first layer is empty.")
      .def_readonly("reached_s", &Diagnosis::reached_s, "m.")
      .def_readonly("cause", &Diagnosis::cause, "The one thing that ends every path there.")
      .def_readonly("at_s", &Diagnosis::at_s, "m, of the layer past the furthest one.")
      .def_property_readonly(
          "waypoints",
          [](const Diagnosis& d) { return pair_or_none(d.waypoints[0], d.waypoints[1]); },
          "Before and after it.")
      .def_readonly("without_it", &Diagnosis::without_it,
                    "A layer that paths reach if the cause alone is removed.")
      .def_readonly("without_it_s", &Diagnosis::without_it_s, "m.")
      .def_readonly("together", &Diagnosis::together,
                    "What must go besides, where no single thing helps.")
      .def_readonly("empty_layers", &Diagnosis::empty_layers, "With evidence=True.")
      .def_property_readonly(
          "removed", [](const Diagnosis& d) -> Typed<"list[tuple[Cause, int]]"> {
            py::list all;
            for (const auto& [cause, count] : d.removed) all.append(py::make_tuple(cause, count));
            return all;
          },
          "With evidence=True: (Cause, nodes and edges that it removed just past the furthest "
          "layer).")
      .def_property_readonly(
          "holds", [](const Diagnosis& d) { return to_string(d.holds()); },
          "'this_resolution', 'exact_tool' (whatever the resolution, for a tool exactly on its "
          "path), or\n"
          "'every_resolution' (a waypoint has no joints within their limits).")
      .def_property_readonly(
          "unreachable",
          [](const Diagnosis& d) -> std::optional<int> {
            return d.unreachable ? std::optional(d.unreachable->layer) : std::nullopt;
          },
          "A layer that no joints within their limits reach, at any arm angle.")
      .def_readonly("complete", &Diagnosis::complete,
                    "False where time ran out; what is said is true nevertheless.")
      .def_readonly("layers_known", &Diagnosis::layers_known)
      .def("__repr__", [](const Diagnosis& d) {
        return "<Diagnosis: " + py::str(py::cast(d.cause)).cast<std::string>() +
               (d.reached_s ? formatted(" ends every path by s = %.4f m>", *d.reached_s)
                            : std::string(" bars the first layer>"));
      });
  py::class_<SpecialPair>(
      m, "SpecialPair", "A robot pair without an SRDF's word that is not kept apart as others are.")
      .def(pickling<SpecialPair>())
      .def_property_readonly("bodies", [](const SpecialPair& p) { return bodies_of(p.bodies); })
      .def_readonly("median", &SpecialPair::median, "Clearance over sampled postures, m.")
      .def_readonly("clearance", &SpecialPair::clearance, "m, kept on layers.")
      .def_readonly("edge_clearance", &SpecialPair::edge_clearance, "m, kept between them.")
      .def("__repr__", [](const SpecialPair& p) {
        return "<SpecialPair " + p.bodies[0] + " - " + p.bodies[1] +
               formatted(": keeps %.3f mm>", 1e3 * p.clearance);
      });
}

void bind_lattice(py::module_& m) {
  py::class_<LatticeInfo>(m, "LatticeInfo", "The lattice that was searched.")
      .def(pickling<LatticeInfo>())
      .def_readonly("layers", &LatticeInfo::layers)
      .def_readonly("nodes", &LatticeInfo::nodes)
      .def_readonly("arcs", &LatticeInfo::arcs,
                    "Arcs of self-motion in all layers, of arms that are not S-R-S; else None.")
      .def_readonly("method", &LatticeInfo::method, "How solutions are found.")
      .def_readonly("complete", &LatticeInfo::complete, "False: \"no path\" means \"none found\".")
      .def_readonly("cost", &LatticeInfo::cost, "What the search minimised.")
      .def("__repr__", [](const LatticeInfo& x) {
        return formatted("<LatticeInfo %d layers, %lld nodes, ", x.layers,
                         static_cast<long long>(x.nodes)) +
               x.method + ">";
      });
}

}  // namespace

Typed<"dict[str, int]"> counters_of(const Counters& c) {
  py::dict all;
  all["ik_nodes"] = c.ik_nodes;
  all["edges"] = c.edges;
  all["nodes_checked"] = c.nodes_checked;
  all["edges_checked"] = c.edges_checked;
  all["fcl_calls"] = c.fcl_calls;
  all["certified_free"] = c.proved_free;
  all["certified_colliding"] = c.proved_colliding;
  all["expansions"] = c.expansions;
  all["iterations"] = c.iterations;
  return all;
}

void bind_measures(py::module_& m) {
  bind_figures(m);
  bind_verdicts(m);
  bind_lattice(m);
}

}  // namespace swivel::python
