// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>

#include "las/laz_items.h"

// The items of the point formats 6-10: every attribute is a stream of its own (a layer), and a layer in which nothing
// changes within a chunk is left out. Each of the four scanner channels has its own models and last values.

namespace alidade::laz {
inline namespace ALIDADE_LAZ_SET {

/// One layer's coder. Decoding: `present` says that the layer was written. Encoding: that it must be.
template <class Coder>
struct Layer {
  Coder coder;
  StreamEnd end;
  bool present = false;
};

/// What an item keeps of each scanner channel, made when the channel first appears.
template <class Context>
class Channels {
 public:
  template <class Init>
  void start(unsigned channel, const Init& init) {
    m_used.fill(false);
    use(channel, init);
  }
  bool used(unsigned channel) const { return m_used[channel]; }
  Context& operator[](unsigned channel) { return *m_contexts[channel]; }
  template <class Init>
  void use(unsigned channel, const Init& init) {
    if (!m_contexts[channel]) m_contexts[channel] = std::make_unique<Context>();
    m_used[channel] = true;
    init(*m_contexts[channel]);
  }

 private:
  std::array<std::unique_ptr<Context>, 4> m_contexts;
  std::array<bool, 4> m_used{};
};

/// LAS 1.4 core record, 30 bytes: POINT14 version 3 or 4.
class Point14 {
 public:
  static constexpr std::size_t kSize = 30;

  explicit Point14(int version) : m_tellsAlways(version > 3) {}

  enum LayerIndex { kReturnsXy, kZ, kClass, kFlags, kIntensity, kAngle, kUser, kSource, kTime, kLayers };

  /// Scanner channel of the first point; the other items start with it.
  unsigned start(const std::byte* first) {
    m_channel = channelOf(first);
    m_channels.start(m_channel, [&](Context& context) { context.start(first); });
    return m_channel;
  }

  /// Codes one record through kLayers layers. Returns the scanner channel that the other items are told: in version 3
  /// the record's own where it has just changed, else 0 (a slip of the first implementation that became the format).
  template <class Coder>
  unsigned code(Layer<Coder>* layers, std::byte* at) {
    Changes changes = codeChanges(layers[kReturnsXy].coder, at);
    Context& c = m_channels[m_channel];
    codeXyz(layers, c, changes, at);
    codeClassAndFlags(layers, c, changes, at);
    codeIntensity(layers[kIntensity], c, changes, at);
    codeAngleUserSource(layers, c, changes, at);
    Layer<Coder>& time = layers[kTime];
    if constexpr (Coder::kEncodes) time.present |= changes.time;
    if (changes.time && time.present) {
      std::byte now[8];
      std::memcpy(now, at + 22, 8);
      c.time.code(time.coder, now);
      std::memcpy(c.last + 22, now, 8);
    }
    c.timeChanged = changes.time;
    if constexpr (!Coder::kEncodes) std::memcpy(at, c.last, kSize);
    return changes.channel || m_tellsAlways ? m_channel : 0;
  }

 private:
  struct Context {
    void start(const std::byte* first) {
      std::memcpy(last, first, kSize);
      timeChanged = false;
      intensities.fill(load<std::uint16_t>(first + 12));
      heights.fill(load<std::int32_t>(first + 8));
      xMedians.fill({});
      yMedians.fill({});
      for (auto& model : changed) renew(model);
      renew(otherChannel);
      returnCount.reset();
      returnNumber.reset();
      renew(returnStep);
      renew(dx);
      renew(dy);
      renew(z);
      classification.reset();
      flags.reset();
      userData.reset();
      renew(intensity);
      renew(scanAngle);
      renew(pointSource);
      time.start(first + 22);
    }

    alignas(8) std::byte last[kSize];
    bool timeChanged;
    std::array<std::uint16_t, 8> intensities;
    std::array<std::int32_t, 8> heights;
    std::array<StreamingMedian, 12> xMedians, yMedians;
    std::array<SymbolModel<128>, 8> changed;
    SymbolModel<3> otherChannel;
    LazyModels<16, 16> returnCount, returnNumber;
    SymbolModel<13> returnStep;
    IntegerModel<32, 2> dx;
    IntegerModel<32, 22> dy;
    IntegerModel<32, 20> z;
    LazyModels<256, 64> classification, userData;
    LazyModels<64, 64> flags;
    IntegerModel<16, 4> intensity;
    IntegerModel<16, 2> scanAngle;
    IntegerModel<16, 1> pointSource;
    GpsTime<true> time;
  };

  /// What changed, and where the new point stands among its pulse's returns.
  struct Changes {
    bool channel = false, source = false, time = false, angle = false;
    unsigned count = 0, number = 0;
    unsigned standing() const { return (number == 1 ? 2 : 0) + (number >= count ? 1 : 0); }  // first, last
  };

  static unsigned channelOf(const std::byte* at) { return byteAt(at + 15) >> 4 & 3; }
  static unsigned numberOf(const std::byte* at) { return byteAt(at + 14) & 15; }
  static unsigned countOf(const std::byte* at) { return byteAt(at + 14) >> 4; }

  template <class Coder>
  Changes codeChanges(Coder& coder, const std::byte* at) {
    Context* c = &m_channels[m_channel];
    const unsigned lastStanding = (numberOf(c->last) == 1 ? 1 : 0) + (numberOf(c->last) >= countOf(c->last) ? 2 : 0) +
                                  (c->timeChanged ? 4 : 0);
    unsigned changed = 0, channel = m_channel;
    if constexpr (Coder::kEncodes) {
      channel = channelOf(at);
      const std::byte* last = m_channels.used(channel) ? m_channels[channel].last : c->last;
      const unsigned step = (numberOf(at) - numberOf(last)) & 15;
      changed = (channel != m_channel) << 6 | (load<std::uint16_t>(at + 20) != load<std::uint16_t>(last + 20)) << 5 |
                (load<std::uint64_t>(at + 22) != load<std::uint64_t>(last + 22)) << 4 |
                (load<std::int16_t>(at + 18) != load<std::int16_t>(last + 18)) << 3 |
                (countOf(at) != countOf(last)) << 2 | (step == 0 ? 0 : step == 1 ? 1 : step == 15 ? 2 : 3);
    }
    changed = coder.symbol(c->changed[lastStanding], changed);
    if (changed & 64) {
      channel = (m_channel + 1 + coder.symbol(c->otherChannel, (channel - m_channel - 1) & 3)) & 3;
      if (!m_channels.used(channel)) m_channels.use(channel, [&](Context& fresh) { fresh.start(c->last); });
      m_channel = channel;
      c = &m_channels[channel];
      c->last[15] = static_cast<std::byte>((byteAt(c->last + 15) & ~0x30u) | channel << 4);
    }
    Changes changes;
    changes.channel = changed & 64;
    changes.source = changed & 32;
    changes.time = changed & 16;
    changes.angle = changed & 8;
    changes.count = countOf(c->last);
    if (changed & 4) changes.count = coder.symbol(c->returnCount[changes.count], Coder::kEncodes ? countOf(at) : 0);
    changes.number = codeReturnNumber(coder, *c, changed & 3, changes.time, at);
    c->last[14] = static_cast<std::byte>(changes.count << 4 | changes.number);
    return changes;
  }

  template <class Coder>
  unsigned codeReturnNumber(Coder& coder, Context& c, unsigned how, bool timeChanged, const std::byte* at) {
    const unsigned last = numberOf(c.last);
    if (how == 0) return last;
    if (how == 1) return (last + 1) & 15;
    if (how == 2) return (last + 15) & 15;
    if (timeChanged) return coder.symbol(c.returnNumber[last], Coder::kEncodes ? numberOf(at) : 0);
    return (last + 2 + coder.symbol(c.returnStep, Coder::kEncodes ? (numberOf(at) - last - 2) & 15 : 0)) & 15;
  }

  template <class Coder>
  void codeXyz(Layer<Coder>* layers, Context& c, const Changes& changes, const std::byte* at) {
    Coder& xy = layers[kReturnsXy].coder;
    const unsigned median = returnContext(changes.count, changes.number) << 1 | (changes.time ? 1 : 0);
    const unsigned single = changes.count == 1;
    codeDifference(xy, c.dx, c.xMedians[median], single, c.last, at);
    codeDifference(xy, c.dy, c.yMedians[median], single + evenUpTo(c.dx.k, 20), c.last + 4, at + 4);
    Layer<Coder>& layer = layers[kZ];
    const auto value = load<std::int32_t>(at + 8);
    if constexpr (Coder::kEncodes) layer.present |= value != load<std::int32_t>(c.last + 8);
    if (!Coder::kEncodes && !layer.present) return;
    const int level = std::min(std::abs(static_cast<int>(changes.count) - static_cast<int>(changes.number)), 7);
    std::int32_t& height = c.heights[level];
    height = codeInteger(layer.coder, c.z, height, single + evenUpTo((c.dx.k + c.dy.k) / 2, 18), value);
    store(c.last + 8, height);
  }

  template <class Coder, int Contexts>
  static void codeDifference(Coder& coder, IntegerModel<32, Contexts>& model, StreamingMedian& median, unsigned context,
                             std::byte* last, const std::byte* at) {
    const auto before = load<std::int32_t>(last);
    const std::int32_t difference =
        codeInteger(coder, model, median.get(), context, minus(load<std::int32_t>(at), before));
    store(last, plus(before, difference));
    median.add(difference);
  }

  template <class Coder>
  void codeClassAndFlags(Layer<Coder>* layers, Context& c, const Changes& changes, const std::byte* at) {
    const auto changed = [](Layer<Coder>& layer, unsigned now, unsigned last) {
      if constexpr (Coder::kEncodes) layer.present |= now != last;
      return Coder::kEncodes || layer.present;
    };
    const unsigned lastClass = byteAt(c.last + 16);
    if (changed(layers[kClass], byteAt(at + 16), lastClass)) {
      const unsigned context = (lastClass & 0x1F) << 1 | (changes.standing() == 3 ? 1 : 0);
      c.last[16] = static_cast<std::byte>(layers[kClass].coder.symbol(c.classification[context], byteAt(at + 16)));
    }
    const unsigned lastFlags = flagsOf(c.last);
    if (changed(layers[kFlags], flagsOf(at), lastFlags)) {
      const unsigned flags = layers[kFlags].coder.symbol(c.flags[lastFlags], flagsOf(at));
      c.last[15] = static_cast<std::byte>((flags & 15) | (byteAt(c.last + 15) & 0x30) | (flags & 0x30) << 2);
    }
    const unsigned lastUser = byteAt(c.last + 17);
    if (changed(layers[kUser], byteAt(at + 17), lastUser))
      c.last[17] = static_cast<std::byte>(layers[kUser].coder.symbol(c.userData[lastUser / 4], byteAt(at + 17)));
  }

  /// Edge of flight line, scan direction and the four classification flags.
  static unsigned flagsOf(const std::byte* at) { return (byteAt(at + 15) & 15u) | (byteAt(at + 15) & 0xC0u) >> 2; }

  template <class Coder>
  void codeIntensity(Layer<Coder>& layer, Context& c, const Changes& changes, const std::byte* at) {
    const auto value = load<std::uint16_t>(at + 12);
    if constexpr (Coder::kEncodes) layer.present |= value != load<std::uint16_t>(c.last + 12);
    if (!Coder::kEncodes && !layer.present) return;
    std::uint16_t& predicted = c.intensities[changes.standing() << 1 | (changes.time ? 1 : 0)];
    predicted = static_cast<std::uint16_t>(codeInteger(layer.coder, c.intensity, predicted, changes.standing(), value));
    store(c.last + 12, predicted);
  }

  template <class Coder>
  void codeAngleUserSource(Layer<Coder>* layers, Context& c, const Changes& changes, const std::byte* at) {
    if constexpr (Coder::kEncodes) {
      layers[kAngle].present |= changes.angle;
      layers[kSource].present |= changes.source;
    }
    if (changes.angle && layers[kAngle].present)
      store(c.last + 18, static_cast<std::int16_t>(codeInteger(layers[kAngle].coder, c.scanAngle,
                                                               load<std::int16_t>(c.last + 18), changes.time ? 1 : 0,
                                                               load<std::int16_t>(at + 18))));
    if (changes.source && layers[kSource].present)
      store(c.last + 20, static_cast<std::uint16_t>(codeInteger(layers[kSource].coder, c.pointSource,
                                                                load<std::uint16_t>(c.last + 20), 0,
                                                                load<std::uint16_t>(at + 20))));
  }

  /// Number of returns (row) and return number (column) as one of six contexts.
  static unsigned returnContext(unsigned count, unsigned number) {
    static constexpr std::uint8_t kMap[16][16] = {
        {0, 1, 2, 3, 4, 5, 3, 4, 4, 5, 5, 5, 5, 5, 5, 5}, {1, 0, 1, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3},
        {2, 1, 2, 4, 4, 4, 4, 4, 4, 4, 4, 3, 3, 3, 3, 3}, {3, 3, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
        {4, 3, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4}, {5, 3, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
        {3, 3, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4}, {4, 3, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4},
        {4, 3, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4}, {5, 3, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4},
        {5, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 4, 4, 4},
        {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4, 4}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4},
        {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5}};
    return kMap[count][number];
  }

  bool m_tellsAlways;
  unsigned m_channel = 0;
  Channels<Context> m_channels;
};

/// How the items behind POINT14 follow the scanner channel. On a change to a channel that was seen
/// before, version 3 goes on from the last values of the channel left, for this one point (another slip that
/// became the format); version 4 from the channel's own.
template <class Context>
class ChannelFollower {
 public:
  explicit ChannelFollower(int version = 3) : m_stale(version == 3) {}

  template <class Init>
  void start(unsigned channel, const Init& init) {
    m_channel = channel;
    m_channels.start(channel, init);
  }
  /// The context whose models are in force, and the one whose last values are.
  template <class Init>
  std::pair<Context*, Context*> follow(unsigned channel, const Init& initFrom) {
    Context* last = &m_channels[m_channel];
    if (channel != m_channel) {
      m_channel = channel;
      if (!m_channels.used(channel)) {
        m_channels.use(channel, [&](Context& fresh) { initFrom(fresh, *last); });
        last = &m_channels[channel];
      } else if (!m_stale) {
        last = &m_channels[channel];
      }
    }
    return {&m_channels[channel], last};
  }

 private:
  bool m_stale;
  unsigned m_channel = 0;
  Channels<Context> m_channels;
};

/// RGB14 (6 bytes) and RGBNIR14 (8 bytes).
class Rgb14 {
 public:
  Rgb14(int version, bool infrared) : m_infrared(infrared), m_contexts(version) {}
  std::size_t size() const { return m_infrared ? 8 : 6; }
  std::size_t layers() const { return m_infrared ? 2 : 1; }

  void start(unsigned channel, const std::byte* first) {
    m_contexts.start(channel, [&](Context& c) {
      std::memcpy(c.last, first, size());
      c.startModels();
    });
  }

  template <class Coder>
  void code(Layer<Coder>* layers, unsigned channel, std::byte* at) {
    const auto [models, last] = m_contexts.follow(channel, [](Context& fresh, const Context& from) {
      std::memcpy(fresh.last, from.last, sizeof from.last);
      fresh.startModels();
    });
    std::uint16_t now[4] = {};
    std::memcpy(now, Coder::kEncodes ? at : reinterpret_cast<const std::byte*>(last->last), size());
    if constexpr (Coder::kEncodes) layers[0].present |= std::memcmp(now, last->last, 6) != 0;
    if (Coder::kEncodes || layers[0].present) codeRgb(layers[0].coder, models->rgb, last->last, now);
    if (m_infrared) {
      if constexpr (Coder::kEncodes) layers[1].present |= now[3] != last->last[3];
      if (Coder::kEncodes || layers[1].present) codeInfrared(layers[1].coder, *models, last->last[3], now[3]);
    }
    if constexpr (!Coder::kEncodes) std::memcpy(at, now, size());
  }

 private:
  struct Context {
    void startModels() {
      rgb.start();
      renew(infraredUsed);
      for (auto& model : infrared) renew(model);
    }
    std::uint16_t last[4] = {};
    RgbModels rgb;
    SymbolModel<4> infraredUsed;
    std::array<SymbolModel<256>, 2> infrared;
  };

  template <class Coder>
  static void codeInfrared(Coder& coder, Context& c, std::uint16_t& last, std::uint16_t& now) {
    unsigned used = 0;
    if constexpr (Coder::kEncodes) used = ((now ^ last) & 0xFF ? 1 : 0) | ((now ^ last) & 0xFF00 ? 2 : 0);
    used = coder.symbol(c.infraredUsed, used);
    unsigned bytes[2] = {last & 0xFFu, static_cast<unsigned>(last >> 8)};
    for (int i = 0; i < 2; ++i) {
      if (!(used >> i & 1)) continue;
      const unsigned difference = Coder::kEncodes ? ((now >> 8 * i) - bytes[i]) & 0xFF : 0;
      bytes[i] = (bytes[i] + coder.symbol(c.infrared[i], difference)) & 0xFF;
    }
    last = now = static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8);
  }

  bool m_infrared;
  ChannelFollower<Context> m_contexts;
};

/// WAVEPACKET14.
class WavePacket14 {
 public:
  explicit WavePacket14(int version) : m_contexts(version) {}

  void start(unsigned channel, const std::byte* first) {
    m_contexts.start(channel, [&](WavePacket& c) { c.start(first); });
  }

  template <class Coder>
  void code(Layer<Coder>& layer, unsigned channel, std::byte* at) {
    const auto [models, last] =
        m_contexts.follow(channel, [](WavePacket& fresh, WavePacket& from) { fresh.start(from.last()); });
    if constexpr (Coder::kEncodes) layer.present |= std::memcmp(at, last->last(), WavePacket::kSize) != 0;
    if (Coder::kEncodes || layer.present)
      models->codeAgainst(layer.coder, last->last(), at);
    else
      std::memcpy(at, last->last(), WavePacket::kSize);
  }

 private:
  ChannelFollower<WavePacket> m_contexts;
};

/// Extra bytes, each a layer: BYTE14.
class ExtraBytes14 {
 public:
  ExtraBytes14(int version, std::size_t size) : m_size(size), m_contexts(version) {}
  std::size_t size() const { return m_size; }

  void start(unsigned channel, const std::byte* first) {
    m_contexts.start(channel, [&](Context& c) { c.start(first, m_size); });
  }

  template <class Coder>
  void code(Layer<Coder>* layers, unsigned channel, std::byte* at) {
    const auto [models, last] = m_contexts.follow(
        channel, [&](Context& fresh, Context& from) { fresh.start(from.last.data(), m_size); });
    for (std::size_t i = 0; i < m_size; ++i) {
      std::byte& before = last->last[i];
      if constexpr (Coder::kEncodes) layers[i].present |= at[i] != before;
      if (Coder::kEncodes || layers[i].present) {
        const auto difference = static_cast<std::uint8_t>(byteAt(at + i) - byteAt(&before));
        before = static_cast<std::byte>(byteAt(&before) + layers[i].coder.symbol(models->models[i], difference));
      }
      if constexpr (!Coder::kEncodes) at[i] = before;
    }
  }

 private:
  struct Context {
    void start(const std::byte* first, std::size_t size) {
      last.assign(first, first + size);
      models.resize(size);
      for (auto& model : models) renew(model);
    }
    std::vector<std::byte> last;
    std::vector<SymbolModel<256>> models;
  };

  std::size_t m_size;
  ChannelFollower<Context> m_contexts;
};

}  // namespace ALIDADE_LAZ_SET
}  // namespace alidade::laz
