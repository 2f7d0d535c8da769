// SPDX-License-Identifier: BSD-3-Clause
// Names of bodies, as hostile as they may be, in every drawing.
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "page_data.hpp"
#include "robots.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/report/lattice_map.hpp"
#include "swivel/report/overview.hpp"
#include "swivel/report/page.hpp"

namespace swivel {
namespace {

using namespace test;

TEST(Names, OfBodiesStayWordsInEveryDrawing) {
  for (const std::string name : {"<!--<script>", "</script><script>", "a - b", "]]>&lt;\"'",
                                 "Türgriff 扉", "%s%n", "$&@@DATA@@"}) {
    SCOPED_TRACE(name);
    PathProblem problem =
        episode_problem(io::load_path_problem(data_dir() / "problems" / "experiment_c.yaml"), 1,
                        258);  // the post blocks it
    problem.source = name;
    problem.resolution = {0.02, 0.2, 0.1};
    problem.limits.edges = EdgeMode::kNodes;
    const auto post = std::find_if(problem.scene.begin(), problem.scene.end(),
                                   [](const auto& object) { return object.name == "post"; });
    ASSERT_NE(post, problem.scene.end());
    post->name = name;
    PlanOptions options;
    options.planner = PlannerKind::kEagerDp;
    Planner planner(problem);
    const PlanResult result = planner.plan(options);
    const LatticeMap map = make_map(planner.view(), true);
    bool found = false;
    for (const auto& [a, b] : map.blockers) found = found || a == name || b == name;
    EXPECT_TRUE(found);

    tinyxml2::XMLDocument svg;
    ASSERT_EQ(svg.Parse(to_svg(map).c_str()), tinyxml2::XML_SUCCESS);
    tinyxml2::XMLPrinter printer;
    svg.Print(&printer);
    found = false;
    for (auto* e = svg.RootElement()->FirstChildElement("text"); e != nullptr;
         e = e->NextSiblingElement("text"))
      found = found || std::string_view(e->GetText()).find(name) != std::string_view::npos;
    EXPECT_TRUE(found);
    EXPECT_EQ(to_svg(map).find("]]>"), std::string::npos);
    std::string text = to_text(map, 100, false);
    EXPECT_NE(text.find(name), std::string::npos);
    text.erase(std::remove(text.begin(), text.end(), '\n'), text.end());
    EXPECT_TRUE(is_valid_name(text));

    EXPECT_EQ(nlohmann::json::parse(io::to_json(result))["status"], to_string(result.status));
    if (!page_available()) continue;
    const nlohmann::json json =
        nlohmann::json::parse(data_of(to_page(planner.view(), map, io::to_json(result))));
    EXPECT_EQ(json["problem"], std::filesystem::path(name).filename().string());
    found = false;
    for (const auto& body : json["bodies"]) found = found || body["name"] == name;
    EXPECT_TRUE(found);
    found = false;
    for (const auto& pair : json["map"]["blockers"])
      found = found || (pair.size() == 2 && (pair[0] == name || pair[1] == name));
    EXPECT_TRUE(found);
  }
}

TEST(Names, ThatNobodyCheckedDoNotEscape) {
  LatticeMap map;
  map.layers = map.angles = 2;
  map.s = {0, 1};
  map.blockers = {{"a\x1b[31m\xff", "b\n"}};
  map.nodes.resize(static_cast<std::size_t>(map.layers * map.solutions() * map.angles),
                   {NodeState::kBlocked, 0});
  std::string text = to_text(map, 100, false);
  text.erase(std::remove(text.begin(), text.end(), '\n'), text.end());
  EXPECT_TRUE(is_valid_name(text)) << text;
  std::string svg = to_svg(map);
  svg.erase(std::remove(svg.begin(), svg.end(), '\n'), svg.end());
  EXPECT_TRUE(is_valid_name(svg));
}

TEST(Names, InTheOverview) {
  if (!page_available()) GTEST_SKIP() << "built without pages";
  EpisodeRow row;
  row.status = PlanStatus::kInfeasible;
  row.reason = "<!--<script> - \xff";
  CampaignFacts facts;
  facts.problem = "</script>\xff";
  facts.episodes = 1;
  const std::string data = data_of(to_overview({row}, facts));
  EXPECT_EQ(nlohmann::json::parse(data)["rows"][0]["reason"], "<!--<script> - \uFFFD");
}

}  // namespace
}  // namespace swivel
