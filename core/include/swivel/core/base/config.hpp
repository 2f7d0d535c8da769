// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <string>

namespace swivel {

/// Coordinates of the arms that are planned today. An arm of six joints counts its tool's roll as
/// the seventh. Closed forms, grids of arm angles and curves of self-motion have this number.
inline constexpr int kDof = 7;
/// Coordinates that a Config has room for.
inline constexpr int kMaxDof = 10;

/// A joint configuration: joint positions from base to tip, rad (m for joints that slide). Entries
/// behind the arm's last coordinate are zero, so sums over all entries are sums over the arm's.
class Config : public Eigen::Matrix<double, kMaxDof, 1> {
 public:
  using Base = Eigen::Matrix<double, kMaxDof, 1>;

  Config() : Base(Base::Zero()) {}
  /// Makes a configuration of at most kMaxDof values; those that are not given are zero.
  Config(std::initializer_list<double> values) : Config() {
    eigen_assert(values.size() <= static_cast<std::size_t>(kMaxDof));
    Eigen::Index j = 0;
    for (const double value : values) (*this)[j++] = value;
  }
  /// Makes a configuration of a vector of at most kMaxDof entries; the others are zero.
  template <typename Vector>
  EIGEN_ALWAYS_INLINE Config(const Eigen::MatrixBase<Vector>& vector) {
    *this = vector;
  }
  template <typename Vector>
  EIGEN_ALWAYS_INLINE Config& operator=(const Eigen::MatrixBase<Vector>& vector) {
    if constexpr (Vector::RowsAtCompileTime == kMaxDof) {
      Base::operator=(vector);
    } else {
      Base filled = Base::Zero();
      filled.head(vector.size()) = vector;
      Base::operator=(filled);
    }
    return *this;
  }

  /// Returns a configuration of kDof values.
  static Config of(const double* values) {
    return Eigen::Map<const Eigen::Matrix<double, kDof, 1>>(values);
  }
  /// Returns a configuration whose first kDof coordinates have a value.
  static Config Constant(double value) { return Eigen::Matrix<double, kDof, 1>::Constant(value); }
  static Config Ones() { return Constant(1); }
  static void Map(const double*) = delete;  // would read kMaxDof values; see of()

  /// Returns the first kDof entries: what files, messages and users see of the arm.
  [[nodiscard]] auto coordinates() & { return head<kDof>(); }
  [[nodiscard]] auto coordinates() const& { return head<kDof>(); }
  void coordinates() && = delete;  // it refers to the entries of this configuration
};

/// The names of an arm's joints, base to tip. The last is empty where an arm of six joints has a
/// tool that may not turn: then the seventh coordinate is 0, and files and users have six.
using JointNames = std::array<std::string, kDof>;
/// Returns the number of joints that have a name, 6 or 7; 7 where none has.
[[nodiscard]] inline std::size_t named_joints(const JointNames& names) {
  return names.back().empty() && !names.front().empty() ? kDof - 1 : kDof;
}

/// Returns the sum of the arm's coordinates in `v`, a vector as long as a Config. It leaves out the
/// entries behind them, which are zero, so that it has the bits of a sum of kDof numbers.
template <typename Vector>
EIGEN_ALWAYS_INLINE double joint_sum(const Eigen::MatrixBase<Vector>& v) {
  static_assert(Vector::SizeAtCompileTime == kMaxDof);
  return v.template head<kDof>().sum();
}

/// Returns the square of the Euclidean norm of `v`, a vector as long as a Config.
template <typename Vector>
EIGEN_ALWAYS_INLINE double joint_squared_norm(const Eigen::MatrixBase<Vector>& v) {
  return v.template head<kDof>().squaredNorm();
}

/// Returns the Euclidean norm of `v`, a vector as long as a Config.
template <typename Vector>
EIGEN_ALWAYS_INLINE double joint_norm(const Eigen::MatrixBase<Vector>& v) {
  return v.template head<kDof>().norm();
}

/// Returns the scalar product of two vectors as long as a Config.
template <typename First, typename Second>
EIGEN_ALWAYS_INLINE double joint_dot(const Eigen::MatrixBase<First>& a,
                                     const Eigen::MatrixBase<Second>& b) {
  return a.template head<kDof>().dot(b.template head<kDof>());
}

}  // namespace swivel
