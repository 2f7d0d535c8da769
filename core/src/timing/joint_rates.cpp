// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>

#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/timing/time_path.hpp"

namespace swivel {

namespace {

/// Says which rate is assumed where no file states one, of joints that turn and of a slide.
std::string assumed_rate(const Chain& chain, double rate, int power) {
  std::string text = formatted("%.4g rad/s^%d is assumed", rate, power);
  if (const int slide = chain.slide(); slide >= 0)
    text += formatted(", of '%s' %.4g m/s^%d",
                      chain.joint_names[static_cast<std::size_t>(slide)].c_str(),
                      kSlideForTurn * rate, power);
  return text;
}

}  // namespace

JointRates joint_rates(const Chain& chain, const Limits& limits, const std::string& source) {
  // of small and middle-sized arms, on the slow side
  constexpr double kAcceleration = 10, kJerk = 100;
  JointRates rates;
  JointRates::Assumed no_acceleration{JointRate::kAcceleration,
                                      {},
                                      "joint accelerations are stated neither by the URDF nor as "
                                      "limits.joint_acceleration: " +
                                          assumed_rate(chain, kAcceleration, 2)};
  JointRates::Assumed no_jerk{
      JointRate::kJerk,
      {},
      "joint jerks are stated neither by the URDF nor as limits.joint_jerk: " +
          assumed_rate(chain, kJerk, 3)};
  for (std::size_t j = 0; j < kDof; ++j) {
    const auto joint = static_cast<Eigen::Index>(j);
    const JointLimit& model = chain.limit[j];
    if (chain.roll && j + 1 == kDof) {  // it is no joint
      rates.speed[joint] = rates.acceleration[joint] = rates.jerk[joint] =
          std::numeric_limits<double>::infinity();
      continue;
    }
    rates.speed[joint] = limits.joint_speed ? (*limits.joint_speed)[j] : model.velocity;
    rates.acceleration[joint] =
        limits.joint_acceleration ? (*limits.joint_acceleration)[j] : model.acceleration;
    rates.jerk[joint] = limits.joint_jerk ? (*limits.joint_jerk)[j] : model.jerk;
    if (!(rates.speed[joint] > 0))
      throw InputError(source, "joint '" + chain.joint_names[j] +
                                   "' has no speed limit in the URDF: allowed are robots whose "
                                   "joints all have one, or limits.joint_speed");
    const double of_turn = model.slides ? kSlideForTurn : 1;
    if (!(rates.acceleration[joint] > 0))
      rates.acceleration[joint] = of_turn * kAcceleration, no_acceleration.of[j] = true;
    if (!(rates.jerk[joint] > 0)) rates.jerk[joint] = of_turn * kJerk, no_jerk.of[j] = true;
  }
  for (const JointRates::Assumed& assumed : {no_acceleration, no_jerk})
    if (std::any_of(assumed.of.begin(), assumed.of.end(), [](bool one) { return one; }))
      rates.assumed.push_back(assumed);
  return rates;
}

}  // namespace swivel
