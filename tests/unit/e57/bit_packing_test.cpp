// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <random>

#include <gmock/gmock.h>

#include "e57/bit_packing.h"
#include "e57/crc32c.h"
#include "unit/e57/e57_builder.h"

using namespace alidade;
using alidade::testing::BitWriter;
using ::testing::ElementsAre;

namespace {

std::vector<std::byte> bytesOf(const std::string& text) {
  std::vector<std::byte> bytes(text.size() + 16);
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

std::vector<std::int64_t> unpacked(const std::string& stream, std::uint64_t firstBit, int bits, std::int64_t minimum, std::size_t count) {
  std::vector<std::int64_t> out(count);
  unpackIntegers(bytesOf(stream).data(), firstBit, bits, minimum, count, out.data());
  return out;
}

}  // namespace

TEST(Crc32c, GivesThePublishedSums) {
  const auto sum = [](const std::string& text) { return crc32c(std::as_bytes(std::span(text))); };
  EXPECT_EQ(sum("123456789"), 0xE3069283u);          // the check value of CRC-32C
  EXPECT_EQ(sum(std::string(32, '\0')), 0x8A9136AAu);  // RFC 3720 B.4
  EXPECT_EQ(sum(std::string(32, '\xff')), 0x62A8AB43u);
  EXPECT_EQ(sum(""), 0u);
}

TEST(Crc32c, InstructionAndTableAgreeAtEveryLength) {
  std::mt19937 random(1);
  std::vector<std::byte> bytes(1020);
  for (auto& each : bytes) each = static_cast<std::byte>(random());
  for (std::size_t n = 0; n <= bytes.size(); n += n < 40 ? 1 : 49)
    EXPECT_EQ(crc32c({bytes.data(), n}), crc32cByTable({bytes.data(), n})) << n;
}

TEST(BitPacking, CountsTheBitsOfARange) {
  EXPECT_EQ(packedBits(5, 5), 0);
  EXPECT_EQ(packedBits(0, 1), 1);
  EXPECT_EQ(packedBits(0, 255), 8);
  EXPECT_EQ(packedBits(-500, 500), 10);
  EXPECT_EQ(packedBits(INT32_MIN, INT32_MAX), 32);
  EXPECT_EQ(packedBits(INT64_MIN, INT64_MAX), 64);
}

TEST(BitPacking, UnpacksBytesWorkedOutByHand) {
  // 3 bits each, lowest first: 1, 2, 3, 4, 5 is 001 010 011 100 101 from the right: 0101'1000'1101'0001.
  EXPECT_THAT(unpacked("\xd1\x58", 0, 3, 0, 5), ElementsAre(1, 2, 3, 4, 5));
  EXPECT_THAT(unpacked("\xd1\x58", 3, 3, -10, 4), ElementsAre(-8, -7, -6, -5));
  EXPECT_THAT(unpacked(std::string("\x34\x12\xff\xff", 4), 0, 16, -1, 2), ElementsAre(0x1233, 0xfffe));
  EXPECT_THAT(unpacked("", 0, 0, 42, 3), ElementsAre(42, 42, 42));
}

TEST(BitPacking, UnpacksEveryWidthFromEveryBit) {
  std::mt19937_64 random(7);
  for (int bits = 1; bits <= 64; ++bits) {
    for (int lead = 0; lead < 8; ++lead) {
      BitWriter writer;
      writer.put(random(), lead);
      std::vector<std::int64_t> truth;
      for (int i = 0; i < 20; ++i) {
        const std::uint64_t raw = bits == 64 ? random() : random() & ((std::uint64_t(1) << bits) - 1);
        writer.put(raw, bits);
        truth.push_back(static_cast<std::int64_t>(raw + static_cast<std::uint64_t>(std::int64_t(-1234567))));
      }
      ASSERT_EQ(unpacked(writer.bytes(), static_cast<std::uint64_t>(lead), bits, -1234567, 20), truth) << bits << " bits from " << lead;
    }
  }
}
