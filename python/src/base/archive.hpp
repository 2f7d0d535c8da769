// SPDX-License-Identifier: BSD-3-Clause
// Problems and answers as bytes, for pickle. Of a struct all members are written, in the order of
// their declaration: what is added to it is written as well. A struct with a base, or of which
// something is left out, lists its members; where it has a base, it does not compile if a member
// was added and not listed. An object that is shared within another, as the mesh of many links, is
// written once.
#pragma once
#include <cereal/archives/portable_binary.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/map.hpp>
#include <cereal/types/memory.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/set.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/utility.hpp>
#include <cereal/types/variant.hpp>
#include <cereal/types/vector.hpp>
#include <sstream>
#include <string>
#include <typeinfo>

#include "base/bindings.hpp"
#include "base/members.hpp"
#include "swivel/core/answer/advice.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/base/fnv1a.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/core/study/placement.hpp"
#include "swivel/planner/verify/check.hpp"

namespace cereal {

// Writes coefficients one by one, since Eigen's own conversions would select other overloads.
template <class Archive, int Rows, int Columns>
void serialize(Archive& archive, Eigen::Matrix<double, Rows, Columns>& x) {
  static_assert(Rows > 0 && Columns > 0);
  for (int k = 0; k < Rows * Columns; ++k) archive(x.data()[k]);
}
template <class Archive>
void serialize(Archive& archive, Eigen::Quaterniond& x) {
  archive(x.coeffs());
}
template <class Archive>
void serialize(Archive& archive, Eigen::Isometry3d& x) {
  archive(x.matrix());
}

}  // namespace cereal

namespace swivel {

/// Writes or reads all members of a struct without bases.
template <class A, class T>
requires python::Aggregate<T>
void serialize(A& archive, T& x) {
  python::with_members(x, [&](auto&... all) { archive(all...); });
}

template <class A>
void serialize(A& archive, Allowed& x) {
  auto& [body, depth] = x;
  archive(body, depth);
}
/// Lists the members of a PathProblem and of its two bases, which no structured binding takes apart
/// together.
template <class A>
void serialize(A& archive, PathProblem& x) {
  struct Listed : Robot, Task {
    std::string source;
    std::vector<SceneObject> scene;
    std::vector<Variation> vary;
  };
  static_assert(sizeof(Listed) == sizeof(PathProblem));
  archive(static_cast<Robot&>(x), static_cast<Task&>(x), x.source, x.scene, x.vary);
}

/// Lists the members of a Stroke and of its base, which no structured binding takes apart together.
template <class A>
void serialize(A& archive, Stroke& x) {
  struct Listed : Task {
    std::string name;
    bool reversible;
    Vector3d approach, retract;
    std::optional<double> process_speed, approach_speed;
    std::vector<double> feed;
    std::optional<StrokePiece> piece;
  };
  static_assert(sizeof(Listed) == sizeof(Stroke));
  archive(static_cast<Task&>(x), x.name, x.reversible, x.approach, x.retract, x.process_speed,
          x.approach_speed, x.feed, x.piece);
}
/// Lists the members of an ArmTask and of its base.
template <class A>
void serialize(A& archive, ArmTask& x) {
  struct Listed : Robot {
    std::string name;
    std::vector<Stroke> strokes;
    std::vector<Config> given;
    Limits transition_limits;
    std::optional<Config> home;
    StrokeOrder order;
    std::optional<double> process_speed, approach_speed;
    double rapid;
    std::optional<LiftOffs> lift;
  };
  static_assert(sizeof(Listed) == sizeof(ArmTask));
  archive(static_cast<Robot&>(x), x.name, x.strokes, x.given, x.transition_limits, x.home, x.order,
          x.process_speed, x.approach_speed, x.rapid, x.lift);
}
/// Lists the members of a LiftOffAnswer and of its base, which no structured binding takes apart
/// together.
template <class A>
void serialize(A& archive, LiftOffAnswer& x) {
  struct Listed : LiftOff {
    double reached;
    Cause cause;
  };
  static_assert(sizeof(Listed) == sizeof(LiftOffAnswer));
  archive(x.stroke, x.end, x.resumed, x.reached, x.cause);
}

/// Lists the members of a RunAnswer and of its base, which no structured binding takes apart
/// together.
template <class A>
void serialize(A& archive, RunAnswer& x) {
  struct Listed : Measures {
    StrokeRun run;
    PlanStatus status;
    double least_cost;
    LatticeInfo lattice;
    std::optional<Diagnosis> diagnosis;
  };
  static_assert(sizeof(Listed) == sizeof(RunAnswer));
  archive(static_cast<Measures&>(x), x.run, x.status, x.least_cost, x.lattice, x.diagnosis);
}
/// Lists the members of an ArmMotion and of its base.
template <class A>
void serialize(A& archive, ArmMotion& x) {
  struct Listed : TimedPath {
    std::string name;
    std::vector<std::size_t> part;
    std::vector<ProcessEvent> events;
    std::vector<TimedPath> runs;
  };
  static_assert(sizeof(Listed) == sizeof(ArmMotion));
  archive(static_cast<TimedPath&>(x), x.name, x.part, x.events, x.runs);
}
template <class A>
void serialize(A& archive, EpisodeRow& x) {
  auto& [episode, status, cost, plan_ms, nodes_checked, fcl_calls, error_mean, error_max, failed_s,
         cause, by, reason, checked, offsets] = x;
  archive(episode, status, cost, plan_ms, nodes_checked, fcl_calls, error_mean, error_max, failed_s,
          cause, by, reason, checked, offsets);
}

namespace python {

using swivel::serialize;  // of structs of this namespace as well

/// Returns the checksum of bytes that stand for a T. The name of the class is part of it, so that
/// the same bytes of another class have another checksum.
template <class T>
std::uint64_t checksum_of(const std::string& bytes) {
  return fnv1a(bytes, fnv1a(typeid(T).name()));
}

/// Returns what `def` of a class takes to support Python's module pickle, between processes and
/// machines with the same version of this package. The state is (version, checksum, bytes). The
/// checksum matters because damaged bytes could be read as lengths of lists that fill the memory.
template <class T>
auto pickling() {
  return py::pickle(
      [](const T& self) {
        std::ostringstream bytes(std::ios::binary);
        cereal::PortableBinaryOutputArchive archive(bytes);
        archive(self);
        return py::make_tuple(SWIVEL_VERSION, checksum_of<T>(bytes.str()), py::bytes(bytes.str()));
      },
      [](const py::tuple& state) {
        const std::string version = state.size() > 0 ? py::str(state[0]).cast<std::string>() : "?";
        if (version != SWIVEL_VERSION)
          throw py::value_error("pickled by version " + version +
                                " of swivel: allowed is that of this one, " SWIVEL_VERSION);
        if (state.size() != 3 || !py::isinstance<py::int_>(state[1]) ||
            !py::isinstance<py::bytes>(state[2]))
          throw py::value_error(
              "not a pickle of swivel: allowed are a version, a checksum and bytes");
        std::string content = state[2].cast<std::string>();
        if (const py::object told = state[1]; !told.equal(py::int_(checksum_of<T>(content))))
          throw py::value_error("a damaged pickle of swivel: its checksum is not that of its " +
                                std::to_string(content.size()) +
                                " bytes: allowed is what pickle wrote");
        std::istringstream bytes(std::move(content), std::ios::binary);
        T self;
        try {
          cereal::PortableBinaryInputArchive archive(bytes);
          archive(self);
        } catch (const std::exception& error) {
          throw py::value_error(std::string("not a pickle of swivel: ") + error.what());
        }
        return self;
      });
}

}  // namespace python

}  // namespace swivel
