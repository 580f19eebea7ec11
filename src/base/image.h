// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/pixel_memory.h"

namespace alidade {

struct Rgba8 {
  std::uint8_t r = 0, g = 0, b = 0, a = 255;
  friend bool operator==(const Rgba8&, const Rgba8&) = default;
};

/// Says that all pixels will be written: clearing them before takes as long as many a pass over them.
struct Uncleared {};

/// A picture in memory, row by row from the top, no padding. Pixel (0,0) is the top-left one and
/// its centre is at (0,0), as in OpenCV.
template <class T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, T value = T{})
      : m_width(width), m_height(height), m_pixels(static_cast<std::size_t>(width) * height, value) {}
  Image(int width, int height, Uncleared) : m_width(width), m_height(height), m_pixels(static_cast<std::size_t>(width) * height) {}
  Image(const Image& other) : Image(other.m_width, other.m_height, Uncleared{}) { std::copy_n(other.data(), size(), data()); }
  Image(Image&&) = default;
  Image& operator=(const Image& other) { return *this = Image(other); }
  Image& operator=(Image&&) = default;
  ~Image() = default;

  int width() const { return m_width; }
  int height() const { return m_height; }
  bool empty() const { return m_pixels.empty(); }
  std::size_t size() const { return m_pixels.size(); }
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < m_width && y < m_height; }

  T* data() { return m_pixels.data(); }
  const T* data() const { return m_pixels.data(); }
  T* row(int y) { return m_pixels.data() + static_cast<std::size_t>(y) * m_width; }
  const T* row(int y) const { return m_pixels.data() + static_cast<std::size_t>(y) * m_width; }
  T& at(int x, int y) { return row(y)[x]; }
  const T& at(int x, int y) const { return row(y)[x]; }
  void fill(T value) { m_pixels.assign(m_pixels.size(), value); }

 private:
  int m_width = 0;
  int m_height = 0;
  std::vector<T, PixelAllocator<T>> m_pixels;
};

using ColourImage = Image<Rgba8>;
using DepthImage = Image<float>;       ///< metres along the optical axis; +inf where nothing is
using IdImage = Image<std::uint32_t>;  ///< 0 where nothing is

}  // namespace alidade
