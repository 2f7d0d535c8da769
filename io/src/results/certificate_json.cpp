// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "files/bad_input.hpp"
#include "files/files.hpp"
#include "results/result_parts.hpp"
#include "swivel/io/results/result.hpp"

namespace swivel::io {

namespace {

using Parsed = nlohmann::json;  // ordered_json looks for each key among all before it

constexpr const char* kFormat = "swivel certificate 1";
constexpr const char* kWorkcellFormat = "swivel certificate of a workcell 1";

Json witness_json(const Cause& cause) {
  Json json = {{"cause", to_string(cause.kind)}};
  if (!cause.joint.empty()) json["joint"] = cause.joint;
  if (cause.side != Cause::Side::kNone) json["side"] = to_string(cause.side);
  if (!cause.bodies[0].empty()) json["bodies"] = cause.bodies;
  if (!cause.check.empty()) json["check"] = cause.check;
  return json;
}

Json layer_json(int number, const InfeasibilityCertificate::Layer& layer) {
  Json reached = Json::array(), nodes = Json::array(), edges = Json::array();
  for (const InfeasibilityCertificate::Range& range : layer.reached)
    reached.push_back({range.first, range.last});
  for (const InfeasibilityCertificate::Nodes& removed : layer.removed)
    nodes.push_back({removed.slots.first, removed.slots.last, removed.witness});
  for (const InfeasibilityCertificate::Edges& removed : layer.edges)
    edges.push_back({removed.tails.first, removed.tails.last, removed.heads.first,
                     removed.heads.last, removed.witness, removed.count});
  return {{"layer", number},
          {"slots", layer.slots},
          {"reached", reached},
          {"nodes", nodes},
          {"edges", edges}};
}

/// Reads values of a certificate; error messages name the key.
class Reader {
 public:
  explicit Reader(std::string file) : file_(std::move(file)) {}

  [[noreturn]] void fail(const std::string& key, const std::string& what,
                         const std::string& allowed) const {
    bad_input(file_, key + ": " + what, allowed);
  }
  const Parsed& at(const Parsed& object, const char* key, const std::string& where) const {
    if (!object.is_object()) fail(where, "is no object", "what plan --certificate writes");
    const auto found = object.find(key);
    if (found == object.end()) fail(where + key, "is missing", "what plan --certificate writes");
    return *found;
  }
  /// Refuses an object with another key than these.
  void only(const Parsed& object, const std::string& where,
            std::initializer_list<std::string_view> keys) const {
    if (!object.is_object()) return;  // at() says so
    for (const auto& [key, value] : object.items())
      if (std::find(keys.begin(), keys.end(), key) == keys.end())
        fail(where + key, "is unknown here", "what plan --certificate writes");
  }
  std::int64_t whole(const Parsed& value, const std::string& key,
                     std::int64_t most = std::numeric_limits<int>::max()) const {
    if (!value.is_number_integer() || value.get<double>() < 0 ||
        value.get<double>() > static_cast<double>(most))
      fail(key, "is no number of this kind", "whole numbers from 0 to " + std::to_string(most));
    return value.get<std::int64_t>();
  }
  int small(const Parsed& value, const std::string& key) const {
    return static_cast<int>(whole(value, key));
  }
  double real(const Parsed& value, const std::string& key) const {
    if (!value.is_number()) fail(key, "is no number", "a number");
    return value.get<double>();
  }
  bool truth(const Parsed& value, const std::string& key) const {
    if (!value.is_boolean()) fail(key, "is neither", "true or false");
    return value.get<bool>();
  }
  std::string text(const Parsed& value, const std::string& key) const {
    if (!value.is_string()) fail(key, "is no text", "a text");
    return value.get<std::string>();
  }
  const Parsed& list(const Parsed& value, const std::string& key,
                     std::optional<std::size_t> size = {}) const {
    if (!value.is_array() || (size && value.size() != *size))
      fail(key, "is no list" + (size ? " of " + std::to_string(*size) : ""),
           "what plan --certificate writes");
    return value;
  }

 private:
  std::string file_;
};

/// Returns how deep lists and objects are nested in JSON. The parser's own callback could tell, but
/// would make lists of objects take quadratic time.
int depth_of(std::string_view text) {
  int depth = 0, most = 0;
  bool quoted = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (c == '"') quoted = !quoted;
    if (quoted) {
      k += c == '\\' ? 1 : 0;
      continue;
    }
    if (c == '[' || c == '{') most = std::max(most, ++depth);
    if (c == ']' || c == '}') --depth;
  }
  return most;
}

Cause witness_of(const Reader& read, const Parsed& json, const std::string& key) {
  Cause cause;
  read.only(json, key, {"cause", "joint", "side", "bodies", "check"});
  const std::string name = read.text(read.at(json, "cause", key), key + "cause");
  for (int kind = static_cast<int>(Cause::Kind::kReach);
       kind <= static_cast<int>(Cause::Kind::kCheck); ++kind)
    if (name == to_string(static_cast<Cause::Kind>(kind)))
      cause.kind = static_cast<Cause::Kind>(kind);
  if (cause.kind == Cause::Kind::kNone)
    read.fail(key + "cause", "'" + name + "' is unknown", "the causes of docs/formats.md");
  if (json.contains("joint")) cause.joint = read.text(json["joint"], key + "joint");
  if (json.contains("check")) cause.check = read.text(json["check"], key + "check");
  if (json.contains("side")) {
    const std::string side = read.text(json["side"], key + "side");
    if (side != "lower" && side != "upper")
      read.fail(key + "side", "'" + side + "' is unknown", "lower or upper");
    cause.side = side == "lower" ? Cause::Side::kLower : Cause::Side::kUpper;
  }
  if (json.contains("bodies")) {
    const Parsed& bodies = read.list(json["bodies"], key + "bodies", 2);
    cause.bodies = {read.text(bodies[0], key + "bodies"), read.text(bodies[1], key + "bodies")};
  }
  return cause;
}

InfeasibilityCertificate::Layer layer_of(const Reader& read, const Parsed& json,
                                         const std::string& key) {
  InfeasibilityCertificate::Layer layer;
  read.only(json, key, {"layer", "slots", "reached", "nodes", "edges"});
  layer.slots = read.small(read.at(json, "slots", key), key + "slots");
  const auto each = [&](const char* name, std::size_t size, const auto& take) {
    const std::string where = key + name;
    for (const Parsed& range : read.list(read.at(json, name, key), where)) {
      read.list(range, where, size);
      take([&](std::size_t k) { return read.small(range[k], where); });
    }
  };
  each("reached", 2, [&](const auto& at) { layer.reached.push_back({at(0), at(1)}); });
  each("nodes", 3, [&](const auto& at) { layer.removed.push_back({{at(0), at(1)}, at(2)}); });
  each("edges", 6, [&](const auto& at) {
    layer.edges.push_back({{at(0), at(1)}, {at(2), at(3)}, at(4), at(5)});
  });
  return layer;
}

/// Returns what says of which lattice a certificate is: resolution, edges and windings.
Json layout_json(const Resolution& resolution, EdgeMode edges,
                 const std::vector<std::array<bool, kDof>>& windings) {
  Json told_apart = Json::array();
  for (const auto& joints : windings) {
    Json told = Json::array();
    for (std::size_t j = 0; j < kDof; ++j)
      if (joints[j]) told.push_back(j);
    told_apart.push_back(std::move(told));
  }
  Json steps = {{"ds", resolution.ds},
                {"dphi", resolution.dphi},
                {"dalpha", resolution.dalpha},
                {"arcs", resolution.arcs}};
  if (resolution.arc) steps["arc"] = *resolution.arc;
  if (resolution.knot.value_or(0) > 0) steps["knot"] = *resolution.knot;
  return {{"resolution", std::move(steps)},
          {"edges", edges == EdgeMode::kContinuous ? "continuous" : "nodes"},
          {"windings", std::move(told_apart)}};
}

Json witnesses_json(const InfeasibilityCertificate& cut) {
  Json witnesses = Json::array();
  for (const Cause& cause : cut.witnesses) witnesses.push_back(witness_json(cause));
  return witnesses;
}

std::string line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Reads what layout_json() writes.
void read_layout(const Reader& read, const Parsed& json, const std::string& key,
                 Resolution& resolution, EdgeMode& mode,
                 std::vector<std::array<bool, kDof>>& windings) {
  const std::string within = key + "resolution.";
  const Parsed& steps = read.at(json, "resolution", key);
  read.only(steps, within, {"ds", "dphi", "dalpha", "arc", "arcs", "knot"});
  const auto real = [&](const char* name) {
    return read.real(read.at(steps, name, within), within + name);
  };
  resolution.ds = real("ds");
  resolution.dphi = real("dphi");
  resolution.dalpha = real("dalpha");
  if (steps.contains("arc")) resolution.arc = real("arc");
  resolution.knot = steps.contains("knot") ? real("knot") : 0;
  resolution.arcs = read.truth(read.at(steps, "arcs", within), within + "arcs");
  const std::string edges = read.text(read.at(json, "edges", key), key + "edges");
  if (edges != "continuous" && edges != "nodes")
    read.fail(key + "edges", "'" + edges + "' is unknown", "continuous or nodes");
  mode = edges == "nodes" ? EdgeMode::kNodes : EdgeMode::kContinuous;
  for (const Parsed& told : read.list(read.at(json, "windings", key), key + "windings")) {
    auto& joints = windings.emplace_back();
    for (const Parsed& joint : read.list(told, key + "windings"))
      joints[static_cast<std::size_t>(read.whole(joint, key + "windings", kDof - 1))] = true;
    if (windings.size() > kDof) read.fail(key + "windings", "has too many lists", "at most 7");
  }
}

/// Reads witnesses and layers of a cut.
void read_cut(const Reader& read, const Parsed& json, const std::string& key,
              InfeasibilityCertificate& cut) {
  for (const Parsed& witness : read.list(read.at(json, "witnesses", key), key + "witnesses"))
    cut.witnesses.push_back(witness_of(
        read, witness, key + "witnesses[" + std::to_string(cut.witnesses.size()) + "]."));
  for (const Parsed& layer : read.list(read.at(json, "layers", key), key + "layers")) {
    const std::string at = key + "layers[" + std::to_string(cut.band.size()) + "].";
    const int number = read.small(read.at(layer, "layer", at), at + "layer");
    if (cut.band.empty()) cut.first_layer = number;
    if (number != cut.first_layer + static_cast<int>(cut.band.size()))
      read.fail(at + "layer", "is " + std::to_string(number), "layers one after the other");
    cut.band.push_back(layer_of(read, layer, at));
  }
}

/// Reads the JSON of a certificate of a format.
Parsed parsed_certificate(const Reader& read, const std::filesystem::path& file,
                          const char* format) {
  const std::string text = read_file(file, "certificate (JSON)", kMostCertificateBytes);
  constexpr int kMostDepth = 8;
  if (depth_of(text) > kMostDepth)
    bad_input(file.string(), "is nested too deep",
              "at most " + std::to_string(kMostDepth) + " levels");
  Parsed json;
  try {
    json = Parsed::parse(text);
  } catch (const Parsed::exception& error) {
    bad_input(file.string(), error.what(), "what plan --certificate writes");
  }
  if (!json.is_object() || !json.contains("format") || json["format"] != format)
    read.fail("format", "is another", std::string("'") + format + "'");
  return json;
}

Json region_json(const WorkcellCertificate::Region& region) {
  Json json = {{"layer", region.layer}};
  Json sides = Json::array();
  const bool of_moves = !region.moves[0].empty();
  for (std::size_t k = 0; k < 2; ++k) {
    Json side = Json::array();
    for (const auto& range : region.slots[k]) side.push_back({range.first, range.last});
    for (const auto& move : region.moves[k]) side.push_back({move.from, move.to});
    sides.push_back(std::move(side));
  }
  json[of_moves ? "moves" : "nodes"] = std::move(sides);
  if (!region.bodies[0].empty()) json["bodies"] = region.bodies;
  return json;
}

WorkcellCertificate::Region region_of(const Reader& read, const Parsed& json,
                                      const std::string& key) {
  WorkcellCertificate::Region region;
  region.layer = read.small(read.at(json, "layer", key), key + "layer");
  const bool of_moves = json.contains("moves");
  read.only(json, key, {"layer", of_moves ? "moves" : "nodes", "bodies"});
  const std::string name = of_moves ? "moves" : "nodes", where = key + name;
  const Parsed& sides = read.list(read.at(json, name.c_str(), key), where, 2);
  for (std::size_t k = 0; k < 2; ++k)
    for (const Parsed& two : read.list(sides[k], where)) {
      read.list(two, where, 2);
      const int first = read.small(two[0], where), last = read.small(two[1], where);
      if (of_moves)
        region.moves[k].push_back({first, last});
      else
        region.slots[k].push_back({first, last});
    }
  if (json.contains("bodies")) {
    const Parsed& bodies = read.list(json["bodies"], key + "bodies", 2);
    region.bodies = {read.text(bodies[0], key + "bodies"), read.text(bodies[1], key + "bodies")};
  }
  return region;
}

Json set_json(const WorkcellCertificate::Branch& set) {
  Json json;
  if (set.parent >= 0) json = {{"parent", set.parent}, {"arm", set.arm}};
  if (set.region) {
    json["region"] = region_json(*set.region);
    return json;
  }
  json["without_path"] = set.arm_without_path;
  json["witnesses"] = witnesses_json(set.cut);
  Json layers = Json::array();
  for (std::size_t k = 0; k < set.cut.band.size(); ++k)
    layers.push_back(layer_json(set.cut.first_layer + static_cast<int>(k), set.cut.band[k]));
  json["layers"] = std::move(layers);
  return json;
}

WorkcellCertificate::Branch set_of(const Reader& read, const Parsed& json, const std::string& key) {
  WorkcellCertificate::Branch set;
  if (!json.is_object()) read.fail(key, "is no object", "what plan --certificate writes");
  if (json.contains("arm") && !json.contains("parent"))
    read.fail(key + "arm", "is given without a parent", "what plan --certificate writes");
  if (json.contains("parent")) {
    set.parent = read.small(json["parent"], key + "parent");
    set.arm = static_cast<int>(read.whole(read.at(json, "arm", key), key + "arm", 1));
  }
  if (json.contains("region")) {
    read.only(json, key, {"parent", "arm", "region"});
    set.region = region_of(read, json["region"], key + "region.");
    return set;
  }
  read.only(json, key, {"parent", "arm", "without_path", "witnesses", "layers"});
  set.arm_without_path =
      static_cast<int>(read.whole(read.at(json, "without_path", key), key + "without_path", 1));
  read_cut(read, json, key, set.cut);
  return set;
}

}  // namespace

std::string to_json(const InfeasibilityCertificate& certificate) {
  Json head = {{"format", kFormat}};
  if (!certificate.stroke.empty()) {
    head["stroke"] = certificate.stroke;
    head["reversed"] = certificate.reversed;
  }
  head.update(layout_json(certificate.resolution, certificate.edges, certificate.windings));
  if (!certificate.halvings.empty()) head["halved"] = certificate.halvings;
  head["path_layers"] = certificate.layers;
  head["witnesses"] = witnesses_json(certificate);
  std::string text = line(head);
  text.back() = ',';
  text += "\n\"layers\":[";
  for (std::size_t k = 0; k < certificate.band.size(); ++k)
    text += (k == 0 ? "\n" : ",\n") +
            line(layer_json(certificate.first_layer + static_cast<int>(k), certificate.band[k]));
  return text + "\n]}\n";
}

InfeasibilityCertificate load_certificate(const std::filesystem::path& file) {
  const Reader read(file.string());
  const Parsed json = parsed_certificate(read, file, kFormat);
  InfeasibilityCertificate certificate;
  read.only(json, "",
            {"format", "stroke", "reversed", "resolution", "edges", "windings", "halved",
             "path_layers", "witnesses", "layers"});
  if (json.contains("reversed") && !json.contains("stroke"))
    read.fail("reversed", "is given without a stroke", "what plan --certificate writes");
  if (json.contains("stroke")) {
    certificate.stroke = read.text(json["stroke"], "stroke");
    certificate.reversed = read.truth(read.at(json, "reversed", ""), "reversed");
  }
  read_layout(read, json, "", certificate.resolution, certificate.edges, certificate.windings);
  if (json.contains("halved")) {
    for (const Parsed& steps : read.list(json["halved"], "halved")) {
      std::set<int>& halved = certificate.halvings.emplace_back();
      for (const Parsed& item : read.list(steps, "halved")) {
        const int step = read.small(item, "halved");
        if (!halved.empty() && step <= *halved.rbegin())
          read.fail("halved", std::to_string(step) + " follows " + std::to_string(*halved.rbegin()),
                    "steps of one search in ascending order, each once");
        halved.insert(step);
      }
    }
  }
  certificate.layers = read.small(read.at(json, "path_layers", ""), "path_layers");
  read_cut(read, json, "", certificate);
  return certificate;
}

std::string to_json(const WorkcellCertificate& certificate) {
  Json arms = Json::array();
  for (std::size_t k = 0; k < 2; ++k)
    arms.push_back(
        layout_json(certificate.resolution[k], certificate.edges[k], certificate.windings[k]));
  std::string text =
      line({{"format", kWorkcellFormat}, {"arms", arms}, {"path_layers", certificate.layers}});
  text.back() = ',';
  text += "\n\"sets\":[";
  for (std::size_t k = 0; k < certificate.tree.size(); ++k)
    text += (k == 0 ? "\n" : ",\n") + line(set_json(certificate.tree[k]));
  return text + "\n]}\n";
}

WorkcellCertificate load_workcell_certificate(const std::filesystem::path& file) {
  const Reader read(file.string());
  const Parsed json = parsed_certificate(read, file, kWorkcellFormat);
  WorkcellCertificate certificate;
  read.only(json, "", {"format", "arms", "path_layers", "sets"});
  const Parsed& arms = read.list(read.at(json, "arms", ""), "arms", 2);
  for (const Parsed& arm : arms) read.only(arm, "arms.", {"resolution", "edges", "windings"});
  for (std::size_t k = 0; k < 2; ++k)
    read_layout(read, arms[k], "arms[" + std::to_string(k) + "].", certificate.resolution[k],
                certificate.edges[k], certificate.windings[k]);
  certificate.layers = read.small(read.at(json, "path_layers", ""), "path_layers");
  for (const Parsed& set : read.list(read.at(json, "sets", ""), "sets"))
    certificate.tree.push_back(
        set_of(read, set, "sets[" + std::to_string(certificate.tree.size()) + "]."));
  return certificate;
}

}  // namespace swivel::io
