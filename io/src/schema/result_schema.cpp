// SPDX-License-Identifier: BSD-3-Clause
#include "schema/schema.hpp"

namespace swivel::io {

namespace {

constexpr Range kResultVersions{"1", kResultVersion, kResultVersion};

Schema numbers(std::size_t count) {
  return list(number(), count);
}

/// Returns the schema of one number for each joint: seven, or six of an arm of six joints whose
/// tool may not turn.
Schema joint_numbers() {
  return either(numbers(kDof), numbers(kDof - 1));
}

Schema::Key key(const char* name, Schema value, const char* meaning, const char* unit = "") {
  return {name, std::move(value), unit, required(), meaning};
}

/// Returns a key that some results do not have.
Schema::Key key_of_some(const char* name, Schema value, const char* meaning,
                        const char* unit = "") {
  return {name, std::move(value), unit, optional(), meaning};
}

Schema bodies() {
  return list(text(), 2);
}

Schema side() {
  return one_of({"lower", "upper"});
}

Schema cause() {
  return or_null(section(
      "cause",
      {
          key("cause",
              one_of({"reach", "singular", "limit", "manipulability", "pair", "contact",
                      "arm_slope", "roll_slope", "joint_step", "speed", "path_error", "angle_error",
                      "step_error", "not_closed", "check"}),
              "`pair`: two bodies nearer than they must keep; `contact`: they touch; `check`: of "
              "the program that plans"),
          key("joint", or_null(text()), "of limits, steps and speeds; of `roll_slope` the roll"),
          key("other_joints", boolean(),
              "every node has several joints beyond their limits, of which this is the furthest"),
          key("unwinds", boolean(),
              "of `limit`: the joint can follow only beyond the end of its range, where it would "
              "have to unwind by a turn"),
          key("side", or_null(side()), "of limits; of `reach`: too near or too far"),
          key("bodies", or_null(bodies()), "of pairs: their names"),
          key("between_layers", boolean(), "whether they meet on motions only"),
          key("object", or_null(text()),
              "a scene object that several bodies come too near to; `bodies` is then one pair of "
              "them"),
          key("check", or_null(text()), "its name"),
          key("by", or_null(number()),
              "how much is missed at the node or motion that misses least, or, by a joint that "
              "leaves its range on the way, where it would be furthest outside before it came "
              "back; "
              "`null` where it was not measured",
              "`unit`"),
          key("value", or_null(number()),
              "what was found there; of two bodies less than zero: how deep they are in each other",
              "`unit`"),
          key("limit", or_null(number()), "what is asked for", "`unit`"),
          key("over", or_null(number()),
              "of `roll_slope`: the length of path for which `limit` is allowed; of a pair that "
              "may be so deep in each other: the "
              "depth "
              "that `allow` gives, of which `limit` leaves a part to motions between layers",
              "m"),
          key("unit", or_null(one_of({"m", "rad"})), "of these three"),
      }));
}

Schema held() {
  return list(section(
      "",
      {key("joint", text(), "its name"), key("position", number(), "where it stands", "`unit`"),
       key("unit", one_of({"m", "rad"}), "of `position`"),
       key("given", boolean(), "whether `robot.hold` says so"),
       key("mimics", or_null(text()), "the joint that it follows, which stands still as well")}));
}

Schema summary() {
  const auto place = [] { return key("s", number(), "where on the path", "m"); };
  return section(
      "summary",
      {
          key("solved", boolean(), "whether there is a path"),
          key("clearance",
              or_null(section("", {key("value", number(), "what is left", "m"),
                                   key("asked", number(), "what the pair must keep", "m"),
                                   key("bodies", bodies(), "the pair"), place()})),
              "the pair that comes nearest to what it must keep: `value`, `asked`, `bodies`, `s`",
              "m"),
          key("joint_limit",
              or_null(section(
                  "", {key("joint", text(), "its name"), key("side", side(), "which limit"),
                       key("margin_deg", number(), "how far from it", "degrees"), place()})),
              "of the joints that turn, the one that comes nearest to a limit: `joint`, `side`, "
              "`margin_deg`, `s`",
              "degrees"),
          key("slide_limit",
              or_null(
                  section("", {key("joint", text(), "its name"), key("side", side(), "which limit"),
                               key("margin_mm", number(), "how far from it", "mm"), place()})),
              "of the joint that slides, where one does, how near it comes to a limit: `joint`, "
              "`side`, `margin_mm`, `s`",
              "mm"),
          key("tool_path_error",
              or_null(section(
                  "", {key("max_mm", number(), "the most", "mm"),
                       key("allowed_mm", or_null(number()), "by the limits", "mm"), place()})),
              "how far the tool leaves its path between layers: `max_mm`, `allowed_mm`, `s`", "mm"),
          key("top_tool_speed",
              or_null(section("", {key("speed", number(), "of the tool", "m/s"),
                                   key("joint", text(), "which bounds it"), place()})),
              "the highest constant speed of the tool at which no joint need exceed its own: "
              "`speed`, the "
              "`joint` that bounds it, `s`",
              "m/s"),
      });
}

Schema lattice() {
  return section(
      "lattice",
      {
          key("layers", integer(), "along the path"),
          key_of_some("phi", integer(), "arm angles, of S-R-S arms"),
          key_of_some("branches", integer(), "of solutions at one arm angle, of S-R-S arms"),
          key_of_some("windings", integer(),
                      "images of joints with more than a turn, of S-R-S arms"),
          key_of_some("window", integer(), "steps of arm angle between neighbours, of S-R-S arms"),
          key_of_some("rolls", integer(),
                      "of S-R-S arms with `path.roll`: turns of the tool that are told apart"),
          key_of_some("arcs", integer(),
                      "of self-motion, in all layers, of other arms; of six joints without a roll "
                      "IK solutions"),
          key_of_some("knot_bound", or_null(number()),
                      "no path through nodes of these layers costs less, whatever layers between "
                      "have nodes besides; `null` where nodes have costs or are only near their "
                      "rows, or where there is none; of lattices with `resolution.knot`"),
          key_of_some(
              "knot_gap", or_null(number()),
              "by what share of `knot_bound` the rows of the lattice's path cost more; those of a "
              "refined one, which goes beside the nodes, may cost less"),
          key_of_some(
              "bias", or_null(number()),
              "an estimate: by what share at most the lattice's path is dearer than one whose "
              "redundancy changes by any slope; `null` where the metric is not `l2`, and with "
              "rolls of arms of seven joints"),
          key_of_some("halved", boolean(),
                      "whether knots were added wherever that might have been worth it; `false`: "
                      "time was up before"),
          key("nodes", integer(), "in all layers"),
          key("merged_waypoints", integer(), "equal neighbours"),
          key("cost", or_null(number()),
              "what the search minimised: before `--refine`, and of the fitted arm's nodes where "
              "the arm is not exactly S-R-S"),
          key_of_some("method", text(), "how solutions are found"),
          key("complete", boolean(),
              "whether all solutions are known; else \"no path\" means \"none found\""),
      });
}

Schema counters() {
  return section("counters",
                 {
                     key("ik_nodes", integer(), "nodes solved"),
                     key("edges", integer(), "candidates compared"),
                     key("nodes_checked", integer(), "nodes tested for collision"),
                     key("edges_checked", integer(), "edges tested for collision or path error"),
                     key("fcl_calls", integer(), "asked of FCL"),
                     key("certified_free", integer(), "proved free without FCL"),
                     key("certified_colliding", integer(), "proved colliding without FCL"),
                     key("expansions", integer(), "of the search"),
                     key("iterations", integer(), "best paths validated"),
                 });
}

Schema time_ms() {
  return section("time_ms", {
                                key("load", number(), "reading files", "ms"),
                                key("prepare", number(), "what a planner keeps", "ms"),
                                key("plan", number(), "finding the answer", "ms"),
                                key("check", number(), "proving it", "ms"),
                                key("report", number(), "measuring it", "ms"),
                                key("stages", map(number()), "of these by name", "ms"),
                            });
}

Schema empty_layers() {
  const auto two_layers = [] { return list(integer(), 2); };
  return list(section(
      "", {key("layers", two_layers(), "first and last"), key("s", numbers(2), "of these", "m"),
           key("waypoints", or_null(two_layers()), "of these; `null` where there is no waypoint"),
           key("reason", text(), "why they are empty, in words"),
           key("cause", cause(), "at the layer that misses least"),
           key("most", or_null(number()), "the most that one misses by", "of the cause")}));
}

Schema unreachable_layer() {
  return or_null(
      section("", {key("layer", integer(), "its number"), key("s", number(), "along the path", "m"),
                   key("waypoint", or_null(integer()), "`null` between waypoints")}));
}

Schema diagnosis() {
  return section(
      "diagnosis",
      {
          key("reached_layer", or_null(integer()),
              "the furthest that a valid path comes; `null` where the first layer is empty"),
          key("reached_s", or_null(number()), "the same along the path", "m"),
          key("reason", text(),
              "what ends every path, in words, as in a campaign's CSV; `not known: time was up` "
              "where time ran out before it was "
              "found"),
          key("cause", cause(),
              "the same as values, [below](#cause); `null` where it is not known"),
          key("at_s", or_null(number()), "s of the layer past the furthest one", "m"),
          key("waypoints", list(or_null(integer()), 2),
              "rows of the path, from 0, before and after it"),
          key("without_it", or_null(integer()),
              "a layer that paths reach if this one thing is removed: at least a twentieth of the "
              "path further, or its end; `null` "
              "where "
              "no single thing was found that does"),
          key("without_it_s", or_null(number()), "the same along the path", "m"),
          key("together", list(cause()),
              "causes that must go besides, where no single thing helps"),
          key("empty_layers", empty_layers(),
              "runs of layers without a valid node: `layers`, `s` and `waypoints` (first and last; "
              "`null` where there is no "
              "waypoint), "
              "`reason`, `cause` (at the layer that misses least), `most` (the most that one "
              "misses by)"),
          key("removed", map(integer()),
              "reason → nodes and edges removed just past the furthest layer"),
          key("holds", one_of({"this_resolution", "exact_tool", "every_resolution"}),
              "how far \"no path\" goes: at this resolution; `exact_tool`: at any resolution with "
              "which a layer lies there; at "
              "every resolution"),
          key("unreachable", unreachable_layer(),
              "why more than this resolution: a layer whose pose no joints within their limits "
              "reach, at any arm angle (`layer`, "
              "`s`, "
              "`waypoint`, `null` between waypoints); `null` where none is proved, as of all arms "
              "that are not exactly S-R-S"),
          key("complete", boolean(),
              "false where time ran out, or where the layers past the furthest would have taken "
              "more than about a second to look "
              "at"),
          key("layers_known", integer(),
              "of so many layers, from the first on, it is known whether they are empty"),
      });
}

Schema refinement() {
  return section(
      "refinement",
      {
          key("refined", boolean(), "whether the path is another than the lattice's"),
          key("reason", or_null(text()), "why not; `stopped` where the time was up"),
          key("cost_before", number(), "of the lattice's path"),
          key("cost", number(), "of the refined one; never more"),
          key("bend_before", number(), "`bend` of the lattice's path", "rad/m²"),
          key("bend", number(),
              "the largest second divided difference of the joints over the tool's travel; times "
              "the square of "
              "the tool's speed it is acceleration",
              "rad/m²"),
          key("rounds", integer(), "of optimising and asking"),
          key("nodes_asked", integer(), "whether they are valid"),
          key("edges_asked", integer(), "whether they are valid"),
          key("second_seed", boolean(), "it was found from a lattice coarse along the path"),
      });
}

Schema peaks_of_motion() {
  const auto peaks = [] {
    return list(
        section("", {key("joint", text(), "its name"), key("ratio", number(), "of what it can do"),
                     key("t", number(), "when", "s"), key("s", number(), "where", "m")}));
  };
  return section(
      "", {key("speed", peaks(), "of each joint"), key("acceleration", peaks(), "of each joint"),
           key("jerk", peaks(), "of each joint")});
}

Schema slow_stretches() {
  return list(section(
      "",
      {key("s", numbers(2), "from, to", "m"), key("t", numbers(2), "from, to", "s"),
       key("share", number(), "of the speed at its slowest"),
       key("joint", text(), "which bounds it"),
       key("reason", one_of({"speed", "acceleration", "jerk"}), "which of its rates"),
       key("singular", or_null(one_of({"shoulder", "elbow", "wrist"})), "what is nearly singular"),
       key("singular_angle_deg", or_null(number()), "how nearly", "degrees")}));
}

Schema corners_of_motion() {
  return section(
      "",
      {key("rounded", integer(), "how many"), key("position", number(), "the most", "m"),
       key("angle", number(), "the most", "rad"),
       key("stops",
           list(section("", {key("waypoint", or_null(integer()), "row of the path, from 0"),
                             key("s", number(), "where", "m"), key("t", number(), "when", "s")})),
           "where the tool must rest")});
}

Schema motion() {
  return section(
      "motion",
      {
          key("executable", boolean(),
              "whether there is one; else the keys from `samples` on are missing"),
          key("reason", or_null(text()),
              "why there is none (`stopped` where the time was up, which is exit code 3, else 1)"),
          key("at_s", or_null(number()), "where", "m"),
          key("speed", number(), "asked for", "m/s"),
          key("turn_speed", or_null(number()), "asked for", "rad/s"),
          key("rate", number(), "samples a second", "1/s"),
          key("chord", or_null(number()),
              "asked for: how far the tool may leave its path between samples", "m"),
          key_of_some("samples", integer(), "rows"),
          key_of_some("duration", number(), "until the tool rests at the end", "s"),
          key_of_some(
              "ideal", number(),
              "the same at the speed asked for throughout, less where `chord` asks for less", "s"),
          key_of_some("peaks", peaks_of_motion(),
                      "`speed`, `acceleration`, `jerk`: for each joint the largest difference "
                      "between samples over what it can do, "
                      "`ratio`, "
                      "with `t` and `s`"),
          key_of_some(
              "slow", slow_stretches(),
              "stretches below the speed asked for, starting and stopping aside: `s` and `t` "
              "(from, to), `share` of the speed at "
              "its slowest, the `joint` and which of its rates is the `reason`; `singular` "
              "(shoulder, elbow, wrist) with "
              "`singular_angle_deg` where one is within 0.3 rad of being singular, else `null`"),
          key_of_some("corners", corners_of_motion(),
                      "how many are `rounded` and by how much the curve leaves the polyline there "
                      "(`position`, m, `angle`, rad); `stops` "
                      "(`waypoint`, `s`, `t`) where the tool must rest"),
          key_of_some("between_samples",
                      section("", {key("position", number(), "the most", "m"),
                                   key("angle", number(), "the most", "rad")}),
                      "how far the tool leaves its path where joints move straight from sample to "
                      "sample: `position`, m, `angle`, rad"),
          key_of_some("warnings", list(text()),
                      "rates that were assumed since neither URDF nor problem states them, and "
                      "whether they decide how long the motion "
                      "takes; "
                      "speeds asked for above `limits.tool_speed` or `limits.tool_turn_speed`, "
                      "which are kept; a `rate` that is low "
                      "for the path"),
      });
}

Schema advice() {
  return list(section(
      "advice",
      {
          key("change", text(),
              "`free_start`, `free_end`, `free_roll` (no bounds of `path.roll`), `finer` (half the "
              "steps of the lattice), "
              "the name of a limit, `allow` (all depths that the object's `allow` gives, "
              "by one factor), "
              "`move_object`, `without_object`, `hold` (a joint that is held, held elsewhere), "
              "`turned_over` (the tool's frame by 180° about its x axis)"),
          key("words", text(), "the change in a phrase"),
          key("object", or_null(text()),
              "of `allow`, `move_object` and `without_object`; of `hold` the joint"),
          key("from", or_null(number()), "of limits, `allow` and `hold`: what it is"),
          key("to", or_null(number()), "of limits, `allow` and `hold`: what was tried"),
          key("offset", or_null(numbers(3)),
              "of `move_object`, base frame; zeros where no way helps", "m"),
          key("also", or_null(text()),
              "of `move_object` and `without_object`: a second object that is changed with it"),
          key("also_offset", or_null(numbers(3)), "of `move_object` with `also`, base frame", "m"),
          key("outcome", one_of({"solved", "further", "no_help", "unknown"}),
              "`further`: paths come further; `unknown`: no time left"),
          key("cost", or_null(number()), "of `solved`"),
          key("reached_s", or_null(number()), "how far paths come", "m"),
      }));
}

Schema certificate() {
  return section("certificate",
                 {
                     key("layers", list(integer(), 2), "first and last that nothing leads through"),
                     key("reached", integer(), "nodes that paths reach"),
                     key("removed",
                         list(section("", {key("reason", text(), "in words"),
                                           key("cause", cause(), "as values"),
                                           key("nodes", integer(), "that it removes"),
                                           key("edges", integer(), "that it removes")})),
                         "for each witness `reason`, `cause`, how many `nodes` and `edges`"),
                     key("bytes", integer(), "of the [file](#certificate-json)"),
                 });
}

Schema rows() {
  return list(section(
      "", {key("s", number(), "along the path", "m"),
           key("phi", number(), "as in the [CSV](#trajectory-csv)", "rad"),
           key("branch", integer(), "as in the CSV"),
           key("joints", joint_numbers(), "base to tip", "rad"),
           key_of_some("roll", number(), "as in the CSV, where the tool stands turned", "rad")}));
}

Schema robot_pairs() {
  return section("", {key("dropped", list(section("", {key("bodies", bodies(), "their names")})),
                          "touch in every sampled posture, not kept apart"),
                      key("reduced",
                          list(section("", {key("bodies", bodies(), "their names"),
                                            key("median", number(), "clearance over samples", "m"),
                                            key("clearance", number(), "kept at layers", "m"),
                                            key("edge_clearance", number(), "kept between", "m")})),
                          "near by design")});
}

/// Returns the schema of a status beside a number, which tells why the number is null.
Schema known() {
  return one_of({"measured", "none", "not_measured"});
}

Schema min_margin() {
  return or_null(section("", {key("margin", number(), "what is left of it", "m"),
                              key("clearance", number(), "of the pair", "m"),
                              key("required", number(), "what it must keep", "m"),
                              key("bodies", bodies(), "their names"),
                              key("row", integer(), "of the trajectory, from 0")}));
}

Schema deepest_contact() {
  return or_null(section(
      "",
      {key("depth", number(), "found at a row: the bodies are at least so deep", "m"),
       key("at_most", or_null(number()),
           "the bodies are nowhere deeper at rows; `null` where that is not known within 0.5 mm, "
           "as of a mesh that is not closed",
           "m"),
       key("allowed", or_null(number()), "the depth that `allow` gives; `null`: however deep", "m"),
       key("bodies", bodies(), "their names"),
       key("row", integer(), "of the trajectory, from 0")}));
}

/// Returns the keys that say what the answer is, and what finding it took.
std::vector<Schema::Key> answer_keys() {
  return {
      key("schema_version", integer(kResultVersions),
          "1; it rises when a key goes or changes its meaning, not when one is new"),
      key("status", one_of({"solved", "infeasible", "timeout", "cancelled"}),
          "or `error`, where the program failed: then there is `message` besides, and nothing "
          "else"),
      key("summary", summary(), "the answer at a glance, [below](#summary)"),
      key("cost", or_null(number()),
          "of the trajectory's rows; like all that describes one, `null` unless solved"),
      key("checked", or_null(boolean()),
          "whether the trajectory, and the motion that was made of it, passed what `check` "
          "asks; `false` with `--no-check`. "
          "One that "
          "does not pass is an internal error, exit code 5, and nothing is written"),
      key("planner", text(), "which of the planners"),
      key("threads", integer(), "that worked"),
      key("lattice", lattice(), "its size, [below](#lattice)"),
      key("counters", counters(), "work done, [below](#counters)"),
      key("time_ms", time_ms(), "where time went, [below](#times)", "ms"),
  };
}

/// Returns the keys that say how good the trajectory is.
std::vector<Schema::Key> measure_keys() {
  return {
      key("tool_path_error_mm",
          section("", {key("mean", or_null(number()), "over the steps", "mm"),
                       key("max", or_null(number()), "over the steps", "mm")}),
          "`mean`, `max` between layers", "mm"),
      key("min_clearance", or_null(number()), "least over the rows; `null` unless measured", "m"),
      key("min_clearance_status", known(),
          "of `min_clearance` and `min_margin`: `measured`; `none`: no pair is near; "
          "`not_measured`: there is no trajectory, or time ran out"),
      key("min_margin", min_margin(),
          "the row and pair that come nearest to what the pair must keep: `margin`, "
          "`clearance`, `required`, `bodies`, `row`",
          "m"),
      key("deepest_contact", deepest_contact(),
          "the deepest [contact](model.md#contact) of bodies that a scene object's `allow` "
          "names: `depth`, `at_most`, "
          "`allowed`, "
          "`bodies`, `row`; `null` unless measured",
          "m"),
      key("deepest_contact_status", known(),
          "`measured`; `none`: no such bodies were found to touch; `not_measured`: there is no "
          "trajectory, or time ran out"),
      key("min_manipulability", or_null(number()), "least over the rows"),
      key("arm_angle", list(or_null(number())), "conventional arm angle of each row", "rad"),
  };
}

/// Returns the keys of the parts of a result: what was made of the trajectory, why there is none,
/// and its rows.
std::vector<Schema::Key> part_keys() {
  return {
      key("refinement", or_null(refinement()), "`null` without `--refine`; [below](#refinement)"),
      key("motion", or_null(motion()), "`null` without `--speed`; [below](#motion-in-the-result)"),
      key("diagnosis", or_null(diagnosis()), "`null` unless infeasible; [below](#diagnosis)"),
      key("advice", or_null(advice()),
          "with `--advise`, of problems that have no path; else `null`: what was tried, what "
          "helps first, [below](#advice)"),
      key("certificate", or_null(certificate()),
          "with `--certificate`, of problems that have no path; else `null`; "
          "[below](#certificate)"),
      key("trajectory", rows(), "rows of `s`, `phi`, `branch`, `joints`"),
      key("partial", rows(),
          "where there is no answer: the same rows from the first on, as far as they are known "
          "to be valid; maybe none"),
      key("robot_pairs", robot_pairs(),
          "`dropped`: pairs that touch in every sampled posture, not kept apart; `reduced`: "
          "pairs near by design, with "
          "`median`, "
          "`clearance`, `edge_clearance` (m); `info PROBLEM --pairs` lists all"),
      key("held", held(),
          "joints between base and tip that move and are not planned: `joint`, `position` "
          "(`unit`), whether `robot.hold` has "
          "it (`given`), the joint that it `mimics` or `null`; what is said of paths is said "
          "with them there"),
      key("warnings", list(text()), "e.g. open meshes, merged waypoints"),
      key("joint_names", either(list(text(), kDof), list(text(), kDof - 1)), "base to tip"),
  };
}

Schema plan_result() {
  return section("result", join(join(answer_keys(), measure_keys()), part_keys()));
}

/// Returns the schema of what was found out about each run of a job.
Schema runs_of_job() {
  const std::vector<Schema::Key> first{
      key("stroke", text(), "its name"),
      key("reversed", boolean(), "whether it runs from the last waypoint to the first"),
      key("status", one_of({"solved", "infeasible", "timeout", "cancelled"}),
          "whether it has a path by itself"),
      key("least_cost", or_null(number()), "of the run by itself; `null` where it has no path"),
      key("cost", or_null(number()),
          "of the run in the job; like all that describes its rows, "
          "`null` where there is no job"),
      key("summary", summary(), "the run at a glance, as of [results](#summary)"),
      key("lattice", lattice(), "its size, as of [results](#lattice)")};
  const std::vector<Schema::Key> last{
      key("diagnosis", or_null(diagnosis()),
          "of a run that has no path by itself, as of [results](#diagnosis); else `null`")};
  std::vector<Schema::Key> measures = measure_keys();
  for (Schema::Key& one : measures) one.group = "result";
  return list(section("run", join(join(first, measures), last)));
}

Schema parts_of_job() {
  return list(section(
      "part",
      {key("stroke", or_null(text()), "its name; `null`: a transition"),
       key("reversed", boolean(), "whether a stroke runs from the last waypoint to the first"),
       key("cost", number(), "of its rows"),
       key("rows",
           list(section("", {key_of_some("s", number(), "along the run", "m"),
                             key_of_some("phi", number(), "as in the CSV", "rad"),
                             key_of_some("branch", integer(), "as in the CSV"),
                             key("joints", joint_numbers(), "base to tip", "rad"),
                             key_of_some("roll", number(), "as in the CSV", "rad"),
                             key("process", boolean(), "whether it is on the stroke itself")})),
           "of strokes `s`, `phi`, `branch`, `joints`, `roll` where the tool stands turned, "
           "`process`; of transitions `joints` and `process`, which is false: the joints move "
           "straight from row to row")}));
}

Schema motion_of_job() {
  const Schema event =
      section("", {key("t", number(), "of a sample", "s"), key("stroke", text(), "its name"),
                   key("s", number(), "along the stroke, its approach included", "m"),
                   key("process", one_of({"on", "off"}), "what it is from then on")});
  return section(
      "job_motion",
      {key("executable", boolean(),
           "whether there is one; else the keys from `rate` on are missing"),
       key("reason", or_null(text()),
           "why there is none (`stopped` where the time was up, which is exit code 3, else 1)"),
       key("part", or_null(integer()), "which of `parts`, from 0, has none"),
       key("at_s", or_null(number()), "where", "m"),
       key_of_some("rate", number(), "samples a second", "1/s"),
       key_of_some("samples", integer(), "rows"),
       key_of_some("duration", number(), "from rest to rest", "s"),
       key_of_some("events", list(event),
                   "when the process is switched: `t`, `stroke`, `s`, `process` (`on`, `off`)"),
       key_of_some("warnings", list(text()), "as of [motions](#motion-in-the-result)")});
}

Schema refinement_of_job() {
  const std::vector<Schema::Key> of_run{key("stroke", text(), "name of its stroke"),
                                        key("reversed", boolean(), "whether it runs backwards")};
  return section(
      "job_refinement",
      {key("cost_before", number(), "of all runs as the search found them, without transitions"),
       key("cost", number(), "of all runs now; never more"),
       key("runs", list(section("", join(of_run, refinement().keys))),
           "of each run `stroke`, `reversed` and what refining it brought, as of "
           "[results](#refinement)")});
}

/// Returns the keys that say what the answer of a job is.
std::vector<Schema::Key> job_answer_keys() {
  return {
      key("schema_version", integer(kResultVersions), "as of [results](#result-json)"),
      key("status", one_of({"solved", "infeasible", "timeout", "cancelled"}),
          "as of results; a job that ran out of time may have a motion nevertheless"),
      key("cost", or_null(number()),
          "of strokes, transitions and lift-offs; like all that describes the motion, `null` where "
          "there is none"),
      key("bound", or_null(number()),
          "no job of the lattices' nodes, in this order and with these lift-offs, has a smaller "
          "`lattice_cost`, in whatever directions of `reversible` strokes, if its transitions are "
          "those that Swivel finds"),
      key("bound_any", or_null(number()),
          "no job of the lattices' nodes, in this order and with these lift-offs, has a smaller "
          "`lattice_cost`, whatever its directions and transitions; finer lattices may have one"),
      key("bound_orders", or_null(number()),
          "no job of the lattices' nodes, in any order that the problem allows and with these "
          "lift-offs, has a smaller `lattice_cost`, if its transitions are those that Swivel "
          "finds. "
          "Of S-R-S arms it is of the knots that strokes have by themselves"),
      key("lattice_cost", or_null(number()),
          "as `cost`, but of the nodes of the lattices, which the search minimised; rows of arms "
          "that are not exactly S-R-S, and rows between knots, may cost a little more or less"),
      key("gap", or_null(number()),
          "`lattice_cost` over `bound`, less 1: 0 where the job is optimal"),
      key("checked", or_null(boolean()), "whether the motion passed what `check` asks"),
      key("planner", text(), "which of the planners"),
      key("threads", integer(), "that worked"),
      key("order",
          list(section("", {key("stroke", text(), "its name"),
                            key("reversed", boolean(), "whether it runs backwards")})),
          "of the strokes, as they are run: `stroke`, `reversed`"),
  };
}

Schema advice_on_job() {
  const Schema of_job = list(section(
      "advice_on_job",
      {key("change",
           one_of({"without_strokes", "reversed", "best_order", "home", "approach", "retract",
                   "lines"}),
           "what was tried"),
       key("words", text(), "the change in a phrase"),
       key("strokes", list(text()), "that are left out, run backwards, or have a longer line"),
       key("length", or_null(number()),
           "of `approach`, `retract` and `lines` (both, at all strokes)", "m"),
       key("home", or_null(joint_numbers()), "of `home`: joints", "rad"),
       key("outcome", one_of({"solved", "further", "no_help", "unknown"}),
           "`unknown`: no time left"),
       key("cost", or_null(number()), "of `solved`")}));
  const Schema of_strokes = list(section(
      "", {key("stroke", text(), "that has no path by itself"),
           key("advice", advice(), "what would help it by itself, as of [results](#advice)")}));
  return section("", {key("job", of_job, "changes of the job"),
                      key("strokes", of_strokes, "changes for strokes by themselves")});
}

Schema job_result() {
  const Schema transitions = list(section(
      "", {key("from", or_null(text()), "stroke; `null`: the home"),
           key("to", or_null(text()), "stroke; `null`: the home"), key("cost", number(), "of it"),
           key("via", integer(), "configurations between its ends; 0: the joints move straight")}));
  const Schema missing =
      section("", {key("from", or_null(text()), "stroke; `null`: the home"),
                   key("to", or_null(text()), "stroke; `null`: the home"),
                   key("where", text(), "`between`, `home`, `end` or `begin`"),
                   key("bodies", or_null(bodies()), "that are in the way, where they are known")});
  const std::vector<Schema::Key> parts{
      key("runs", runs_of_job(), "of the strokes, in this order, [below](#run-of-a-stroke)"),
      key("transitions", transitions,
          "moves between strokes, `from`, `to` (`null`: the home), `cost`, `via`: how many "
          "configurations lie between their ends, 0 where the joints move straight"),
      key("lift_offs",
          list(section(
              "lift_off",
              {key("stroke", text(), "name of the whole stroke"),
               key("s", number(), "place on it at which a run ends, its approach included", "m"),
               key("resumed_s", number(), "place at which the next run begins", "m"),
               key("reached_s", number(),
                   "place that the longest run from the begin of this one reaches", "m"),
               key("cause", cause(),
                   "what ends every run there; `null`: no single cause is known")})),
          "places at which the tool [lifts off](#lift-offs) within strokes, "
          "[below](#lift-off-of-a-stroke)"),
      key("no_transition", or_null(missing),
          "where every stroke has a path and there is no way between two: `from`, `to`, the two "
          "`bodies` that come nearer to each other than transitions may or `null`, and `where` "
          "they do: `between` the two, at `home`, wherever the stroke before may `end`, wherever "
          "the "
          "next one may `begin`"),
      key("advice", or_null(advice_on_job()),
          "with `--advise`, of jobs that cannot be planned; [below](#advice-on-a-job)"),
      key("counters", counters(), "work done, as of [results](#counters)"),
      key("transition_counters",
          section("", {key("pairs", integer(), "asked for"), key("searches", integer(), "made"),
                       key("rounds", integer(), "of the search")}),
          "`pairs` of configurations asked whether the way is free, `searches` for a way around, "
          "`rounds`: jobs tried"),
      key("time_ms", time_ms(), "where time went, as of [results](#times)", "ms"),
      key("refinement", or_null(refinement_of_job()),
          "`null` without `--refine`; [below](#refinement-of-a-job)"),
      key("motion", or_null(motion_of_job()),
          "`null` unless it is timed; [below](#motion-in-the-result-of-a-job)"),
      key("parts", parts_of_job(), "the rows: strokes and transitions, [below](#part-of-a-job)"),
      key("partial", parts_of_job(),
          "where time was up before a job was proved: the parts of the cheapest one known, "
          "unproved; else empty")};
  std::vector<Schema::Key> last = part_keys();
  std::erase_if(last, [](const Schema::Key& one) {
    return one.name != "robot_pairs" && one.name != "held" && one.name != "warnings" &&
           one.name != "joint_names";
  });
  for (Schema::Key& one : last) one.group = "result";
  return section("job_result", join(join(job_answer_keys(), parts), last));
}

Schema advice_on_workcell() {
  const Schema of_cell = list(section(
      "advice_on_workcell",
      {key("change", text(),
           "as of [results](#advice), of one arm, of both or of the scene; besides `leads` (the "
           "arm leads, its leader so far follows) and `move_paths` (that of the arm, or both "
           "alike)"),
       key("words", text(), "the change in a phrase"),
       key("arm", or_null(text()), "that is changed; `null`: both, or the scene"),
       key("object", or_null(text()), "of `allow`, `move_object` and `without_object`"),
       key("from", or_null(number()), "of limits and `allow`: what it is"),
       key("to", or_null(number()), "of limits and `allow`: what was tried"),
       key("offset", or_null(numbers(3)),
           "of `move_object` and `move_paths`, base frame; zeros where no way helps", "m"),
       key("also", or_null(text()),
           "of `move_object` and `without_object`: a second object that is changed with it"),
       key("also_offset", or_null(numbers(3)), "of `move_object` with `also`, base frame", "m"),
       key("outcome", one_of({"solved", "no_help", "unknown"}), "`unknown`: no time left"),
       key("cost", or_null(number()), "of `solved`: of both paths")}));
  const Schema of_arms = list(section(
      "", {key("arm", text(), "that has no path by itself"),
           key("advice", advice(), "what would help it by itself, as of [results](#advice)")}));
  return section("", {key("cell", of_cell, "changes of the workcell, planned with both arms"),
                      key("arms", of_arms, "changes for arms by themselves")});
}

Schema refinement_of_workcell() {
  std::vector<Schema::Key> of_arm{key("name", text(), "of the arm")};
  return section(
      "workcell_refinement",
      {key("cost_before", number(), "of both paths as the search found them"),
       key("cost", number(), "of both now; never more"),
       key("turns", integer(), "times that both arms were refined, one after the other"),
       key("arms", list(section("", join(of_arm, refinement().keys)), 2),
           "of each arm `name` and what refining it brought, as of [results](#refinement)")});
}

Schema motion_of_workcell() {
  const Schema follower =
      section("", {key("arm", text(), "its name"), key("position", number(), "the most", "m"),
                   key("angle", number(), "the most", "rad")});
  std::vector<Schema::Key> of_arm{key("name", text(), "of the arm"),
                                  key("speed", number(), "that its tool may have", "m/s")};
  for (const char* const name : {"peaks", "slow", "corners", "between_samples", "warnings"})
    of_arm.push_back(*motion().find(name));
  return section(
      "workcell_motion",
      {key("executable", boolean(),
           "whether there is one; else the keys from `samples` on are missing"),
       key("reason", or_null(text()),
           "why there is none (`stopped` where the time was up, which is exit code 3, else 1)"),
       key("arm", or_null(text()), "which arm has none"),
       key("at_s", or_null(number()), "where, of that arm", "m"),
       key("speed", number(), "asked for, of the faster tool", "m/s"),
       key("turn_speed", or_null(number()), "asked for", "rad/s"),
       key("rate", number(), "samples a second", "1/s"),
       key("chord", or_null(number()), "asked for, as of [motions](#motion-in-the-result)", "m"),
       key_of_some("samples", integer(), "rows"),
       key_of_some("duration", number(), "until both tools rest at the end", "s"),
       key_of_some("ideal", number(), "the same with the faster tool at its speed throughout", "s"),
       key_of_some("blended", integer(), "waypoints passed at a changing ratio of speeds"),
       key_of_some("follower", or_null(follower),
                   "of a leader and its follower: the `arm` that follows, and how far its tool is "
                   "off its path on the leader's tool, `position`, `angle`"),
       key_of_some(
           "arms", list(section("", of_arm), 2),
           "of each arm `name`, `speed`, and `peaks`, `slow` (the stretches that its joints "
           "cause), `corners`, `between_samples`, `warnings` as of "
           "[motions](#motion-in-the-result)"),
       key_of_some("warnings", list(text()), "of both together")});
}

Schema arms_of_workcell() {
  const std::vector<Schema::Key> first{
      key("name", text(), "of the arm"),
      key("given", boolean(), "whether its motion was"),
      key("least_cost", or_null(number()), "of it by itself; `null`: it has no path"),
      key("cost", or_null(number()),
          "of its path; like all that describes its rows, `null` where there is no plan"),
      key("summary", summary(), "the arm at a glance, as of [results](#summary)"),
      key("lattice", lattice(), "its size, as of [results](#lattice)")};
  std::vector<Schema::Key> last = part_keys();
  std::erase_if(last, [](const Schema::Key& one) {
    return one.name != "robot_pairs" && one.name != "held" && one.name != "warnings" &&
           one.name != "joint_names";
  });
  const std::vector<Schema::Key> middle{
      key("counters", counters(), "work done for it, as of [results](#counters)"),
      key("diagnosis", or_null(diagnosis()),
          "of an arm that has no path by itself, as of [results](#diagnosis); else `null`"),
      key("trajectory", or_null(rows()), "its rows; row k of both arms are simultaneous"),
      key("partial", rows(),
          "where there is no path: valid rows from the first on; where time was up before a plan "
          "was proved: the unproved rows; maybe none")};
  std::vector<Schema::Key> measures = measure_keys();
  for (Schema::Key& one : measures) one.group = "result";
  for (Schema::Key& one : last) one.group = "result";
  return list(section("workcell_arm", join(join(first, measures), join(middle, last))), 2);
}

Schema workcell_result() {
  const Schema conflict = section(
      "", {key("layer", integer(), "of both paths"),
           key("on_motion", boolean(), "whether they meet on the way to the next layer"),
           key("s", numbers(2), "of both arms", "m"), key("bodies", bodies(), "one of each arm")});
  const Schema between =
      section("", {key("clearance_mm", number(), "of these", "mm"),
                   key("margin_mm", number(), "more than they must keep", "mm"),
                   key("bodies", bodies(), "one of each arm"), key("row", integer(), "from 0")});
  const Schema asked = section("", {key("rounds", integer(), "regions of conflict"),
                                    key("pops", integer(), "pairs of nodes taken"),
                                    key("node_pairs", integer(), "asked about"),
                                    key("move_pairs", integer(), "asked about")});
  return section(
      "workcell_result",
      {key("schema_version", integer(kResultVersions), "as of [results](#result-json)"),
       key("status", one_of({"solved", "infeasible", "timeout", "cancelled"}), "as of results"),
       key("cost", or_null(number()), "of both paths together; `null` where there is no plan"),
       key("bound", or_null(number()),
           "no two paths of nodes without conflict cost less (refined ones may); `null` where "
           "there "
           "are none"),
       key("checked", or_null(boolean()), "whether the answer passed what `check` asks"),
       key("planner", text(), "which of the planners"), key("threads", integer(), "that worked"),
       key("decided_by", one_of({"arms alone", "regions", "pairs of nodes", "none"}),
           "`arms alone`: the arms' own answers, which do not meet, or an arm that has none; "
           "`regions` or `pairs of nodes`: the search that ended first ([theory](theory.md)); "
           "`none`: stopped"),
       key("arms", arms_of_workcell(), "of each arm its part, [below](#arm-of-a-workcell)"),
       key("refinement", or_null(refinement_of_workcell()),
           "`null` without `--refine`; [below](#refinement-of-a-workcell)"),
       key("motion", or_null(motion_of_workcell()),
           "`null` without `--speed`; [below](#motion-in-the-result-of-a-workcell)"),
       key("conflict", or_null(conflict),
           "where each arm has a path and both together have none: the first conflict met, "
           "`layer`, "
           "`on_motion`, `s` of both arms and the two `bodies`; else `null`"),
       key("advice", or_null(advice_on_workcell()),
           "with `--advise`, of workcells that have no plan; [below](#advice-on-a-workcell)"),
       key("between_arms", or_null(between),
           "the `row` and the `bodies` of both arms with the least margin, `clearance_mm` and "
           "`margin_mm`; `null` unless measured"),
       key("between_arms_status", known(),
           "`measured`; `none`: no pair is near; `not_measured`: there is no plan, or time ran "
           "out"),
       key("counters", asked,
           "`rounds` of regions, `pops` of pairs of nodes, `node_pairs` and `move_pairs` asked "
           "about"),
       key("time_ms", time_ms(), "where time went, as of [results](#times)", "ms"),
       key("warnings", list(text()), "of both; each arm has its own besides")});
}

Schema campaign_summary() {
  const auto spread = [] {
    return section("",
                   {key("median", number(), "half of them are below"),
                    key("p5", number(), "5 % are below"), key("p95", number(), "5 % are above")});
  };
  return section(
      "campaign",
      {
          key("schema_version", integer(kResultVersions), "1, as of [results](#result-json)"),
          key("episodes", integer(), "of this shard"),
          key("answered", integer(),
              "of these: the others were not planned when the campaign was stopped"),
          key("solved", integer(), "with a path"),
          key("infeasible", integer(), "without a path"),
          key("errors", integer(), "with an internal error"),
          key("plan_ms", spread(),
              "finding the answer: `median`, `p5`, `p95` over the episodes answered", "ms"),
          key("nodes_checked", spread(), "the same of this counter"),
          key("fcl_calls", spread(), "the same of this counter"),
          key("held", held(),
              "joints between base and tip that are not planned, as of [results](#result-json)"),
      });
}

Schema error_result() {
  return section("",
                 {key("schema_version", integer(kResultVersions), "as of other results"),
                  key("status", one_of({"error"}), "it failed"), key("message", text(), "why")});
}

}  // namespace

const Schema& result_schema() {
  static const Schema schema = [] {
    Schema any = either(plan_result(), job_result());
    any.others.push_back(workcell_result());
    any.others.push_back(error_result());
    return any;
  }();
  return schema;
}
const Schema& campaign_schema() {
  static const Schema schema = campaign_summary();
  return schema;
}

}  // namespace swivel::io
