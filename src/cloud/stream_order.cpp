// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/stream_order.h"

#include <algorithm>
#include <numeric>

namespace alidade {

void UnitBox::add(const UnitBox& other) {
  if (low.x > high.x) *this = other;
  low = glm::min(low, other.low);
  high = glm::max(high, other.high);
}

bool UnitBox::touches(const UnitBox& other, std::int64_t reach) const {
  return glm::all(glm::lessThanEqual(low - reach, other.high)) && glm::all(glm::lessThanEqual(other.low, high + reach));
}

WorkOrder workOrderOf(const std::vector<UnitBox>& boxes, std::int64_t reach) {
  const auto count = static_cast<std::uint32_t>(boxes.size());
  std::vector<std::vector<std::uint32_t>> neighbours(count);
  std::vector<std::uint32_t> byX(count);
  std::iota(byX.begin(), byX.end(), 0u);
  std::sort(byX.begin(), byX.end(), [&](std::uint32_t a, std::uint32_t b) {
    return boxes[a].low.x != boxes[b].low.x ? boxes[a].low.x < boxes[b].low.x : a < b;
  });
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count && boxes[byX[j]].low.x <= boxes[byX[i]].high.x + reach; ++j) {
      if (!boxes[byX[i]].touches(boxes[byX[j]], reach)) continue;
      neighbours[byX[i]].push_back(byX[j]);
      neighbours[byX[j]].push_back(byX[i]);
    }
  }
  std::vector<std::uint32_t> colour(count, 0);
  std::vector<char> taken;
  for (std::uint32_t b = 0; b < count; ++b) {
    taken.assign(neighbours[b].size() + 1, 0);
    for (const std::uint32_t n : neighbours[b])
      if (n < b && colour[n] < taken.size()) taken[colour[n]] = 1;
    colour[b] = static_cast<std::uint32_t>(std::find(taken.begin(), taken.end(), 0) - taken.begin());
  }
  WorkOrder work;
  work.order.resize(count);
  std::iota(work.order.begin(), work.order.end(), 0u);
  std::stable_sort(work.order.begin(), work.order.end(), [&](std::uint32_t a, std::uint32_t b) { return colour[a] < colour[b]; });
  work.before.resize(count);
  for (std::uint32_t b = 0; b < count; ++b) {
    for (const std::uint32_t n : neighbours[b])
      if (colour[n] < colour[b]) work.before[b].push_back(n);
    std::sort(work.before[b].begin(), work.before[b].end());
  }
  return work;
}

}  // namespace alidade
