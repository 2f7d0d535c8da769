// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/base/isa.hpp"

#include <cstdlib>
#include <string_view>

namespace swivel {

namespace {

bool has(Isa isa) {
#ifdef SWIVEL_X86_KERNELS
  switch (isa) {
    case Isa::kScalar:
      return true;
    case Isa::kAvx2:
      return __builtin_cpu_supports("avx2");
    case Isa::kAvx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512vl");
  }
#endif
  return isa == Isa::kScalar;
}

Isa choose() {
  const char* forced = std::getenv("SWIVEL_FORCE_ISA");
  if (forced)
    for (const Isa isa : {Isa::kScalar, Isa::kAvx2, Isa::kAvx512})
      if (std::string_view(forced) == to_string(isa) && has(isa)) return isa;
  for (const Isa isa : {Isa::kAvx512, Isa::kAvx2})
    if (has(isa)) return isa;
  return Isa::kScalar;
}

}  // namespace

Isa active_isa() {
  static const Isa isa = choose();
  return isa;
}

const char* to_string(Isa isa) {
  switch (isa) {
    case Isa::kScalar:
      return "scalar";
    case Isa::kAvx2:
      return "avx2";
    case Isa::kAvx512:
      return "avx512";
  }
  return "?";
}

}  // namespace swivel
