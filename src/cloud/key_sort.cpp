// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/key_sort.h"

#include <hwy/contrib/sort/vqsort.h>

namespace alidade {

// Quicksort in whole registers (Wassenberg et al., 2022): twice as fast as a radix sort where those are wide, and nothing that
// outgrows a core's own cache.
void sortKeys(std::span<std::uint64_t> keys) {
  hwy::Sorter()(keys.data(), keys.size(), hwy::SortAscending());
}

}  // namespace alidade
