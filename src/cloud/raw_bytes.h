// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace alidade {

/// Memory in large pages: what is reached for at random then costs no second look-up, and first touch is cheap.
void* takeLarge(std::size_t bytes);
void giveLarge(void* memory) noexcept;

/// Leaves new elements as they are: what is written anyway need not be cleared first.
template <class T>
struct Unfilled : std::allocator<T> {
  /// From here on what a large page leaves unused is little.
  static constexpr std::size_t kLargeBytes = std::size_t{4} << 20;

  T* allocate(std::size_t count) {
    if (count < kLargeBytes / sizeof(T)) return std::allocator<T>::allocate(count);
    if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(takeLarge(count * sizeof(T)));
  }
  void deallocate(T* memory, std::size_t count) noexcept {
    if (count < kLargeBytes / sizeof(T)) return std::allocator<T>::deallocate(memory, count);
    giveLarge(memory);
  }
  template <class U>
  struct rebind {
    using other = Unfilled<U>;
  };
  template <class U>
  void construct(U* at) noexcept {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... Args>
  void construct(U* at, Args&&... args) {
    ::new (static_cast<void*>(at)) U(std::forward<Args>(args)...);
  }
};

/// Elements that a larger size brings hold anything.
template <class T>
using RawVector = std::vector<T, Unfilled<T>>;

}  // namespace alidade
