// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/copc_info.h"

#include "las/las_header.h"

namespace alidade {

namespace {

template <class T>
void put(std::vector<std::byte>& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

}  // namespace

CopcInfo CopcInfo::parse(const std::byte* payload) {
  CopcInfo info;
  for (int axis = 0; axis < 3; ++axis) info.centre[axis] = lasValue<double>(payload, 8 * axis);
  info.halfSize = lasValue<double>(payload, 24);
  info.spacing = lasValue<double>(payload, 32);
  info.rootOffset = lasValue<std::uint64_t>(payload, 40);
  info.rootSize = lasValue<std::uint64_t>(payload, 48);
  info.firstTime = lasValue<double>(payload, 56);
  info.lastTime = lasValue<double>(payload, 64);
  return info;
}

std::vector<std::byte> CopcInfo::bytes() const {
  std::vector<std::byte> payload(kSize);
  for (int axis = 0; axis < 3; ++axis) put(payload, 8 * axis, centre[axis]);
  put(payload, 24, halfSize);
  put(payload, 32, spacing);
  put(payload, 40, rootOffset);
  put(payload, 48, rootSize);
  put(payload, 56, firstTime);
  put(payload, 64, lastTime);
  return payload;
}

}  // namespace alidade
