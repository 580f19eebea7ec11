// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <vector>

#include "e57/bit_packing.h"
#include "e57/e57_document.h"

namespace alidade {

/// The values of one field over a run of records: `whole` for Integer, `real` for the other kinds; neither
/// for a String, which no column of a point batch can hold.
struct FieldColumn {
  std::vector<double> real;
  std::vector<std::int64_t> whole;
};
using RecordColumns = std::vector<FieldColumn>;

/// Reads the records of one scan: a compressed vector's section (ASTM E2807-11, 9.3), whose packets carry
/// a piece of every field's stream each. Streams run on over packets, and a record's values need not
/// stand in one packet. Memory: a few packets, as long as the writer kept the streams in step.
class RecordReader {
 public:
  /// Checks the section's header and that it has room for the records. The scan and the file must outlive it.
  static Result<RecordReader> open(const PagedFile& file, const E57Scan& scan, std::size_t runPages);

  /// Bytes of the section; 0 where the scan has none.
  std::uint64_t sectionLength() const { return m_end - m_begin; }
  std::uint64_t recordsLeft() const { return m_left; }

  /// The next records, at most `most`, in `columns` (one a field); 0 when all were read. Error where the
  /// section ends before.
  Result<std::size_t> next(std::size_t most, RecordColumns& columns);

  /// Records of the first packet that holds one at or behind number `from`, at most `most`; 0 where there
  /// is none. Only that packet is decoded, and of those before it the first bytes are read. Not to be mixed
  /// with next(). `first` is the number of the first record returned, `end` that behind the packet's last.
  Result<std::size_t> nextFrom(std::uint64_t from, std::size_t most, RecordColumns& columns, std::uint64_t& first, std::uint64_t& end);

 private:
  struct Packet {
    std::uint64_t offset = 0;      ///< logical
    std::uint32_t length = 0;      ///< bytes
    std::uint32_t dataOffset = 0;  ///< of the first stream's piece within the packet
    std::vector<std::uint16_t> pieces;
  };

  RecordReader(const PagedFile& file, const E57Scan& scan, std::size_t runPages);
  Error damaged(const std::string& what, std::uint64_t logical) const;
  /// The next data packet's head; false at the end of the section.
  Result<bool> nextPacket(Packet& packet);
  Result<void> append(const Packet& packet);
  std::uint64_t recordsWaiting() const;
  void decode(std::size_t count, RecordColumns& columns);
  std::size_t bytesHeld() const;

  const PagedFile* m_file;
  const E57Scan* m_scan;
  PageReader m_pages;
  std::uint64_t m_begin = 0, m_position = 0, m_end = 0;  ///< logical
  std::uint64_t m_left = 0;
  std::vector<std::uint64_t> m_bits;       ///< a record's, by field
  std::vector<BitStream> m_streams;
  std::vector<std::uint64_t> m_bitsBefore; ///< of each stream, before m_position; for nextFrom
};

}  // namespace alidade
