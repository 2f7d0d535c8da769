// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/problem/robot_model.hpp"

namespace swivel {

namespace {
template <class T>
int index_of(const std::vector<T>& items, const std::string& name) {
  for (std::size_t i = 0; i < items.size(); ++i)
    if (items[i].name == name) return static_cast<int>(i);
  return -1;
}
}  // namespace

int RobotModel::find_link(const std::string& link_name) const {
  return index_of(links, link_name);
}
int RobotModel::find_joint(const std::string& joint_name) const {
  return index_of(joints, joint_name);
}

}  // namespace swivel
