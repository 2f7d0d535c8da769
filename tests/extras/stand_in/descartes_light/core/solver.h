// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for descartes_light 0.4, which Debian does not have: the classes and members that a
// solver of it meets, with their names and types, and nothing else. It serves the tests alone.
#pragma once
#include <Eigen/Core>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

namespace descartes_light {

template <typename FloatT>
struct State {
  using ConstPtr = std::shared_ptr<const State>;
  virtual ~State() = default;
  Eigen::Matrix<FloatT, Eigen::Dynamic, 1> values;
};
template <typename FloatT>
struct StateSample {
  typename State<FloatT>::ConstPtr state;
  FloatT cost{0};
};
template <typename FloatT>
struct WaypointSampler {
  using ConstPtr = std::shared_ptr<const WaypointSampler>;
  virtual ~WaypointSampler() = default;
  virtual std::vector<StateSample<FloatT>> sample() const = 0;
};
template <typename FloatT>
struct EdgeEvaluator {
  using ConstPtr = std::shared_ptr<const EdgeEvaluator>;
  virtual ~EdgeEvaluator() = default;
  virtual std::pair<bool, FloatT> evaluate(const State<FloatT>&, const State<FloatT>&) const = 0;
};
template <typename FloatT>
struct StateEvaluator {
  using ConstPtr = std::shared_ptr<const StateEvaluator>;
  virtual ~StateEvaluator() = default;
  virtual std::pair<bool, FloatT> evaluate(const State<FloatT>&) const = 0;
};
struct BuildStatus {
  std::vector<std::size_t> failed_vertices, failed_edges;
  operator bool() const { return failed_vertices.empty() && failed_edges.empty(); }
};
template <typename FloatT>
struct SearchResult {
  std::vector<typename State<FloatT>::ConstPtr> trajectory;
  FloatT cost{0};
};
template <typename FloatT>
class Solver {
 public:
  virtual ~Solver() = default;
  /// Takes one edge evaluator for all steps or one for each, and none, one or all state evaluators.
  BuildStatus build(const std::vector<typename WaypointSampler<FloatT>::ConstPtr>& trajectory,
                    std::vector<typename EdgeEvaluator<FloatT>::ConstPtr> edges,
                    std::vector<typename StateEvaluator<FloatT>::ConstPtr> states) {
    if (edges.size() == 1) edges.resize(trajectory.size() - 1, edges.front());
    if (states.size() == 1) states.resize(trajectory.size(), states.front());
    return buildImpl(trajectory, edges, states);
  }
  virtual SearchResult<FloatT> search() = 0;

 protected:
  virtual BuildStatus buildImpl(
      const std::vector<typename WaypointSampler<FloatT>::ConstPtr>& trajectory,
      const std::vector<typename EdgeEvaluator<FloatT>::ConstPtr>& edges,
      const std::vector<typename StateEvaluator<FloatT>::ConstPtr>& states) = 0;
};

}  // namespace descartes_light
