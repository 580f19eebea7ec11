// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace alidade {

/// A number that only means something within its kind: ScanId never compares with FrameId.
/// 0 is "none"; stores count from 1.
template <class Tag>
struct Id {
  std::int64_t value = 0;
  explicit operator bool() const { return value != 0; }
  friend auto operator<=>(const Id&, const Id&) = default;
};

}  // namespace alidade

template <class Tag>
struct std::hash<alidade::Id<Tag>> {
  std::size_t operator()(const alidade::Id<Tag>& id) const noexcept { return std::hash<std::int64_t>{}(id.value); }
};
