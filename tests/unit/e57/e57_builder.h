// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace alidade::testing {

/// CRC-32C bit by bit, straight from its definition.
inline std::uint32_t slowCrc32c(const char* bytes, std::size_t count) {
  std::uint32_t sum = 0xFFFFFFFF;
  for (std::size_t i = 0; i < count; ++i) {
    sum ^= static_cast<unsigned char>(bytes[i]);
    for (int bit = 0; bit < 8; ++bit) sum = sum & 1 ? sum >> 1 ^ 0x82F63B78 : sum >> 1;
  }
  return ~sum;
}

template <class T>
void putLittleEndian(std::string& into, std::size_t at, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) into[at + i] = static_cast<char>(static_cast<std::uint64_t>(value) >> 8 * i & 255);
}

/// Bits packed one after the other, lowest first, one at a time.
class BitWriter {
 public:
  void put(std::uint64_t value, int bits) {
    for (int i = 0; i < bits; ++i, ++m_count) {
      if (m_count % 8 == 0) m_bytes += '\0';
      if (value >> i & 1) m_bytes.back() = static_cast<char>(m_bytes.back() | 1 << m_count % 8);
    }
  }
  const std::string& bytes() const { return m_bytes; }

 private:
  std::string m_bytes;
  int m_count = 0;
};

/// Builds E57 files by the standard's own words, apart from the reader's code.
class E57Builder {
 public:
  /// Puts bytes into the file's content and returns their *physical* offset.
  std::uint64_t add(const std::string& bytes) {
    while (m_content.size() % 4 != 0) m_content += '\0';
    const std::uint64_t at = m_content.size();
    m_content += bytes;
    return physical(at);
  }

  /// A compressed vector's section of the streams, cut into packets of at most `piece` bytes a stream.
  std::uint64_t addPoints(const std::vector<std::string>& streams, std::size_t piece = 8000, int sectionId = 1) {
    while (m_content.size() % 4 != 0) m_content += '\0';
    const std::size_t begin = m_content.size();
    m_content += std::string(32, '\0');
    std::size_t longest = 0;
    for (const std::string& stream : streams) longest = std::max(longest, stream.size());
    for (std::size_t at = 0; at < longest; at += piece) {
      std::string packet(6 + 2 * streams.size(), '\0');
      for (std::size_t i = 0; i < streams.size(); ++i) {
        const std::string part = at < streams[i].size() ? streams[i].substr(at, piece) : std::string();
        putLittleEndian(packet, 6 + 2 * i, static_cast<std::uint16_t>(part.size()));
        packet += part;
      }
      while (packet.size() % 4 != 0) packet += '\0';
      packet[0] = 1;
      putLittleEndian(packet, 2, static_cast<std::uint16_t>(packet.size() - 1));
      putLittleEndian(packet, 4, static_cast<std::uint16_t>(streams.size()));
      m_content += packet;
    }
    m_content[begin] = static_cast<char>(sectionId);
    putLittleEndian(m_content, begin + 8, std::uint64_t(m_content.size() - begin));
    putLittleEndian(m_content, begin + 16, physical(begin + 32));
    return physical(begin);
  }

  /// The whole file with this inside e57Root.
  std::string finish(const std::string& inRoot) {
    const std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\" "
                            "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\">" + inRoot + "</e57Root>\n";
    const std::uint64_t xmlAt = add(xml);
    std::string content = m_content;
    while (content.size() % 1020 != 0) content += '\0';
    content.replace(0, 8, "ASTM-E57");
    putLittleEndian(content, 8, std::uint32_t(1));
    putLittleEndian(content, 16, std::uint64_t(content.size() / 1020 * 1024));
    putLittleEndian(content, 24, xmlAt);
    putLittleEndian(content, 32, std::uint64_t(xml.size()));
    putLittleEndian(content, 40, std::uint64_t(1024));
    return paged(content);
  }

  /// Content of whole pages with their checksums behind each.
  static std::string paged(const std::string& content) {
    std::string file;
    for (std::size_t at = 0; at < content.size(); at += 1020) {
      const std::uint32_t sum = slowCrc32c(content.data() + at, 1020);
      file += content.substr(at, 1020);
      for (int shift = 24; shift >= 0; shift -= 8) file += static_cast<char>(sum >> shift & 255);
    }
    return file;
  }

 private:
  static std::uint64_t physical(std::uint64_t logical) { return logical / 1020 * 1024 + logical % 1020; }

  std::string m_content = std::string(48, '\0');
};

}  // namespace alidade::testing
