// SPDX-License-Identifier: BSD-3-Clause
// A rule of one's own: a hose allows joints 5 and 7 together so much twist and no more. All
// planners honour it as they do collision.
#include <cmath>
#include <iostream>
#include <memory>
#include <swivel/io/io.hpp>
#include <swivel/planner/plan/planner.hpp>

class Hose : public swivel::StateCheck {
 public:
  explicit Hose(double most_twist) : most_twist_(most_twist) {}  // rad
  [[nodiscard]] std::string name() const override { return "hose"; }
  void states(std::span<const swivel::Config> states, std::span<bool> allowed) override {
    for (std::size_t k = 0; k < states.size(); ++k)
      allowed[k] = std::abs(states[k][4] + states[k][6]) <= most_twist_;
    asked += states.size();
  }
  std::size_t asked = 0;

 private:
  double most_twist_;
};

int main(int argc, char** argv) {
  const swivel::PathProblem problem =
      swivel::io::load_path_problem(argc > 1 ? argv[1] : "data/problems/experiment_c.yaml");
  for (const double most_twist : {10.0, 1.0}) {
    const auto hose = std::make_shared<Hose>(most_twist);
    swivel::PlanOptions options;
    options.hooks.check = hose;
    const swivel::PlanResult result = swivel::plan(problem, options);
    double twist = 0;
    for (const swivel::TrajectoryRow& row : result.trajectory)
      twist = std::max(twist, std::abs(row.q[4] + row.q[6]));
    std::cout << "at most " << most_twist << ": " << to_string(result.status) << ", largest twist "
              << twist << " rad, " << hose->asked << " states asked\n";
  }
}
