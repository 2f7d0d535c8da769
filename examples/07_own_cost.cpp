// SPDX-License-Identifier: BSD-3-Clause
// A cost of one's own: joints are to stay near the middle of their range. It is added to the cost
// of the path.
#include <iostream>
#include <memory>
#include <swivel/io/io.hpp>
#include <swivel/planner/plan/planner.hpp>

class NearTheMiddle : public swivel::StateCost {
 public:
  explicit NearTheMiddle(double weight) : weight_(weight) {}
  [[nodiscard]] std::string name() const override { return "near the middle"; }
  void costs(std::span<const swivel::Config> states, std::span<double> costs) override {
    for (std::size_t k = 0; k < states.size(); ++k) costs[k] = weight_ * states[k].squaredNorm();
  }

 private:
  double weight_;  // per layer and rad^2
};

int main(int argc, char** argv) {
  swivel::PathProblem problem =
      swivel::io::load_path_problem(argc > 1 ? argv[1] : "data/problems/experiment_a.yaml");
  problem.resolution = {.ds = 0.02, .dphi = 0.1};
  for (const double weight : {0.0, 0.02}) {
    swivel::PlanOptions options;
    options.hooks.cost = std::make_shared<NearTheMiddle>(weight);
    const swivel::PlanResult result = swivel::plan(problem, options);
    double sum = 0;
    for (const swivel::TrajectoryRow& row : result.trajectory) sum += row.q.norm();
    std::cout << "weight " << weight << ": cost " << result.cost
              << ", mean distance from the middle "
              << sum / static_cast<double>(result.trajectory.size()) << " rad\n";
  }
}
