// SPDX-License-Identifier: BSD-3-Clause
#include "results/result_parts.hpp"

#include "tables/run_settings.hpp"

namespace swivel::io {

Json lattice_json(const LatticeInfo& lattice, bool solved) {
  Json json = {{"layers", lattice.layers}};
  if (lattice.grid) {
    json["phi"] = lattice.grid->phi;
    json["branches"] = lattice.grid->branches;
    json["windings"] = lattice.grid->windings;
    json["window"] = lattice.grid->window;
    if (lattice.grid->rolls) json["rolls"] = *lattice.grid->rolls;
  }
  if (lattice.arcs) json["arcs"] = *lattice.arcs;
  if (const auto& knots = lattice.knots) {
    json["knot_bound"] = knots->bound ? Json(*knots->bound) : Json(nullptr);
    json["knot_gap"] = solved && knots->gap ? Json(*knots->gap) : Json(nullptr);
    json["bias"] = solved && knots->bias ? Json(*knots->bias) : Json(nullptr);
    json["halved"] = knots->halved;
  }
  json["nodes"] = lattice.nodes;
  json["merged_waypoints"] = lattice.merged_waypoints;
  json["cost"] = solved ? Json(lattice.cost) : Json(nullptr);
  if (!lattice.method.empty()) json["method"] = lattice.method;
  json["complete"] = lattice.complete;
  return json;
}

Json counters_json(const Counters& counters) {
  return {{"ik_nodes", counters.ik_nodes},
          {"edges", counters.edges},
          {"nodes_checked", counters.nodes_checked},
          {"edges_checked", counters.edges_checked},
          {"fcl_calls", counters.fcl_calls},
          {"certified_free", counters.proved_free},
          {"certified_colliding", counters.proved_colliding},
          {"expansions", counters.expansions},
          {"iterations", counters.iterations}};
}

Json time_json(const std::map<std::string, double>& time_ms) {
  Json json = {{"load", 0.0}, {"prepare", 0.0}, {"plan", 0.0}, {"check", 0.0}, {"report", 0.0}};
  Json stages = Json::object();
  for (const auto& [name, value] : time_ms) (json.contains(name) ? json : stages)[name] = value;
  json["stages"] = std::move(stages);
  return json;
}

Json text_or_null(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

Json cause_json(const Cause& cause) {
  if (cause.kind == Cause::Kind::kNone || cause.kind == Cause::Kind::kNotAsked) return nullptr;
  return {{"cause", to_string(cause.kind)},
          {"joint", text_or_null(cause.joint)},
          {"other_joints", cause.other_joints},
          {"unwinds", cause.unwinds},
          {"side", text_or_null(to_string(cause.side))},
          {"bodies", cause.bodies[0].empty() ? Json(nullptr) : Json(cause.bodies)},
          {"between_layers", cause.between_layers},
          {"object", text_or_null(cause.object)},
          {"check", text_or_null(cause.check)},
          {"by", or_null(cause.by())},
          {"value", or_null(cause.value)},
          {"limit", or_null(cause.limit)},
          {"over", or_null(cause.over)},
          {"unit", text_or_null(cause.unit())}};
}

Json waypoint_json(int waypoint) {
  return waypoint < 0 ? Json(nullptr) : Json(waypoint);
}

Json diagnosis_json(const Diagnosis& diagnosis) {
  Json together = Json::array(), empty = Json::array(), removed = Json::object();
  for (const Cause& cause : diagnosis.together) together.push_back(cause_json(cause));
  for (const EmptyLayers& run : diagnosis.empty_layers)
    empty.push_back(
        {{"layers", {run.first, run.last}},
         {"s", {run.first_s, run.last_s}},
         {"waypoints",
          run.first_waypoint < 0 ? Json(nullptr) : Json({run.first_waypoint, run.last_waypoint})},
         {"reason", words(run.cause)},
         {"cause", cause_json(run.cause)},
         {"most", or_null(run.most)}});
  for (const Diagnosis::Removed& one : diagnosis.removed) removed[words(one.cause)] = one.count;
  return {
      {"reached_layer", or_null(diagnosis.reached_layer)},
      {"reached_s", or_null(diagnosis.reached_s)},
      {"reason", words(diagnosis.cause)},
      {"cause", cause_json(diagnosis.cause)},
      {"at_s", or_null(diagnosis.at_s)},
      {"waypoints", {waypoint_json(diagnosis.waypoints[0]), waypoint_json(diagnosis.waypoints[1])}},
      {"without_it", or_null(diagnosis.without_it)},
      {"without_it_s", or_null(diagnosis.without_it_s)},
      {"together", std::move(together)},
      {"empty_layers", std::move(empty)},
      {"removed", std::move(removed)},
      {"holds", to_string(diagnosis.holds())},
      {"unreachable", diagnosis.unreachable
                          ? Json{{"layer", diagnosis.unreachable->layer},
                                 {"s", diagnosis.unreachable->s},
                                 {"waypoint", waypoint_json(diagnosis.unreachable->waypoint)}}
                          : Json(nullptr)},
      {"complete", diagnosis.complete},
      {"layers_known", diagnosis.layers_known}};
}

Json row_json(const TrajectoryRow& row, bool roll, std::size_t joints) {
  Json json = {{"s", row.s},
               {"phi", row.phi},
               {"branch", row.branch},
               {"joints", joints_json(row.q, joints)}};
  if (roll) json["roll"] = row.roll;
  return json;
}

Json joints_json(const Config& q, std::size_t joints) {
  return std::vector<double>(q.data(), q.data() + joints);
}

Json trajectory_json(const std::vector<TrajectoryRow>& trajectory, std::size_t joints) {
  Json rows = Json::array();
  const bool roll = any_rolls(trajectory);
  for (const TrajectoryRow& row : trajectory) rows.push_back(row_json(row, roll, joints));
  return rows;
}

Json summary_json(const Measures& result, const std::vector<TrajectoryRow>& rows) {
  const bool solved = !rows.empty();
  const auto s_of = [&](int row) { return rows[static_cast<std::size_t>(row)].s; };
  Json json = {{"solved", solved},       {"clearance", nullptr},       {"joint_limit", nullptr},
               {"slide_limit", nullptr}, {"tool_path_error", nullptr}, {"top_tool_speed", nullptr}};
  if (!solved) return json;
  if (const auto& least = result.min_margin)
    json["clearance"] = {{"value", least->clearance},
                         {"asked", least->required},
                         {"bodies", least->bodies},
                         {"s", s_of(least->row)}};
  if (const auto& limit = result.nearest_limit)
    json["joint_limit"] = {{"joint", limit->joint},
                           {"side", to_string(limit->side)},
                           {"margin_deg", limit->margin * 180 / kPi},
                           {"s", s_of(limit->row)}};
  if (const auto& limit = result.nearest_slide_limit)
    json["slide_limit"] = {{"joint", limit->joint},
                           {"side", to_string(limit->side)},
                           {"margin_mm", 1e3 * limit->margin},
                           {"s", s_of(limit->row)}};
  if (const auto& error = result.tool_path_error_mm; result.evidence.tool_path_error)
    json["tool_path_error"] = {
        {"max_mm", error.max},
        {"allowed_mm", error.allowed ? Json(1e3 * *error.allowed) : Json(nullptr)},
        {"s", s_of(error.row)}};
  if (const auto& top = result.top_tool_speed)
    json["top_tool_speed"] = {{"speed", top->speed}, {"joint", top->joint}, {"s", s_of(top->row)}};
  return json;
}

namespace {

Json contact_json(const DeepestContact& contact) {
  return {{"depth", contact.depth},
          {"at_most", or_null(contact.at_most)},
          {"allowed", or_null(contact.allowed)},
          {"bodies", contact.bodies},
          {"row", contact.row}};
}

Json margin_json(const LeastMargin& least) {
  return {{"margin", least.margin},
          {"clearance", least.clearance},
          {"required", least.required},
          {"bodies", least.bodies},
          {"row", least.row}};
}

Json reduced_json(const std::vector<SpecialPair>& pairs) {
  Json list = Json::array();
  for (const SpecialPair& pair : pairs)
    list.push_back({{"bodies", pair.bodies},
                    {"median", pair.median},
                    {"clearance", pair.clearance},
                    {"edge_clearance", pair.edge_clearance}});
  return list;
}

Json dropped_json(const std::vector<SpecialPair>& pairs) {
  Json list = Json::array();
  for (const SpecialPair& pair : pairs) list.push_back({{"bodies", pair.bodies}});
  return list;
}
Json peaks_json(const TimedPath& motion, const JointNames& names) {
  Json json = Json::object();
  for (const JointRate rate : {JointRate::kSpeed, JointRate::kAcceleration, JointRate::kJerk}) {
    Json joints = Json::array();
    for (const TimedPath::Peak& peak : motion.peaks[static_cast<std::size_t>(rate)])
      joints.push_back({{"joint", names[static_cast<std::size_t>(peak.joint)]},
                        {"ratio", peak.ratio},
                        {"t", peak.t},
                        {"s", peak.s}});
    json[to_string(rate)] = std::move(joints);
  }
  return json;
}

}  // namespace

void add_robot(Json& json, const ArmAnswer& arm, const std::vector<std::string>& warnings) {
  json["robot_pairs"] = {{"dropped", dropped_json(arm.dropped_pairs)},
                         {"reduced", reduced_json(arm.reduced_pairs)}};
  json["held"] = held_json(arm.held);
  json["warnings"] = warnings;
  json["joint_names"] = std::vector<std::string>(
      arm.joint_names.begin(),
      arm.joint_names.begin() + static_cast<std::ptrdiff_t>(named_joints(arm.joint_names)));
}

Json partial_json(const ArmAnswer& arm) {
  return trajectory_json(
      arm.partial.empty() ? std::vector<TrajectoryRow>() : arm.partial.front().rows,
      named_joints(arm.joint_names));
}

void add_measures(Json& json, const Measures& result, bool solved) {
  // Numbers about a trajectory are null where there is none: a zero would read as a perfect one.
  const auto if_known = [&](bool known, double value) {
    return solved && known ? Json(value) : Json(nullptr);
  };
  const Evidence& evidence = result.evidence;
  json["tool_path_error_mm"] = {
      {"mean", if_known(evidence.tool_path_error, result.tool_path_error_mm.mean)},
      {"max", if_known(evidence.tool_path_error, result.tool_path_error_mm.max)}};
  json["min_clearance"] = or_null(result.min_clearance);
  json["min_clearance_status"] = to_string(result.min_clearance_status());
  json["min_margin"] = result.min_margin ? margin_json(*result.min_margin) : Json(nullptr);
  json["deepest_contact"] =
      result.deepest_contact ? contact_json(*result.deepest_contact) : Json(nullptr);
  json["deepest_contact_status"] = to_string(result.deepest_contact_status());
  json["min_manipulability"] = if_known(evidence.postures, result.min_manipulability);
  json["arm_angle"] = result.arm_angle;
}

std::string document_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

Json refinement_json(const Refined& refined) {
  return {{"refined", refined.refined},         {"reason", text_or_null(refined.reason)},
          {"cost_before", refined.cost_before}, {"cost", refined.cost},
          {"bend_before", refined.bend_before}, {"bend", refined.bend},
          {"rounds", refined.rounds},           {"nodes_asked", refined.nodes_asked},
          {"edges_asked", refined.edges_asked}, {"second_seed", refined.from_second_seed}};
}

Json advice_json(const Advice& one) {
  const auto vector = [](const Vector3d& offset) {
    return Json({offset.x(), offset.y(), offset.z()});
  };
  const bool moves =
      one.change == Advice::Change::kMoveObject || one.change == Advice::Change::kMovePaths;
  return {{"change", to_string(one.change)},
          {"words", words(one)},
          {"object", one.object.empty() ? Json(nullptr) : Json(one.object)},
          {"from", or_null(one.from)},
          {"to", or_null(one.to)},
          {"offset", moves ? vector(one.offset) : Json(nullptr)},
          {"also", one.also.empty() ? Json(nullptr) : Json(one.also)},
          {"also_offset", moves && !one.also.empty() ? vector(one.also_offset) : Json(nullptr)},
          {"outcome", to_string(one.outcome)},
          {"cost", or_null(one.cost)},
          {"reached_s", or_null(one.reached_s)}};
}

Json advice_json(const std::vector<Advice>& advice) {
  Json list = Json::array();
  for (const Advice& one : advice) list.push_back(advice_json(one));
  return list;
}

void add_motion_measures(Json& json, const TimedPath& motion, const JointNames& names) {
  Json slow = Json::array(), stops = Json::array();
  for (const TimedPath::Slow& stretch : motion.slow)
    slow.push_back(
        {{"s", {stretch.from_s, stretch.to_s}},
         {"t", {stretch.from_t, stretch.to_t}},
         {"share", stretch.share},
         {"joint", names[static_cast<std::size_t>(stretch.joint)]},
         {"reason", to_string(stretch.reason)},
         {"singular", text_or_null(stretch.singular)},
         {"singular_angle_deg",
          stretch.singular.empty() ? Json(nullptr) : Json(stretch.singular_angle * 180 / kPi)}});
  for (const TimedPath::Stop& stop : motion.stops)
    stops.push_back({{"waypoint", waypoint_json(stop.waypoint)}, {"s", stop.s}, {"t", stop.t}});
  json["peaks"] = peaks_json(motion, names);
  json["slow"] = std::move(slow);
  json["corners"] = {{"rounded", motion.rounded},
                     {"position", motion.rounded_position},
                     {"angle", motion.rounded_angle},
                     {"stops", std::move(stops)}};
  json["between_samples"] = {{"position", motion.between_position},
                             {"angle", motion.between_angle}};
  json["warnings"] = motion.warnings;
}

}  // namespace swivel::io
