// SPDX-License-Identifier: BSD-3-Clause
// Bindings of trajectories.
#include "answers/answer.hpp"
#include "base/archive.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/io/io.hpp"

namespace swivel::python {

namespace {

using Rows = std::vector<TrajectoryRow>;

template <class Number>
py::array_t<Number> member_column(const std::shared_ptr<const Rows>& rows,
                                  Number TrajectoryRow::*member) {
  return column(rows, rows->empty() ? nullptr : &(rows->front().*member));
}

bool last_joint_is_roll(const io::JointNames& names) {
  return names[kDof - 1] == "roll";
}

Trajectory make_trajectory(const ArrayLike& joints, const ArrayLike& s, const ArrayLike& phi,
                           const ArrayLike& branch, const std::vector<std::string>& names,
                           const ArrayLike& roll) {
  const Postures q = to_joints(joints, "joints", 0);
  const auto count = static_cast<py::ssize_t>(q.rows.size());
  using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
  const auto numbers = [&](py::handle source, const char* name) {
    const Doubles array = Doubles::ensure(source);
    if (!array || array.ndim() != 1 || array.shape(0) != count) {
      PyErr_Clear();
      throw py::value_error(std::string(name) + ": allowed is one number for each of the " +
                            std::to_string(count) + " rows");
    }
    return array;
  };
  const Doubles along = numbers(s, "s");
  const Doubles angle = phi.is_none() ? Doubles() : numbers(phi, "phi"),
                label = branch.is_none() ? Doubles() : numbers(branch, "branch"),
                turn = roll.is_none() ? Doubles() : numbers(roll, "roll");
  auto rows = std::make_shared<Rows>(q.rows.size());
  for (py::ssize_t k = 0; k < count; ++k) {
    TrajectoryRow& row = (*rows)[static_cast<std::size_t>(k)];
    row.q = q.rows[static_cast<std::size_t>(k)];
    row.s = along.at(k);
    if (!phi.is_none()) row.phi = angle.at(k);
    if (!roll.is_none()) row.roll = turn.at(k);
    if (!branch.is_none()) {
      const double value = label.at(k);
      if (!(value >= 0 && value <= 7) || value != static_cast<int>(value))
        throw py::value_error("branch[" + std::to_string(k) +
                              "]: allowed are whole numbers from 0 to 7");
      row.branch = static_cast<int>(value);
    }
  }
  Trajectory made{std::move(rows), to_joint_names(names, q.width)};
  if (!roll.is_none() && last_joint_is_roll(made.joint_names))
    throw py::value_error("roll: is the last joint of these rows already: allowed is None");
  return made;
}

void save_trajectory(const Trajectory& trajectory, const std::filesystem::path& csv) {
  PlanResult result;
  result.trajectory = *trajectory.rows;
  result.joint_names = trajectory.joint_names;
  io::write_trajectory(csv, result);
}

}  // namespace

py::array_t<double> joints_of(const Trajectory& trajectory) {
  const auto& rows = trajectory.rows;
  return column(rows, rows->empty() ? nullptr : rows->front().q.data(),
                static_cast<py::ssize_t>(named_joints(trajectory.joint_names)));
}

io::JointNames to_joint_names(const std::vector<std::string>& names, std::size_t width) {
  io::JointNames all;
  if (!names.empty() && names.size() != width)
    throw py::value_error("joint_names: " + std::to_string(names.size()) + ": allowed are " +
                          std::to_string(width));
  for (std::size_t k = 0; k < width; ++k)
    all[k] = names.empty() ? "joint_" + std::to_string(k + 1) : names[k];
  return all;
}

void bind_rows(py::module_& m) {
  py::class_<Trajectory>(
      m, "Trajectory",
      "Rows along a tool path. Arrays are read-only views that keep the rows alive.")
      .def(pickling<Trajectory>())
      .def(py::init(&make_trajectory), py::arg("joints"), py::arg("s"), py::arg("phi") = py::none(),
           py::arg("branch") = py::none(), py::arg("joint_names") = std::vector<std::string>{},
           py::arg("roll") = py::none(),
           "joints: (n, 7), or (n, 6) of six joints without a roll, rad. s: (n,), m along the "
           "path. phi: carried arm angle, rad, and "
           "branch: 0 to 7, of S-R-S arms. roll: of seven-joint arms whose tool may turn, rad; the "
           "roll of six-joint arms is the last of the joints. All of these are 0 by default.")
      .def_property_readonly(
          "s", [](const Trajectory& t) { return member_column(t.rows, &TrajectoryRow::s); },
          "(n,), m along the path.")
      .def_property_readonly(
          "phi", [](const Trajectory& t) { return member_column(t.rows, &TrajectoryRow::phi); },
          "(n,), carried arm angle, rad.")
      .def_property_readonly(
          "branch",
          [](const Trajectory& t) { return member_column(t.rows, &TrajectoryRow::branch); },
          "(n,), 0 to 7.")
      .def_property_readonly(
          "roll",
          [](const Trajectory& t) {
            if (last_joint_is_roll(t.joint_names))
              return column(t.rows, t.rows->empty() ? nullptr : &t.rows->front().q[kDof - 1]);
            return member_column(t.rows, &TrajectoryRow::roll);
          },
          "(n,), by how much the tool is turned about its z axis, rad; 0 where it may not turn.")
      .def_property_readonly(
          "joints", [](const Trajectory& t) { return joints_of(t); },
          "(n, 7) float64, or (n, 6) of six joints without a roll; rad, base to tip.")
      .def_property_readonly("joint_names",
                             [](const Trajectory& t) { return names_in(t.joint_names); })
      .def("save", &save_trajectory, py::arg("file"), "As CSV, docs/formats.md.")
      .def("__len__", [](const Trajectory& t) { return t.rows->size(); })
      .def("__repr__", [](const Trajectory& t) {
        return t.rows->empty() ? std::string("<Trajectory, empty>")
                               : formatted("<Trajectory of %zu rows, s %.4g to %.4g m>",
                                           t.rows->size(), t.rows->front().s, t.rows->back().s);
      });
}

}  // namespace swivel::python
