// SPDX-License-Identifier: BSD-3-Clause
// What one plan is made of, piece by piece, on experiment C at resolution #4. Inputs are drawn from
// a fixed seed into pools that are cycled, so that no branch learns one input. items_per_second
// counts what the name says: nodes, questions, expansions. Names that end in a vector unit depend
// on it: SWIVEL_FORCE_ISA=scalar|avx2|avx512 picks one for the whole process.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "context.hpp"
#include "exact/pair_test.hpp"
#include "proofs/distance_proof.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/base/isa.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/graph/search/path_first.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace {

using namespace swivel;
using namespace swivel::detail;

constexpr std::size_t kPool = 1024;
constexpr double kAsked = 0.005;  // m, the clearance that pairs are asked about

class Random {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1.0p-53);
  }
  Vector3d in_cube(double half) {
    return {uniform(-half, half), uniform(-half, half), uniform(-half, half)};
  }
  Pose pose(double half) {
    Pose pose;
    pose.translation() = in_cube(half);
    pose.linear() =
        Quaterniond(Eigen::Vector4d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(0.1, 1))
                        .normalized())
            .toRotationMatrix();
    return pose;
  }

 private:
  std::mt19937_64 engine_{1};
};

/// Experiment C and what all pieces share. Never moved: the lattice points into it.
struct Fixture {
  explicit Fixture(const std::filesystem::path& file)
      : problem(io::load_path_problem(file)),
        robot(problem),
        path(waypoints_in_base(problem), problem.resolution, problem.source),
        lattice(robot.arm().chain, robot.srs(), path, problem),
        world(robot.world(), problem) {
    rule = world.edge_rule(robot.radii());
    LayerNodes here, next;
    while (nodes.size() < kPool) {
      const int layer = static_cast<int>(random.uniform(0, lattice.layers() - 1));
      const int slot = static_cast<int>(random.uniform(0, lattice.width()));
      if (const auto q = lattice.node(layer, slot)) nodes.push_back({layer, slot, *q});
    }
    while (edges.size() < kPool) {
      const Node& a =
          nodes[static_cast<std::size_t>(random.uniform(0, static_cast<double>(nodes.size())))];
      const int b =
          lattice.solution_of(a.slot) * lattice.angles() + lattice.run_after(a.layer, a.slot).first;
      const auto q = lattice.node(a.layer + 1, b);
      if (q && lattice.in_window(a.layer, a.slot, b) &&
          lattice.step_allowed(a.layer, lattice.delta(a.q, *q)))
        edges.push_back({a, b, *q});
    }
    World::Query query(world);  // FCL's trees of meshes are built at its first question
    for (const Node& x : nodes)
      static_cast<void>(query.find_violating_pair(x.q, ClearanceRule::kNode));
  }
  Fixture(const Fixture&) = delete;

  struct Node {
    int layer, slot;
    Config q;
  };
  struct Edge {
    Node a;
    int b;
    Config q;
  };
  Random random;
  PathProblem problem;
  PreparedRobot robot;
  ToolPath path;
  SrsLattice lattice;
  World world;
  EdgeRule rule;
  std::vector<Node> nodes;
  std::vector<Edge> edges;
};

/// A capsule about the size of a link near another body, at clearances on both sides of kAsked.
struct Pairs {
  MeshStore store;
  FclShape capsule, other;
  std::vector<Pose> poses;
  Pose origin = Pose::Identity();

  explicit Pairs(const Shape& shape)
      : capsule(make_fcl_shape(Capsule{0.05, 0.2}, store)), other(make_fcl_shape(shape, store)) {
    Random random;
    PairTest test;
    // Half of the pool below the asked clearance, half above; nothing further away than a link's
    // length.
    std::size_t below = 0;
    const double half = other.bound.reach + 0.2;
    while (poses.size() < kPool) {
      Pose pose = random.pose(half);
      pose.translation() += other.bound.center;
      const double clearance = test.clearance({&capsule, &pose}, {&other, &origin});
      if (clearance > 0.2 ||
          (clearance < kAsked ? below >= kPool / 2 : poses.size() - below >= kPool / 2))
        continue;
      below += clearance < kAsked;
      poses.push_back(pose);
    }
  }
};

template <class Body>
void add(const std::string& name, Body body) {
  benchmark::RegisterBenchmark(name.c_str(), body);
}

/// Calls body(item) with the pool's items one after the other; each call is one item of work.
template <class Pool, class Body>
void cycle(benchmark::State& state, const Pool& pool, Body body) {
  std::size_t k = 0;
  for (auto _ : state) {
    auto result = body(pool[k]);
    benchmark::DoNotOptimize(result);
    k = (k + 1) % pool.size();
  }
  state.SetItemsProcessed(state.iterations());
}

void add_kinematics(Fixture& c) {
  const std::string unit = std::string("/") + to_string(active_isa());
  const SrsLattice& lattice = c.lattice;
  add("ik/layer" + unit, [&](benchmark::State& state) {
    LayerNodes nodes;
    int layer = 0;
    for (auto _ : state) {
      lattice.solve(layer, nodes);
      benchmark::DoNotOptimize(nodes.q(0, 0));
      layer = (layer + 1) % lattice.layers();
    }
    state.SetItemsProcessed(state.iterations() * lattice.width());
  });
  add("ik/single_node" + unit, [&](benchmark::State& state) {
    cycle(state, c.nodes, [&](const Fixture::Node& x) { return lattice.node(x.layer, x.slot); });
  });
  add("ik/closed_form_libm", [&](benchmark::State& state) {
    std::vector<std::array<ElbowCircle, 2>> circles;
    for (int i = 0; i < lattice.layers(); ++i)
      circles.push_back(
          elbow_circles(lattice.arm(), lattice.plane(i), lattice.path().layer(i).tool));
    cycle(state, c.nodes, [&](const Fixture::Node& x) {
      return srs_ik(lattice.arm(), circles[static_cast<std::size_t>(x.layer)],
                    lattice.phi(x.layer, x.slot), lattice.branch_of(x.slot));
    });
  });
  const Chain& chain = lattice.chain();
  add("forward_kinematics", [&](benchmark::State& state) {
    cycle(state, c.nodes, [&](const Fixture::Node& x) { return chain.tool(x.q); });
  });
  add("jacobian", [&](benchmark::State& state) {
    cycle(state, c.nodes, [&](const Fixture::Node& x) { return chain.jacobian(x.q); });
  });
  add("manipulability", [&](benchmark::State& state) {
    cycle(state, c.nodes, [&](const Fixture::Node& x) { return chain.manipulability(x.q); });
  });
  add("step_error", [&](benchmark::State& state) {
    cycle(state, c.edges, [&](const Fixture::Edge& x) {
      const double phi = lattice.phi(x.a.layer, x.a.slot);
      return step_error(lattice, x.a.layer, 0, lattice.branch_of(x.a.slot), phi,
                        lattice.phi(x.a.layer + 1, x.b) - phi);
    });
  });
  add("tool_path_error", [&](benchmark::State& state) {
    cycle(state, c.edges, [&](const Fixture::Edge& x) {
      return path_deviation(chain, lattice.path(), x.a.layer, x.a.q, lattice.delta(x.a.q, x.q));
    });
  });
}

void add_search(Fixture& c) {
  const std::string unit = std::string("/") + to_string(active_isa());
  for (const auto& [name, what] :
       {std::pair{"whole", Pruning::kNone}, {"bounded", Pruning::kByBound}}) {
    const auto extent = what;  // a structured binding cannot be captured
    add(std::string("sweep/") + name + unit, [&c, extent](benchmark::State& state) {
      for (auto _ : state) {
        const auto cost_to_go = make_cost_to_go(c.lattice, extent);
        cost_to_go->sweep(c.lattice.layers() - 1);
        benchmark::DoNotOptimize(cost_to_go->best());
      }
      state.SetItemsProcessed(state.iterations() * c.lattice.nodes());
    });
  }
  add("a_star/expansion", [&](benchmark::State& state) {
    const auto cost_to_go = make_cost_to_go(c.lattice);
    cost_to_go->sweep(c.lattice.layers() - 1);
    std::int64_t expansions = 0;
    for (auto _ : state) benchmark::DoNotOptimize(best_path(*cost_to_go, expansions).data());
    state.SetItemsProcessed(expansions);
  });
}

/// Adds the distance tests of a capsule and each other shape.
void add_pairs(const Fixture& c, const std::filesystem::path& problems) {
  const auto door = [](const PathProblem& problem) { return problem.scene.front().shape; };
  const std::pair<const char*, Shape> shapes[] = {
      {"sphere", Sphere{0.1}},
      {"capsule", Capsule{0.05, 0.3}},
      {"box", Box{Vector3d(0.2, 0.3, 0.4)}},
      {"cylinder", Cylinder{0.1, 0.4}},
      {"mesh_2k", door(c.problem)},
      {"mesh_20k", door(io::load_path_problem(problems / "experiment_c_20k.yaml"))}};
  for (const auto& [name, shape] : shapes) {
    const auto pairs = std::make_shared<Pairs>(shape);  // shared: three benchmarks read it
    const std::string end = std::string("/capsule-") + name;
    add("fcl/below" + end, [=](benchmark::State& state) {
      PairTest test;
      cycle(state, pairs->poses, [&](const Pose& pose) {
        return test.below({&pairs->capsule, &pose}, {&pairs->other, &pairs->origin}, kAsked);
      });
    });
    add("fcl/clearance" + end, [=](benchmark::State& state) {
      PairTest test;
      cycle(state, pairs->poses, [&](const Pose& pose) {
        return test.clearance({&pairs->capsule, &pose}, {&pairs->other, &pairs->origin});
      });
    });
    add("certificate" + end, [=](benchmark::State& state) {
      std::size_t undecided = 0;
      cycle(state, pairs->poses, [&](const Pose& pose) {
        const DistanceProof answer =
            prove_distance({&pairs->capsule, &pose}, {&pairs->other, &pairs->origin}, kAsked);
        undecided += answer == DistanceProof::kNone;
        return answer;
      });
      state.counters["undecided"] =
          static_cast<double>(undecided) / static_cast<double>(state.iterations());
    });
  }
}

/// Adds the collision queries of postures and motions.
void add_queries(Fixture& c) {
  PlanOptions options;
  options.check = false;  // the time of planning is measured
  options.planner = PlannerKind::kLazy;
  add("posture/kept",
      [&c, rows = plan(c.robot, c.problem, options).trajectory](benchmark::State& state) {
        World::Query query(c.world, DistanceProofs::kOn);
        cycle(state, rows, [&](const TrajectoryRow& row) {
          return query.find_violating_pair_incremental(row.q, ClearanceRule::kNode);
        });
      });
  for (const auto& [name, distance_proofs] :
       {std::pair{"fcl", DistanceProofs::kOff}, {"certificates", DistanceProofs::kOn}}) {
    const auto who = distance_proofs;  // a structured binding cannot be captured
    add(std::string("posture/") + name, [&c, who](benchmark::State& state) {
      World::Query query(c.world, who);
      cycle(state, c.nodes, [&](const Fixture::Node& x) {
        return query.find_violating_pair(x.q, ClearanceRule::kNode);
      });
    });
    add(std::string("motion/") + name, [&c, who](benchmark::State& state) {
      World::Query query(c.world, who);
      cycle(state, c.edges,
            [&](const Fixture::Edge& x) { return edge_blocked(query, c.rule, x.a.q, x.q); });
    });
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path problems = std::filesystem::path(SWIVEL_DATA_DIR) / "problems";
  Fixture c(problems / "experiment_c.yaml");
  add_kinematics(c);
  add_search(c);
  add_pairs(c, problems);
  add_queries(c);
  for (const auto& [key, value] : bench::context()) benchmark::AddCustomContext(key, value);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
