// SPDX-License-Identifier: BSD-3-Clause
// Conversions that the files of the Python module share: poses, waypoints, arrays and enums.
#pragma once
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/nearest_name.hpp"
#include "swivel/core/problem/path_problem.hpp"

// Python changes a scene in place, so it must never be copied into a list.
PYBIND11_MAKE_OPAQUE(std::vector<swivel::SceneObject>)

namespace swivel::python {
/// The seventh coordinate of a posture that has six numbers in Python. to_core() replaces it by 0
/// where the arm has six joints and its tool may not turn, and refuses it elsewhere.
inline constexpr double kNoSeventh = std::numeric_limits<double>::infinity();
}  // namespace swivel::python

/// Gives Python a Config as an array of the arm's coordinates, (7,) or (6,). Arguments are read by
/// to_posture() and to_joints().
template <>
struct pybind11::detail::type_caster<swivel::Config> {
  static constexpr auto name = const_name("numpy.ndarray[numpy.float64[7, 1]]");
  static handle cast(const swivel::Config& q, return_value_policy, handle) {
    const bool six = q[swivel::kDof - 1] == swivel::python::kNoSeventh;
    return array_t<double>(six ? swivel::kDof - 1 : swivel::kDof, q.data()).release();
  }
};

namespace swivel::python {

namespace py = pybind11;

/// Text that is an argument of a template.
template <std::size_t kSize>
struct Words {
  constexpr Words(const char (&given)[kSize]) { std::copy_n(given, kSize, text); }  // implicit
  char text[kSize] = {};
};
/// A Python object, checked as a `Base`. Signatures, and the stubs that are made of them, say that
/// it is of the type `kType`.
template <Words kType, class Base = py::object>
class Typed : public Base {
 public:
  using Base::Base;
  Typed(Base value) : Base(std::move(value)) {}       // implicit
  Typed(const char* value) : Base(py::str(value)) {}  // implicit
  static bool check_(py::handle value) { return py::isinstance<Base>(value); }
};
/// A member of an enum, or its name: to_enum() reads it.
template <class E>
class OrName : public py::object {
 public:
  using py::object::object;
  static bool check_(py::handle value) { return py::isinstance<py::object>(value); }
};
using ArrayLike = Typed<"ArrayLike">;
using OptionalArray = Typed<"Optional[ArrayLike]">;
using SceneObjects = Typed<"Iterable[SceneObject]", py::iterable>;
using ProgressCallback = Typed<"_Progress">;

/// A mesh, shared by all that use it.
struct Mesh {
  MeshPtr mesh;
};

/// Converts a pose: a (4, 4) array or [x y z qw qx qy qz], m, and if `position_alone` also [x y z].
/// Throws ValueError for anything else.
[[nodiscard]] Waypoint to_waypoint(py::handle source, bool position_alone);
[[nodiscard]] Pose to_pose(py::handle source);
/// Returns the pose that the 16 numbers of a (4, 4) array state, row by row. Throws ValueError for
/// no rigid transform.
[[nodiscard]] Pose to_rigid(const double* numbers);
/// Throws ValueError for a quaternion whose length is off 1 by more than 1e-3.
void require_unit(const Quaterniond& quaternion);
[[nodiscard]] std::vector<Waypoint> to_waypoints(py::handle source);
[[nodiscard]] py::array_t<double> from_waypoints(const std::vector<Waypoint>& waypoints);
/// Lets a tool that `robot` may turn freely about its z axis pass half turns between waypoints, as
/// files do (io::choose_sides).
void pass_half_turns(const Robot& robot, std::vector<Waypoint>& waypoints);
/// Returns the arm of a robot. Throws InputError as build_arm() does.
[[nodiscard]] ArmModel arm_of(const Robot& robot);
/// Returns the joints of one posture, rad, of six numbers with kNoSeventh; nothing for None. Throws
/// ValueError, with `name` as that of the argument, for another shape than (7,) or (6,).
[[nodiscard]] std::optional<Config> to_posture(py::handle joints, const char* name);
/// Configurations that Python gives, rad.
struct Postures {
  std::vector<Config> rows;  ///< those of six numbers have 0 behind them
  std::size_t width = kDof;  ///< numbers of a row as it was given
};
/// Returns the configurations of joints, (n, width) or one row (width,), rad. `width` 0: 7 or 6.
/// Throws ValueError, with `what` as the name of the argument, for other shapes.
[[nodiscard]] Postures to_joints(py::handle source, const char* what, std::size_t width);
/// Returns the names of joints that there are.
[[nodiscard]] std::vector<std::string> names_in(const JointNames& names);

/// Returns a read-only numpy array of one member of all rows, without a copy. `first` points at the
/// member in the first row. Shape (n,), or (n, width) if width > 0.
template <class Row, class Number>
py::array_t<Number> column(const std::shared_ptr<const std::vector<Row>>& rows, const Number* first,
                           py::ssize_t width = 0) {
  using Owner = std::shared_ptr<const std::vector<Row>>;
  const auto count = static_cast<py::ssize_t>(rows->size());
  std::vector<py::ssize_t> shape{count}, strides{static_cast<py::ssize_t>(sizeof(Row))};
  if (width > 0) shape.push_back(width), strides.push_back(sizeof(Number));
  const py::capsule owner(new Owner(rows), [](void* kept) { delete static_cast<Owner*>(kept); });
  py::array_t<Number> array(shape, strides, first, owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

/// A Python enum whose members equal their names, and may be given by name wherever the module
/// takes one: Status.SOLVED and "solved".
template <class E>
struct EnumNames {
  static inline std::vector<std::pair<std::string, E>> names;
  static inline std::string type;
  static std::string name_of(E value) {
    for (const auto& [name, known] : names)
      if (known == value) return name;
    return {};
  }
};
template <class E>
void bind_enum(py::module_& m, const char* type, const char* doc,
               std::vector<std::pair<std::string, E>> names) {
  const std::string told = std::string(doc) +
                           " A member is equal to its name as str() gives it: \"" +
                           names.front().first + "\", and hashes like it.";
  py::enum_<E> bound(m, type, told.c_str());
  for (const auto& [name, value] : names) {
    std::string upper = name;
    for (char& letter : upper)
      letter = static_cast<char>(letter >= 'a' && letter <= 'z' ? letter - 'a' + 'A' : letter);
    bound.value(upper.c_str(), value);
  }
  // Replaces pybind11's own __str__, which calls itself "name"; an overload of that would replace
  // the property `name`.
  bound.attr("__str__") =
      py::cpp_function(&EnumNames<E>::name_of, py::name("__str__"), py::is_method(bound));
  const auto same = [](E value, const py::object& other) {
    if (py::isinstance<E>(other)) return value == other.cast<E>();
    return py::isinstance<py::str>(other) &&
           other.cast<std::string>() == EnumNames<E>::name_of(value);
  };
  bound.attr("__eq__") =
      py::cpp_function(same, py::name("__eq__"), py::is_method(bound), py::arg("other"));
  bound.attr("__ne__") =
      py::cpp_function([same](E value, const py::object& other) { return !same(value, other); },
                       py::name("__ne__"), py::is_method(bound), py::arg("other"));
  bound.attr("__hash__") =
      py::cpp_function([](E value) { return py::hash(py::str(EnumNames<E>::name_of(value))); },
                       py::name("__hash__"), py::is_method(bound));
  EnumNames<E>::names = std::move(names);
  EnumNames<E>::type = type;
}
template <class E>
E to_enum(py::handle source) {
  if (py::isinstance<E>(source)) return source.cast<E>();
  std::string allowed;
  for (const auto& [name, value] : EnumNames<E>::names) {
    if (py::isinstance<py::str>(source) && source.cast<std::string>() == name) return value;
    allowed += (allowed.empty() ? "" : ", ") + name;
  }
  throw py::value_error(EnumNames<E>::type + ": " + py::repr(source).cast<std::string>() +
                        ": allowed are " + allowed);
}

template <class T>
auto pickling();  // archive.hpp

/// Supports Python's module copy. Meshes and robot models stay shared, since they do not change.
template <class T, class... Bases>
void make_copyable(py::class_<T, Bases...>& type) {
  type.def("__copy__", [](const T& self) { return T(self); });
  type.def(
      "__deepcopy__", [](const T& self, const py::dict&) { return T(self); }, py::arg("memo"));
}

/// Binds a plain struct: it is made from keywords, its members are attributes, and its repr is the
/// call that makes it, with all members.
template <class T>
class PlainStruct {
 public:
  PlainStruct(py::module_& m, const char* type, const char* doc)
      : class_(m, type, doc), type_(type) {}
  template <class Member>
  PlainStruct& member(const char* name, Member T::*member, const char* doc) {
    class_.def_readwrite(name, member, doc);
    names_->push_back(name);
    return *this;
  }
  /// A member that is a number for each joint, seven or six (kNoSeventh).
  PlainStruct& of_joints(const char* name, std::optional<std::array<double, kDof>> T::*member,
                         const char* doc) {
    class_.def_property(
        name,
        [member](const T& self) -> std::optional<std::vector<double>> {
          const auto& numbers = self.*member;
          if (!numbers) return {};
          return std::vector<double>(numbers->begin(),
                                     numbers->end() - (numbers->back() == kNoSeventh ? 1 : 0));
        },
        [member, name](T& self, const std::optional<std::vector<double>>& given) {
          (self.*member).reset();
          if (!given) return;
          if (given->size() != kDof && given->size() + 1 != kDof)
            throw py::value_error(std::string(name) + ": " + std::to_string(given->size()) +
                                  " numbers: allowed are 7, or 6 of six joints without a roll");
          auto& numbers = (self.*member).emplace();
          numbers.back() = kNoSeventh;
          std::copy(given->begin(), given->end(), numbers.begin());
        },
        doc);
    names_->push_back(name);
    return *this;
  }
  template <class E>
  PlainStruct& choice(const char* name, E T::*member, const char* doc) {
    class_.def_property(
        name, [member](const T& self) { return self.*member; },
        [member](T& self, const OrName<E>& value) { self.*member = to_enum<E>(value); }, doc);
    names_->push_back(name);
    return *this;
  }
  void finish() {
    const auto names = names_;
    const std::string type = type_;
    class_.def(py::init([names, type](const py::kwargs& values) {
      T made;
      const py::object self = py::cast(&made, py::return_value_policy::reference);
      for (const std::pair<py::handle, py::handle> value : values) {
        const std::string name = py::str(value.first);
        if (std::find(names->begin(), names->end(), name) == names->end())
          throw py::type_error(type + ": unknown keyword '" + name + "', nearest is '" +
                               nearest_name(name, *names) + "'");
        self.attr(value.first) = value.second;
      }
      return made;
    }));
    class_.def("__repr__", [names, type](const T& self) {
      const py::object own = py::cast(self);
      std::string text;
      for (const std::string& name : *names) {
        py::object value = own.attr(name.c_str());
        if (py::hasattr(value, "__members__")) value = py::str(value);
        text += (text.empty() ? "" : ", ") + name + "=" + py::repr(value).cast<std::string>();
      }
      return type + "(" + text + ")";
    });
    class_.def(
        "__eq__", [](const T& a, const T& b) { return a == b; }, py::is_operator());
    class_.attr("__hash__") = py::none();
    class_.def(pickling<T>());
    make_copyable(class_);
  }

 private:
  py::class_<T> class_;
  std::string type_;
  // Shared with the functions that are bound.
  std::shared_ptr<std::vector<std::string>> names_ = std::make_shared<std::vector<std::string>>();
};

void bind_problem(py::module_& m);
void bind_planner(py::module_& m);
void bind_functions(py::module_& m);
void bind_runs(py::module_& m);
void bind_plan_many(py::module_& m);
void bind_states(py::module_& m);
void bind_drawings(py::module_& m);
void bind_certificates(py::module_& m);

}  // namespace swivel::python

namespace pybind11::detail {

template <swivel::python::Words kType, class Base>
struct handle_type_name<swivel::python::Typed<kType, Base>> {
  static constexpr auto name = const_name(kType.text);
};
template <class E>
struct handle_type_name<swivel::python::OrName<E>> {
  static constexpr auto name = const_name("Union[") + make_caster<E>::name + const_name(", str]");
};

template <>
struct type_caster<swivel::Pose> {
  PYBIND11_TYPE_CASTER(swivel::Pose, const_name("PoseLike"));
  bool load(handle source, bool) {
    value = swivel::python::to_pose(source);
    return true;
  }
  static handle cast(const swivel::Pose& pose, return_value_policy, handle) {
    return type_caster<Eigen::Matrix4d>::cast(pose.matrix(), return_value_policy::copy, {});
  }
};

template <>
struct type_caster<std::vector<swivel::Waypoint>> {
  PYBIND11_TYPE_CASTER(std::vector<swivel::Waypoint>, const_name("WaypointsLike"));
  bool load(handle source, bool) {
    value = swivel::python::to_waypoints(source);
    return true;
  }
  static handle cast(const std::vector<swivel::Waypoint>& waypoints, return_value_policy, handle) {
    return swivel::python::from_waypoints(waypoints).release();
  }
};

}  // namespace pybind11::detail
