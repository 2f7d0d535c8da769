// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/kinematics/closed_form/arm_class.hpp"

#include "swivel/core/messages/input_error.hpp"

namespace swivel {

ArmClass classify(const Chain& chain, const std::string& source) {
  ArmClass result;
  const auto other = [&](const std::string& why) {
    result.not_srs = why;
    result.lock = lock_method(chain);
    if (result.lock.best >= 0) result.kind = ArmKind::kArcs;
  };
  if (const int slide = chain.slide(); slide >= 0) {
    const std::string& name = chain.joint_names[static_cast<std::size_t>(slide)];
    if (chain.free_roll)
      throw InputError(source, "path.roll: joint '" + name +
                                   "' is prismatic: allowed where the arm's joints turn: hold it "
                                   "by robot.hold");
    other("joint '" + name + "' slides");
    if (result.lock.best < 0)
      throw InputError(source, "joint '" + name +
                                   "' is prismatic, and the six others have no closed form: "
                                   "allowed are six of which three neighbouring axes meet in a "
                                   "point or are parallel");
    return result;
  }
  if (chain.roll) {
    other("six joints and the roll of the tool");
    return result;
  }
  try {
    result.srs = fit_srs(chain, source);
    result.kind = ArmKind::kSrs;
  } catch (const NotSrs& error) {
    if (chain.free_roll) {
      const int lock = lock_method(chain).best;
      throw InputError(
          source,
          "path.roll: of arms of seven joints allowed for those with spherical shoulder and "
          "wrist; here " +
              error.why() +
              (lock < 0 ? std::string()
                        : ": robot.hold: {" + chain.joint_names[static_cast<std::size_t>(lock)] +
                              ": POSITION} makes it an arm of six"));
    }
    other(error.why());
  }
  return result;
}

std::string ArmClass::method() const {
  switch (kind) {
    case ArmKind::kSrs:
      return srs->exact ? "closed form: spherical shoulder and wrist; arm angle"
                        : "closed form of the nearest arm with spherical shoulder and wrist, "
                          "polished; arm angle";
    case ArmKind::kArcs:
      return lock.words() + "; arcs of self-motion";
    case ArmKind::kSampled:
      break;
  }
  return lock.words();
}

}  // namespace swivel
