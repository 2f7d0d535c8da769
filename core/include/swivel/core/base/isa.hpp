// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel {

/// Vector units that kernels are compiled for. kScalar is the build's baseline (SSE2 on x86-64, NEON on arm64).
enum class Isa { kScalar, kAvx2, kAvx512 };
/// The best unit of this processor, or the one that SWIVEL_FORCE_ISA=scalar|avx2|avx512 asks for (ignored where the processor lacks
/// it).
[[nodiscard]] Isa active_isa();
[[nodiscard]] const char* to_string(Isa isa);

}  // namespace swivel
