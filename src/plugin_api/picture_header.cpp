// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "plugin_api/picture_header.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "base/input_file.h"

namespace alidade {

namespace {

// A blank 1-bit PNG packs 8 × 1032 pixels into a byte (deflate's best); nothing in use packs more.
constexpr double kMaxPixelsPerByte = 10000.0;
constexpr std::int64_t kAlwaysAllowedPixels = std::int64_t(4) << 20;
constexpr std::int64_t kMaxPixels = std::int64_t(1) << 29;

/// A picture file, or one that stands inside another file and was read into memory.
class PictureBytes {
 public:
  explicit PictureBytes(const InputFile& file) : m_file(&file) {}
  explicit PictureBytes(std::span<const std::byte> memory) : m_memory(memory) {}

  std::uint64_t size() const { return m_file ? m_file->size() : m_memory.size(); }
  bool readAt(std::uint64_t offset, std::span<std::byte> into) const {
    if (m_file) return m_file->readAt(offset, into).has_value();
    if (offset > m_memory.size() || into.size() > m_memory.size() - offset) return false;
    std::memcpy(into.data(), m_memory.data() + offset, into.size());
    return true;
  }

 private:
  const InputFile* m_file = nullptr;
  std::span<const std::byte> m_memory;
};

bool readInto(const PictureBytes& file, std::uint64_t offset, std::span<unsigned char> bytes) {
  return file.readAt(offset, std::as_writable_bytes(bytes));
}

std::uint64_t bigEndian(std::span<const unsigned char> bytes) {
  std::uint64_t value = 0;
  for (const unsigned char b : bytes) value = value << 8 | b;
  return value;
}

std::uint64_t littleEndian(std::span<const unsigned char> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | bytes[i];
  return value;
}

using Size = std::array<std::int64_t, 2>;

std::optional<Size> pngSize(const PictureBytes& file) {
  std::array<unsigned char, 16> b{};
  if (!readInto(file, 8, b) || std::memcmp(b.data() + 4, "IHDR", 4) != 0) return std::nullopt;
  const std::span<const unsigned char> all(b);
  return Size{std::int64_t(bigEndian(all.subspan(8, 4))), std::int64_t(bigEndian(all.subspan(12, 4)))};
}

std::optional<Size> bmpSize(const PictureBytes& file) {
  std::array<unsigned char, 12> b{};
  if (!readInto(file, 14, b)) return std::nullopt;
  const std::span<const unsigned char> all(b);
  if (littleEndian(all.first(4)) == 12)  // OS/2's header: 16-bit sizes
    return Size{std::int64_t(littleEndian(all.subspan(4, 2))), std::int64_t(littleEndian(all.subspan(6, 2)))};
  const auto height = static_cast<std::int32_t>(littleEndian(all.subspan(8, 4)));
  return Size{static_cast<std::int32_t>(littleEndian(all.subspan(4, 4))), height < 0 ? -std::int64_t(height) : height};
}

std::optional<Size> webpSize(const PictureBytes& file) {
  std::array<unsigned char, 18> b{};
  if (!readInto(file, 12, b)) return std::nullopt;
  const std::span<const unsigned char> all(b);
  if (std::memcmp(b.data(), "VP8X", 4) == 0)
    return Size{std::int64_t(littleEndian(all.subspan(12, 3))) + 1, std::int64_t(littleEndian(all.subspan(15, 3))) + 1};
  if (std::memcmp(b.data(), "VP8L", 4) == 0) {
    const std::uint64_t bits = littleEndian(all.subspan(9, 4));
    return Size{std::int64_t(bits & 0x3fff) + 1, std::int64_t(bits >> 14 & 0x3fff) + 1};
  }
  if (std::memcmp(b.data(), "VP8 ", 4) != 0) return std::nullopt;
  return Size{std::int64_t(littleEndian(all.subspan(14, 2)) & 0x3fff), std::int64_t(littleEndian(all.subspan(16, 2)) & 0x3fff)};
}

/// First directory of a classic or big TIFF: tags 256 (width) and 257 (height).
std::optional<Size> tiffSize(const PictureBytes& file) {
  std::array<unsigned char, 16> head{};
  if (!readInto(file, 0, std::span(head).first(8))) return std::nullopt;
  const bool little = head[0] == 'I';
  const auto number = [&](std::span<const unsigned char> bytes) { return little ? littleEndian(bytes) : bigEndian(bytes); };
  const std::span<const unsigned char> h(head);
  const bool big = number(h.subspan(2, 2)) == 43;
  if (big && !readInto(file, 0, head)) return std::nullopt;
  const std::uint64_t directory = big ? number(h.subspan(8, 8)) : number(h.subspan(4, 4));
  const std::size_t countBytes = big ? 8 : 2, entryBytes = big ? 20 : 12, valueAt = big ? 12 : 8;
  std::array<unsigned char, 20> entry{};
  if (!readInto(file, directory, std::span(entry).first(countBytes))) return std::nullopt;
  const std::uint64_t count = std::min<std::uint64_t>(number(std::span(entry).first(countBytes)), 4096);
  Size size{0, 0};
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!readInto(file, directory + countBytes + i * entryBytes, std::span(entry).first(entryBytes))) return std::nullopt;
    const std::span<const unsigned char> e(entry);
    const std::uint64_t tag = number(e.first(2)), type = number(e.subspan(2, 2));
    if (tag != 256 && tag != 257) continue;
    size[tag - 256] = std::int64_t(number(e.subspan(valueAt, type == 3 ? 2 : 4)));
  }
  return size;
}

/// Walks the segments of a JPEG (ITU-T T.81, annex B) and calls `visit(marker, offset, length)` with
/// the payload of each; stops where it returns false or at the first entropy-coded data.
template <class Visit>
std::optional<std::uint64_t> walkJpegSegments(const PictureBytes& file, std::uint64_t at, Visit&& visit) {
  std::array<unsigned char, 4> b{};
  while (readInto(file, at, std::span(b).first(2))) {
    if (b[0] != 0xff) return std::nullopt;
    if (b[1] == 0xff) {  // fill byte
      ++at;
      continue;
    }
    const unsigned marker = b[1];
    if (marker == 0xd9 || marker == 0x01 || (marker >= 0xd0 && marker <= 0xd8)) {
      if (!visit(marker, at + 2, std::uint64_t(0))) return at + 2;
      at += 2;
      continue;
    }
    if (!readInto(file, at, b)) return std::nullopt;
    const std::uint64_t length = bigEndian(std::span(b).subspan(2, 2));
    if (length < 2) return std::nullopt;
    if (!visit(marker, at + 4, length - 2)) return at + 2 + length;
    at += 2 + length;
    if (marker == 0xda) return at;
  }
  return std::nullopt;
}

std::optional<Size> jpegSize(const PictureBytes& file) {
  std::optional<Size> size;
  walkJpegSegments(file, 2, [&](unsigned marker, std::uint64_t offset, std::uint64_t length) {
    const bool startOfFrame = marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (!startOfFrame) return true;
    std::array<unsigned char, 5> b{};
    if (length >= 5 && readInto(file, offset, b))
      size = Size{std::int64_t(bigEndian(std::span(b).subspan(3, 2))), std::int64_t(bigEndian(std::span(b).subspan(1, 2)))};
    return false;
  });
  return size;
}

/// From entropy-coded data at `at` to the next true marker; nothing where the file ends first.
std::optional<std::uint64_t> endOfEntropyData(const PictureBytes& file, std::uint64_t at) {
  std::vector<unsigned char> block(std::size_t(1) << 18);
  while (at + 1 < file.size()) {
    const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(block.size(), file.size() - at));
    if (!readInto(file, at, std::span(block).first(count))) return std::nullopt;
    std::size_t i = 0;
    while (i + 1 < count) {
      const auto* hit = static_cast<const unsigned char*>(std::memchr(block.data() + i, 0xff, count - 1 - i));
      if (!hit) break;
      i = static_cast<std::size_t>(hit - block.data());
      const unsigned char next = block[i + 1];
      if (next != 0x00 && next != 0xff && !(next >= 0xd0 && next <= 0xd7)) return at + i;
      i += next == 0xff ? 1 : 2;
    }
    at += count - 1;  // a marker may straddle two blocks
  }
  return std::nullopt;
}

bool jpegReachesItsEnd(const PictureBytes& file) {
  bool ended = false;
  std::optional<std::uint64_t> at = 2;
  while (at && !ended) {
    at = walkJpegSegments(file, *at, [&](unsigned marker, std::uint64_t, std::uint64_t) {
      ended = marker == 0xd9;
      return !ended;
    });
    if (at && !ended) at = endOfEntropyData(file, *at);
  }
  return ended;
}

}  // namespace

PictureFormat pictureFormatOf(std::span<const std::byte> head) {
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  if (text.starts_with("\x89PNG\r\n\x1a\n")) return PictureFormat::Png;
  if (text.starts_with("\xff\xd8\xff")) return PictureFormat::Jpeg;
  if (text.starts_with(std::string_view("II*\0", 4)) || text.starts_with(std::string_view("MM\0*", 4)) ||
      text.starts_with(std::string_view("II+\0", 4)) || text.starts_with(std::string_view("MM\0+", 4)))
    return PictureFormat::Tiff;
  if (text.starts_with("RIFF") && text.substr(std::min<std::size_t>(8, text.size())).starts_with("WEBP"))
    return PictureFormat::WebP;
  if (text.starts_with("BM")) return PictureFormat::Bmp;
  return PictureFormat::None;
}

std::string_view pictureFormatName(PictureFormat format) {
  switch (format) {
    case PictureFormat::Png: return "PNG";
    case PictureFormat::Jpeg: return "JPEG";
    case PictureFormat::Tiff: return "TIFF";
    case PictureFormat::Bmp: return "BMP";
    case PictureFormat::WebP: return "WebP";
    case PictureFormat::None: break;
  }
  return "no picture";
}

bool isPictureExtension(std::string_view extension) {
  constexpr std::array<std::string_view, 7> known = {"png", "jpg", "jpeg", "tif", "tiff", "bmp", "webp"};
  return std::find(known.begin(), known.end(), extension) != known.end();
}

namespace {

Result<PictureHeader> headerOf(const PictureBytes& file, const std::string& path) {
  if (file.size() == 0) return fail("The picture file is empty", path, "Copy the file again");
  std::array<unsigned char, 12> head{};
  const auto headBytes = static_cast<std::size_t>(std::min<std::uint64_t>(head.size(), file.size()));
  if (!readInto(file, 0, std::span(head).first(headBytes))) return fail("The picture cannot be read", path, "Check the disk");

  PictureHeader header;
  header.format = pictureFormatOf(std::as_bytes(std::span(head)).first(headBytes));
  std::optional<Size> size;
  switch (header.format) {
    case PictureFormat::Png: size = pngSize(file); break;
    case PictureFormat::Jpeg: size = jpegSize(file); break;
    case PictureFormat::Tiff: size = tiffSize(file); break;
    case PictureFormat::Bmp: size = bmpSize(file); break;
    case PictureFormat::WebP: size = webpSize(file); break;
    case PictureFormat::None:
      return fail("The file is no picture that can be read", path, "Save it as PNG, JPEG, TIFF, BMP or WebP");
  }
  const std::string format(pictureFormatName(header.format));
  if (!size) return fail("The " + format + " header is cut off or damaged", path, "Copy the file again");
  const auto [width, height] = *size;
  const std::string words = std::to_string(width) + " × " + std::to_string(height) + " pixels";
  if (width < 1 || height < 1 || width > 1 << 20 || height > 1 << 20 || width * height > kMaxPixels)
    return fail("The " + format + " header says " + words + ", which is not read", path,
                "At most 536 million pixels are read: export a smaller picture");
  if (width * height > kAlwaysAllowedPixels && double(width * height) > kMaxPixelsPerByte * double(file.size()))
    return fail("The " + format + " header promises " + words + ", the file holds only " +
                    std::to_string(file.size()) + " bytes", path, "The file is damaged: copy it again");
  header.width = static_cast<int>(width);
  header.height = static_cast<int>(height);
  return header;
}

Result<void> completenessOf(const PictureBytes& file, const std::string& path, const PictureHeader& header) {
  if (header.format == PictureFormat::Jpeg && !jpegReachesItsEnd(file))
    return fail("The JPEG is cut off or damaged: its end marker is missing", path, "Copy the file again");
  return {};
}

}  // namespace

Result<PictureHeader> readPictureHeader(const std::string& path) {
  const auto file = InputFile::open(path);
  if (!file) return fail(file.error());
  return headerOf(PictureBytes(*file), path);
}

Result<PictureHeader> pictureHeaderOf(std::span<const std::byte> bytes, const std::string& where) {
  return headerOf(PictureBytes(bytes), where);
}

Result<void> checkPictureComplete(const std::string& path, const PictureHeader& header) {
  if (header.format != PictureFormat::Jpeg) return {};
  const auto file = InputFile::open(path);
  if (!file) return fail(file.error());
  return completenessOf(PictureBytes(*file), path, header);
}

Result<void> checkPictureComplete(std::span<const std::byte> bytes, const std::string& where, const PictureHeader& header) {
  return completenessOf(PictureBytes(bytes), where, header);
}

ColourImage colourImageFrom(const RawPicture& raw) {
  ColourImage image(raw.width, raw.height, Uncleared{});
  const auto convert = [&](auto sample, auto&& narrow) {
    using Sample = decltype(sample);
    for (int y = 0; y < raw.height; ++y) {
      const auto* in = reinterpret_cast<const Sample*>(raw.data + raw.rowBytes * static_cast<std::size_t>(y));
      Rgba8* out = image.row(y);
      for (int x = 0; x < raw.width; ++x, in += raw.channels) {
        const bool gray = raw.channels < 3;
        out[x].b = narrow(in[0]);
        out[x].g = narrow(in[gray ? 0 : 1]);
        out[x].r = narrow(in[gray ? 0 : 2]);
        out[x].a = raw.channels == 2 ? narrow(in[1]) : raw.channels == 4 ? narrow(in[3]) : std::uint8_t(255);
      }
    }
  };
  if (raw.bytesPerChannel == 2)
    convert(std::uint16_t{}, [](std::uint16_t v) { return static_cast<std::uint8_t>((v + 128u) / 257u); });
  else
    convert(std::uint8_t{}, [](std::uint8_t v) { return v; });
  return image;
}

}  // namespace alidade
