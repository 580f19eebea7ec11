// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

namespace alidade {

/// Memory for pictures, on a boundary of 64 bytes, or of a huge page. Large blocks are kept when they are returned (up to kKeptPixelBytes of the
/// whole process, the oldest go first) and handed out again: the first touch of fresh pages costs more than writing a picture.
/// Throws std::bad_alloc.
void* takePixels(std::size_t bytes);
void returnPixels(void* block, std::size_t bytes) noexcept;

constexpr std::size_t kKeptPixelBytes = std::size_t{256} << 20;

/// std::vector's memory from there. Elements that were given no value are left as the memory is.
template <class T>
struct PixelAllocator {
  using value_type = T;

  PixelAllocator() = default;
  template <class U>
  PixelAllocator(const PixelAllocator<U>&) {}  // NOLINT: allocators convert

  T* allocate(std::size_t count) { return static_cast<T*>(takePixels(count * sizeof(T))); }
  void deallocate(T* block, std::size_t count) noexcept { returnPixels(block, count * sizeof(T)); }

  template <class U, class... Values>
  void construct(U* place, Values&&... values) {
    constexpr bool may = std::is_trivially_copyable_v<U> && std::is_trivially_destructible_v<U>;
    if constexpr (sizeof...(Values) > 0 || !may) std::construct_at(place, std::forward<Values>(values)...);
  }

  friend bool operator==(const PixelAllocator&, const PixelAllocator&) { return true; }
};

}  // namespace alidade
