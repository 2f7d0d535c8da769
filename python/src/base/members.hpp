// SPDX-License-Identifier: BSD-3-Clause
// The members of a struct, without their names.
#pragma once
#include <cstddef>
#include <tuple>
#include <type_traits>

namespace swivel::python {

/// A struct without constructors of its own, but no std::array. Where it has a base, with_members()
/// does not compile.
template <class T>
concept Aggregate = std::is_aggregate_v<T> && !requires {
  typename std::tuple_size<T>::type;
};

/// A vector, a matrix, a quaternion or a pose of Eigen's.
template <class T>
concept Coefficients = requires {
  typename T::Scalar;
};

/// Stand for what initializes a member: a value of any type, and one of Eigen's, whose constructors
/// say that they take anything.
struct AnyValue {
  template <class T>
  requires(!Coefficients<T>) operator T() const;  // implicit, and never called, as the next
};
struct AnyCoefficients {
  template <Coefficients T>
  operator T() const;
};

/// Returns the number of members of a struct: the most values that initialize it, of which the
/// first are `Before`.
template <Aggregate T, class... Before>
constexpr std::size_t member_count() {
  if constexpr (requires { T{Before{}..., AnyValue{}}; })
    return member_count<T, Before..., AnyValue>();
  else if constexpr (requires { T{Before{}..., AnyCoefficients{}}; })
    return member_count<T, Before..., AnyCoefficients>();
  else
    return sizeof...(Before);
}

/// Calls `use` with all members of a struct, in the order of their declaration.
template <Aggregate T, class Use>
void with_members(T& x, const Use& use) {
  constexpr std::size_t kCount = member_count<T>();
  static_assert(kCount > 0 && kCount <= 22, "allowed are as many members as there are lines below");
#define SWIVEL_MEMBERS(number, ...)   \
  if constexpr (kCount == (number)) { \
    auto& [__VA_ARGS__] = x;          \
    use(__VA_ARGS__);                 \
  }
  SWIVEL_MEMBERS(1, a)
  SWIVEL_MEMBERS(2, a, b)
  SWIVEL_MEMBERS(3, a, b, c)
  SWIVEL_MEMBERS(4, a, b, c, d)
  SWIVEL_MEMBERS(5, a, b, c, d, e)
  SWIVEL_MEMBERS(6, a, b, c, d, e, f)
  SWIVEL_MEMBERS(7, a, b, c, d, e, f, g)
  SWIVEL_MEMBERS(8, a, b, c, d, e, f, g, h)
  SWIVEL_MEMBERS(9, a, b, c, d, e, f, g, h, i)
  SWIVEL_MEMBERS(10, a, b, c, d, e, f, g, h, i, j)
  SWIVEL_MEMBERS(11, a, b, c, d, e, f, g, h, i, j, k)
  SWIVEL_MEMBERS(12, a, b, c, d, e, f, g, h, i, j, k, l)
  SWIVEL_MEMBERS(13, a, b, c, d, e, f, g, h, i, j, k, l, m)
  SWIVEL_MEMBERS(14, a, b, c, d, e, f, g, h, i, j, k, l, m, n)
  SWIVEL_MEMBERS(15, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o)
  SWIVEL_MEMBERS(16, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p)
  SWIVEL_MEMBERS(17, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q)
  SWIVEL_MEMBERS(18, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r)
  SWIVEL_MEMBERS(19, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s)
  SWIVEL_MEMBERS(20, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t)
  SWIVEL_MEMBERS(21, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u)
  SWIVEL_MEMBERS(22, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v)
#undef SWIVEL_MEMBERS
}

}  // namespace swivel::python
