// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/raw_bytes.h"

#include <new>

#include <sys/mman.h>

namespace alidade {

namespace {

constexpr std::align_val_t kLargePage{std::size_t{2} << 20};

}  // namespace

void* takeLarge(std::size_t bytes) {
  void* memory = ::operator new(bytes, kLargePage);
  ::madvise(memory, bytes, MADV_HUGEPAGE);  // where there are none, small ones do
  return memory;
}

void giveLarge(void* memory) noexcept {
  ::operator delete(memory, kLargePage);
}

}  // namespace alidade
