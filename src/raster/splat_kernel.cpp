// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/splat_kernel.h"

#include <cstdlib>
#include <string_view>

#include "raster/mesh_kernel.h"
#include "raster/surface_kernel.h"

namespace alidade {

namespace {

/// Read at every call: a test, or a user who doubts a kernel, may change it while the program runs.
std::string_view forcedKernel() {
  const char* forced = std::getenv("ALIDADE_SIMD");
  return forced ? std::string_view(forced) : std::string_view();
}

#if defined(__x86_64__)
bool hasAvx2() {
  static const bool has = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return has;
}

bool hasAvx512() {
  static const bool has = hasAvx2() && __builtin_cpu_supports("avx512f") &&
                          __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
                          __builtin_cpu_supports("avx512vl");
  return has;
}
#endif

}  // namespace

const SplatKernel& splatKernel() {
#if defined(__x86_64__)
  const std::string_view forced = forcedKernel();
  if (forced == "scalar") return kScalarSplatKernel;
  if (hasAvx512() && forced != "avx2") return kAvx512SplatKernel;
  if (hasAvx2()) return kAvx2SplatKernel;
#endif
  return kScalarSplatKernel;
}

const MeshKernel& meshKernel() {
#if defined(__x86_64__)
  const SplatKernel* kernel = &splatKernel();
  if (kernel == &kAvx512SplatKernel) return kAvx512MeshKernel;
  if (kernel == &kAvx2SplatKernel) return kAvx2MeshKernel;
#endif
  return kScalarMeshKernel;
}

const SurfaceKernel& surfaceKernel() {
#if defined(__x86_64__)
  const SplatKernel* kernel = &splatKernel();
  if (kernel == &kAvx512SplatKernel) return kAvx512SurfaceKernel;
  if (kernel == &kAvx2SplatKernel) return kAvx2SurfaceKernel;
#endif
  return kScalarSurfaceKernel;
}

}  // namespace alidade
