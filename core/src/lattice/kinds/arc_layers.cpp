// SPDX-License-Identifier: BSD-3-Clause
#include "lattice/kinds/arc_layers.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "kinematics/self_motion/self_motion_arcs.hpp"
#include "swivel/core/base/angle.hpp"

namespace swivel {

namespace {

using Point = ExplicitLattice::Point;

constexpr double kCatch = 0.025;  // rad, Euclidean: an image this near an arc belongs to it
constexpr double kOnArc = 1e-3;   // rad: on the arc where it was looked for first
constexpr double kFill = 1.5;     // spacings: wider gaps are filled
constexpr double kCrowded = 0.5;  // spacings: nearer images are dropped

/// A place on the arcs of a layer.
struct Place {
  int arc = -1, chord = 0;
  double u = 0;       // of the chord
  double length = 0;  // weighted, from the first point of the arc
  double away = 0;    // rad
};

double difference(double a, double b) {
  const double d = a - b;
  return std::abs(d) < 3 ? d : wrap_angle(d);  // a small d needs no division
}

/// Returns difference() of all joints; of the one that slides (0-based; -1: none) plainly a - b.
Config difference(const Config& a, const Config& b, int slide) {
  Config d;
  for (int j = 0; j < kDof; ++j) d[j] = difference(a[j], b[j]);
  if (slide >= 0) d[slide] = a[slide] - b[slide];
  return d;
}

double length_at(const SelfMotionArc& arc, int chord, double u) {
  const auto k = static_cast<std::size_t>(chord);
  return arc.length[k] + u * (arc.length[k + 1] - arc.length[k]);
}

/// Returns the point of a chord's cubic that is nearest to q; none beyond `within`, rad.
std::optional<Place> nearest_on(const SelfMotionArc& arc, int number, int chord, const Config& q,
                                double within) {
  const auto k = static_cast<std::size_t>(chord), next = (k + 1) % arc.q.size();
  const Config line = difference(arc.q[next], arc.q[k], arc.slide),
               way = difference(q, arc.q[k], arc.slide);
  const double length2 = joint_squared_norm(line);
  const double along = joint_dot(way, line) / length2;
  if (along < -0.5 || along > 1.5) {
    if (joint_squared_norm(way) > within * within &&
        joint_squared_norm(way - line) > within * within)
      return std::nullopt;
  }
  double u = std::clamp(along, 0.0, 1.0);
  Config off = difference(q, arc.at(chord, u), arc.slide);
  if (joint_squared_norm(off) > 0.04 * length2 + within * within) return std::nullopt;
  // Two steps along the chord: the cubic runs nearly at its speed.
  for (int step = 0; step < 2; ++step) {
    const double more = std::clamp(u + joint_dot(off, line) / length2, 0.0, 1.0);
    if (more == u) break;
    u = more;
    off = difference(q, arc.at(chord, u), arc.slide);
  }
  const double away = joint_norm(off);
  if (away > within) return std::nullopt;
  return Place{number, chord, u, length_at(arc, chord, u), away};
}

/// A box about a chord's cubic, on the circle of each joint. That of a slide may be nearer than it
/// is by whole turns.
struct Box {
  int arc, chord;
  Config middle, radius;
  /// False where the cubic is surely further than `within` from q.
  [[nodiscard]] bool maybe_near(const Config& q, double within) const {
    // the last joints turn most: they rule out most chords
    for (int j = kDof - 1; j >= 0; --j) {
      const double apart = std::abs(q[j] - middle[j]), reach = radius[j] + within;
      if (apart > reach && apart < kTwoPi - reach) return false;
    }
    return true;
  }
};

/// Returns the box about a chord's cubic, which lies in the hull of its four control points (Farin
/// 2002, Bezier's form).
Box box_of(const SelfMotionArc& arc, int number, int chord) {
  constexpr double kRounding = 1e-9;  // rad: far above that of a few operations on angles
  const auto k = static_cast<std::size_t>(chord), next = (k + 1) % arc.q.size();
  const Config d = difference(arc.q[next], arc.q[k], arc.slide);
  const double third = joint_norm(d) / 3;
  const Config first = third * arc.tangent[k], second = d - third * arc.tangent[next];
  const Config low = first.cwiseMin(second).cwiseMin(d).cwiseMin(0),
               high = first.cwiseMax(second).cwiseMax(d).cwiseMax(0);
  return {number, chord, arc.q[k] + (low + high) / 2,
          (high - low) / 2 + Config::Constant(kRounding)};
}

/// Finds the nearest points of a layer's arcs.
class Finder {
 public:
  explicit Finder(const std::vector<SelfMotionArc>& arcs) : arcs_(arcs) {
    for (int number = 0; number < static_cast<int>(arcs_.size()); ++number) {
      first_.push_back(boxes_.size());
      for (int chord = 0; chord < arcs_[static_cast<std::size_t>(number)].chords(); ++chord)
        boxes_.push_back(box_of(arcs_[static_cast<std::size_t>(number)], number, chord));
    }
  }
  /// Returns the place that is nearest to q; none beyond kCatch. Looks first near where the last
  /// question was answered, since nodes are asked about in the order of their arcs.
  [[nodiscard]] std::optional<Place> find(const Config& q) {
    if (last_.arc >= 0) {
      const SelfMotionArc& arc = arcs_[static_cast<std::size_t>(last_.arc)];
      for (int ahead = 0; ahead < 4; ++ahead) {
        int chord = last_.chord + ahead;
        if (chord >= arc.chords()) {
          if (!arc.closed) break;
          chord %= arc.chords();
        }
        if (!boxes_[first_[static_cast<std::size_t>(last_.arc)] + static_cast<std::size_t>(chord)]
                 .maybe_near(q, kOnArc))
          continue;
        if (const auto place = nearest_on(arc, last_.arc, chord, q, kOnArc); place && inner(*place))
          return last_ = *place;
      }
    }
    std::optional<Place> best;
    for (const Box& box : boxes_) {
      const double within = best ? best->away : kCatch;
      if (!box.maybe_near(q, within)) continue;
      const auto place =
          nearest_on(arcs_[static_cast<std::size_t>(box.arc)], box.arc, box.chord, q, within);
      if (place && (!best || place->away < best->away)) best = place;
    }
    if (best) last_ = *best;
    return best;
  }

 private:
  static bool inner(const Place& place) { return place.u > 0 && place.u < 1; }
  const std::vector<SelfMotionArc>& arcs_;
  std::vector<Box> boxes_;          // of all chords, arc by arc
  std::vector<std::size_t> first_;  // box of each arc
  Place last_;
};

/// A node of the layer before, carried on to this one, or a node at a roll that is asked for.
struct Image {
  Place place;
  Config q;
  int source = -1;     // slot of the layer before that it continues; -1: none
  bool asked = false;  // for its roll, however near the arc's end
};

/// Adds the points of an arc at which the roll has a value, rad. They take the place of images
/// nearby.
void add_at_roll(double roll, const SelfMotion& motion, const Pose& tool, const SelfMotionArc& arc,
                 int number, double spacing, std::vector<Image>& images) {
  for (int chord = 0; chord < arc.chords(); ++chord) {
    const auto k = static_cast<std::size_t>(chord), next = (k + 1) % arc.q.size();
    const double from = wrap_angle(arc.q[k][kDof - 1] - roll),
                 to = from + difference(arc.q[next][kDof - 1], arc.q[k][kDof - 1]);
    if (!(from < 0 && to > 0) && !(from > 0 && to < 0)) continue;
    double low = 0, high = 1;
    for (int halving = 0; halving < 30; ++halving) {
      const double u = (low + high) / 2;
      (wrap_angle(arc.at(chord, u)[kDof - 1] - roll) * from > 0 ? low : high) = u;
    }
    const auto q = motion.with_joint_at(arc.at(chord, low), tool, kDof - 1, roll);
    if (!q) continue;
    Image added{{number, chord, low, length_at(arc, chord, low), 0}, *q, -1, true};
    double nearest = kCrowded * spacing;
    std::erase_if(images, [&](const Image& image) {
      const double gap = std::abs(image.place.length - added.place.length);
      if (gap < nearest) nearest = gap, added.source = image.source;
      return gap < kCrowded * spacing;
    });
    images.push_back(added);
  }
}

/// Returns the slot of the node at which a node that was carried to this layer stands: the nearest,
/// or, where no node is as near as `near` (rad, of each joint), one that is added. Returns -1 for
/// joints outside the limits.
int slot_of_image(const SelfMotion& motion, Config image, double near, std::vector<Point>& nodes) {
  if (!motion.canonical(image)) return -1;
  int nearest = -1;
  double least = near;
  for (std::size_t slot = 0; slot < nodes.size(); ++slot) {
    const double away = difference(nodes[slot].q, image, -1).cwiseAbs().maxCoeff();
    if (away < least) least = away, nearest = static_cast<int>(slot);
  }
  if (nearest >= 0) return nearest;
  nodes.emplace_back().q = image;
  return static_cast<int>(nodes.size()) - 1;
}

/// Fills a layer with nodes on its arcs.
class Layer {
 public:
  Layer(const SelfMotion& motion, const Pose& tool, double spacing)
      : motion_(motion), tool_(tool), spacing_(spacing) {}
  /// Appends the nodes of one arc: its `images`, which are in the order of their lengths, less
  /// those that crowd, and nodes that fill the gaps between them.
  void place(const SelfMotionArc& arc, const std::vector<Image>& images);
  /// Appends nodes that stand by themselves: where the arm is singular, a point of a layer's
  /// solutions is on no arc. Those nearer than half a spacing to a node are dropped, and what they
  /// continue goes on there.
  void place_alone(const std::vector<Image>& images);
  /// Leaves out the points whose roll the layer does not allow. Returns the slot of each point that
  /// there was; -1 for those left out.
  std::vector<int> keep_window(const PathLayer& layer);
  /// Adds the twins of all points.
  void add_flipped(const CarriedNodes& before);
  /// Links the points with those of the layer before, `last`, that they continue.
  void link(const CarriedNodes& before, std::vector<Point>& last);
  std::vector<Point> points;

 private:
  void add(const Config& q, double length) {
    Point point;
    point.q = q;
    points.push_back(point);
    lengths_.push_back(length);
  }
  /// Lists the images that are not too near to one before them, or to an end of the arc.
  [[nodiscard]] std::vector<const Image*> uncrowded(const SelfMotionArc& arc,
                                                    const std::vector<Image>& images) const;
  /// Appends points between two lengths, at most kFill spacings apart.
  void fill(const SelfMotionArc& arc, double from, double to);
  /// Appends the ends of an open arc, the images kept, and points that fill the gaps.
  void fill_open(const SelfMotionArc& arc, const std::vector<const Image*>& kept);
  /// Appends the images kept of a closed arc and points that fill the gaps, by their lengths.
  void fill_closed(const SelfMotionArc& arc, const std::vector<const Image*>& kept);
  /// Links the points of an arc, from slot `first` on, with their neighbours.
  void link_along_arc(std::size_t first, bool closed);
  /// Links the slot that an image continues with the point that continues it, of those from slot
  /// `first` on: the image itself, or what stands in its way.
  void link_to_source(const SelfMotionArc& arc, std::size_t first, const Image& image);

  const SelfMotion& motion_;
  const Pose& tool_;
  double spacing_;
  std::vector<double> lengths_;
  // slot of the layer before, and the slot here that continues it
  std::vector<std::pair<int, int>> continued_;
};

void Layer::fill(const SelfMotionArc& arc, double from, double to) {
  const int parts = static_cast<int>(std::ceil((to - from) / (kFill * spacing_) - 1e-9));
  for (int part = 1; part < parts; ++part) {
    double length = from + part * ((to - from) / parts);
    if (length >= arc.whole()) length -= arc.whole();  // of closed arcs
    const auto above = std::upper_bound(arc.length.begin(), arc.length.end(), length);
    const int chord =
        std::clamp(static_cast<int>(above - arc.length.begin()) - 1, 0, arc.chords() - 1);
    const auto k = static_cast<std::size_t>(chord);
    const double u = (length - arc.length[k]) / (arc.length[k + 1] - arc.length[k]);
    if (const auto q = motion_.point(arc, chord, u, tool_)) add(*q, length);
  }
}

std::vector<const Image*> Layer::uncrowded(const SelfMotionArc& arc,
                                           const std::vector<Image>& images) const {
  const double whole = arc.whole(), least = kCrowded * spacing_;
  std::vector<const Image*> kept;
  for (const Image& image : images) {
    const double at = image.place.length;
    if (image.asked) {
      // It has been given room.
    } else if (arc.closed) {
      if (!kept.empty() && (at - kept.back()->place.length < least ||
                            kept.front()->place.length + whole - at < least))
        continue;
    } else if (at - (kept.empty() ? 0 : kept.back()->place.length) < least || whole - at < least) {
      continue;
    }
    kept.push_back(&image);
  }
  return kept;
}

void Layer::fill_open(const SelfMotionArc& arc, const std::vector<const Image*>& kept) {
  add(arc.q.front(), 0);
  double before = 0;
  for (const Image* image : kept) {
    fill(arc, before, image->place.length);
    add(image->q, image->place.length);
    before = image->place.length;
  }
  fill(arc, before, arc.whole());
  add(arc.q.back(), arc.whole());
}

void Layer::fill_closed(const SelfMotionArc& arc, const std::vector<const Image*>& kept) {
  if (kept.empty()) {
    add(arc.q.front(), 0);
    fill(arc, 0, arc.whole());
    return;
  }
  const auto first = static_cast<std::ptrdiff_t>(points.size());
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const double at = kept[k]->place.length, next = k + 1 < kept.size()
                                                        ? kept[k + 1]->place.length
                                                        : kept[0]->place.length + arc.whole();
    add(kept[k]->q, at);
    fill(arc, at, next);
  }
  // What was filled across the wrap goes to the front.
  const auto wrapped = std::find_if(lengths_.begin() + first + 1, lengths_.end(),
                                    [&](double x) { return x < kept[0]->place.length; });
  const auto by = wrapped - lengths_.begin();
  std::rotate(points.begin() + first, points.begin() + by, points.end());
  std::rotate(lengths_.begin() + first, wrapped, lengths_.end());
}

void Layer::link_along_arc(std::size_t first, bool closed) {
  const std::size_t end = points.size();
  const bool round = closed && end > first + 1;
  for (std::size_t k = first; k < end; ++k) {
    if (k > first || round) points[k].beside[0] = static_cast<int>(k > first ? k - 1 : end - 1);
    if (k + 1 < end || round) points[k].beside[1] = static_cast<int>(k + 1 < end ? k + 1 : first);
  }
}

void Layer::link_to_source(const SelfMotionArc& arc, std::size_t first, const Image& image) {
  const std::size_t end = points.size();
  const auto begin = lengths_.begin() + static_cast<std::ptrdiff_t>(first);
  const auto above = static_cast<std::size_t>(
      std::lower_bound(begin, lengths_.end(), image.place.length) - lengths_.begin());
  std::size_t nearest = first;
  double least_gap = -1;
  // the ends of a closed arc are neighbours
  for (const std::size_t k : {first, above - 1, above, end - 1}) {
    if (k < first || k >= end) continue;
    double gap = std::abs(lengths_[k] - image.place.length);
    if (arc.closed) gap = std::min(gap, arc.whole() - gap);
    if (least_gap < 0 || gap < least_gap) {
      least_gap = gap;
      nearest = k;
    }
  }
  if (points[nearest].along[0] < 0 || least_gap == 0) points[nearest].along[0] = image.source;
  continued_.emplace_back(image.source, static_cast<int>(nearest));
}

void Layer::place(const SelfMotionArc& arc, const std::vector<Image>& images) {
  const std::size_t first = points.size();
  const std::vector<const Image*> kept = uncrowded(arc, images);
  if (arc.closed)
    fill_closed(arc, kept);
  else
    fill_open(arc, kept);
  link_along_arc(first, arc.closed);
  for (const Image& image : images)
    if (image.source >= 0) link_to_source(arc, first, image);
}

void Layer::place_alone(const std::vector<Image>& images) {
  for (const Image& image : images) {
    const std::size_t before = points.size();
    const int slot = slot_of_image(motion_, image.q, kCrowded * spacing_, points);
    if (slot < 0) continue;
    if (points.size() > before) lengths_.push_back(0);
    if (image.source < 0) continue;
    int& from = points[static_cast<std::size_t>(slot)].along[0];
    if (from < 0) from = image.source;
    continued_.emplace_back(image.source, slot);
  }
}

void Layer::link(const CarriedNodes& before, std::vector<Point>& last) {
  for (const auto& [source, slot] : continued_) {
    if (!before.start)
      last[static_cast<std::size_t>(source)].along[1] = slot;
    else if (source == before.start_slot())
      last[0].along[1] = slot;
  }
  if (!before.start) return;
  for (Point& point : points) point.along[0] = point.along[0] == before.start_slot() ? 0 : -1;
}

std::vector<int> Layer::keep_window(const PathLayer& layer) {
  std::vector<int> slot_of;
  std::vector<Point> kept;
  for (const Point& point : points) {
    const bool keeps = layer.in_window(point.q[kDof - 1]);
    slot_of.push_back(keeps ? static_cast<int>(kept.size()) : -1);
    if (keeps) kept.push_back(point);
  }
  if (kept.size() == points.size()) return slot_of;
  const auto moved = [&](int slot) {
    return slot < 0 ? -1 : slot_of[static_cast<std::size_t>(slot)];
  };
  for (Point& point : kept)
    for (int& slot : point.beside) slot = moved(slot);
  for (auto& [source, slot] : continued_) slot = moved(slot);
  std::erase_if(continued_, [](const auto& link) { return link.second < 0; });
  points = std::move(kept);
  return slot_of;
}

void Layer::add_flipped(const CarriedNodes& before) {
  const auto half = points.size(), links = continued_.size();
  const auto by = static_cast<int>(half);
  for (std::size_t k = 0; k < half; ++k) {
    Point point = points[k];
    point.q = motion_.flipped(point.q);
    for (int& slot : point.beside)
      if (slot >= 0) slot += by;
    point.along[0] = before.flipped_of(point.along[0]);
    points.push_back(point);
  }
  for (std::size_t k = 0; k < links; ++k)
    continued_.emplace_back(before.flipped_of(continued_[k].first), continued_[k].second + by);
}

/// The arcs of a layer, the images on each of them, and those that lie on none, at singular places.
struct ArcsOfLayer {
  std::vector<SelfMotionArc> arcs;
  std::vector<std::vector<Image>> images;
  std::vector<Image> alone;
};

/// Sets the images on the arcs of a layer: nodes `moved` of the layer before, each where it comes
/// to lie nearest. Returns those that lie on none of the arcs.
std::vector<Config> place_images(const SelfMotion& motion, const Pose& tool,
                                 const CarriedNodes& before,
                                 const std::vector<std::optional<Config>>& moved,
                                 ArcsOfLayer& layer) {
  layer.images.assign(layer.arcs.size(), {});
  layer.alone.clear();
  std::vector<Config> strays;
  Finder finder(layer.arcs);
  for (std::size_t k = 0; k < moved.size(); ++k) {
    auto q = moved[k];
    if (!q) continue;
    int source = before.slots[k];
    const bool inside = motion.canonical(*q);
    if (motion.is_flipped(*q)) {  // it came over to the other side, and its twin to this one
      q = motion.flipped(*q);
      source = before.flipped_of(source);
    }
    const auto place = finder.find(*q);
    if (!place) {
      if (inside) strays.push_back(*q);
      if (inside && motion.is_aligned(*q)) layer.alone.push_back({{}, *q, source});
      continue;
    }
    if (!inside) {
      q = motion.point(layer.arcs[static_cast<std::size_t>(place->arc)], place->chord, place->u,
                       tool);
      if (!q) continue;
    }
    layer.images[static_cast<std::size_t>(place->arc)].push_back({*place, *q, source});
  }
  return strays;
}

/// Returns the arcs of a layer with the images of the nodes of the layer before.
ArcsOfLayer arcs_of(const SelfMotion& motion, const LockMethod& method, const Pose& tool,
                    const CarriedNodes& before, SelfMotion::Least least) {
  // Without a closed form the arcs of the layer before are followed.
  std::vector<Config> followed;
  const std::vector<std::optional<Config>> moved = motion.images(before.q, tool, least);
  for (const auto& q : moved)
    if (method.best < 0 && q) followed.push_back(*q);
  ArcsOfLayer layer;
  layer.arcs = motion.arcs(tool, followed, SelfMotion::Flipped::kOne);
  std::vector<Config> strays = place_images(motion, tool, before, moved, layer);
  if (strays.empty()) return layer;
  // They lie on arcs of which the closed form shows nothing.
  strays.insert(strays.end(), followed.begin(), followed.end());
  layer.arcs = motion.arcs(tool, strays, SelfMotion::Flipped::kOne);
  place_images(motion, tool, before, moved, layer);
  return layer;
}

/// Adds images to an arc where the roll costs least, and at the ends of what it may be.
void add_at_asked_rolls(const Chain& chain, const PathProblem& problem, const SelfMotion& motion,
                        const PathLayer& layer, const SelfMotionArc& arc, int number,
                        std::vector<Image>& images) {
  const Roll& window = layer.window;
  const JointLimit& limit = chain.limit.back();
  const auto add = [&](double roll) {
    add_at_roll(roll, motion, layer.tool, arc, number, problem.resolution.arc_of_nodes(), images);
  };
  if (problem.cost.roll > 0) add(0);
  if (window.lower > limit.lower) add(window.lower);
  if (window.upper < limit.upper && window.upper > window.lower) add(window.upper);
}

std::vector<Config> joints_of(const std::vector<Point>& points) {
  std::vector<Config> joints;
  for (const Point& point : points) joints.push_back(point.q);
  return joints;
}

std::vector<int> numbers_below(std::size_t n) {
  std::vector<int> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

}  // namespace

ArcLayer ArcLayerMaker::make(const PathLayer& here, const CarriedNodes& before,
                             std::vector<Point>* last) const {
  if (solutions_) return make_solutions(here, before, last);
  ArcsOfLayer found = arcs_of(motion_, method_, here.tool, before, least_);
  Layer layer(motion_, here.tool, problem_.resolution.arc_of_nodes());
  for (std::size_t k = 0; k < found.arcs.size(); ++k) {
    if (chain_.roll)
      add_at_asked_rolls(chain_, problem_, motion_, here, found.arcs[k], static_cast<int>(k),
                         found.images[k]);
    std::stable_sort(
        found.images[k].begin(), found.images[k].end(),
        [](const Image& a, const Image& b) { return a.place.length < b.place.length; });
    layer.place(found.arcs[k], found.images[k]);
  }
  layer.place_alone(found.alone);
  ArcLayer made;
  std::vector<Config> nodes = joints_of(layer.points);
  std::vector<int> slot_of = numbers_below(nodes.size());
  if (chain_.roll) slot_of = layer.keep_window(here);
  if (twins_) layer.add_flipped(before);
  if (last) layer.link(before, *last);
  made.arcs = static_cast<std::int64_t>(found.arcs.size()) * (twins_ ? 2 : 1);
  made.carried = {std::move(nodes), std::move(slot_of), static_cast<int>(layer.points.size()),
                  false};
  made.points = std::move(layer.points);
  return made;
}

ArcLayer ArcLayerMaker::make_solutions(const PathLayer& here, const CarriedNodes& before,
                                       std::vector<Point>* last) const {
  const double near = kCrowded * problem_.resolution.arc_of_nodes();
  ArcLayer made;
  std::vector<Config> solutions;
  for (Config& q : solutions_->at(here.tool))
    if (motion_.canonical(q)) solutions.push_back(q);
  std::sort(solutions.begin(), solutions.end(), less);
  for (const Config& q : solutions) made.points.emplace_back().q = q;
  const auto images = motion_.images(before.q, here.tool);
  for (std::size_t k = 0; k < images.size(); ++k) {
    if (!images[k]) continue;
    const int slot = slot_of_image(motion_, *images[k], near, made.points);
    if (slot < 0) continue;
    const int source = !before.start ? before.slots[k] : k + 1 == images.size() ? 0 : -1;
    if (source < 0) continue;
    int& from = made.points[static_cast<std::size_t>(slot)].along[0];
    if (from < 0) from = source;
    (*last)[static_cast<std::size_t>(source)].along[1] = slot;
  }
  made.carried = carried_from(made.points);
  made.arcs = static_cast<std::int64_t>(solutions.size());
  return made;
}

void ArcLayerMaker::add_midway(const ToolPath& path, int layer,
                               std::vector<std::vector<Point>>& points) const {
  constexpr double kSame = 1e-3;  // rad
  const auto at = static_cast<std::size_t>(layer);
  const double before = path.layer(layer - 1).travel, after = path.layer(layer + 1).travel,
               share = (path.layer(layer).travel - before) / (after - before);
  std::vector<Config> midway;
  for (const Point& a : points[at - 1])
    for (const Point& b : points[at + 1]) {
      const Config way = difference(b.q, a.q, -1);
      if (way.cwiseAbs().maxCoeff() <= 2 * problem_.limits.joint_step)
        midway.push_back(a.q + share * way);
    }
  for (const auto& q : motion_.images(midway, path.layer(layer).tool))
    if (q) slot_of_image(motion_, *q, kSame, points[at]);
}

void ArcLayerMaker::carry_back(const ToolPath& path, const std::vector<std::int64_t>& solutions,
                               std::vector<std::vector<Point>>& points, int first) const {
  const double near = kCrowded * problem_.resolution.arc_of_nodes();
  for (int i = path.size() - 2; i >= first; --i) {
    auto &here = points[static_cast<std::size_t>(i)],
         &after = points[static_cast<std::size_t>(i) + 1];
    const auto images = motion_.images(joints_of(after), path.layer(i).tool);
    for (std::size_t k = 0; k < images.size(); ++k) {
      if (!images[k]) continue;
      const int slot = slot_of_image(motion_, *images[k], near, here);
      if (slot < 0) continue;
      const auto from = static_cast<int>(k);
      int &back = after[k].along[0], &ahead = here[static_cast<std::size_t>(slot)].along[1];
      if (back < 0) back = slot;
      if (ahead < 0) ahead = from;
    }
    if (i > 0 && std::ssize(here) > solutions[static_cast<std::size_t>(i)])
      add_midway(path, i, points);
  }
}

CarriedNodes ArcLayerMaker::carried_from(const std::vector<Point>& points) const {
  CarriedNodes before;
  before.nodes = static_cast<int>(points.size());
  before.q = joints_of(points);
  if (twins_ && points.size() > 1) before.q.resize(points.size() / 2);
  before.slots = numbers_below(before.q.size());
  return before;
}

}  // namespace swivel
