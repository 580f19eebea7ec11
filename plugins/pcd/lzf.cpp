// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pcd/lzf.h"

#include <algorithm>
#include <cstdint>

namespace alidade {

bool decodeLzf(std::span<const std::byte> in, std::span<std::byte> out) {
  std::size_t from = 0, to = 0;
  const auto next = [&] { return std::to_integer<std::size_t>(in[from++]); };
  while (from < in.size()) {
    const std::size_t control = next();
    if (control < 32) {
      const std::size_t count = control + 1;
      if (count > in.size() - from || count > out.size() - to) return false;
      std::copy_n(in.begin() + from, count, out.begin() + to);
      from += count;
      to += count;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) {
      if (from >= in.size()) return false;
      length += next();
    }
    if (from >= in.size()) return false;
    const std::size_t distance = ((control & 31) << 8) + next() + 1;
    length += 2;
    if (distance > to || length > out.size() - to) return false;
    // The two runs may overlap: byte by byte, the copy feeds itself.
    for (std::size_t i = 0; i < length; ++i, ++to) out[to] = out[to - distance];
  }
  return to == out.size();
}

}  // namespace alidade
