// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "schema/schema.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel::io {

namespace {

using Keys = std::vector<Schema::Key>;

Schema numbers(std::size_t count, const Range& range) {
  return list(number(range), count);
}

/// Returns the schema of a number for all joints or a list with one for each; null counts as a
/// missing key.
Schema of_joints(const Range& range) {
  return or_null(either(either(number(range), numbers(kDof, range)), numbers(kDof - 1, range)));
}

Schema scale() {
  return either(number(kFinite), numbers(3, kFinite));
}

Keys in_group(const char* group, Keys keys) {
  for (Schema::Key& key : keys) key.group = group;
  return keys;
}

Keys pose_keys(Presence position = otherwise("[0, 0, 0]")) {
  return in_group("pose", {
                              {"xyz", numbers(3, kCoordinate), "m", std::move(position),
                               "position; a waypoint must have it"},
                              {"rpy", numbers(3, kFinite), "rad", optional(),
                               "roll, pitch, yaw about the fixed axes x, y, z, as in a URDF: R = "
                               "Rz(yaw) Ry(pitch) Rx(roll); each within a turn"},
                              {"quat", numbers(4, kFinite), "", optional(),
                               "instead of `rpy`: `[w, x, y, z]`, w first; in a waypoint of length "
                               "1 within 1e-3, elsewhere of any length but 0"},
                          });
}

Keys shape_keys() {
  const Keys round{{"radius", number(kLength), "m", required(), "radius"},
                   {"length", number(kLength), "m", required(), "length"}};
  return in_group(
      "shape",
      {
          {"box", numbers(3, kLength), "m", optional(), "full edge lengths along x, y, z"},
          {"cylinder", section("", round), "", optional(),
           "`{radius: 0.05, length: 0.3}` (m): from −length/2 to +length/2"},
          {"capsule", section("", round), "", optional(),
           "`{radius: 0.05, length: 0.3}` (m): length without the two caps"},
          {"sphere",
           either(number(kLength),
                  section("", {{"radius", number(kLength), "m", required(), "radius"}})),
           "m", optional(), "radius; or `{radius: 0.05}`"},
          {"mesh", text(), "", optional(), "name of an STL, OBJ, DAE or PLY file"},
          {"scale", or_null(scale()), "", otherwise(1.0),
           "with `mesh`: factor, or one each for x, y, z, none of them 0; a negative one mirrors"},
      });
}

const Schema::Choice kOneShape{{"box", "cylinder", "sphere", "capsule", "mesh"}, true};
const Schema::Choice kOneOrientation{{"rpy", "quat"}};

Schema robot() {
  const Keys name{
      {"name", text(), "", required(), "neither that of a link nor of another body", "a name"}};
  const Keys where{{"link", text(), "", in_words("`tip_link`"),
                    "the link that it moves with, and in whose frame its pose is"}};
  return section(
      "robot",
      {
          {"urdf", text(), "", required(), "name of the URDF file", "the name of a URDF file"},
          {"srdf", text(), "", optional(), "name of the SRDF file: pairs of links that may touch"},
          {"packages", map(text()), "", optional(),
           "package → folder: where `package://NAME/...` of the URDF lies"},
          {"without", list(text()), "", optional(),
           "links left out of the robot, with all that they carry"},
          {"base_link", text(), "", required(),
           "link that the arm is reached from, or the hand where the part is in it; everything is "
           "in its frame, unless said",
           "the name of a link"},
          {"tip_link", text(), "", in_words("**required**, or of each of the `arms`"),
           "link that carries the tool: the arm is the last seven movable joints between the two "
           "(six with `path.roll`)",
           "the name of a link"},
          {"tool", section("", pose_keys(), {kOneOrientation}), "", in_words("that of `tip_link`"),
           "tool frame in `tip_link`: a [pose](#poses)"},
          {"hold", map(number(kCoordinate)), "m or rad", in_words("0, or the limit nearest to it"),
           "joint → where it stands; joints named here are none of the arm's"},
          {"attached",
           list(section("attached", join(join(name, shape_keys()), join(pose_keys(), where)),
                        {kOneShape, kOneOrientation})),
           "", optional(), "bodies that move with a link: tools, held parts"},
      });
}

/// Returns the schema of `joints`: one number for each, base to tip.
Schema configuration() {
  return section(
      "", {{"joints", either(numbers(kDof, kFinite), numbers(kDof - 1, kFinite)), "rad", required(),
            "base to tip; of six joints with `path.roll` the roll of the tool is the seventh"}});
}

/// Returns the schema of `joints` where an arm of six joints may leave out the roll of its tool.
Schema configuration_without_roll() {
  return section(
      "", {{"joints", either(numbers(kDof, kFinite), numbers(kDof - 1, kFinite)), "rad", required(),
            "base to tip; of six joints with `path.roll` the roll of the tool is the seventh, "
            "which may be left out"}});
}

Schema path() {
  constexpr Range kCut{"a whole number from 1 to 1000000", 1, 1'000'000};
  const PathSmoothing smooth;
  const Keys window{{"roll", numbers(2, kFinite), "rad", optional(),
                     "with `roll` of the path: `[lower, upper]`, what it may be there, at all "
                     "waypoints or at none; in between the ends "
                     "are linear"}};
  Schema keys = section(
      "path",
      {
          {"frame", text(), "", in_words("`base_link`"),
           "`base_link` or the name of a scene object, which the path then follows"},
          {"waypoints",
           list(section("waypoint", join(pose_keys(required()), window), {kOneOrientation})), "",
           optional(), "at least two [poses](#poses) that the tool frame visits"},
          {"file", text(), "", optional(),
           "instead of `waypoints`: name of a [CSV file](#tool-path-csv) or an [APT "
           "file](#tool-path-apt) with them"},
          {"units", one_of({"m", "mm", "inch"}), "", in_words("m; of APT files what they say"),
           "of positions and feeds in the `file`", "", "", "file"},
          {"cut", integer(kCut), "", in_words("the `file` has only one"),
           "which [cut](#tool-path-apt) of an APT file the path is, from 1", "", "", "file"},
          {"smooth",
           or_null(section("smooth",
                           {
                               {"position", number(kExtent), "m", otherwise(smooth.position),
                                "how far the tool may leave the polyline at a corner"},
                               {"angle", number(kNonNegative), "rad", otherwise(smooth.angle),
                                "the same for its orientation"},
                           })),
           "", in_words("paths are planned on the polyline, and timed with these defaults"),
           "lets the tool round corners, on a curve that is twice continuously differentiable; "
           "`null` forbids it"},
          {"roll", or_null(either(one_of({"free"}), numbers(2, kFinite))), "rad",
           in_words("the tool stands as the waypoints have it"),
           "`free`, or `[lower, upper]`: how far the tool may stand turned about its own z axis, "
           "of arms of six joints and of "
           "S-R-S arms "
           "of seven"},
          {"end", configuration_without_roll(), "", in_words("Swivel chooses"),
           "`{joints: [...]}`, seven numbers (rad), or six of an arm of six joints: the "
           "configuration at the [end](#start-and-end) of the path"},
          {"closed", boolean(), "", otherwise("false"),
           "whether the path must end in the joints in which it begins, so that laps "
           "[repeat](#closed-paths): its last waypoint is its first"},
      },
      {{{"waypoints", "file"}, true}});
  return keys;
}

Schema scene() {
  const Keys name{{"name", text(), "", required(), "a name of its own", "a name"}};
  const Keys allow{{"allow", either(list(text()), map(number(kLength))), "m", optional(),
                    "links and attached bodies that may touch it; or, `{nozzle: 0.003}`, how "
                    "[deep](model.md#contact) each may be in it"}};
  const Keys frame{{"frame", text(), "", in_words("`base_link`"),
                    "the link in whose frame its pose is, and with which it moves: the table under "
                    "a part, or what the robot stands on where the table is the `base_link`"}};
  return list(section("scene",
                      join(join(name, shape_keys()), join(join(pose_keys(), frame), allow)),
                      {kOneShape, kOneOrientation}));
}

Schema resolution() {
  const Resolution d;
  return section(
      "resolution",
      {
          {"ds", number(kLength), "m", otherwise(d.ds),
           "longest step along the path: each straight stretch is divided into equal ones, and "
           "every corner is a layer"},
          {"dphi", number(kTurn), "rad", otherwise(d.dphi), "widest step of the arm angle"},
          {"dalpha", number(kPositive), "rad", otherwise(d.dalpha), "widest step of tool rotation"},
          {"arcs", one_of({"false", "true"}), "", otherwise("false"),
           "nodes besides at the ends of arcs of arm angles within the joint limits, and in the "
           "middles of narrow ones: "
           "no arc is missed; S-R-S arms"},
          {"arc", or_null(number(kPositive)), "rad",
           in_words("0.07; 0.175 where every layer has nodes"),
           "self-motion between nodes, of arms without an arm angle; 1 m of a prismatic joint "
           "counts as 1 rad"},
          {"droll", number(kTurn), "rad", otherwise(d.droll),
           "widest step of `path.roll`, of arms of seven joints"},
          {"knot", or_null(number(kExtent)), "m",
           in_words("0.06 of arms without an arm angle; else 0.1"),
           "about how far along the path the redundancy is chosen anew: arm angle, roll, or places "
           "on arcs; between it changes evenly, and every layer is tested; 0: at every layer, as "
           "strokes in several runs, arms of two and paths with `limits.step_error` or `arcs` "
           "always have"},
      });
}

Keys clearance_limits() {
  const Limits d;
  return {
      {"clearance", number(kExtent), "m", otherwise(d.clearance),
       "distance kept between bodies at the layers of the path"},
      {"self_clearance", or_null(number(kExtent)), "m", in_words("`clearance`"),
       "the same between bodies of the robot; without an SRDF a pair keeps at most half of its "
       "median clearance over sampled "
       "postures"},
      {"edges", one_of({"continuous", "nodes"}), "", otherwise("continuous"),
       "`continuous`: motions between layers are proved to keep `edge_clearance`, not sampled; "
       "`nodes`: only the layers are "
       "tested"},
      {"edge_clearance", or_null(number(kExtent)), "m",
       in_words("half of what is kept at the layers"),
       "distance kept between layers; without an SRDF a pair of the robot keeps at most a "
       "quarter of its median. For paths "
       "that are "
       "refined or timed the default is `clearance`, where `self_clearance` is not set"},
      {"edge_tolerance", number(kPositive), "m", otherwise(d.edge_tolerance),
       "how finely that is proved; smaller refuses fewer motions that are just free, and takes "
       "longer"},
  };
}

Keys joint_and_path_limits() {
  const Limits d;
  return {
      {"joint_margin", either(number(kNonNegative), map(number(kNonNegative))), "rad or m",
       otherwise(d.joint_margin),
       "distance kept from both limits of each joint; or, `{joint_5: 0.1}`, of each joint that is "
       "named"},
      {"joints", map(numbers(2, kFinite)), "rad or m", in_words("those of the URDF"),
       "joint → `[lower, upper]`, narrower than its limits in the URDF; a continuous joint gets "
       "them"},
      {"file", text(), "", optional(),
       "name of a `joint_limits.yaml` as MoveIt has it: its positions narrow the limits of the "
       "URDF, its speeds, accelerations and jerks stand in place of the URDF's"},
      {"soft_limits", one_of({"true", "false"}), "", otherwise("true"),
       "joints keep the soft limits of their `<safety_controller>` in the URDF, where these "
       "are narrower"},
      {"joint_step", number(kPositive), "rad", otherwise(d.joint_step),
       "largest move of a joint between neighbouring layers, whatever their distance: a "
       "smaller `ds` allows more; a prismatic joint may move by 0.2 m for each rad"},
      {"arm_slope", number(kPositive), "rad/m", otherwise(d.arm_slope),
       "largest change of the arm angle along the path"},
      {"roll_slope", number(kPositive), "rad/m", otherwise(d.roll_slope),
       "the same of `path.roll`"},
      {"manipulability", number(kNonNegative), "", otherwise(d.manipulability),
       "least sqrt(det(J Jᵀ)), with J in m and rad at the tool"},
      {"tool_path_error", or_null(number(kPositive)), "m", otherwise(d.tool_path_error),
       "how far the tool may leave its path between layers"},
      {"tool_angle_error", or_null(number(kPositive)), "rad", otherwise(d.tool_angle_error),
       "the same for its orientation"},
      {"step_error", or_null(number(kPositive)), "rad", otherwise(d.step_error),
       "largest second-order estimate of the joint-space step, the paper's Eq. 15"},
  };
}

Keys speed_limits() {
  const Limits d;
  const auto rate = [](const char* what) {
    return std::string("largest ") + what +
           " of [motions](#motion): one number, or one for each joint (that of a roll is not "
           "looked at)";
  };
  return {
      {"tool_speed", or_null(number(kPositive)), "m/s", otherwise(d.tool_speed),
       "the joints must follow at this speed within the velocities of the URDF"},
      {"tool_turn_speed", or_null(number(kPositive)), "rad/s", otherwise(d.tool_turn_speed),
       "the same where the tool turns"},
      {"joint_speed", of_joints(kPositive), "rad/s", in_words("`velocity` of the URDF"),
       rate("speed")},
      {"joint_acceleration", of_joints(kPositive), "rad/s²",
       in_words("the smaller of `acceleration` and `deceleration` of the URDF; else 10 (of a "
                "prismatic joint 2 m/s²), with a warning"),
       rate("acceleration")},
      {"joint_jerk", of_joints(kPositive), "rad/s³",
       in_words("`jerk` of the URDF; else 100 (of a prismatic joint 20 m/s³), with a warning"),
       rate("jerk")},
  };
}

Schema limits() {
  return section("limits", join(join(clearance_limits(), joint_and_path_limits()), speed_limits()));
}

Schema cost() {
  return section(
      "cost", {
                  {"metric", one_of({"l2", "l1", "max", "time"}), "", otherwise("l2"),
                   "what a step costs: `l2` sqrt(Σ (w Δq)²), `l1` Σ w |Δq|, `max` max w |Δq|, "
                   "`time` max |Δq| / v with the velocities of the URDF"},
                  {"weights",
                   either(either(numbers(kDof, kNonNegative), map(number(kNonNegative))),
                          numbers(kDof - 1, kNonNegative)),
                   "per rad or m", in_words("1 each, that of the roll of six-joint arms 0"),
                   "w, base to tip: each 0 or from 1e-6 to 1e6; or, `{joint_1: 2}`, of the joints "
                   "that are named"},
                  {"roll", number(kNonNegative), "", otherwise(Cost().roll),
                   "per m of path and rad that the tool stands turned from where the waypoints "
                   "have it: 0 or from 1e-6 to 1e6; with "
                   "`path.roll`"},
              });
}

Schema refine() {
  const Refinement d;
  return section(
      "refine",
      {
          {"smoothing", number(kNonNegative), "m", otherwise(d.smoothing),
           "how much the joints' bends weigh against the cost: the length over which a bend costs "
           "as much as "
           "a way of its size; 0: cost alone"},
          {"joint_margin", number(kNonNegative), "rad", otherwise(d.joint_margin),
           "kept from joint limits besides `limits.joint_margin`, as far as the path does before"},
          {"singular_margin", number(kNonNegative), "rad", otherwise(d.singular_margin),
           "kept from singular angles, as far as the path does before; of arms that are not S-R-S "
           "from where "
           "the outer axes of three that meet in a point line up"},
      });
}

Schema vary() {
  return list(section(
      "vary",
      {
          {"object", text(), "", required(), "the scene object that moves",
           "the name of a scene object"},
          {"xyz", numbers(3, kExtent), "m", otherwise("[0, 0, 0]"),
           "half-widths along the axes of `base_link`"},
          {"rpy", numbers(3, kNonNegative), "rad", otherwise("[0, 0, 0]"),
           "half-widths of turns about the object's own origin, about the axes of `base_link`"},
      }));
}

/// Returns the schema of where the tool stands before a stroke or after it.
Schema offset() {
  return either(
      number(kExtent),
      section("", {{"xyz", numbers(3, kCoordinate), "m", required(), "in the tool frame there"}}));
}

/// Returns the keys that each stroke may have in place of the job's.
Keys keys_of_strokes(const char* other) {
  const auto presence = [&] { return other ? in_words(other) : otherwise(0.0); };
  return {
      {"approach", offset(), "m", presence(),
       "from where the tool comes to a stroke, on a straight line without turning: so far against "
       "its z axis, or `{xyz: [x, y, z]}` in the tool frame of the first waypoint; 0: no such "
       "line"},
      {"retract", offset(), "m", presence(),
       "where it goes after a stroke, alike; in the tool frame of the last waypoint"},
      {"process_speed", number(kPositive), "m/s", in_words(other ? other : "`limits.tool_speed`"),
       "speed of the tool along strokes, see [speeds](#speeds)"},
      {"approach_speed", number(kPositive), "m/s", in_words(other ? other : "that of the stroke"),
       "speed of the tool along approach and retract"},
  };
}

/// Returns the schema of limits in place of the file's.
Schema limits_of_one() {
  Schema limits =
      section("", join(join(clearance_limits(), joint_and_path_limits()), speed_limits()));
  for (const char* const of_robot : {"soft_limits", "joints", "file"}) {
    std::erase_if(limits.keys, [&](const Schema::Key& key) { return key.name == of_robot; });
    limits.refused.push_back({of_robot, "is of the robot", "this key in the `limits` of the file"});
  }
  const auto margin =
      std::find_if(limits.keys.begin(), limits.keys.end(),
                   [](const Schema::Key& key) { return key.name == "joint_margin"; });
  margin->value = number(kNonNegative);
  return limits;
}

Schema strokes() {
  const Keys first{
      {"name", text(), "", required(), "a name of its own, without commas and quotes", "a name"},
      {"path", path(), "", required(), "its [path](#path)", "a section with waypoints or file"},
      {"reversible", boolean(), "", otherwise("false"),
       "whether the tool may run from the last waypoint to the first as well"}};
  const Keys last{{"limits", limits_of_one(), "", optional(),
                   "[limits](#limits) in place of the file's, key by key"}};
  Schema stroke = section("stroke", join(join(first, keys_of_strokes("that of the job")), last));
  return list(refusing(std::move(stroke),
                       {not_yet("lift"),
                        {"closed", "is of the path", "this key in the `path` of the stroke"},
                        {"end", "is of the path", "this key in the `path` of the stroke"},
                        {"start", "is of problems with one path", "`home`, of a job as a whole"}}));
}

/// Returns the schema of the two arms of a workcell.
Schema arms() {
  const Keys body{
      {"name", text(), "", required(), "neither that of a link nor of another body", "a name"}};
  const Keys where{{"link", text(), "", in_words("`tip_link` of the arm"),
                    "the link that it moves with, and in whose frame its pose is"},
                   {"allow", list(text()), "", optional(),
                    "links and attached bodies of the other arm that may touch it"}};
  const Keys keys{
      {"name", text(), "", required(), "a name of its own, without commas and quotes", "a name"},
      {"tip_link", text(), "", required(), "link that carries its tool", "the name of a link"},
      {"tool", section("", pose_keys(), {kOneOrientation}), "", in_words("that of `tip_link`"),
       "tool frame in its `tip_link`: a [pose](#poses)"},
      {"attached",
       list(section("", join(join(body, shape_keys()), join(pose_keys(), where)),
                    {kOneShape, kOneOrientation})),
       "", optional(), "bodies that move with the arm: tools, held parts"},
      {"path", path(), "", in_words("**required**, or `trajectory`"),
       "its [path](#path); `frame` may be the name of the other arm, whose tool carries it then",
       "a section with waypoints or file; or `trajectory`, of an arm whose motion is given"},
      {"trajectory", text(), "", optional(),
       "instead, of one of the arms: the file of its [given motion](#an-arm-whose-motion-is-given)",
       "the name of a file"},
      {"at_rows", list(number(kNonNegative)), "",
       in_words("see [there](#an-arm-whose-motion-is-given)"),
       "beside an arm whose motion is given: the row at which each waypoint is, from 0"},
      {"start", configuration(), "", in_words("Swivel chooses"),
       "`{joints: [...]}` (rad): its configuration at the first waypoint"},
      {"limits", limits_of_one(), "", optional(),
       "[limits](#limits) in place of the file's, key by key"}};
  Schema arm = section(
      "arm", keys,
      {{{"path", "trajectory"}, true}, {{"at_rows", "trajectory"}}, {{"start", "trajectory"}}});
  arm = refusing(std::move(arm),
                 {not_yet("axes"),
                  not_yet("cost"),
                  {"wait", "is of an arm whose joints are held",
                   "a file of the other arm alone, with the joints of this one in `robot.hold`"}});
  return list(std::move(arm), 2);
}

/// Returns the keys that only jobs have.
Keys job_keys() {
  Keys keys = join(
      {{"home", configuration_without_roll(), "",
        in_words("the job begins and ends at its strokes"),
        "`{joints: [...]}`, seven numbers (rad), or six of an arm of six joints: where the arm "
        "starts and where it returns to"},
       {"order", one_of({"given", "best"}), "", otherwise("given"),
        "of the strokes: as listed, or the cheapest that is found"},
       {"rapid", number(kShare), "", otherwise(ArmTask().rapid),
        "share of the joints' speeds in transitions"}},
      keys_of_strokes(nullptr));
  for (Schema::Key& key : keys) key.beside = "strokes";
  const LiftOffs lift;
  keys.push_back(
      {"lift",
       section("lift", {{"allowed", boolean(), "", required(), "whether the tool may lift off",
                         "true or false"},
                        {"cost", number(kNonNegative), "", otherwise(lift.cost),
                         "of each lift-off, in units of the metric"},
                        {"overlap", number(kExtent), "m", otherwise(lift.overlap),
                         "how much before the end of a run the next one begins, at least"}}),
       "", in_words("every stroke is one run"),
       "[lift-offs](#lift-offs) within strokes that no single run finishes; beside `path` too"});
  return in_group("job", std::move(keys));
}

Keys start_keys() {
  const Task d;
  return {
      {"start", configuration(), "", in_words("Swivel chooses"),
       "`{joints: [...]}`, seven numbers (rad): the configuration at the first waypoint"},
      {"start_at", or_null(number(kExtent)), "m", in_words("the beginning"),
       "where on the path the `start` stands, along the whole of it"},
      {"start_tolerance", or_null(number(kStartTolerance)), "m, rad", otherwise(d.start_tolerance),
       "how far from the path the tool may stand at the `start`"},
  };
}

}  // namespace

const Schema& problem_schema() {
  static const Schema schema = [] {
    const Keys what{
        {"robot", robot(), "", required(), "the [robot](#robot)",
         "a section with urdf, base_link, tip_link"},
        {"path", path(), "", in_words("**required**, or `strokes`, or `arms`"),
         "the [path](#path) of the tool",
         "a section with waypoints or file; or `strokes`, of a job; or `arms`, of a workcell"},
        {"strokes", strokes(), "", optional(), "of a [job](#jobs) instead: the strokes"},
        {"arms", arms(), "", optional(), "of a [workcell](#workcells) instead: two arms"},
        {"scene", scene(), "", optional(), "the [bodies](#scene) that stand around"},
        {"resolution", resolution(), "", optional(), "how fine the [lattice](#resolution) is"},
        {"limits", limits(), "", optional(), "what is to be [kept](#limits)"}};
    const Keys how{
        {"cost", cost(), "", optional(), "what is [summed](#cost) over the steps of the path"},
        {"refine", refine(), "", optional(), "what [refining](#refine) weighs and keeps"},
        {"vary", vary(), "", optional(),
         "uniform random offsets of objects, for [campaigns](#vary)"}};
    return refusing(section("problem", join(join(join(what, start_keys()), how), job_keys()),
                            {{{"path", "strokes", "arms"}, true},
                             {{"start", "strokes"}},
                             {{"start", "arms"}},
                             {{"start_at", "strokes"}},
                             {{"start_at", "arms"}},
                             {{"start_tolerance", "strokes"}},
                             {{"start_tolerance", "arms"}},
                             {{"lift", "arms"}}}),
                    {});
  }();
  return schema;
}

}  // namespace swivel::io
