// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel {

/// Instruction sets that vector kernels are compiled for. kScalar is the build's baseline (SSE2 on
/// x86-64, NEON on arm64).
enum class Isa { kScalar, kAvx2, kAvx512 };
/// Returns the instruction set that kernels run with: the widest that this processor has, or the
/// one that the environment variable SWIVEL_FORCE_ISA names (scalar, avx2 or avx512; ignored where
/// the processor lacks it). It is decided at the first call.
[[nodiscard]] Isa active_isa();
/// Returns "scalar", "avx2" or "avx512".
[[nodiscard]] const char* to_string(Isa isa);

}  // namespace swivel
