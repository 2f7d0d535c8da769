// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/cost_to_go.hpp"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <tuple>

#include "kernels/relax.hpp"
#include "swivel/core/timeline.hpp"
#include "swivel/graph/validity.hpp"

namespace swivel {

namespace {

/// f(0) ... f(count - 1), count <= whole; a loop of known length is unrolled into vectors.
template <int whole, class F>
void each(int count, const F& f) {
  if (count == whole)
    for (int k = 0; k < whole; ++k) f(k);
  else
    for (int k = 0; k < count; ++k) f(k);
}

struct Interval {
  double low = kUnreachable, high = -kUnreachable;
  Interval() = default;
  static Interval of(const double* q, int count) {
    Interval range;
    const Eigen::Map<const Eigen::ArrayXd> values(q, count);
    range.low = values.minCoeff();
    range.high = values.maxCoeff();
    return range;
  }
  [[nodiscard]] bool empty() const { return low > high; }
  Interval(const double* q, int begin, int end) {
    for (int k = begin; k < end; ++k) add(q[k]);
  }
  /// Of those that have a value; the others need not have been solved.
  Interval(const double* q, const double* value, int begin, int end) {
    for (int k = begin; k < end; ++k)
      if (value[k] != kUnreachable) add(q[k]);
  }
  void add(double q) {
    low = q < low ? q : low;
    high = q > high ? q : high;
  }
  void add(const Interval& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
  [[nodiscard]] double gap(const Interval& other) const { return std::max(low - other.high, other.low - high); }
};

}  // namespace

/// A chunk of a label.
struct CostToGo::Part {
  int label = 0, chunk = 0;
  bool live = false;  // holds values
  [[nodiscard]] int begin() const { return chunk * kChunk; }
  [[nodiscard]] int end(int angles) const { return std::min(angles, begin() + kChunk); }
  bool operator==(const Part& o) const { return label == o.label && chunk == o.chunk; }
  bool operator<(const Part& o) const { return std::tie(label, chunk) < std::tie(o.label, o.chunk); }
};

/// A branch flips only through the zero of a middle angle, so these tell branches apart.
struct CostToGo::Middles {
  static constexpr std::array<int, 2> kJoints{1, 5};
  std::array<Interval, 2> joint;
  void add(const Middles& other) {
    for (std::size_t m = 0; m < joint.size(); ++m) joint[m].add(other.joint[m]);
  }
};

struct CostToGo::Joints {
  int layer = -1;
  LayerNodes nodes;
  std::array<std::vector<std::uint8_t>, 2> solved;  // [elbow][chunk]
  /// Ranges of the joints that tell branches apart, over what is solved: of each chunk, and of all.
  std::vector<Middles> of_chunk, of_layer;  // [label][chunk], [label]
};

/// Joints that a search had kept, for the next one: pages fresh from the system took a quarter of a plan that meets obstacles.
class CostToGo::Spare {
 public:
  static Spare& of_process() {
    static Spare spare;
    return spare;
  }
  std::unique_ptr<Joints> take() {
    const std::lock_guard lock(mutex_);
    if (joints_.empty()) return std::make_unique<Joints>();
    std::unique_ptr<Joints> joints = std::move(joints_.back());
    joints_.pop_back();
    bytes_ -= joints->nodes.bytes();
    return joints;
  }
  void give(std::unique_ptr<Joints> joints) {
    constexpr std::size_t kMost = 64 << 20;
    const std::lock_guard lock(mutex_);
    if (bytes_ + joints->nodes.bytes() > kMost) return;
    bytes_ += joints->nodes.bytes();
    joints->layer = -1;
    joints_.push_back(std::move(joints));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Joints>> joints_;
  std::size_t bytes_ = 0;
};

struct CostToGo::Block {
  int layer = -1;
  Joints own;
  Joints* joints = nullptr;
  std::vector<double> row;    // [label][angle], of the parts
  std::vector<Part> parts;    // to be relaxed or holding values, in order
  std::vector<double> value;  // [label][padded angle]: the row once it is settled, infinite elsewhere
  std::vector<int> labels;    // with a finite value
  /// The finite values in the window of a chunk: first and last padded position, none where last < first.
  struct Near {
    int first = 0, last = -1;
    mutable Middles middles;  // filled when asked for
  };
  std::vector<Near> near;        // [label][chunk], of the labels with a finite value
  std::array<Marks, 2> reached;  // [elbow]: chunks with any near
  [[nodiscard]] const LayerNodes& nodes() const { return joints->nodes; }
  [[nodiscard]] bool find(int label, int chunk) const { return std::binary_search(parts.begin(), parts.end(), Part{label, chunk}); }
};

CostToGo::CostToGo(const Lattice& lattice, Extent extent)
    : lattice_(&lattice),
      bounded_(extent == Extent::kBounded),
      cell_(static_cast<std::size_t>(lattice.layers()) * static_cast<std::size_t>(lattice.labels() * chunks()), 0),
      verdict_(static_cast<std::size_t>(lattice.nodes()), Verdict::kUnknown) {
  cells_.emplace_back().fill(kUnreachable);
  if (!lattice.arm().exact) cache_.resize(static_cast<std::size_t>(lattice.layers()));
  const std::size_t marks = mark(lattice.labels(), 0);
  for (auto& block : block_) {
    block = std::make_unique<Block>();
    block->row.resize(static_cast<std::size_t>(lattice.width()));
    block->near.resize(marks);
    block->value.assign(static_cast<std::size_t>(lattice.labels() * (lattice.angles() + 2 * lattice.window())), kUnreachable);
  }
}

CostToGo::~CostToGo() {
  for (auto& joints : cache_)
    if (joints) Spare::of_process().give(std::move(joints));
}

// --- joints

CostToGo::Joints& CostToGo::joints(int layer, Block& block) {
  Joints* joints = &block.own;
  if (!cache_.empty()) {
    auto& kept = cache_[static_cast<std::size_t>(layer)];
    if (!kept) kept = Spare::of_process().take();
    joints = kept.get();
  }
  if (joints->layer != layer) {
    const int n = lattice_->angles(), window = lattice_->window();
    joints->layer = layer;
    lattice_->lay_out(layer, (n - window % n) % n, n + 2 * window, joints->nodes);
    for (auto& solved : joints->solved) solved.assign(static_cast<std::size_t>(chunks()), 0);
    joints->of_chunk.resize(mark(lattice_->labels(), 0));
    joints->of_layer.assign(static_cast<std::size_t>(lattice_->labels()), {});
  }
  return *joints;
}

void CostToGo::want(Joints& joints, int elbow, int first, int last) {
  Marks& solved = joints.solved[static_cast<std::size_t>(elbow)];
  const int n = lattice_->angles(), window = lattice_->window();
  for (int chunk = first, next = first; chunk < last; chunk = next) {
    next = chunk + 1;
    if (solved[static_cast<std::size_t>(chunk)]) continue;
    while (next < last && !solved[static_cast<std::size_t>(next)]) ++next;
    std::fill(solved.begin() + chunk, solved.begin() + next, std::uint8_t{1});
    const int begin = chunk * kChunk, end = std::min(n, next * kChunk);
    ik_nodes_ += static_cast<std::int64_t>(end - begin) * lattice_->labels() / 2;
    lattice_->solve_part(elbow, window + begin, window + end, joints.nodes);
    for (int done = chunk; done < next; ++done) range(joints, elbow, done);
    // The window reaches around the circle.
    if (begin < window) joints.nodes.repeat(window + begin, window + begin + n, std::min(end, window) - begin);
    if (end > n - window) {
      const int from = std::max(begin, n - window);
      joints.nodes.repeat(window + from, window + from - n, end - from);
    }
  }
}

void CostToGo::range(Joints& joints, int elbow, int chunk) const {
  const int half = lattice_->labels() / 2, begin = lattice_->window() + chunk * kChunk;
  const int count = std::min(kChunk, lattice_->angles() - chunk * kChunk);
  for (std::size_t m = 0; m < Middles::kJoints.size(); ++m) {
    const double* known = nullptr;  // labels share arrays
    Interval found;
    for (int label = elbow * half; label < (elbow + 1) * half; ++label) {
      const double* q = joints.nodes.q(label, Middles::kJoints[m]) + begin;
      if (q != known) found = Interval::of(q, count);
      known = q;
      joints.of_chunk[mark(label, chunk)].joint[m] = found;
      joints.of_layer[static_cast<std::size_t>(label)].joint[m].add(found);
    }
  }
}

CostToGo::Nodes CostToGo::nodes(int layer, int elbow, int first, int count, LayerNodes& scratch) {
  const int n = lattice_->angles();
  if (cache_.empty()) {
    if (n >= kChunk) count = (count + kChunk - 1) / kChunk * kChunk;  // whole vectors are quicker
    ik_nodes_ += static_cast<std::int64_t>(count) * lattice_->labels() / 2;
    lattice_->lay_out(layer, first, count, scratch);
    lattice_->solve_part(elbow, 0, count, scratch);
    return {&scratch, 0};
  }
  Joints& kept = joints(layer, *block_[0]);
  for (int k = 0; k < count; ++k) {
    const int chunk = (first + k) % n / kChunk;
    want(kept, elbow, chunk, chunk + 1);
  }
  return {&kept.nodes, (first + lattice_->window()) % n};
}

Config CostToGo::config(int layer, int slot) {
  const int label = lattice_->label_of(slot);
  const Nodes here = nodes(layer, lattice_->elbow_of(label), lattice_->angle_of(slot), 1, scratch_);
  return here.nodes->config(label, here.shift);
}

// --- one layer

void CostToGo::clear(int layer, Block& block) {
  const int n = lattice_->angles(), length = n + 2 * lattice_->window();
  for (const int label : block.labels) {
    const auto row = block.value.begin() + static_cast<std::ptrdiff_t>(label) * length;
    std::fill(row, row + length, kUnreachable);
  }
  block.labels.clear();
  block.layer = layer;
  block.joints = &joints(layer, block);
  block.parts.clear();
  for (Marks& reached : block.reached) reached.assign(static_cast<std::size_t>(chunks()), 0);
}

bool CostToGo::elbows_may_connect(int step_layer, int layer, int elbow, int other_layer, int other) const {
  if (elbow == other) return true;
  const auto angle = lattice_->elbow_angle(layer, elbow), other_angle = lattice_->elbow_angle(other_layer, other);
  return !angle || !other_angle || std::abs(*angle - *other_angle) <= lattice_->step_bound(step_layer)[3];
}

void CostToGo::mark_reach(int step_layer, const Block& to, Block& from) {
  for (int elbow = 0; elbow < 2; ++elbow) {
    const int first_label = elbow * lattice_->labels() / 2;
    if (!from.nodes().alive(first_label)) continue;  // all of an elbow's labels, or none
    const std::array<bool, 2> reaches{elbows_may_connect(step_layer, from.layer, elbow, to.layer, 0),
                                      elbows_may_connect(step_layer, from.layer, elbow, to.layer, 1)};
    columns_.clear();
    for (int chunk = 0; chunk < chunks(); ++chunk) {
      const auto c = static_cast<std::size_t>(chunk);
      if ((reaches[0] && to.reached[0][c]) || (reaches[1] && to.reached[1][c])) columns_.push_back(chunk);
    }
    for (std::size_t k = 0, next = 0; k < columns_.size(); k = next) {
      for (next = k + 1; next < columns_.size() && columns_[next] == columns_[next - 1] + 1;) ++next;
      want(*from.joints, elbow, columns_[k], columns_[next - 1] + 1);
    }
    for (int label = first_label; label < first_label + lattice_->labels() / 2; ++label)
      for (const int chunk : columns_) from.parts.push_back({label, chunk});
  }
}

bool CostToGo::may_meet(int step_layer, const Middles& a, const Middles& b) const {
  const Config& bound = lattice_->step_bound(step_layer);
  for (std::size_t m = 0; m < Middles::kJoints.size(); ++m) {
    const int joint = Middles::kJoints[m];
    if (!lattice_->continuous()[static_cast<std::size_t>(joint)] && a.joint[m].gap(b.joint[m]) > bound[joint]) return false;
  }
  return true;
}

bool CostToGo::may_connect(int step_layer, const Block& from, int label, int chunk, const Block& to, int other) const {
  const Middles& own_middles = from.joints->of_chunk[mark(label, chunk)];
  if (!may_meet(step_layer, own_middles, to.joints->of_layer[static_cast<std::size_t>(other)])) return false;
  const Block::Near& near = to.near[mark(other, chunk)];
  const double* const value = to.value.data() + static_cast<std::ptrdiff_t>(other) * (lattice_->angles() + 2 * lattice_->window());
  const auto theirs = [&](int joint) { return Interval(to.nodes().q(other, joint), value, near.first, near.last + 1); };
  if (near.middles.joint[0].empty())
    for (std::size_t m = 0; m < Middles::kJoints.size(); ++m) near.middles.joint[m] = theirs(Middles::kJoints[m]);
  if (!may_meet(step_layer, own_middles, near.middles)) return false;
  // Near a singular pose the outer joints of the triple must meet as well. Joints of several turns tell windings apart. Continuous
  // joints have no plain interval.
  const int begin = lattice_->window() + chunk * kChunk, end = std::min(lattice_->window() + lattice_->angles(), begin + kChunk);
  const bool one_elbow = lattice_->elbow_of(label) == lattice_->elbow_of(other);
  for (const int joint : {0, 2, 4, 6, 3}) {
    const bool shared = one_elbow && from.nodes().q(label, joint) == from.nodes().q(other, joint);  // tells nothing apart
    if (shared || lattice_->continuous()[static_cast<std::size_t>(joint)]) continue;
    const Interval own(from.nodes().q(label, joint), begin, end);
    if (own.gap(theirs(joint)) > lattice_->step_bound(step_layer)[joint]) return false;
  }
  return true;
}

void CostToGo::relax_run(int step_layer, const Block& from, int label, int first, int count, const Block& to, int other,
                         double* best) {
  const int window = lattice_->window(), length = lattice_->angles() + 2 * window;
  RelaxTask<double> task;
  task.n = count;
  task.offsets = 2 * window + 1;
  task.metric = lattice_->cost().metric == CostMetric::kL2 ? RelaxMetric::kL2 : RelaxMetric::kMax;
  task.wraps = false;
  const Config& bound = lattice_->step_bound(step_layer);
  for (int j = 0; j < kDof; ++j) {
    const bool turns = lattice_->continuous()[static_cast<std::size_t>(j)];
    task.wraps |= turns;
    task.turn[j] = turns ? kTwoPi : 0;
    task.scale[j] = lattice_->cost_scale()[static_cast<std::size_t>(j)];
    task.bound[j] = bound[j];
    task.from[j] = from.nodes().q(label, j) + window + first;
    task.to[j] = to.nodes().q(other, j) + first;
  }
  task.best = best;
  task.value = to.value.data() + static_cast<std::ptrdiff_t>(other) * length + first;
  edges_ += static_cast<std::int64_t>(count) * task.offsets;
  relax_kernels().relax(task);
}

void CostToGo::relax(int step_layer, Block& from, const Block& to) {
  const int n = lattice_->angles();
  for (const Part& part : from.parts) {
    double* const row = from.row.data() + static_cast<std::ptrdiff_t>(part.label) * n;
    std::fill(row + part.begin(), row + part.end(n), kUnreachable);
  }
  for (std::size_t first = 0, last = 0; first < from.parts.size(); first = last) {
    const int label = from.parts[first].label;
    while (last < from.parts.size() && from.parts[last].label == label) ++last;
    for (const int other : to.labels) {
      if (label != other &&
          (!elbows_may_connect(step_layer, from.layer, lattice_->elbow_of(label), to.layer, lattice_->elbow_of(other)) ||
           !may_meet(step_layer, from.joints->of_layer[static_cast<std::size_t>(label)],
                     to.joints->of_layer[static_cast<std::size_t>(other)])))
        continue;
      int begin = 0, end = 0;  // a run of chunks
      const auto relax_chunks = [&] {
        if (begin == end) return;
        const int stop = std::min(n, end * kChunk), start = std::max(0, std::min(begin * kChunk, stop - kChunk));  // whole vectors
        relax_run(step_layer, from, label, start, stop - start, to, other, from.row.data() + label * n + start);
      };
      for (std::size_t k = first; k < last; ++k) {
        Part& part = from.parts[k];
        if (to.near[mark(other, part.chunk)].last < 0 ||
            (label != other && !may_connect(step_layer, from, label, part.chunk, to, other)))
          continue;
        part.live = true;
        if (part.chunk != end) {
          relax_chunks();
          begin = part.chunk;
        }
        end = part.chunk + 1;
      }
      relax_chunks();
    }
  }
}

void CostToGo::bar(Block& block) const {
  const int n = lattice_->angles(), window = lattice_->window();
  for (const Part& part : block.parts) {
    if (!part.live) continue;
    const int slot = part.label * n + part.begin(), at = window + part.begin(), count = part.end(n) - part.begin();
    double* const values = block.row.data() + slot;
    const double* shoulder = block.nodes().shoulder_bar(part.label) + at;
    const double* wrist = block.nodes().wrist_bar(part.label) + at;
    each<kChunk>(count, [&](int k) { values[k] += shoulder[k] + wrist[k]; });
    const Verdict* verdict = &verdict_[index(block.layer, slot)];
    if (std::memchr(verdict, static_cast<int>(Verdict::kRemoved), static_cast<std::size_t>(count)))
      each<kChunk>(count, [&](int k) {
        if (verdict[k] == Verdict::kRemoved) values[k] = kUnreachable;
      });
  }
}

void CostToGo::cut(Block& block) const {
  if (limit_ == kUnreachable) return;
  const int n = lattice_->angles();
  const float* bound = chords_->row(block.layer);
  for (const Part& part : block.parts) {
    if (!part.live) continue;
    const int slot = part.label * n + part.begin(), count = part.end(n) - part.begin();
    double* const values = block.row.data() + slot;
    if (const float* before = bound ? bound + slot : nullptr)
      each<kChunk>(count, [&](int k) { values[k] = values[k] + before[k] > limit_ ? kUnreachable : values[k]; });
    else
      each<kChunk>(count, [&](int k) { values[k] = values[k] > limit_ ? kUnreachable : values[k]; });
  }
}

void CostToGo::settle(Block& block) {
  const int n = lattice_->angles(), window = lattice_->window(), length = n + 2 * window;
  std::size_t kept = 0;
  for (const Part& part : block.parts) {
    if (!part.live) continue;
    const double* row = block.row.data() + static_cast<std::ptrdiff_t>(part.label) * n;
    double* value = block.value.data() + static_cast<std::ptrdiff_t>(part.label) * length;
    Block::Near* near = block.near.data() + mark(part.label, 0);
    Marks& reached = block.reached[static_cast<std::size_t>(lattice_->elbow_of(part.label))];
    int first = part.begin(), last = part.end(n) - 1;
    while (first <= last && row[first] == kUnreachable) ++first;
    while (first <= last && row[last] == kUnreachable) --last;
    if (first > last) continue;
    block.parts[kept++] = part;
    if (block.labels.empty() || block.labels.back() != part.label) {
      std::fill(near, near + chunks(), Block::Near{length, -1, {}});
      block.labels.push_back(part.label);
    }
    std::copy(row + first, row + last + 1, value + window + first);
    for (const int turn : {0, n, -n}) {
      const int low = std::max(0, window + first + turn), high = std::min(length - 1, window + last + turn);
      if (low > high) continue;
      if (turn != 0) std::copy(row + low - window - turn, row + high - window - turn + 1, value + low);
      // The window of chunk c is at the padded positions c * kChunk ... c * kChunk + kChunk - 1 + 2 * window.
      const int begin = std::max(0, low - 2 * window) / kChunk, end = std::min(chunks() - 1, high / kChunk);
      for (int c = begin; c <= end; ++c) {
        near[c].first = std::min(near[c].first, std::max(low, c * kChunk));
        near[c].last = std::max(near[c].last, std::min(high, c * kChunk + kChunk - 1 + 2 * window));
        reached[static_cast<std::size_t>(c)] = 1;
      }
    }
  }
  block.parts.resize(kept);
}

double& CostToGo::cell_value(int layer, int slot) {
  const int j = lattice_->angle_of(slot);
  std::uint32_t& cell = cell_[cell_index(layer, lattice_->label_of(slot), j / kChunk)];
  if (cell == 0) {
    cell = static_cast<std::uint32_t>(cells_.size());
    cells_.emplace_back().fill(kUnreachable);
  }
  return cells_[cell][static_cast<std::size_t>(j % kChunk)];
}

void CostToGo::store(const Block& block) {
  const int n = lattice_->angles();
  for (const Part& part : block.parts) {
    cell_[cell_index(block.layer, part.label, part.chunk)] = static_cast<std::uint32_t>(cells_.size());
    Cell& cell = cells_.emplace_back();
    const double* row = block.row.data() + static_cast<std::ptrdiff_t>(part.label) * n;
    std::fill(std::copy(row + part.begin(), row + part.end(n), cell.begin()), cell.end(), kUnreachable);
  }
}

void CostToGo::load(int layer, const Marks& columns, Block& block) {
  clear(layer, block);
  const int n = lattice_->angles();
  for (int label = 0; label < lattice_->labels(); ++label)
    for (int chunk = 0; chunk < chunks(); ++chunk) {
      const std::uint32_t cell = columns[static_cast<std::size_t>(chunk)] ? cell_[cell_index(layer, label, chunk)] : 0;
      if (cell == 0) continue;
      want(*block.joints, lattice_->elbow_of(label), chunk, chunk + 1);
      const Part& part = block.parts.emplace_back(Part{label, chunk, true});
      std::copy_n(cells_[cell].begin(), part.end(n) - part.begin(),
                  block.row.begin() + static_cast<std::ptrdiff_t>(label) * n + part.begin());
    }
  settle(block);
}

double CostToGo::relax_one(int layer, int slot) {
  const int n = lattice_->angles(), label = lattice_->label_of(slot);
  const Nodes here = nodes(layer, lattice_->elbow_of(label), lattice_->angle_of(slot), 1, scratch_);
  if (!here.nodes->valid(label, here.shift) || node_verdict(layer, slot) == Verdict::kRemoved) return kUnreachable;
  const Config q = here.nodes->config(label, here.shift);
  const Lattice::Run run = lattice_->successors(layer, slot);
  double best = kUnreachable;
  for (int elbow = 0; elbow < 2; ++elbow) {
    Nodes next;
    for (int other = 0; other < lattice_->labels(); ++other)
      for (int k = 0; lattice_->elbow_of(other) == elbow && k < run.count; ++k) {
        const int b = other * n + (run.first + k) % n;
        const double rest = at(layer + 1, b);
        if (rest >= best) continue;
        if (!next.nodes) next = nodes(layer + 1, elbow, run.first, run.count, scratch_);
        const Config delta = lattice_->delta(q, next.nodes->config(other, next.shift + k));
        ++edges_;
        const double value = lattice_->edge_cost(delta) + rest;
        if (value < best && lattice_->step_allowed(layer, delta) && edge_verdict(layer, slot, b) != Verdict::kRemoved) best = value;
      }
  }
  return best;
}

// --- the whole lattice

bool CostToGo::sweep(int goal_layer, const std::function<bool()>& stop) {
  goal_ = goal_layer;
  limit_ = kUnreachable;
  forget();
  for (int layer = 0; layer <= goal_; ++layer)
    if (!lattice_->alive(layer)) return true;
  if (bounded_ && goal_layer == lattice_->layers() - 1) {
    if (!chords_) {
      chords_ = std::make_unique<ChordBound>(*lattice_);
      ik_nodes_ += chords_->ik_nodes();
    }
    if (chords_->best() == kUnreachable) return true;
    raise_limit();
  }
  return sweep_once(stop) && make_exact(stop);
}

void CostToGo::raise_limit() {
  if (chords_->row(0)) {
    const double least = chords_->best(), found = limit_ == kUnreachable ? kUnreachable : best();
    const double passed = limit_ == kUnreachable ? -1 : limit_;
    for (const double share : {0.01, 0.2, 1.5}) {  // most problems stop at the first: 1 to 5 % of the lattice
      limit_ = least * (1 + share);
      if (limit_ > passed && (found == kUnreachable || found <= limit_)) return;
    }
  }
  limit_ = kUnreachable;
}

bool CostToGo::make_exact(const std::function<bool()>& stop) {
  while (limit_ != kUnreachable && !(best() <= limit_)) {
    raise_limit();
    if (!sweep_once(stop)) return false;
  }
  return true;
}

void CostToGo::start_from(int layer, Block& block) {
  clear(layer, block);
  std::fill(block.row.begin(), block.row.end(), 0.0);
  for (int label = 0; label < lattice_->labels(); ++label) {
    if (!block.nodes().alive(label)) continue;
    want(*block.joints, lattice_->elbow_of(label), 0, chunks());
    for (int chunk = 0; chunk < chunks(); ++chunk) block.parts.push_back({label, chunk, true});
  }
  bar(block);
}

void CostToGo::forget() {
  pending_.clear();
  std::fill(cell_.begin(), cell_.end(), 0U);
  cells_.resize(1);
}

bool CostToGo::sweep_once(const std::function<bool()>& stop) {
  const Span span("sweep");
  forget();
  Block* next = block_[0].get();
  Block* here = block_[1].get();
  start_from(goal_, *next);
  cut(*next);
  settle(*next);
  store(*next);
  for (int layer = goal_ - 1; layer >= 0 && !next->labels.empty(); --layer) {
    if (stop && stop()) return false;
    if (layer == 0 && lattice_->has_start()) {
      const double value = relax_one(0, lattice_->start_slot());
      if (value <= limit_) cell_value(0, lattice_->start_slot()) = value;
      break;
    }
    clear(layer, *here);
    mark_reach(layer, *next, *here);
    relax(layer, *here, *next);
    bar(*here);
    relax_removed(*here);
    cut(*here);
    settle(*here);
    store(*here);
    std::swap(here, next);
  }
  return true;
}

void CostToGo::relax_removed(Block& block) {
  const auto removed = removed_edges_.find(block.layer);
  if (removed == removed_edges_.end()) return;
  for (const auto& [a, edges] : removed->second.tails) {
    if (!block.find(lattice_->label_of(a), lattice_->angle_of(a) / kChunk)) continue;
    double& value = block.row[static_cast<std::size_t>(a)];
    const auto gives_value = [&](const HalfEdge& edge) { return edge.cost + at(block.layer + 1, edge.other) == value; };
    if (value != kUnreachable && std::any_of(edges.begin(), edges.end(), gives_value)) value = relax_one(block.layer, a);
  }
}

double CostToGo::best() const {
  double best = kUnreachable;
  for (std::size_t k = 0; k < mark(lattice_->labels(), 0); ++k)
    if (cell_[k] != 0)
      for (const double value : cells_[cell_[k]]) best = std::min(best, value);
  return best;
}

// --- removals

void CostToGo::remove_node(int layer, int slot) {
  verdict_[index(layer, slot)] = Verdict::kRemoved;
  pending_[layer].nodes.push_back(slot);
}

void CostToGo::remove_alike(int layer, int slot, std::uint8_t depends) {
  if (depends == kOnNodeAlone) return remove_node(layer, slot);
  const int n = lattice_->angles(), branch = lattice_->branch_of(slot), angle = lattice_->angle_of(slot);
  for (int label = 0; label < lattice_->labels(); ++label) {
    const int other = label / lattice_->windings();
    if ((other ^ branch) & depends & (kShoulderBit | kWristBit | kElbowBit)) continue;
    const int first = depends & kOnArmAngle ? angle : 0, last = depends & kOnArmAngle ? angle : n - 1;
    for (int j = first; j <= last; ++j)
      if (node_verdict(layer, label * n + j) != Verdict::kRemoved) remove_node(layer, label * n + j);
  }
}

Verdict CostToGo::edge_verdict(int layer, int a, int b) const {
  if (edge_verdict_.empty()) return Verdict::kUnknown;
  const auto found = edge_verdict_.find({static_cast<std::int64_t>(index(layer, a)), b});
  return found == edge_verdict_.end() ? Verdict::kUnknown : found->second;
}

void CostToGo::keep_edge(int layer, int a, int b) {
  edge_verdict_[{static_cast<std::int64_t>(index(layer, a)), b}] = Verdict::kValid;
}

void CostToGo::remove_edge(int layer, int a, int b) {
  edge_verdict_[{static_cast<std::int64_t>(index(layer, a)), b}] = Verdict::kRemoved;
  const double cost = lattice_->edge_cost(lattice_->delta(config(layer, a), config(layer + 1, b)));
  removed_edges_[layer].tails[a].push_back({b, cost});
  removed_edges_[layer].heads[b].push_back({a, cost});
  pending_[layer].tails.push_back(a);
}

bool CostToGo::repair(const std::function<bool()>& stop) {
  // Where one repair is needed more follow, so joints are worth keeping, for lattices that leave room for 40 bytes a node.
  constexpr std::int64_t kMostKept = 1'000'000;
  if (lattice_->nodes() <= kMostKept) cache_.resize(static_cast<std::size_t>(lattice_->layers()));
  repair_once();
  return make_exact(stop);
}

CostToGo::Marks CostToGo::widened(const Marks& columns) const {
  const int n = lattice_->angles(), window = lattice_->window();
  Marks result(columns.size(), 0);
  for (int c = 0; c < chunks(); ++c) {
    if (!columns[static_cast<std::size_t>(c)]) continue;
    const int first = c * kChunk - window, last = std::min(n, (c + 1) * kChunk) - 1 + window;
    if (last - first + 1 >= n) return Marks(columns.size(), 1);
    for (int j = first, next = 0; j <= last; j += next) {
      const int angle = j < 0 ? j + n : j >= n ? j - n : j, column = angle / kChunk;
      result[static_cast<std::size_t>(column)] = 1;
      next = std::min(n, (column + 1) * kChunk) - angle;
    }
  }
  return result;
}

void CostToGo::repair_once() {
  const Span span("repair");
  const int n = lattice_->angles();
  Marks changed(static_cast<std::size_t>(chunks()), 0), here_changed(changed.size());  // columns, of any label
  bool any = false;
  Block* next = block_[0].get();
  Block* here = block_[1].get();
  while (!pending_.empty() && pending_.rbegin()->first > goal_) pending_.erase(std::prev(pending_.end()));
  for (int layer = pending_.empty() ? -1 : pending_.rbegin()->first; layer >= 0; --layer) {
    std::fill(here_changed.begin(), here_changed.end(), std::uint8_t{0});
    bool here_any = false;
    const auto set = [&](int slot, double value) {
      double& cell = cell_value(layer, slot);
      if (cell == value) return;
      cell = value;
      here_changed[static_cast<std::size_t>(lattice_->angle_of(slot) / kChunk)] = 1;
      here_any = true;
    };
    if (any && layer == 0 && lattice_->has_start()) {
      if (at(0, lattice_->start_slot()) != kUnreachable) set(lattice_->start_slot(), relax_one(0, lattice_->start_slot()));
    } else if (any) {
      const Marks dependent = widened(changed);
      load(layer + 1, widened(dependent), *next);
      load(layer, dependent, *here);
      relax(layer, *here, *next);
      bar(*here);
      relax_removed(*here);
      cut(*here);
      for (const Part& part : here->parts)
        for (int slot = part.label * n + part.begin(); slot < part.label * n + part.end(n); ++slot)
          set(slot, here->row[static_cast<std::size_t>(slot)]);
    }
    std::swap(here, next);  // its joints serve once more
    const auto pending = pending_.find(layer);
    if (pending != pending_.end()) {
      for (const int slot : pending->second.nodes)
        if (at(layer, slot) != kUnreachable) set(slot, kUnreachable);
      for (const int slot : pending->second.tails)
        if (layer < goal_ && at(layer, slot) != kUnreachable) set(slot, relax_one(layer, slot));
      pending_.erase(pending);
    }
    changed.swap(here_changed);
    any = here_any;
    if (!any) {
      if (pending_.empty()) break;
      layer = pending_.rbegin()->first + 1;  // nothing to do until there
    }
  }
}

// --- reach

double CostToGo::relax_one_forward(int layer, int slot, const Block& before) {
  const int n = lattice_->angles(), length = n + 2 * lattice_->window(), label = lattice_->label_of(slot);
  const Nodes here = nodes(layer, lattice_->elbow_of(label), lattice_->angle_of(slot), 1, scratch_);
  if (!here.nodes->valid(label, here.shift) || node_verdict(layer, slot) == Verdict::kRemoved) return kUnreachable;
  const Config q = here.nodes->config(label, here.shift);
  const Lattice::Run run = lattice_->predecessors(layer - 1, slot);
  double best = kUnreachable;
  for (const int other : before.labels)
    for (int k = 0; k < run.count; ++k) {
      const int j = (run.first + k) % n, a = other * n + j;
      const double done = before.value[static_cast<std::size_t>(other * length + lattice_->window() + j)];
      if (done >= best) continue;
      const Config delta = lattice_->delta(config(layer - 1, a), q);
      const double value = lattice_->edge_cost(delta) + done;
      if (value < best && lattice_->step_allowed(layer - 1, delta) && edge_verdict(layer - 1, a, slot) != Verdict::kRemoved)
        best = value;
    }
  return best;
}

int CostToGo::deepest_reachable() {
  const Span span("reach");
  const int n = lattice_->angles();
  Block* before = block_[0].get();
  Block* here = block_[1].get();
  start_from(0, *before);
  settle(*before);
  if (before->labels.empty()) return -1;
  int layer = 1;
  for (; layer < lattice_->layers(); ++layer) {
    clear(layer, *here);
    const auto step_one = [&](int slot) {
      const Part part{lattice_->label_of(slot), lattice_->angle_of(slot) / kChunk, true};
      double* row = here->row.data() + part.label * n;
      const auto place = std::lower_bound(here->parts.begin(), here->parts.end(), part);
      if (place == here->parts.end() || *place != part) {
        std::fill(row + part.begin(), row + part.end(n), kUnreachable);
        here->parts.insert(place, part);
      }
      want(*here->joints, lattice_->elbow_of(part.label), part.chunk, part.chunk + 1);
      row[lattice_->angle_of(slot)] = relax_one_forward(layer, slot, *before);
    };
    const auto reaches = [&](const HalfEdge& edge, double value) {
      const int n_padded = n + 2 * lattice_->window(), label = lattice_->label_of(edge.other);
      const int place = label * n_padded + lattice_->window() + lattice_->angle_of(edge.other);
      return edge.cost + before->value[static_cast<std::size_t>(place)] == value;
    };
    if (layer == 1 && lattice_->has_start()) {
      const Lattice::Run run = lattice_->successors(0, lattice_->start_slot());
      for (int label = 0; label < lattice_->labels(); ++label)
        for (int k = 0; k < run.count; ++k) step_one(label * n + (run.first + k) % n);
    } else {
      mark_reach(layer - 1, *before, *here);
      relax(layer - 1, *here, *before);
      bar(*here);
      const auto removed = removed_edges_.find(layer - 1);
      if (removed != removed_edges_.end())
        for (const auto& [b, edges] : removed->second.heads)
          if (here->find(lattice_->label_of(b), lattice_->angle_of(b) / kChunk) &&
              std::any_of(edges.begin(), edges.end(),
                          [&](const HalfEdge& edge) { return reaches(edge, here->row[static_cast<std::size_t>(b)]); }))
            step_one(b);
    }
    settle(*here);
    if (here->labels.empty()) break;
    std::swap(before, here);
  }
  return layer - 1;
}

}  // namespace swivel
