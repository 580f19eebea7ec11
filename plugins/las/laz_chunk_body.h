// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// The decoders of whole chunks. This text is compiled for several instruction sets: each source that includes
// it names its set in ALIDADE_LAZ_SET and, having included what is shared, says so to the compiler. Nothing that is
// defined outside of the set's namespace may then be compiled for it: other sources would be linked to it.

#include <cassert>
#include <initializer_list>
#include <numeric>

#include "las/laz_chunk.h"
#include "las/laz_items.h"
#include "las/laz_items_v1.h"
#include "las/laz_layers.h"

namespace alidade::laz {
inline namespace ALIDADE_LAZ_SET {

inline std::size_t sizeOf(const std::vector<Item>& items) {
  return std::accumulate(items.begin(), items.end(), std::size_t{0},
                         [](std::size_t sum, const Item& item) { return sum + item.size; });
}

inline const Item* itemOf(const std::vector<Item>& items, std::initializer_list<int> types) {
  for (const Item& item : items)
    for (const int type : types)
      if (item.type == type) return &item;
  return nullptr;
}

inline std::size_t extraBytes(const std::vector<Item>& items) {
  const Item* extra = itemOf(items, {Item::Byte, Item::Byte14});
  return extra ? extra->size : 0;
}

/// The formats 0-5: one stream, point after point.
template <class Point, class Time, class Colour, class Extra>
class PointwiseItems {
 public:
  explicit PointwiseItems(const std::vector<Item>& items)
      : m_hasTime(itemOf(items, {Item::GpsTime11})),
        m_hasColour(itemOf(items, {Item::Rgb12})),
        m_hasWave(itemOf(items, {Item::WavePacket13})),
        m_extra(extraBytes(items)) {
    m_colourAt = Point::kSize + (m_hasTime ? Time::kSize : 0);
    m_waveAt = m_colourAt + (m_hasColour ? Colour::kSize : 0);
    m_extraAt = m_waveAt + (m_hasWave ? WavePacket::kSize : 0);
  }
  std::size_t recordSize() const { return m_extraAt + m_extra.size(); }

  void start(const std::byte* first) {
    m_point.start(first);
    if (m_hasTime) m_time.start(first + Point::kSize);
    if (m_hasColour) m_colour.start(first + m_colourAt);
    if (m_hasWave) m_wave.start(first + m_waveAt);
    if (m_extra.size() > 0) m_extra.start(first + m_extraAt);
  }

  /// Calls `visit` with the steps of a point in their order. Two decoders take turns after each.
  template <class Visit>
  static void eachStep(const Visit& visit) {
    using Items = PointwiseItems;
    stepsOf<Point>([&](const auto& step) {
      visit([&](Items& items, auto& coder, std::byte* at) { step(items.m_point, coder, at); });
    });
    stepsOf<Time>([&](const auto& step) {
      visit([&](Items& items, auto& coder, std::byte* at) {
        if (items.m_hasTime) step(items.m_time, coder, at + Point::kSize);
      });
    });
    stepsOf<Colour>([&](const auto& step) {
      visit([&](Items& items, auto& coder, std::byte* at) {
        if (items.m_hasColour) step(items.m_colour, coder, at + items.m_colourAt);
      });
    });
    visit([](Items& items, auto& coder, std::byte* at) {
      if (items.m_hasWave || items.m_extra.size() > 0)
        codeAside(coder, [&](auto& local) {
          if (items.m_hasWave) items.m_wave.code(local, at + items.m_waveAt);
          if (items.m_extra.size() > 0) items.m_extra.code(local, at + items.m_extraAt);
        });
    });
  }

  /// All steps.
  template <class Coder>
  void code(Coder& coder, std::byte* at) {
    eachStep([&](const auto& step) { step(*this, coder, at); });
  }

 private:
  /// An item that takes no turns within itself has one step.
  template <class Item, class Visit>
  static void stepsOf(const Visit& visit) {
    if constexpr (requires { Item::eachStep(visit); })
      Item::eachStep(visit);
    else
      visit([](Item& item, auto& coder, std::byte* at) {
        codeAside(coder, [&](auto& local) { item.code(local, at); });
      });
  }

  bool m_hasTime, m_hasColour, m_hasWave;
  std::size_t m_colourAt, m_waveAt, m_extraAt;
  Point m_point;
  Time m_time;
  Colour m_colour;
  WavePacket m_wave;
  Extra m_extra;
};

using ItemsV2 = PointwiseItems<Point10, GpsTime<false>, Rgb12, ExtraBytes>;
using ItemsV1 = PointwiseItems<Point10V1, GpsTimeV1, Rgb12V1, ExtraBytesV1>;

template <class Items>
class PointwiseDecoder : public ChunkDecoder {
 public:
  explicit PointwiseDecoder(const std::vector<Item>& items) : m_items(items) {}

  bool start(std::span<const std::byte> chunk) override {
    const std::size_t record = m_items.recordSize();
    if (chunk.size() < record) return false;
    m_chunk = chunk;
    m_first = chunk.data();
    m_items.start(m_first);
    m_started = false;
    return true;
  }

  // Flattened: what is not inlined would hold the decoders in memory.
  [[gnu::flatten]] void decode(std::size_t count, std::byte* out) override {
    const std::size_t record = m_items.recordSize();
    if (takeFirst(count, out)) --count, out += record;
    Decoder coder = m_coder;
    for (; count > 0; --count, out += record) {
      m_items.code(coder, out);
      m_end.hold(coder);
    }
    m_coder = coder;
  }

  [[gnu::flatten]] void decodeBoth(ChunkDecoder& otherDecoder, std::size_t count, std::byte* out, std::byte* otherOut) override {
    auto& other = static_cast<PointwiseDecoder&>(otherDecoder);
    const std::size_t record = m_items.recordSize();
    if (count == 0) return;
    const bool first = takeFirst(count, out), otherFirst = other.takeFirst(count, otherOut);
    assert(first == otherFirst);
    if (first && otherFirst) --count, out += record, otherOut += record;
    Decoder a = m_coder, b = other.m_coder;
    for (; count > 0; --count, out += record, otherOut += record) {
      Items::eachStep([&](const auto& step) {
        step(m_items, a, out);
        step(other.m_items, b, otherOut);
      });
      m_end.hold(a);
      other.m_end.hold(b);
    }
    m_coder = a;
    other.m_coder = b;
  }

  bool overran() const override { return m_started && m_end.isBefore(m_coder); }
  std::size_t taken() const override {
    return m_started ? static_cast<std::size_t>(m_coder.position() - m_chunk.data()) : 0;
  }

 private:
  /// The first point of a chunk stands there as it is.
  bool takeFirst(std::size_t count, std::byte* out) {
    if (m_started || count == 0) return false;
    m_started = true;
    const std::size_t record = m_items.recordSize();
    std::memcpy(out, m_first, record);
    m_coder = Decoder(m_chunk.data() + record);
    m_end = StreamEnd(m_chunk);
    return true;
  }

  Items m_items;
  std::span<const std::byte> m_chunk;
  const std::byte* m_first = nullptr;
  bool m_started = false;
  Decoder m_coder;
  StreamEnd m_end;
};

/// The formats 6-10: layers.
template <class Coder>
class LayeredItems {
 public:
  explicit LayeredItems(const std::vector<Item>& items) : m_point(items.front().version) {
    if (const Item* rgb = itemOf(items, {Item::Rgb14, Item::RgbNir14}))
      m_colour.emplace(rgb->version, rgb->type == Item::RgbNir14);
    if (const Item* wave = itemOf(items, {Item::WavePacket14})) m_wave.emplace(wave->version);
    if (const Item* extra = itemOf(items, {Item::Byte14})) m_extra.emplace(extra->version, extra->size);
    m_layers.resize(Point14::kLayers + (m_colour ? m_colour->layers() : 0) + (m_wave ? 1 : 0) +
                    (m_extra ? m_extra->size() : 0));
    m_record = sizeOf(items);
  }
  std::size_t recordSize() const { return m_record; }
  std::vector<Layer<Coder>>& layers() { return m_layers; }
  const std::vector<Layer<Coder>>& layers() const { return m_layers; }

  void start(const std::byte* first) {
    const unsigned channel = m_point.start(first);
    first += Point14::kSize;
    if (m_colour) m_colour->start(channel, first), first += m_colour->size();
    if (m_wave) m_wave->start(channel, first), first += WavePacket::kSize;
    if (m_extra) m_extra->start(channel, first);
  }

  void code(std::byte* at) {
    Layer<Coder>* layer = m_layers.data();
    const unsigned channel = m_point.code(layer, at);
    layer += Point14::kLayers;
    at += Point14::kSize;
    if (m_colour) {
      m_colour->code(layer, channel, at);
      layer += m_colour->layers();
      at += m_colour->size();
    }
    if (m_wave) {
      m_wave->code(*layer, channel, at);
      ++layer;
      at += WavePacket::kSize;
    }
    if (m_extra) m_extra->code(layer, channel, at);
  }

 private:
  std::size_t m_record = 0;
  Point14 m_point;
  std::optional<Rgb14> m_colour;
  std::optional<WavePacket14> m_wave;
  std::optional<ExtraBytes14> m_extra;
  std::vector<Layer<Coder>> m_layers;
};

class LayeredDecoder : public ChunkDecoder {
 public:
  explicit LayeredDecoder(const std::vector<Item>& items) : m_items(items) {}

  bool start(std::span<const std::byte> chunk) override {
    auto& layers = m_items.layers();
    const std::size_t record = m_items.recordSize(), head = record + 4 + 4 * layers.size();
    if (chunk.size() < head) return false;
    m_first = chunk.data();
    m_count = load<std::uint32_t>(chunk.data() + record);
    std::size_t at = head;
    for (std::size_t i = 0; i < layers.size(); ++i) {
      const std::size_t size = load<std::uint32_t>(chunk.data() + record + 4 + 4 * i);
      if (size > chunk.size() - at) return false;
      layers[i].present = size > 0;
      if (size > 0) layers[i].coder = Decoder(chunk.data() + at), layers[i].end = StreamEnd(chunk.subspan(at, size));
      at += size;
    }
    m_taken = at;
    m_started = false;
    m_items.start(m_first);
    return true;
  }

  void decode(std::size_t count, std::byte* out) override {
    const std::size_t record = m_items.recordSize();
    if (!m_started && count > 0) {
      std::memcpy(out, m_first, record);
      m_started = true;
      --count;
      out += record;
    }
    while (count > 0) {
      for (std::size_t some = std::min<std::size_t>(count, 64); some > 0; --some, --count, out += record) m_items.code(out);
      for (auto& layer : m_items.layers()) layer.end.hold(layer.coder);
    }
  }

  /// The layers are chains of their own already.
  void decodeBoth(ChunkDecoder& other, std::size_t count, std::byte* out, std::byte* otherOut) override {
    decode(count, out);
    other.decode(count, otherOut);
  }

  bool overran() const override {
    for (const auto& layer : m_items.layers())
      if (layer.present && layer.end.isBefore(layer.coder)) return true;
    return false;
  }
  std::size_t taken() const override { return m_taken; }
  std::uint32_t statedCount() const override { return m_count; }

 private:
  LayeredItems<Decoder> m_items;
  const std::byte* m_first = nullptr;
  std::uint32_t m_count = 0;
  std::size_t m_taken = 0;
  bool m_started = false;
};

inline std::unique_ptr<ChunkDecoder> makeDecoder(const std::vector<Item>& items) {
  static_assert(ChunkDecoder::kReadable >= kPadding);
  if (items.front().type == Item::Point14) return std::make_unique<LayeredDecoder>(items);
  if (items.front().version == 1) return std::make_unique<PointwiseDecoder<ItemsV1>>(items);
  return std::make_unique<PointwiseDecoder<ItemsV2>>(items);
}

}  // namespace ALIDADE_LAZ_SET
}  // namespace alidade::laz
