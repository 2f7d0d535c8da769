// SPDX-License-Identifier: BSD-3-Clause
#include "job/transitions/rrt_connect.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace swivel {

namespace {

/// SplitMix64 (Steele, Lea & Flood 2014).
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : state_(seed) {}
  /// Returns a number in [0, 1).
  double unit() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15ull;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
  }

 private:
  std::uint64_t state_;
};

struct Tree {
  struct Node {
    Config q;
    std::size_t parent = 0;
  };
  std::vector<Node> nodes;
  [[nodiscard]] std::size_t nearest(const Config& q, const Config& scale) const {
    std::size_t best = 0;
    double least = joint_squared_norm((nodes[0].q - q).cwiseProduct(scale));
    for (std::size_t k = 1; k < nodes.size(); ++k)
      if (const double d = joint_squared_norm((nodes[k].q - q).cwiseProduct(scale)); d < least)
        least = d, best = k;
    return best;
  }
  /// Returns the nodes from the root to a node.
  [[nodiscard]] std::vector<Config> branch(std::size_t node) const {
    std::vector<Config> way;
    for (;; node = nodes[node].parent) {
      way.push_back(nodes[node].q);
      if (node == 0) break;
    }
    std::reverse(way.begin(), way.end());
    return way;
  }
};

class Search {
 public:
  Search(const SearchBox& box, const MotionCheck& free, std::uint64_t seed, const Budget& budget)
      : box_(box), free_(free), draw_(seed), budget_(budget) {}

  std::optional<std::vector<Config>> run(const Config& from, const Config& to, int most_samples) {
    Tree trees[2] = {{{{from, 0}}}, {{{to, 0}}}};
    for (int k = 0; k < most_samples; ++k) {
      budget_.poll();
      Tree &grown = trees[k % 2], &other = trees[1 - k % 2];
      const std::size_t before = grown.nodes.size();
      grow(grown, sample(), false);
      if (grown.nodes.size() == before) continue;
      if (!grow(other, grown.nodes.back().q, true)) continue;
      std::vector<Config> way = trees[0].branch(trees[0].nodes.size() - 1),
                          rest = trees[1].branch(trees[1].nodes.size() - 1);
      way.insert(way.end(), rest.rbegin() + 1, rest.rend());  // both have the meeting node
      return way;
    }
    return std::nullopt;
  }

  /// Shortens a way by straight moves between random places of it, then leaves out corners.
  void shorten(std::vector<Config>& way) {
    constexpr int kTries = 100;
    for (int k = 0; k < kTries && way.size() > 2; ++k) {
      budget_.poll();
      Place a = place(way), b = place(way);
      if (b.leg < a.leg) std::swap(a, b);
      if (a.leg == b.leg) continue;
      double along = distance(a.q, way[a.leg + 1]) + distance(way[b.leg], b.q);
      for (std::size_t i = a.leg + 1; i < b.leg; ++i) along += distance(way[i], way[i + 1]);
      if (!(distance(a.q, b.q) < along * (1 - 1e-9)) || !free_(a.q, b.q)) continue;
      // both parts of a leg that is cut are free, as the leg is
      const auto at = [&](std::size_t i) { return way.begin() + static_cast<std::ptrdiff_t>(i); };
      std::vector<Config> shorter(way.begin(), at(a.leg + 1));
      shorter.push_back(a.q);
      shorter.push_back(b.q);
      shorter.insert(shorter.end(), at(b.leg + 1), way.end());
      if (legs_free(shorter, a.leg)) way.swap(shorter);
    }
    for (std::size_t k = 1; k + 1 < way.size();)
      if (free_(way[k - 1], way[k + 1]))
        way.erase(way.begin() + static_cast<std::ptrdiff_t>(k));
      else
        ++k;
  }

 private:
  /// A random place of a way: its leg and the configuration there.
  struct Place {
    std::size_t leg = 0;
    Config q;
  };
  Place place(const std::vector<Config>& way) {
    const auto leg =
        std::min(way.size() - 2,
                 static_cast<std::size_t>(draw_.unit() * static_cast<double>(way.size() - 1)));
    return {leg, way[leg] + draw_.unit() * (way[leg + 1] - way[leg])};
  }
  /// Returns true if the legs before and after the new one are free as they are now: the proof of a
  /// motion holds for the motion as a whole.
  bool legs_free(const std::vector<Config>& way, std::size_t leg) {
    return free_(way[leg], way[leg + 1]) && free_(way[leg + 2], way[leg + 3]);
  }
  Config sample() {
    Config q;
    for (Eigen::Index j = 0; j < kDof; ++j)
      q[j] = box_.lower[j] + draw_.unit() * (box_.upper[j] - box_.lower[j]);
    return q;
  }
  [[nodiscard]] double distance(const Config& a, const Config& b) const {
    return joint_norm((b - a).cwiseProduct(box_.scale));
  }
  /// Grows a tree from its nearest node towards q by steps, with `all` as far as it goes. Returns
  /// true if q is reached.
  bool grow(Tree& tree, const Config& q, bool all) {
    constexpr double kStep = 0.5;  // rad, scaled
    std::size_t last = tree.nearest(q, box_.scale);
    do {
      const Config from = tree.nodes[last].q;
      const double way = distance(from, q);
      const Config to = way <= kStep ? q : Config(from + kStep / way * (q - from));
      if (!free_(from, to)) return false;
      tree.nodes.push_back({to, last});
      last = tree.nodes.size() - 1;
      if (way <= kStep) return true;
    } while (all);
    return false;
  }

  const SearchBox& box_;
  const MotionCheck& free_;
  Draw draw_;
  const Budget& budget_;
};

}  // namespace

std::optional<std::vector<Config>> rrt_connect(const Config& from, const Config& to,
                                               const SearchBox& box, const MotionCheck& free,
                                               std::uint64_t seed, const Budget& budget,
                                               int most_samples) {
  Search search(box, free, seed, budget);
  auto way = search.run(from, to, most_samples);
  if (!way) return std::nullopt;
  search.shorten(*way);
  return std::vector<Config>(way->begin() + 1, way->end() - 1);
}

}  // namespace swivel
